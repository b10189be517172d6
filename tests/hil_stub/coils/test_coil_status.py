"""COIL_STATUS and the drive it reports, tick by tick, at several tick rates."""

from fractions import Fraction
from math import ceil, inf, nan

import pytest

from fsw.wire.messages import CoilBoot, CoilStatus
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.coil_driver import OFF, CoilLimits, Drive

RATES = (1, 2, 3, 7, 10, 50)


def test_off_is_all_zero():
    assert Drive(0, 0, 0.0) == OFF


class TestTheTableAt1Hz:
    """The contract's own numbers."""

    def test_a_pulse_of_3_s(self, rig_with):
        rig = rig_with(CoilLimits(1))
        rig.skip_to(100)
        fired = rig.step(rig.fire(coil=2, level=-3, seq=7))
        assert fired.status.lockout_ms == 0
        assert fired.drive == Drive(2, -3, 1.0)
        steps = [rig.step() for _ in range(102)]
        table = [
            (s.level, s.coil, s.remaining_ms, s.lockout_ms, s.seq) for s in (step.status for step in steps)
        ]
        assert table[:5] == [
            (-3, 2, 2000, 102_000, 7),
            (-3, 2, 1000, 101_000, 7),
            (-3, 2, 0, 100_000, 7),
            (0, 104 % 3, 0, 99_000, 7),
            (0, 105 % 3, 0, 98_000, 7),
        ]
        assert table[-1] == (0, 202 % 3, 0, 1000, 7)
        assert [step.drive for step in steps] == [Drive(2, -3, 1.0)] * 2 + [OFF] * 100
        again = rig.step(rig.fire(coil=0, level=1, seq=8))
        assert (rig.tick, again.status.lockout_ms, again.drive) == (203, 0, Drive(0, 1, 1.0))

    def test_boot_and_the_first_100_s(self, rig_with):
        rig = rig_with(CoilLimits(1, table_crc=0xDEADBEEF))
        first = rig.step(rig.fire())
        assert first.said == [
            CoilBoot(reason=0, version=1, table_crc=0xDEADBEEF),
            CoilStatus(level=0, coil=0, remaining_ms=0, current_ma=0, lockout_ms=100_000, seq=0),
        ]
        assert first.drive == OFF
        for tick in range(1, 100):
            step = rig.step(rig.fire(seq=tick, coil=tick % 3))
            report = step.status
            assert (report.level, report.coil, report.lockout_ms) == (0, tick % 3, 100_000 - 1000 * tick)
            assert step.reasons == [Reason.LOCKOUT]
            assert step.drive == OFF
        free = rig.step(rig.fire(seq=0))
        assert (rig.tick, free.status.lockout_ms, free.drive) == (100, 0, Drive(1, 3, 1.0))

    def test_per_coil_the_others_stay_free(self, rig_with):
        rig = rig_with(CoilLimits(1, shared=False))
        rig.skip_to(100)
        rig.step(rig.fire(coil=0, seq=1))
        for _ in range(2):
            assert rig.step(rig.fire(coil=1, seq=2)).drive == Drive(0, 3, 1.0)
        second = rig.step(rig.fire(coil=1, seq=2))
        assert (rig.tick, second.reasons, second.drive) == (103, [Reason.COIL_ON], Drive(1, 3, 1.0))
        steps = [rig.step() for _ in range(6)]
        assert [(s.coil, s.lockout_ms) for s in (step.status for step in steps)] == [
            (1, 102_000),
            (1, 101_000),
            (1, 100_000),
            (107 % 3, 0),
            (108 % 3, (203 - 108) * 1000),
            (109 % 3, (206 - 109) * 1000),
        ]


