"""A current without a request: the coil in which it flows, and what the filter knows of it before that."""

from dataclasses import replace
from math import radians

import filter_steps
import numpy as np
import pytest
from changed import changed
from pulse_samples import (
    B_ECI_T,
    CONFIG,
    E1_ECI,
    LEVEL_AM2,
    S_ECI,
    START,
    WEAK,
    deviation,
    error_state,
    fly,
    judged,
    left,
    traced,
)

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, add, cross, scale, unit
from fsw.core.fdir.coils import stray
from fsw.core.fdir.coils.effects import solve
from fsw.core.fdir.coils.explanations import STRAY, Solution, weak_by_pulses
from fsw.core.fdir.coils.health import NONE_OLDER
from fsw.core.fdir.coils.stray import conducting_coil
from fsw.core.laws.plan.pulse_model import AXES, Pulse
from fsw.core.packing import pack


def fly_stray(flows, tuning=CONFIG, ticks=30, start=START, actual=START):
    """The estimate that reckons with 8 A m^2 in any of the coils, ``flows`` being the part in each."""
    random = np.random.default_rng(5)
    truth, estimate = actual, start
    for tick in range(ticks):
        truth = filter_steps.predict(truth, E1_ECI, B_ECI_T, 3e-6, scale(LEVEL_AM2, flows), tuning)
        estimate = filter_steps.predict(estimate, E1_ECI, B_ECI_T, 3e-6, ZERO, tuning)
        s = rotate(truth.q_body_from_eci, S_ECI)
        s = add(s, tuple(radians(0.5) * random.normal(size=3)))
        estimate = filter_steps.update_sun(estimate, s, S_ECI, tuning) or estimate
        kicks = stray.kicks_radps(LEVEL_AM2, AXES, estimate, B_ECI_T, tuning)
        stray.trace_current(estimate, ZERO, kicks, 1.0, begins=tick == 0)
    return estimate, truth


