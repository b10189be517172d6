"""The view of the coil driver: lockout of each coil, what it drove, and whether that was requested."""

from dataclasses import replace

import pytest
from actuator_samples import then
from gate_samples import measured

from fsw.core.actuation.actuator import LOCKOUT_UNKNOWN, MOST_IDLE_TICKS, CoilView, unexpected, update_view
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.packing import pack
from fsw.wire.messages import CoilBoot, CoilRefused, CoilRefusedReason, CoilStatus

ZERO = (0.0, 0.0, 0.0)
TICK = 10_000


@pytest.fixture(scope="module")
def coils(make_world):
    """At 1 Hz: pulses of 3 s, levels of 0.5, 2 and 8 A m^2."""
    return make_world().config.coils


def status(coil, lockout_ms=0, level=0, seq=0):
    return CoilStatus(level, coil, 0, 0, lockout_ms, seq)


def refusal(tick):
    return CoilRefused(0, 9, CoilRefusedReason.LOCKOUT, tick & 0xFF)


def test_before_the_board_is_heard_and_asked_nothing_is_known():
    view = CoilView()
    assert view.lockout_ms == (-1, -1, -1)
    assert (view.driven_coil, view.driven_level, view.driven_am2) == (0, 0, ZERO)
    assert (view.seq, view.refusals) == (0, 0)
    assert (view.fired_tick, view.fired, view.paid_body_nms) == (-1, Pulse(0, 0), ZERO)


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_a_status_is_the_word_on_its_coil_alone(coil, coils):
    before = CoilView(lockout_ms=(10, -1, 30), refusals=4)
    after = then(update_view, before, measured(coil=status(coil, 99_990, level=-2, seq=17)), TICK, coils)
    expected = [10, -1, 30]
    expected[coil] = 99_990
    assert after.lockout_ms == tuple(expected)
    assert (after.driven_coil, after.driven_level, after.seq, after.refusals) == (coil, -2, 17, 4)


FIRED = CoilView((0, 10, -1), seq=9, fired_tick=TICK, fired=Pulse(1, -3), paid_body_nms=(1e-5, 2e-5, 3e-5))


@pytest.mark.parametrize(
    ("ticks_after", "level"), [(0, 0), (1, -3), (2, -3), (3, -3), (4, 0), (100, 0), (TICK, 0)]
)
def test_without_a_status_the_last_word_stands_and_the_own_request_counts_as_driven(
    ticks_after, level, coils
):
    """For as long as it was asked for: a status that was lost is no reason to think the coil was off."""
    after = then(update_view, FIRED, measured(), TICK + ticks_after, coils)
    dipole_am2 = (0.0, -8.0 if level else 0.0, 0.0)
    assert after == replace(FIRED, driven_coil=1, driven_level=level, driven_am2=dipole_am2)
    assert not unexpected(after, TICK + ticks_after, coils.pulses)


@pytest.mark.parametrize("tick", [0, 1, 3, TICK])
def test_without_a_status_and_a_request_nothing_counts_as_driven(tick, coils):
    assert then(update_view, CoilView(), measured(), tick, coils) == CoilView()


@pytest.mark.parametrize("level", [0, 1])
def test_what_the_board_says_goes_before_the_own_request(level, coils):
    after = then(update_view, FIRED, measured(coil=status(2, level=level)), TICK + 1, coils)
    assert (after.driven_coil, after.driven_level, after.driven_am2) == (2, level, (0.0, 0.0, 0.5 * level))


@pytest.mark.parametrize("coil", [None, 0, 1, 2])
def test_a_board_that_has_booted_has_not_told_its_lockouts(coil, coils):
    """But of the coil that it tells of in the same tick."""
    said = None if coil is None else status(coil, 99_000, seq=9)
    booted = measured(coil_boot=CoilBoot(1, 1, 7), coil=said)
    expected = [99_000 if coil == reports else -1 for reports in range(3)]
    assert then(update_view, replace(FIRED, lockout_ms=(0, 10, 0)), booted, TICK + 50, coils) == replace(
        FIRED,
        lockout_ms=tuple(expected),
        driven_coil=1 if coil is None else coil,
        idle_ticks=0 if coil is None else 1,
    )
    assert CoilView().lockout_ms == LOCKOUT_UNKNOWN


