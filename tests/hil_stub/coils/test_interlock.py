"""The interlock: what it refuses and why, to the unit of time."""

from dataclasses import FrozenInstanceError, replace

import pytest
from interlocks import after_request, after_silence, after_ticks

from fsw.wire.messages import CoilFire
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.interlock import UNITS_PER_TICK, CoilLimits, Interlock, boot

TICK = 1234
LOW = TICK & 0xFF
GOOD = CoilFire(coil=1, level=-2, duration_ms=3000, seq=9, tick=LOW)

RATES = (1, 2, 3, 7, 10, 50, 1000)
NO_INTEGER = pytest.mark.interpreted
"""Compiled, the type is checked before: a TypeError, and True is 1."""


def ready(limits: CoilLimits, seq: int | None = None) -> Interlock:
    """Long after boot: nothing on, nothing locked out."""
    state = after_ticks(boot(limits), 10**6)
    assert state.lockout == (0, 0, 0)
    return replace(state, seq=seq)


@pytest.fixture(params=[True, False], ids=["shared", "per_coil"])
def limits(request) -> CoilLimits:
    return CoilLimits(tick_hz=1, shared=request.param)


class TestLimits:
    def test_defaults_are_those_of_the_invariant(self):
        limits = CoilLimits(10)
        assert (limits.pulse_ms, limits.backoff_ms, limits.shared, limits.table_crc) == (
            3000,
            100_000,
            True,
            0,
        )

    @pytest.mark.parametrize("hz", RATES)
    def test_a_second_is_a_thousand_units_times_the_rate(self, hz):
        limits = CoilLimits(hz)
        assert limits.units(1000) == hz * UNITS_PER_TICK
        assert limits.units(1) == hz

    @pytest.mark.parametrize("hz", RATES)
    def test_milliseconds_are_rounded_up_to_the_resolution(self, hz):
        limits = CoilLimits(hz)
        assert limits.milliseconds(0) == 0
        assert limits.milliseconds(0, 10) == 0
        assert limits.milliseconds(1) == 1
        assert limits.milliseconds(1, 10) == 10
        assert limits.milliseconds(10 * hz, 10) == 10
        assert limits.milliseconds(10 * hz + 1, 10) == 20
        assert limits.milliseconds(3 * hz) == 3
        assert limits.milliseconds(3 * hz + 1) == 4

    @pytest.mark.parametrize(
        ("field", "value"),
        [
            ("tick_hz", 0),
            ("tick_hz", -1),
            ("tick_hz", 1001),
            pytest.param("tick_hz", 1.0, marks=NO_INTEGER),
            pytest.param("tick_hz", True, marks=NO_INTEGER),
            ("pulse_ms", 0),
            ("pulse_ms", -3000),
            ("pulse_ms", 65_536),
            pytest.param("pulse_ms", 3000.0, marks=NO_INTEGER),
            ("backoff_ms", -1),
            ("backoff_ms", 10_000_001),
            pytest.param("backoff_ms", 1e5, marks=NO_INTEGER),
            pytest.param("backoff_ms", float("nan"), marks=NO_INTEGER),
            ("table_crc", -1),
            ("table_crc", 2**32),
        ],
    )
    def test_nonsense_is_refused_by_name(self, field, value):
        with pytest.raises(ValueError, match=field):
            CoilLimits(**{"tick_hz": 1} | {field: value})

    @pytest.mark.parametrize(
        ("field", "values"),
        [
            ("tick_hz", (1, 1000)),
            ("pulse_ms", (1, 65_535)),
            ("backoff_ms", (0, 10_000_000)),
            ("table_crc", (0, 2**32 - 1)),
        ],
    )
    def test_the_ends_of_each_range_are_in_it(self, field, values):
        for value in values:
            assert getattr(CoilLimits(**{"tick_hz": 1} | {field: value}), field) == value

    def test_they_cannot_be_changed_later(self, limits):
        with pytest.raises(FrozenInstanceError):
            limits.backoff_ms = 0