def expected(limits, fired, coil, level, duration_ms, tick):
    """The status after a pulse from exact time: (level, coil, remaining_ms, lockout_ms)."""
    since_ms = Fraction(tick - fired, limits.tick_hz) * 1000
    until_next = max(Fraction(0), duration_ms + limits.backoff_ms - since_ms)
    lockout = ceil(until_next / 10) * 10
    if duration_ms > Fraction(tick - 1 - fired, limits.tick_hz) * 1000:
        return level, coil, max(0, ceil(duration_ms - since_ms)), lockout
    return 0, tick % 3, 0, lockout if limits.shared or coil == tick % 3 else 0


@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per_coil"])
@pytest.mark.parametrize(
    ("hz", "duration_ms"),
    [(hz, ms) for hz in RATES for ms in (3000, 2500, 1)]
    + [(hz, ms) for hz in (1, 3, 10) for ms in (2, 333, 334, 999, 1000, 1001, 2999)],
)
def test_every_tick_of_a_pulse_and_its_lockout(rig_with, hz, duration_ms, shared):
    limits = CoilLimits(hz, shared=shared)
    rig = rig_with(limits)
    fired = 100 * hz
    free = fired + ceil(Fraction(duration_ms + 100_000, 1000) * hz)
    rig.skip_to(fired)
    step = rig.step(rig.fire(coil=2, level=-2, duration_ms=duration_ms))
    driven_ms = Fraction(0)
    while rig.tick < free - 1:
        if step.drive.level:
            assert (step.drive.coil, step.drive.level) == (2, -2)
            driven_ms += Fraction(round(step.drive.fraction * 1000), hz)
        step = rig.step(rig.fire(coil=2, level=1, seq=rig.tick & 0xFF | 2))
        report = step.status
        values = (report.level, report.coil, report.remaining_ms, report.lockout_ms)
        assert values == expected(limits, fired, 2, -2, duration_ms, rig.tick)
        assert report.seq == 1
    assert driven_ms == duration_ms, "driven for exactly as long as asked"
    step = rig.step(rig.fire(coil=2, level=1, seq=0))
    assert (rig.tick, step.drive.coil, step.drive.level) == (free, 2, 1), (
        "the first tick after the lockout is free"
    )


@pytest.mark.parametrize("hz", RATES)
def test_the_fraction_is_that_part_of_the_tick_that_is_driven(rig_with, hz):
    rig = rig_with(CoilLimits(hz, pulse_ms=2500))
    rig.skip_to(100 * hz)
    fractions = [rig.step(rig.fire(duration_ms=2500)).drive.fraction]
    while fractions[-1]:
        fractions.append(rig.step().drive.fraction)
    whole, part = divmod(2500 * hz, 1000)
    assert fractions == [1.0] * whole + ([part / 1000] if part else []) + [0.0]


def test_a_lockout_longer_than_its_signal_saturates(rig_with):
    rig = rig_with(CoilLimits(1, backoff_ms=200_000))
    lockouts_ms = [rig.step().status.lockout_ms for _ in range(200)]
    assert lockouts_ms == [min(200_000 - 1000 * tick, 163_830) for tick in range(200)]
    free = rig.step(rig.fire())
    assert (free.status.lockout_ms, free.drive.level) == (0, 3)


@pytest.mark.parametrize(
    ("current_a", "current_ma"),
    [(0.0, 0), (0.3, 300), (-0.3, -300), (0.0004, 0), (0.0006, 1), (2.047, 2047), (9.0, 2047), (-9.0, -2048)],
)
def test_the_current_read_back_is_passed_on(rig_with, current_a, current_ma):
    assert rig_with(CoilLimits(1)).step(current_a=current_a).status.current_ma == current_ma


@pytest.mark.parametrize("current_a", [nan, inf, -inf])
def test_a_current_that_is_not_a_number_is_at_the_end_of_the_range(rig_with, current_a):
    assert rig_with(CoilLimits(1)).step(current_a=current_a).status.current_ma in {-2048, 2047}


def test_one_status_a_tick_with_a_counter_that_rises(rig_with):
    rig = rig_with(CoilLimits(1))
    assert [rig.step().status.counter for _ in range(40)] == [n % 16 for n in range(40)]
