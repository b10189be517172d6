"""What the coils did, by the innovations of the filter: against one that knew, truth, and in doubt."""

from dataclasses import replace
from math import copysign, hypot, inf, isfinite, nan, sqrt

import filter_steps
import numpy as np
import pytest
from changed import changed
from estimator_samples import tuned
from pulse_samples import (
    CONFIG,
    GRAVITY_PS2,
    PULSE_S,
    QUIET,
    START,
    covariance,
    deviation,
    error_state,
    fly,
    judged,
    kick_radps,
    left,
    traced,
)
from pulse_samples import PULSES as PULSES_1_HZ

from fsw.core.algebra.quaternion import conjugate, rotate
from fsw.core.algebra.vector import ZERO, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.coils.effects import trace_pulse
from fsw.core.fdir.coils.explanations import PULSES
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.packing import pack


def test_the_carried_effect_is_what_a_second_filter_shows_that_knew_of_it():
    part = 1e-3

    def knowing(estimate):
        kick = scale(part, kick_radps(estimate, 1))
        wrong = np.array((*scale(0.5 * PULSE_S, kick), *kick, *np.zeros(6)))
        return filter_steps.correct(estimate, wrong, np.zeros((12, 12)), CONFIG)

    unknowing, _ = fly([1], [1.0], noise=0.0)
    other, _ = fly([1], [1.0], noise=0.0, alter=knowing)
    shown = error_state(unknowing, other) / part
    carried = unknowing.trace.effect[:6, 0]
    assert np.linalg.norm(carried[:3]) > 1e-3
    assert shown[:3] == pytest.approx(carried[:3], rel=2e-3, abs=1e-6)
    assert shown[3:] == pytest.approx(carried[3:], rel=2e-3, abs=1e-8)


@pytest.mark.parametrize(("level", "torque_nm", "ratio"), [(2, 0.0, 0.0), (2, 3e-6, 0.833), (3, 3e-6, 0.417)])
def test_a_pulse_proves_little_beside_a_torque_that_does_as_much_by_the_next(level, torque_nm, ratio):
    pushed = replace(START, parameters=replace(START.parameters, torque_body_nm=(0.0, torque_nm, 0.0)))
    across = rotate(conjugate(START.q_body_from_eci), (0.0, 0.0, 3e-5))
    cause = traced(pushed, Pulse(1, level), across).trace.causes[0]
    assert cause.uncertain == pytest.approx(hypot(0.05, ratio), rel=1e-3)
    assert (cause.number, cause.assumed) == (1, 1.0)
    weakest = traced(pushed, Pulse(1, 1), across).trace.causes[0]
    assert weakest.uncertain == pytest.approx(hypot(0.05, 1.0 if torque_nm else 0.0))


def test_a_torque_acts_until_the_next_pulse_whatever_the_length_of_a_tick():
    pushed = replace(START, parameters=replace(START.parameters, torque_body_nm=(0.0, 3e-6, 0.0)))
    across = rotate(conjugate(START.q_body_from_eci), (0.0, 0.0, 3e-5))
    short = replace(PULSES_1_HZ, pulse_ticks=30, backoff_ticks=1000, tick_s=0.1)
    causes = [
        changed(pushed, trace_pulse, Pulse(1, 3), across, GRAVITY_PS2, pulses, CONFIG).trace.causes[0]
        for pulses in (PULSES_1_HZ, short)
    ]
    assert causes[1].uncertain == pytest.approx(causes[0].uncertain)


@pytest.mark.parametrize(("coil", "part"), [(0, 1.1), (1, 0.6), (2, 1.3)])
def test_what_is_taken_for_its_effect_is_by_the_gain_that_the_filter_has_of_its_coil(coil, part):
    errors = (0.1, 0.02, 0.03, 0.04, -0.4, 0.06, 0.07, 0.08, 0.3)
    known = replace(START, parameters=replace(START.parameters, coil_error=errors))
    cause = traced(known, Pulse(coil, 3)).trace.causes[0]
    assert (cause.number, cause.assumed) == (coil, pytest.approx(part))


WITH_INERTIA = tuned(**QUIET, inertia_error_kgm2=Prior((0.06, 0.1, 0.08, 0.02, 0.02, 0.02), (0.0,) * 6))
"""Bounds of sqrt 3 times as much."""