class TestBoot:
    @pytest.mark.parametrize("hz", RATES)
    @pytest.mark.parametrize("shared", [True, False])
    def test_all_coils_are_off_and_locked_out_in_full(self, hz, shared):
        state = boot(CoilLimits(hz, shared=shared))
        full = 100 * hz * UNITS_PER_TICK
        assert state == Interlock(coil=0, level=0, remaining=0, lockout=(full, full, full), seq=None)

    @pytest.mark.parametrize("hz", RATES)
    def test_the_first_request_is_accepted_after_100_s_and_not_a_tick_earlier(self, hz):
        limits = CoilLimits(hz)
        for coil in range(3):
            asked = GOOD.replace(coil=coil)
            early = after_ticks(boot(limits), 100 * hz - 1)
            assert after_request(early, asked, TICK, limits) == (early, Reason.LOCKOUT)
            _, reason = after_request(after_ticks(boot(limits), 100 * hz), asked, TICK, limits)
            assert reason is None

    def test_any_first_seq_will_do(self, limits):
        for seq in range(256):
            assert after_request(ready(limits), GOOD.replace(seq=seq), TICK, limits)[1] is None


REFUSED = [
    (Reason.WRONG_TICK, GOOD.replace(tick=LOW - 1)),
    (Reason.WRONG_TICK, GOOD.replace(tick=LOW + 1)),
    (Reason.WRONG_TICK, GOOD.replace(tick=TICK)),
    (Reason.REPEATED_SEQ, GOOD.replace(seq=77)),
    (Reason.BAD_COIL, GOOD.replace(coil=3)),
    (Reason.BAD_COIL, GOOD.replace(coil=-1)),
    (Reason.BAD_LEVEL, GOOD.replace(level=0)),
    *[(Reason.BAD_LEVEL, GOOD.replace(level=level)) for level in (-8, -7, -6, -5, -4, 4, 5, 6, 7)],
    (Reason.BAD_DURATION, GOOD.replace(duration_ms=0)),
    (Reason.BAD_DURATION, GOOD.replace(duration_ms=-1)),
    *[(Reason.BAD_DURATION, GOOD.replace(duration_ms=ms)) for ms in (3001, 3002, 3100, 4000, 6000, 65_535)],
]


class TestRefusals:
    @pytest.mark.parametrize(("reason", "asked"), REFUSED)
    def test_each_reason(self, limits, reason, asked):
        state = ready(limits, seq=77)
        after, given = after_request(state, asked, TICK, limits)
        assert given is reason
        assert after == state, "a refusal changes nothing"

    def test_of_256_low_bytes_one_answers_the_tick(self, limits):
        for tick in (0, 1, 255, 256, TICK, 2**32 - 1, 2**40 + 5):
            answers = [
                low
                for low in range(256)
                if after_request(ready(limits), GOOD.replace(tick=low), tick, limits)[1] is None
            ]
            assert answers == [tick % 256]

    def test_what_is_not_refused_is_accepted(self, limits):
        for coil in range(3):
            for level in (-3, -2, -1, 1, 2, 3):
                for duration_ms in (1, 2, 999, 1000, 1001, 2999, 3000):
                    asked = CoilFire(level, coil, 5, LOW, duration_ms)
                    state, reason = after_request(ready(limits, seq=77), asked, TICK, limits)
                    assert reason is None
                    assert (state.coil, state.level, state.seq) == (coil, level, 5)
                    assert state.remaining == limits.units(duration_ms)

    def test_the_longest_pulse_is_the_configured_one(self):
        limits = CoilLimits(3, pulse_ms=2500)
        assert after_request(ready(limits), GOOD.replace(duration_ms=2500), TICK, limits)[1] is None
        assert (
            after_request(ready(limits), GOOD.replace(duration_ms=2501), TICK, limits)[1]
            is Reason.BAD_DURATION
        )

    def test_the_first_rule_that_applies_names_the_refusal(self, limits):
        """A request that is wrong in every way, put right rule by rule."""
        on, _ = after_request(ready(limits), GOOD, TICK, limits)
        asked = CoilFire(coil=3, level=0, duration_ms=0, seq=GOOD.seq, tick=LOW ^ 1)
        reasons = []
        for correction in (
            {"tick": LOW},
            {"seq": GOOD.seq + 1},
            {"coil": 1},
            {"level": 3},
            {"duration_ms": 1},
            {},
        ):
            reasons.append(after_request(on, asked, TICK, limits)[1])
            asked = asked.replace(**correction)
        assert reasons == [
            Reason.WRONG_TICK,
            Reason.REPEATED_SEQ,
            Reason.BAD_COIL,
            Reason.BAD_LEVEL,
            Reason.BAD_DURATION,
            Reason.COIL_ON,
        ]
        over = after_ticks(on, 3)
        assert after_request(over, asked, TICK, limits)[1] is Reason.LOCKOUT

    def test_only_the_last_accepted_seq_is_a_repetition(self, limits):
        state, _ = after_request(ready(limits, seq=77), GOOD, TICK, limits)
        later = after_ticks(state, 103)
        assert after_request(later, GOOD, TICK, limits)[1] is Reason.REPEATED_SEQ
        assert after_request(later, GOOD.replace(seq=77), TICK, limits)[1] is None

    def test_a_refused_seq_may_be_asked_again(self, limits):
        state = ready(limits)
        state, reason = after_request(state, GOOD.replace(level=4), TICK, limits)
        assert reason is Reason.BAD_LEVEL
        assert after_request(state, GOOD, TICK, limits)[1] is None