@pytest.mark.parametrize("said", [None, status(1)], ids=["status lost", "status heard"])
def test_each_refusal_is_counted_with_or_without_a_status(said, coils):
    view = CoilView(refusals=2)
    for count in (1, 2, 7):
        refused = measured(coil=said, refused=(refusal(TICK),) * count)
        assert then(update_view, view, refused, TICK, coils).refusals == 2 + count
    assert then(update_view, view, measured(coil=said), TICK, coils).refusals == 2


@pytest.mark.parametrize(
    ("coil", "level", "dipole_am2"),
    [(0, 1, (0.5, 0, 0)), (1, -2, (0, -2.0, 0)), (2, 3, (0, 0, 8.0)), (1, 0, (0, 0, 0))],
)
def test_the_driven_dipole_is_that_of_the_status(coil, level, dipole_am2, coils):
    view = then(update_view, CoilView(), measured(coil=status(coil, level=level)), TICK, coils)
    assert view.driven_am2 == dipole_am2


def test_of_a_coil_out_of_square_it_is_the_true_one(coils):
    """Whether the board says so, or the request is taken as driven."""
    axes = ((0.98, 0.05, -0.02), (0.01, 1.03, 0.04), (-0.03, 0.02, 0.97))
    turned = replace(coils, pulses=replace(coils.pulses, coil_axes=axes))
    said = then(update_view, CoilView(), measured(coil=status(2, level=-2)), TICK, turned)
    assert said.driven_am2 == pytest.approx((0.06, -0.04, -1.94))
    assert then(update_view, FIRED, measured(), TICK + 1, turned).driven_am2 == pytest.approx(
        (-0.08, -8.24, -0.32)
    )


@pytest.mark.parametrize(
    ("ticks_after", "coil", "level", "is_unexpected"),
    [
        (0, 1, -2, True),  # driven before it was asked for
        (1, 1, -2, False),
        (3, 1, -2, False),
        (5, 1, -2, False),  # reported late
        (6, 1, -2, True),  # longer than a pulse
        (5, 1, 2, True),
        (2, 1, 2, True),  # the wrong sign
        (2, 1, -3, True),
        (2, 0, -2, True),
        (4, 1, 0, False),
        (0, 0, 0, False),
    ],
)
def test_only_the_pulse_that_was_asked_for_is_expected_and_little_longer_than_its_time(
    ticks_after, coil, level, is_unexpected, coils
):
    view = CoilView(driven_coil=coil, driven_level=level, fired_tick=TICK, fired=Pulse(1, -2))
    assert unexpected(view, TICK + ticks_after, coils.pulses) is is_unexpected


@pytest.mark.parametrize("tick", [0, 1, 2, 3, TICK])
def test_before_the_first_request_any_drive_is_unexpected(tick, coils):
    assert unexpected(CoilView(driven_coil=0, driven_level=1), tick, coils.pulses)
    assert not unexpected(CoilView(), tick, coils.pulses)


class TestIdleTicks:
    """Reports in a row of a driver at rest: how long ago a pulse may at most have been."""

    def after(self, view, said, coils):
        return then(update_view, view, measured(coil=said), TICK, coils).idle_ticks

    def test_each_report_of_no_level_and_no_current_counts(self, coils):
        view = CoilView()
        for reports in range(1, 6):
            view = then(update_view, view, measured(coil=status(reports % 3)), TICK, coils)
            assert view.idle_ticks == reports

    @pytest.mark.parametrize(
        "said",
        [
            status(0, level=1),
            status(2, level=-3),
            status(1).replace(current_ma=1),
            status(1).replace(current_ma=-1),
            None,
        ],
        ids=["driven", "driven backwards", "current", "current backwards", "no report"],
    )
    def test_any_other_tick_begins_the_count_anew(self, said, coils):
        assert self.after(CoilView(idle_ticks=7), said, coils) == 0

    def test_the_count_ends_where_no_sample_is_as_late(self, coils):
        assert self.after(CoilView(idle_ticks=MOST_IDLE_TICKS - 1), status(1), coils) == MOST_IDLE_TICKS
        assert self.after(CoilView(idle_ticks=MOST_IDLE_TICKS), status(1), coils) == MOST_IDLE_TICKS

    def test_it_is_in_the_checksum_of_the_state(self):
        assert pack(CoilView(idle_ticks=3)) != pack(CoilView())
