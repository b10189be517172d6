"""What is known of a coil after the pulses that showed it: kept with them, forgotten with them."""

import pytest
from pulse_samples import CONFIG, EVERY, PULSES, REFERENCE, WEAK, fly

from fsw.core.actuation.actuator import CoilView
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.fdir.coils import torques
from fsw.core.fdir.coils.effects import solve
from fsw.core.fdir.coils.health import NONE_OLDER, CoilHealth, CoilHealthConfig
from fsw.core.fdir.coils.torques import BelievedParts, judge_effect
from fsw.core.fdir.coils.weak_test import Older, PartSum
from fsw.core.fdir.faults import CoilFault

WEAK_COIL = BelievedParts(0.7, 0.7)
HEALTH = CoilHealth(older=(Older(PartSum(2, 30.0, 9.0, 2.7)), Older(kept=1.0), Older()))
LIMITS = CoilHealthConfig((40.0, 120.0, 400.0), WEAK, 1.0, 5, PULSES, CONFIG, 3000)


def judged(estimate, believed=WEAK_COIL):
    """The health when the next pulse is due."""
    view, state = CoilView(fired_tick=1000 - EVERY), EstimatorState(estimate)
    return judge_effect(HEALTH, view, REFERENCE, state, 1000, believed, False, LIMITS)


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
    assert health == HEALTH._replace(older=NONE_OLDER)


def test_where_noise_may_leave_as_much_of_so_many_pulses_what_was_known_before_stays():
    """Sixteen is much for one pulse, and twenty-five hardly too much for eight."""
    odd, _ = fly([0, 1, 2, 0, 1, 2, 0, 1], [1.18, 0.85, 1.2, 0.86, 1.18, 0.84, 1.15, 0.9])
    _, solution = solve(odd, CONFIG)
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