class TestSilence:
    def test_all_is_off_and_locked_out_in_full_but_seq_stays(self, limits):
        on, _ = after_request(ready(limits), GOOD, TICK, limits)
        assert after_silence(on, limits) == replace(boot(limits), seq=GOOD.seq)
        assert after_silence(boot(limits), limits) == boot(limits)


@pytest.mark.parametrize("hz", RATES)
@pytest.mark.parametrize("duration_ms", [1, 20, 999, 1000, 1500, 2500, 2999, 3000])
class TestLockout:
    def test_it_counts_from_the_end_of_the_pulse(self, limits, hz, duration_ms):
        limits = replace(limits, tick_hz=hz)
        state, _ = after_request(ready(limits), GOOD.replace(duration_ms=duration_ms), TICK, limits)
        assert state.lockout[GOOD.coil] == state.remaining + limits.units(100_000)
        first_free = -(-(duration_ms + 100_000) * hz // 1000)
        again = GOOD.replace(seq=10)
        assert after_request(after_ticks(state, first_free - 1), again, TICK, limits)[1] is Reason.LOCKOUT
        assert after_request(after_ticks(state, first_free), again, TICK, limits)[1] is None

    def test_shared_holds_for_every_coil_and_per_coil_for_one(self, limits, hz, duration_ms):
        limits = replace(limits, tick_hz=hz)
        state, _ = after_request(ready(limits), GOOD.replace(duration_ms=duration_ms), TICK, limits)
        pulse_over = -(-duration_ms * hz // 1000)
        for coil in (0, 2):
            other = GOOD.replace(coil=coil, seq=10)
            assert after_request(after_ticks(state, pulse_over - 1), other, TICK, limits)[1] is Reason.COIL_ON
            reason = after_request(after_ticks(state, pulse_over), other, TICK, limits)[1]
            assert reason is (Reason.LOCKOUT if limits.shared else None)


class TestElapse:
    def test_one_by_one_is_the_same_as_all_at_once(self, limits):
        limits = replace(limits, tick_hz=3)
        start, _ = after_request(ready(limits), GOOD.replace(duration_ms=2500), TICK, limits)
        state = start
        for ticks in range(1, 400):
            state = after_ticks(state, 1)
            assert after_ticks(start, ticks) == state

    def test_a_level_is_seen_to_the_tick_that_ends_its_last_interval(self, limits):
        limits = replace(limits, tick_hz=3)
        state, _ = after_request(ready(limits), GOOD.replace(duration_ms=2500), TICK, limits)  # 7.5 ticks
        assert [after_ticks(state, ticks).level for ticks in range(12)] == [-2] * 9 + [0] * 3
        assert [after_ticks(state, ticks).remaining for ticks in (6, 7, 8)] == [1500, 500, 0]

    def test_time_does_not_run_backwards(self, limits):
        with pytest.raises(ValueError, match="backwards"):
            after_ticks(boot(limits), -1)

    def test_what_is_off_and_free_stays_so(self, limits):
        assert after_ticks(ready(limits), 7) == ready(limits)

    def test_no_timer_goes_below_zero(self, limits):
        state, _ = after_request(ready(limits), GOOD, TICK, limits)
        state = after_ticks(state, 10**9)
        assert (state.level, state.remaining, state.lockout) == (0, 0, (0, 0, 0))