def with_inertia(*error_kgm2):
    estimate = mekf.start(START.q_body_from_eci, START.omega_body_radps, WITH_INERTIA)
    return replace(estimate, parameters=replace(estimate.parameters, inertia_error_kgm2=error_kgm2))


@pytest.mark.parametrize("beyond", [(0.0, 0.0, 0.0), (0.2, -0.3, 0.1), (-0.25, 0.25, 0.0)])
def test_a_pulse_proves_little_beside_what_gravity_may_do_to_an_inertia_beyond_its_bounds(beyond):
    """Not more than what it does to such a body at the worst of many attitudes, and hardly less."""
    bounds = [sqrt(3.0) * sigma for sigma in (0.06, 0.1, 0.08)]
    error = [copysign(most + abs(more), more) for most, more in zip(bounds, beyond, strict=True)]
    across = rotate(conjugate(START.q_body_from_eci), (0.0, 0.0, 3e-5))
    cause = traced(with_inertia(*error, 0.0, 0.0, 0.0), Pulse(1, 3), across, WITH_INERTIA).trace.causes[0]
    uncertain = sqrt(cause.uncertain**2 - 0.05**2)
    directions = np.random.default_rng(7).normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    torques_nm = GRAVITY_PS2 * np.cross(directions, directions * beyond)
    worst = 100.0 * np.linalg.norm(torques_nm, axis=1).max() / (3.0 * 8.0 * 3e-5)
    assert worst <= uncertain + 1e-12
    assert uncertain <= 1.25 * worst + 1e-12
    assert any(beyond) == (uncertain > 0.05)


def test_products_of_inertia_beyond_their_bounds_count_too():
    across = rotate(conjugate(START.q_body_from_eci), (0.0, 0.0, 3e-5))
    causes = [
        traced(
            with_inertia(0.0, 0.0, 0.0, 0.0, product, 0.0), Pulse(1, 3), across, WITH_INERTIA
        ).trace.causes[0]
        for product in (0.02, 0.3)
    ]
    assert causes[0].uncertain == pytest.approx(0.05)
    assert causes[1].uncertain > 0.1


def test_a_pulse_along_the_field_is_traced_though_it_does_nothing():
    along = rotate(conjugate(START.q_body_from_eci), (0.0, 3e-5, 0.0))
    cause = traced(START, Pulse(1, 3), along).trace.causes[0]
    assert isfinite(cause.assumed)
    assert isfinite(cause.uncertain)
    assert traced(START, Pulse(1, 3), ZERO).trace.causes[0].uncertain == 0.05


@pytest.mark.parametrize("part", [0.3, 0.0, -1.0, 1.2])
def test_without_noise_the_deviation_is_found_as_it_is(part):
    estimate, _ = fly([0, 2], [part, 1.0], noise=0.0)
    assert deviation(estimate) == pytest.approx([0.0, part - 1.0], abs=0.03)


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_a_weak_coil_is_accused_and_not_the_one_that_fired_after_it(coil):
    other = (coil + 1) % 3
    estimate, _ = fly([coil, other], [0.3, 1.0])
    _, isolated = judged(estimate)
    assert isolated == (coil, pytest.approx(0.3, abs=0.15))


def test_sound_coils_are_not_accused_and_the_estimate_is_left_alone():
    estimate, _ = fly([0, 1, 2, 1, 0, 2], [1.0] * 6)
    after, isolated = judged(estimate)
    assert isolated is None
    assert pack(after) == pack(estimate)
    z = deviation(estimate) / np.sqrt(covariance(estimate).diagonal())
    assert np.abs(z).max() < 3.0


def test_pulses_too_small_to_be_seen_accuse_nobody():
    estimate, _ = fly([0, 1], [0.0, 0.0], level=1)
    assert judged(estimate)[1] is None


def test_the_estimate_is_set_right_once():
    estimate, truth = fly([1, 0], [1.0, -1.0])
    before = np.abs(error_state(estimate, truth))
    after, isolated = judged(estimate)
    error = np.abs(error_state(after, truth))
    assert isolated == (0, pytest.approx(-1.0, abs=0.15))
    assert error.max() < 0.2 * before.max()
    assert (after.covariance.diagonal() >= estimate.covariance.diagonal()).all()
    again, accused_again = judged(after)
    assert accused_again == isolated
    assert pack(again) == pack(after)