@pytest.mark.parametrize("coil", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_coil_that_conducts_is_told_from_the_sun_alone(coil, sign):
    estimate, _ = fly_stray(scale(sign, AXES[coil]))
    solution = solve(estimate.copy(), CONFIG)
    assert conducting_coil(solution) == (coil if sign > 0.0 else None), "the sign of the current is estimate"
    assert weak_by_pulses(solution, NONE_OLDER, WEAK, WEAK.weak_part) is None


@pytest.mark.parametrize(
    "flows", [ZERO, (1.0, 1.0, 0.0), (0.0, 0.0, 2.0)], ids=["none", "two", "twice as much"]
)
def test_what_one_coil_with_that_current_cannot_have_done_names_nobody(flows):
    estimate, _ = fly_stray(flows)
    solution = solve(estimate.copy(), CONFIG)
    assert conducting_coil(solution) is None


def test_the_gate_lets_through_what_a_deviation_explains_and_nothing_else():
    narrow = replace(CONFIG, gate_nis=16.3)
    estimate, truth = fly_stray(AXES[1], narrow, ticks=40)
    s = rotate(truth.q_body_from_eci, S_ECI)
    assert estimate.trace.measured == 3 * 39, "all but the first, before anything was carried"
    assert filter_steps.update_sun(estimate, s, S_ECI, narrow) is not None
    assert filter_steps.update_sun(replace(estimate, trace=None), s, S_ECI, narrow) is None
    away = unit(add(s, scale(0.15, unit(cross(s, rotate(truth.q_body_from_eci, B_ECI_T))))))
    assert filter_steps.update_sun(estimate, away, S_ECI, narrow) is None


def test_a_new_current_is_not_taken_for_the_one_before():
    estimate, _ = fly_stray(AXES[1])
    pulse = traced(estimate, Pulse(2, 3))
    again = changed(pulse, stray.trace_current, ZERO, (ZERO, ZERO, ZERO), 1.0, True)
    assert pulse.trace.numbers == (2, STRAY, STRAY + 1, STRAY + 2)
    assert again.trace.numbers == (STRAY, STRAY + 1, STRAY + 2, 2)
    assert deviation(again) == pytest.approx([0.0] * 4, abs=1e-12)
    later = changed(again, stray.trace_current, ZERO, (ZERO, ZERO, ZERO), 1.0, False)
    assert later.trace.causes == again.trace.causes


def test_a_current_that_is_known_at_last_sets_the_estimate_right_and_leaves_the_pulses_to_be_judged():
    weak, moving = fly([1, 0], [1.0, 0.3])
    estimate, truth = fly_stray(AXES[1], start=weak, actual=moving)
    before = np.abs(error_state(estimate, truth))
    settled = changed(estimate, stray.settle, 1, CONFIG)
    after, isolated = judged(settled)
    assert np.abs(error_state(after, truth)).max() < 0.1 * before.max()
    assert isolated == (0, pytest.approx(0.3, abs=0.15))
    assert (settled.covariance.diagonal()[:6] > estimate.covariance.diagonal()[:6]).all()
    assert settled.trace.numbers == (0, 1)
    assert left(settled) < 1.3 * settled.trace.measured, "what the current did is no longer unexplained"
    assert left(changed(estimate, stray.settle, 0, CONFIG)) > 2.0 * settled.trace.measured


def test_what_a_weak_coil_did_is_set_right_and_the_current_is_traced_on():
    weak, moving = fly([1, 0], [1.0, 0.3], ticks=60)
    estimate, _ = fly_stray(AXES[1], ticks=15, start=weak, actual=moving)
    after = estimate.copy()
    solution = solve(after, CONFIG)
    pulses = [place for place, number in enumerate(after.trace.numbers) if number < STRAY]
    flows = [solution.causes.index(number) for number in stray.CAUSES]
    assert pack(after) != pack(estimate)
    assert not after.trace.effect[:, pulses].any()
    assert np.array_equal(after.trace.effect[:, flows], estimate.trace.effect[:, flows])
    assert np.abs(after.trace.effect[3:6, flows]).max() > 1e-4


def fly_followed(coil, ticks=90):
    """The estimate that takes into account what it knows of the current, and what it knew, tick by tick."""
    random = np.random.default_rng(7)
    truth = estimate = START
    parts, known = ZERO, []
    for tick in range(ticks):
        truth = filter_steps.predict(truth, E1_ECI, B_ECI_T, 3e-6, scale(LEVEL_AM2, AXES[coil]), CONFIG)
        estimate = filter_steps.predict(estimate, E1_ECI, B_ECI_T, 3e-6, scale(LEVEL_AM2, parts), CONFIG)
        s = add(rotate(truth.q_body_from_eci, S_ECI), tuple(radians(0.5) * random.normal(size=3)))
        estimate = filter_steps.update_sun(estimate, s, S_ECI, CONFIG) or estimate
        kicks = stray.kicks_radps(LEVEL_AM2, AXES, estimate, B_ECI_T, CONFIG)
        stray.trace_current(estimate, parts, kicks, 1.0, begins=tick == 0)
        solution = solve(estimate.copy(), CONFIG)
        followed = stray.follow(estimate, solution, CONFIG)
        if followed is not None:
            parts = followed
        known.append(parts)
    return estimate, truth, known


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_what_is_known_of_the_parts_keeps_the_estimate_near_long_before_the_coil_is_certain(coil):
    estimate, truth, known = fly_followed(coil)
    assert known[0] == ZERO
    assert known[-1] != ZERO
    off = np.linalg.norm(error_state(estimate, truth)[:3])
    left_alone, other = fly_stray(AXES[coil], ticks=len(known))
    assert off < 0.1 * np.linalg.norm(error_state(left_alone, other)[:3])
    assert conducting_coil(solve(estimate.copy(), CONFIG)) == coil


def test_of_a_current_that_was_followed_only_what_is_lacking_is_added_at_last():
    estimate, _, known = fly_followed(1, ticks=60)
    lacks = np.eye(3)[1] - known[-1]
    assert 0.1 < np.abs(lacks).max() < 0.9
    expected = estimate.trace.effect[:6, estimate.trace.numbers.index(STRAY) :][:, :3] @ lacks
    added = error_state(estimate, changed(estimate, stray.settle, 1, CONFIG))
    assert added[:3] == pytest.approx(expected[:3], rel=1e-2, abs=1e-7)
    assert added[3:] == pytest.approx(expected[3:], rel=1e-2, abs=1e-9)


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_the_effect_of_a_tick_is_what_a_second_filter_shows_that_knew_of_it(coil):
    unknowing = filter_steps.predict(START, E1_ECI, B_ECI_T, 3e-6, ZERO, CONFIG)
    knowing = filter_steps.predict(START, E1_ECI, B_ECI_T, 3e-6, scale(LEVEL_AM2, AXES[coil]), CONFIG)
    kicks = stray.kicks_radps(LEVEL_AM2, AXES, START, B_ECI_T, CONFIG)
    effect = changed(unknowing, stray.trace_current, ZERO, kicks, CONFIG.tick_s, True).trace.effect[:6, coil]
    shown, largest = error_state(unknowing, knowing), np.abs(effect).max()
    assert shown == pytest.approx(effect, rel=1e-2, abs=1e-2 * largest)


def test_to_follow_takes_nothing_from_what_the_trace_can_tell():
    """The parts and their covariance are those of before; only what the filter lacks of them is less."""
    estimate, _ = fly_stray(AXES[2], ticks=20)
    before = solve(estimate.copy(), CONFIG)
    followed = estimate.copy()
    parts = stray.follow(followed, before, CONFIG)
    after = solve(followed.copy(), CONFIG)
    assert parts == pytest.approx(tuple(before.part))
    assert after.covariance == pytest.approx(before.covariance)
    assert np.abs(before.deviation).max() > 0.2
    assert np.abs(after.deviation).max() < 0.2 * np.abs(before.deviation).max()
    assert stray.follow(followed, after, CONFIG) is None, "nothing more is certain"


def test_a_current_that_was_never_traced_cannot_be_settled():
    estimate, _ = fly([0], [1.0])
    for other in (START, estimate):
        with pytest.raises(ValueError, match="no stray current is traced"):
            stray.settle(other, 1, CONFIG)


SURE = np.full(3, 0.05)


def named(deviation, sigma, correlation=0.0):
    """The coil that a solution names whose parts were not known beforehand."""
    deviation, shape = np.array(deviation), np.eye(3) + correlation * (1.0 - np.eye(3))
    return conducting_coil(Solution(stray.CAUSES, deviation, deviation, shape * np.outer(sigma, sigma), SURE))


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_the_coil_whose_effect_is_there_conducts(coil):
    assert named(np.eye(3)[coil] + 0.03, (0.05, 0.06, 0.07)) == coil


@pytest.mark.parametrize(
    ("deviation", "sigma", "correlation"),
    [
        ((0.0, 0.0, 0.0), (0.05, 0.06, 0.07), 0.0),
        ((0.5, 0.5, 0.0), (0.05, 0.06, 0.07), 0.0),
        ((0.0, -1.0, 0.0), (0.05, 0.06, 0.07), 0.0),
        ((0.02, 0.8, 0.0), (1.0, 0.3, 1.0), 0.0),
        ((0.5, 0.5, 0.01), (0.7, 0.7, 0.05), -0.99),
    ],
    ids=["none", "two", "the other way", "unsure", "one of two"],
)
def test_it_names_nobody(deviation, sigma, correlation):
    sure = named((0.0, 1.0, 0.0), (0.05, 0.06, 0.07))
    assert sure == 1
    assert named(deviation, sigma, correlation) is None


def test_one_is_named_though_its_own_effect_cannot_be_seen_if_it_is_no_other():
    """Along the field a coil turns nothing; its deviation stays at the prior, those of the others are 0."""
    assert named((0.0, 1.0, 0.01), (0.04, 0.04, 1.0)) == 1
    assert named((0.0, 0.0, 0.0), (0.04, 0.04, 1.0)) is None, "nor is it told from no current at all"


def test_each_explanation_is_weighed_by_its_likelihood_alone():
    """Not by the parts assumed before, from which the solution begins."""
    random, named_coils = np.random.default_rng(29), []
    for _ in range(200):
        root, assumed = random.normal(size=(3, 3)) * random.uniform(1.0, 8.0), random.uniform(-0.2, 1.2, 3)
        measured, explanations = root @ root.T, np.vstack([np.eye(3), np.zeros(3)]) - assumed
        told = measured @ explanations[random.integers(4)] + root @ random.normal(size=3)
        covariance = np.linalg.inv(measured + np.eye(3))
        deviation = covariance @ told
        distances = np.einsum("ki,ij,kj->k", explanations, measured, explanations) - 2.0 * explanations @ told
        distances += told @ deviation
        first, second = np.argsort(distances)[:2]
        certain = distances[first] <= 16.0 <= distances[second] - distances[first]
        expected = int(first) if certain and first < 3 else None
        found = Solution(stray.CAUSES, assumed + deviation, deviation, covariance, np.zeros(3))
        assert conducting_coil(found) == expected
        named_coils.append(expected)
    assert {0, 1, 2, None} == set(named_coils)


def test_pulses_before_it_do_not_name_a_coil():
    parts = np.array((1.0, 0.0))
    assert conducting_coil(Solution((0, 1), parts, parts, 0.03**2 * np.eye(2), SURE[:2])) is None
