"""What the coils did, by the innovations of the filter: against one that knew, truth, and in doubt."""

from dataclasses import replace
from math import inf, isfinite, nan, radians

import numpy as np
import pytest

from fsw.core.actuation.pulses import AXES
from fsw.core.algebra.quaternion import conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, add, cross, scale, sub, transform, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.coil_effects import settle_stray, solve, trace_pulse, trace_stray
from fsw.core.fdir.explanations import PULSES, STRAY, conducting, of_pulses, weak_by_pulses

INERTIA = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))
CONFIG = mekf_config(
    INERTIA,
    1.0,
    {"mag_bias_t": Prior((3e-7,) * 3, (1e-11,) * 3), "torque_body_nm": Prior((1e-7,) * 3, (3e-11,) * 3)},
    magnetometer_sigma_t=2e-7,
    sun_sigma_rad=radians(0.5),
    attitude_sigma_rad=radians(0.1),
    rate_sigma_radps=radians(0.001),
    torque_noise_nm_rts=1e-8,
    gate_nis=inf,
)
B_ECI_T, S_ECI, E1_ECI = (1.7e-5, -2.3e-5, 3.1e-5), unit((-0.8, 0.35, 0.4)), unit((0.3, 0.7, -0.5))
START = mekf.start(normalise((0.6, -0.4, 0.5, 0.3)), (1e-3, -4e-4, 7e-4), CONFIG)
LEVEL_AM2, PULSE_S, EVERY = 8.0, 3, 100
WEAK_PART, THRESHOLD = 0.7, 14.0


def step(estimate, dipole_am2):
    return mekf.predict(estimate, E1_ECI, B_ECI_T, 3e-6, dipole_am2, CONFIG)


def kick_radps(estimate, coil):
    impulse_nms = scale(PULSE_S * LEVEL_AM2, cross(AXES[coil], rotate(estimate.q_body_from_eci, B_ECI_T)))
    return transform(CONFIG.rotor.inertia_inverse, impulse_nms)


def fly(coils, parts, ticks=EVERY, noise=1.0, alter=lambda estimate: estimate, level_am2=LEVEL_AM2):
    """The estimate after pulses of these coils, each with its part of the effect; also the true attitude."""
    random = np.random.default_rng(3)
    truth = estimate = START
    for coil, part in zip(coils, parts, strict=True):
        for tick in range(ticks):
            dipole = scale(level_am2, AXES[coil]) if tick < PULSE_S else ZERO
            truth, estimate = step(truth, scale(part, dipole)), step(estimate, dipole)
            if tick >= PULSE_S:
                b, s = (rotate(truth.q_body_from_eci, r) for r in (B_ECI_T, S_ECI))
                b = add(b, tuple(noise * 2e-7 * random.normal(size=3)))
                s = add(s, tuple(noise * radians(0.5) * random.normal(size=3)))
                estimate = mekf.update_both(estimate, b, B_ECI_T, s, S_ECI, CONFIG)
            elif tick == PULSE_S - 1:
                kick = scale(level_am2 / LEVEL_AM2, kick_radps(estimate, coil))
                estimate = trace_pulse(alter(estimate), coil, kick, PULSE_S)
    return estimate, truth


def judged(estimate):
    """The estimate after the solution, and its likeliest explanation: a coil, and the part of its effect."""
    estimate, solution = solve(estimate, CONFIG)
    if solution is None:
        return estimate, None
    likeliest = of_pulses(solution)[0]
    nothing = next(one for one in of_pulses(solution) if one.coil == -1)
    sure = nothing.distance - likeliest.distance > 2.0 * THRESHOLD
    return estimate, (likeliest.coil, likeliest.part) if sure else None


def deviation(estimate):
    sums = estimate.trace.sums
    return np.linalg.solve(sums[:-1, :-1] + np.eye(len(sums) - 1), sums[:-1, -1])


def covariance(estimate):
    sums = estimate.trace.sums
    return np.linalg.inv(sums[:-1, :-1] + np.eye(len(sums) - 1))


def error_state(estimate, other):
    """Attitude and rate that ``estimate`` lacks of ``other``."""
    _, *turn = multiply(conjugate(estimate.q_body_from_eci), other.q_body_from_eci)
    return np.array((*scale(2.0, tuple(turn)), *sub(other.omega_body_radps, estimate.omega_body_radps)))


