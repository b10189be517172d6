"""What is known of a coil after the pulses that showed it: kept with them, forgotten with them."""

from dataclasses import replace

import pytest
from pulse_samples import B_ECI_T, CONFIG, EVERY, LEVEL_AM2, PULSE_S, PULSES, REFERENCE, START, WEAK, fly

from fsw.core.actuation.actuator import CoilView
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.fdir.coils import torques
from fsw.core.fdir.coils.effects import solve
from fsw.core.fdir.coils.health import NONE_OLDER, CoilHealth, CoilHealthConfig
from fsw.core.fdir.coils.torques import BelievedParts, judge_effect
from fsw.core.fdir.coils.weak_test import Older, PartSum
from fsw.core.fdir.faults import CoilFault
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.packing import copy_state

WEAK_COIL = BelievedParts(0.7, 0.7)
HEALTH = CoilHealth(older=(Older(PartSum(2, 30.0, 9.0, 2.7)), Older(kept=1.0), Older()))
LIMITS = CoilHealthConfig((40.0, 120.0, 400.0), WEAK, 1.0, 5, PULSES, CONFIG, 3000)


def judged(estimate, believed=WEAK_COIL, health=HEALTH):
    """A copy of the health when the next pulse is due, and the state of the estimator."""
    view, state, health = (
        CoilView(fired_tick=1000 - EVERY),
        EstimatorState(estimate.copy()),
        copy_state(health),
    )
    judge_effect(health, view, REFERENCE, state, 1000, believed, False, LIMITS)
    return health, state


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("by_pulses", "by_gain", "fault"),
    [
        (None, (1, 0.38), CoilFault.WEAK),
        (None, (1, 0.55), 0),
        ((1, 0.38), None, 0),
        ((1, 0.1), None, CoilFault.OPEN),
        ((1, 0.38), (1, 0.41), CoilFault.WEAK),
        ((2, 0.1), (1, 0.41), CoilFault.OPEN),
    ],
    ids=["gain", "too large a gain", "pulses", "pulses of an open coil", "both", "two coils"],
)
def test_of_a_gain_more_is_believed_than_of_pulses(monkeypatch, by_pulses, by_gain, fault):
    """The coil that its pulses show comes first."""
    monkeypatch.setattr(torques.explanations, "weak_by_pulses", lambda *of_this_tick: by_pulses)
    monkeypatch.setattr(torques.explanations, "weak_by_gain", lambda *of_this_tick: by_gain)
    sound, _ = fly([0, 1, 2, 0], [1.0, 1.0, 1.0, 1.0])
    health, _ = judged(sound, BelievedParts(by_pulses=0.2, by_gain=0.5))
    coil = 2 if by_pulses == (2, 0.1) else 1
    assert health.faults == tuple(fault if number == coil else 0 for number in range(3))


def test_pulses_that_no_fault_of_a_coil_explains_take_what_was_known_before_with_them():
    contradictory, _ = fly([0, 1, 0, 1], [0.2, 0.2, 1.6, 1.6])
    health, state = judged(contradictory)
    assert state.estimate.trace is None
    assert health == replace(HEALTH, older=NONE_OLDER)


def test_what_a_retest_keeps_waits_for_the_first_pulse():
    """A retest ends the trace, and nothing is traced until a pulse ends: none has spoken for the coil yet."""
    health, state = judged(START)
    assert state.estimate.trace is None
    assert [older.kept for older in health.older] == [0.0, 1.0, 0.0]
    assert [older.parts.pulses for older in health.older] == [0, 0, 0], "of what is no longer traced"


@pytest.mark.parametrize(("kept", "fault"), [(0.0, 0), (0.5, CoilFault.OPEN)], ids=["before", "again"])
def test_one_bad_pulse_isolates_a_coil_that_is_tried_again(kept, fault):
    """Beside sound pulses of the others, which tell it from another inertia."""
    bad, _ = fly([0, 2, 0, 2, 1], [1.0, 1.0, 1.0, 1.0, 0.1])
    older = (Older(), Older(kept=kept * WEAK.threshold), Older())
    health, _ = judged(bad, health=CoilHealth(older=older))
    assert health.faults == (0, fault, 0)
    good, _ = fly([0, 2, 0, 2, 1], [1.0, 1.0, 1.0, 1.0, 0.95])
    health, _ = judged(good, health=CoilHealth(older=older))
    assert health.faults == (0, 0, 0)


def test_where_noise_may_leave_as_much_of_so_many_pulses_what_was_known_before_stays():
    """Sixteen is much for one pulse, and twenty-five hardly too much for eight."""
    odd, _ = fly([0, 1, 2, 0, 1, 2, 0, 1], [1.18, 0.85, 1.2, 0.86, 1.18, 0.84, 1.15, 0.9])
    solution = solve(odd.copy(), CONFIG)
    assert solution is None
    health, state = judged(odd)
    assert state.estimate.trace.numbers == ()
    assert health == HEALTH


@pytest.mark.parametrize("parts", [(1.0, 1.0, 1.0, 1.0), (0.9, 1.0, 0.9, 1.0)])
def test_pulses_that_are_explained_leave_it(parts):
    explained, _ = fly([0, 1, 0, 1], parts)
    health, state = judged(explained)
    assert state.estimate.trace is not None
    assert health == HEALTH