def test_of_each_coil_the_latest_pulses_are_kept_and_what_is_forgotten_changes_nothing_else():
    coils = [0, *[2] * PULSES]
    estimate, _ = fly(coils, [0.3, *[1.0] * PULSES])
    fuller = traced(estimate, Pulse(2, 3))
    assert estimate.trace.numbers == (*[2] * PULSES, 0)
    assert fuller.trace.numbers == estimate.trace.numbers
    kept = [0, 1, 3]  # of those before: the oldest of coil 2 is gone
    assert deviation(fuller)[1:] == pytest.approx(deviation(estimate)[kept])
    assert covariance(fuller)[1:, 1:] == pytest.approx(covariance(estimate)[np.ix_(kept, kept)])


def test_a_weak_coil_leaves_noise_and_where_more_is_left_nobody_is_judged():
    estimate, _ = fly([0], [0.3])
    assert 0.6 < left(estimate) / estimate.trace.measured < 1.1
    assert judged(estimate)[1] is not None
    sums = estimate.trace.sums.copy()
    sums[-1, -1] += 0.7 * estimate.trace.measured
    doubtful = replace(estimate, trace=replace(estimate.trace, sums=sums))
    assert judged(doubtful) == (doubtful, None)


@pytest.mark.parametrize(("more", "kept"), [(0.1, (1, 0)), (0.7, (1,))], ids=["noise", "more than noise"])
def test_what_was_shown_of_pulses_while_something_else_misled_the_filter_proves_nothing_later(more, kept):
    estimate, _ = fly([0], [0.3])
    sums = estimate.trace.sums.copy()
    sums[-1, -1] += more * estimate.trace.measured
    after = traced(replace(estimate, trace=replace(estimate.trace, sums=sums)), Pulse(1, 3))
    assert left(after) == pytest.approx(0.0, abs=1e-9), "what was left before is of the past"
    assert after.trace.measured == 0
    assert after.trace.numbers == kept
    assert (judged(after)[1] is None) == (0 not in kept)


@pytest.mark.parametrize(("unexplained", "kept"), [(20.0, (1, 0)), (50.0, (1,))], ids=["chance", "more"])
def test_soon_after_a_pulse_chance_may_leave_more_for_each_sample(unexplained, kept):
    """Of twelve numbers noise leaves 20 now and then, and 50 hardly ever."""
    estimate, _ = fly([0], [1.0], ticks=PULSE_S + 2)
    assert estimate.trace.measured == 12
    sums = estimate.trace.sums.copy()
    sums[-1, -1] += unexplained - left(estimate)
    after = traced(replace(estimate, trace=replace(estimate.trace, sums=sums)), Pulse(1, 3))
    assert after.trace.numbers == kept


def test_pulses_that_no_fault_of_a_coil_explains_prove_nothing_later():
    contradictory, _ = fly([0, 1, 0, 1], [0.2, 0.2, 1.6, 1.6])
    after, isolated = judged(contradictory)
    assert isolated is None
    assert after.trace is None, "the latest would be explained as soon as the first are forgotten"
    assert after.covariance is contradictory.covariance
    explained, _ = fly([0, 1, 0, 1], [0.2, 1.0, 0.2, 1.0])
    assert judged(explained)[0].trace is not None


@pytest.mark.parametrize("value", [nan, inf, -1.0, -1.5])
@pytest.mark.parametrize("place", ["sums", "effect"])
def test_damaged_sums_accuse_nobody_and_raise_nothing(place, value):
    estimate, _ = fly([0], [1.0], ticks=10)
    array = getattr(estimate.trace, place).copy()
    array[0, 0] = value  # of sums -1: A + 1 is singular; -1.5: not positive
    after, isolated = judged(replace(estimate, trace=replace(estimate.trace, **{place: array})))
    assert isolated is None
    assert after.covariance is estimate.covariance
    if place == "sums" or not isfinite(value):
        assert after.trace is None