def test_the_carried_effect_is_what_a_second_filter_shows_that_knew_of_it():
    part = 1e-3

    def knowing(estimate):
        kick = scale(part, kick_radps(estimate, 1))
        wrong = np.array((*scale(0.5 * PULSE_S, kick), *kick, *np.zeros(6)))
        return mekf.corrected(estimate, wrong, np.zeros((12, 12)), CONFIG)

    unknowing, _ = fly([1], [1.0], noise=0.0)
    other, _ = fly([1], [1.0], noise=0.0, alter=knowing)
    shown = error_state(unknowing, other) / part
    carried = unknowing.trace.effect[:6, 0]
    assert np.linalg.norm(carried[:3]) > 1e-3
    assert shown[:3] == pytest.approx(carried[:3], rel=2e-3, abs=1e-6)
    assert shown[3:] == pytest.approx(carried[3:], rel=2e-3, abs=1e-8)


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
    assert after is estimate
    z = deviation(estimate) / np.sqrt(covariance(estimate).diagonal())
    assert np.abs(z).max() < 3.0


def test_pulses_too_small_to_be_seen_accuse_nobody():
    estimate, _ = fly([0, 1], [0.0, 0.0], level_am2=0.02)
    assert judged(estimate)[1] is None


def test_the_estimate_is_set_right_once():
    estimate, truth = fly([0], [-1.0])
    before = np.abs(error_state(estimate, truth))
    after, isolated = judged(estimate)
    error = np.abs(error_state(after, truth))
    assert isolated == (0, pytest.approx(-1.0, abs=0.15))
    assert error.max() < 0.2 * before.max()
    assert (after.covariance.diagonal() >= estimate.covariance.diagonal()).all()
    again, accused_again = judged(after)
    assert accused_again == isolated
    assert again is after


def test_of_each_coil_the_latest_pulses_are_kept_and_what_is_forgotten_changes_nothing_else():
    coils = [0, *[2] * PULSES]
    estimate, _ = fly(coils, [0.3, *[1.0] * PULSES])
    fuller = trace_pulse(estimate, 2, ZERO, PULSE_S)
    assert estimate.trace.causes == (*[2] * PULSES, 0)
    assert fuller.trace.causes == estimate.trace.causes
    kept = [0, 1, 3]  # of those before: the oldest of coil 2 is gone
    assert deviation(fuller)[1:] == pytest.approx(deviation(estimate)[kept])
    assert covariance(fuller)[1:, 1:] == pytest.approx(covariance(estimate)[np.ix_(kept, kept)])


def left(estimate):
    """What the pulses do not explain of the squares of the innovations."""
    return estimate.trace.sums[-1, -1] - deviation(estimate) @ estimate.trace.sums[:-1, -1]


def test_a_weak_coil_leaves_noise_and_where_more_is_left_nobody_is_judged():
    estimate, _ = fly([0], [0.3])
    assert 0.6 < left(estimate) / estimate.trace.measured < 1.1
    assert judged(estimate)[1] is not None
    sums = estimate.trace.sums.copy()
    sums[-1, -1] += 0.7 * estimate.trace.measured
    doubtful = estimate._replace(trace=estimate.trace._replace(sums=sums))
    assert judged(doubtful) == (doubtful, None)
    begun = trace_pulse(doubtful, 1, kick_radps(estimate, 1), PULSE_S)
    assert left(begun) == pytest.approx(0.0, abs=1e-9), "what was left before is of the past"
    assert begun.trace.measured == 0
    assert judged(begun)[1] is not None


@pytest.mark.parametrize("value", [nan, inf, -1.0, -1.5])
@pytest.mark.parametrize("place", ["sums", "effect"])
def test_damaged_sums_accuse_nobody_and_raise_nothing(place, value):
    estimate, _ = fly([0], [1.0], ticks=10)
    array = getattr(estimate.trace, place).copy()
    array[0, 0] = value  # of sums -1: A + 1 is singular; -1.5: not positive
    after, isolated = judged(estimate._replace(trace=estimate.trace._replace(**{place: array})))
    assert isolated is None
    assert after.covariance is estimate.covariance
    if place == "sums" or not isfinite(value):
        assert after.trace is None