ENDED = CoilView(fired_tick=1000 - PULSE_S, fired=Pulse(2, -3), driven_coil=2, driven_level=-3)
"""A pulse of coil 2 that ends in this tick, driven as requested."""


def ended(view=ENDED, estimate=START, health=HEALTH):
    """A copy of the health, and the state of the estimator, at the end of a pulse."""
    state, health = EstimatorState(estimate.copy()), copy_state(health)
    judge_effect(health, view, REFERENCE, state, 1000, WEAK_COIL, False, LIMITS)
    return health, state


@pytest.mark.interpreted
def test_a_pulse_that_ends_is_traced_with_the_gravity_of_its_orbit(monkeypatch):
    """3 mu/r^3 of a circular orbit is thrice the square of its angular rate: here 1.055 mrad/s."""
    seen = []
    trace_pulse = torques.effects.trace_pulse
    monkeypatch.setattr(
        torques.effects, "trace_pulse", lambda *words: (seen.append(words), trace_pulse(*words))[1]
    )
    _, state = ended()
    assert state.estimate.trace.numbers == (2,)
    (_, pulse, b_eci_t, gravity_ps2, *_) = seen[0]
    assert (pulse, b_eci_t) == (Pulse(2, -3), B_ECI_T)
    assert gravity_ps2 == pytest.approx(3.0 * 1.055e-3**2, rel=2e-3)


@pytest.mark.parametrize(
    "changes",
    [{"driven_level": 3}, {"driven_level": -2}, {"driven_coil": 1}, {"driven_level": 0}],
    ids=["reversed", "another level", "another coil", "not driven"],
)
def test_a_pulse_that_was_not_driven_as_requested_is_not_traced(changes):
    _, state = ended(replace(ENDED, **changes))
    assert state.estimate.trace is None


def test_nor_does_it_take_the_place_of_one_that_is():
    """The oldest of its coil is still traced: added up with the older ones it would count twice."""
    full, _ = fly([2, 0, 2, 1, 2], [0.5, 1.0, 0.5, 1.0, 0.5])
    before = replace(HEALTH, older=NONE_OLDER)
    health, state = ended(replace(ENDED, driven_level=3), full, before)
    assert state.estimate.trace.numbers.count(2) == 3
    assert health == before


def test_what_the_oldest_pulse_of_a_coil_has_shown_is_kept_with_that_coil():
    """Coil 2 has three pulses, too weak ones; a fourth takes the place of the first."""
    full, _ = fly([2, 0, 2, 1, 2], [0.5, 1.0, 0.5, 1.0, 0.5])
    before = replace(HEALTH, older=NONE_OLDER)
    health, state = ended(estimate=full, health=before)
    assert state.estimate.trace.numbers.count(2) == 3
    assert [older.parts.pulses for older in health.older] == [0, 0, 1]


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("faults", "gain_nats", "named"),
    [
        ((0, 0, 0), [-1.0, 30.0, 0.0], True),
        ((0, 0, 0), [0.5, 30.0, -1.0], False),
        ((0, 0, 0), [-1.0, 30.0, 0.5], False),
        ((CoilFault.OPEN, 0, 0), [9.0, 30.0, -1.0], True),
        ((CoilFault.OPEN, 0, 0), [-1.0, 30.0, 0.5], False),
        ((CoilFault.OPEN, 0, CoilFault.WEAK), [-1.0, 30.0, -1.0], False),
    ],
    ids=["sound", "first weak", "third weak", "an isolated one may be", "the other may not", "the last"],
)
def test_a_coil_is_named_only_while_the_others_that_are_left_seem_sound(
    monkeypatch, faults, gain_nats, named
):
    """A wrong inertia makes all of them seem weak; and one coil is never isolated as the last."""
    monkeypatch.setattr(torques.explanations, "weak_by_pulses", lambda *of_this_tick: (1, 0.1))
    monkeypatch.setattr(torques.explanations, "weigh_gains", lambda *of_this_tick: gain_nats)
    estimate, _ = fly([0, 1, 2, 0], [1.0] * 4)
    health, _ = judged(estimate, health=replace(HEALTH, faults=faults))
    assert health.faults == ((faults[0], CoilFault.OPEN, faults[2]) if named else faults)


def test_a_stray_current_is_traced_from_its_first_tick_on_through_all_that_follow():
    """A trace that began anew in each tick would only ever know the last one's kick."""
    health, estimate = replace(HEALTH, stray_ma=400, unrequested_ticks=1), START
    lengths = []
    for tick in range(1000, 1004):
        view, state = CoilView(fired_tick=tick - PULSE_S - 1), EstimatorState(estimate.copy())
        judge_effect(health, view, REFERENCE, state, tick, WEAK_COIL, False, LIMITS)
        estimate = state.estimate
        health.unrequested_ticks += 1
        first = torques.stray.kicks_radps(LEVEL_AM2, LIMITS.stray_axes, estimate, B_ECI_T, CONFIG)[0]
        lengths.append(float(estimate.trace.effect[3, 0] / first[0]))
    assert lengths == pytest.approx([1.0, 2.0, 3.0, 4.0], rel=1e-6)