def fly_stray(flows, tuning=CONFIG, ticks=30, start=START, actual=START):
    """The estimate that reckons with 8 A m^2 in any of the coils, ``flows`` being the part in each."""
    random = np.random.default_rng(5)
    truth, estimate = actual, start
    for tick in range(ticks):
        truth = mekf.predict(truth, E1_ECI, B_ECI_T, 3e-6, scale(LEVEL_AM2, flows), tuning)
        estimate = mekf.predict(estimate, E1_ECI, B_ECI_T, 3e-6, ZERO, tuning)
        s = rotate(truth.q_body_from_eci, S_ECI)
        s = add(s, tuple(radians(0.5) * random.normal(size=3)))
        estimate = mekf.update_sun(estimate, s, S_ECI, tuning) or estimate
        b_body_t = rotate(estimate.q_body_from_eci, B_ECI_T)
        kicks = [transform(tuning.rotor.inertia_inverse, cross(scale(LEVEL_AM2, e), b_body_t)) for e in AXES]
        estimate = trace_stray(estimate, kicks, 1.0, begins=tick == 0)
    return estimate, truth


@pytest.mark.parametrize("coil", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_coil_that_conducts_is_told_from_the_sun_alone(coil, sign):
    estimate, _ = fly_stray(scale(sign, AXES[coil]))
    _, solution = solve(estimate, CONFIG)
    assert conducting(solution) == (coil if sign > 0.0 else None), "the sign of the current is estimate"
    assert weak_by_pulses(solution, ZERO, WEAK_PART, THRESHOLD) is None


@pytest.mark.parametrize(
    "flows", [ZERO, (1.0, 1.0, 0.0), (0.0, 0.0, 2.0)], ids=["none", "two", "twice as much"]
)
def test_what_one_coil_with_that_current_cannot_have_done_names_nobody(flows):
    estimate, _ = fly_stray(flows)
    _, solution = solve(estimate, CONFIG)
    assert conducting(solution) is None


def test_the_gate_lets_through_what_a_deviation_explains_and_nothing_else():
    narrow = replace(CONFIG, gate_nis=16.3)
    estimate, truth = fly_stray(AXES[1], narrow, ticks=40)
    s = rotate(truth.q_body_from_eci, S_ECI)
    assert estimate.trace.measured == 3 * 39, "all but the first, before anything was carried"
    assert mekf.update_sun(estimate, s, S_ECI, narrow) is not None
    assert mekf.update_sun(estimate._replace(trace=None), s, S_ECI, narrow) is None
    away = unit(add(s, scale(0.15, unit(cross(s, rotate(truth.q_body_from_eci, B_ECI_T))))))
    assert mekf.update_sun(estimate, away, S_ECI, narrow) is None


def test_a_new_current_is_not_taken_for_the_one_before():
    estimate, _ = fly_stray(AXES[1])
    pulse = trace_pulse(estimate, 2, kick_radps(estimate, 2), PULSE_S)
    again = trace_stray(pulse, (ZERO, ZERO, ZERO), 1.0, begins=True)
    assert pulse.trace.causes == (2, STRAY, STRAY + 1, STRAY + 2)
    assert again.trace.causes == (STRAY, STRAY + 1, STRAY + 2, 2)
    assert deviation(again) == pytest.approx([0.0] * 4, abs=1e-12)
    assert trace_stray(again, (ZERO, ZERO, ZERO), 1.0, begins=False).trace.causes == again.trace.causes


def test_a_current_that_is_known_at_last_sets_the_estimate_right_and_leaves_the_pulses_to_be_judged():
    weak, moving = fly([0], [0.3])
    estimate, truth = fly_stray(AXES[1], start=weak, actual=moving)
    before = np.abs(error_state(estimate, truth))
    settled = settle_stray(estimate, 1, CONFIG)
    after, isolated = judged(settled)
    assert np.abs(error_state(after, truth)).max() < 0.1 * before.max()
    assert isolated == (0, pytest.approx(0.3, abs=0.15))
    assert (settled.covariance.diagonal()[:6] > estimate.covariance.diagonal()[:6]).all()
    assert settled.trace.causes == (0,)
    assert left(settled) < 1.3 * settled.trace.measured, "what the current did is no longer unexplained"
    assert left(settle_stray(estimate, 0, CONFIG)) > 2.0 * settled.trace.measured


def test_a_current_that_was_never_traced_cannot_be_settled():
    estimate, _ = fly([0], [1.0])
    for other in (START, estimate):
        with pytest.raises(ValueError, match="no stray current is traced"):
            settle_stray(other, 1, CONFIG)
