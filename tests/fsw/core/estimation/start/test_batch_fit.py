"""The equations of a batch against differences, its step, and the estimate written out again."""

import numpy as np
import pytest
from batch_samples import CONFIG, MOVING_PRIORS, STARTS, flight
from cell_samples import CELLS, cell_filter

from fsw.core.algebra.quaternion import from_small_rotation, multiply, normalise
from fsw.core.estimation.parameters import Prior
from fsw.core.estimation.start.batch_fit import (
    MOST_RATE_RADPS,
    MOST_TURN_RAD,
    Equations,
    add_sample,
    at_priors,
    estimate_of,
    improving_step,
)
from fsw.core.estimation.start.batch_model import Motions, expected, measured, model_of, varied

MODEL = model_of(CONFIG, CELLS)
SIZE = len(MODEL.prior)
RANDOM = np.random.default_rng(3)
SCALES = np.concatenate((np.full(3, 0.02), np.full(3, 2e-5), 0.3 * MODEL.prior[6:]))
"""Of the numbers of a motion."""


def of_motions(count):
    q = np.array([normalise(tuple(v)) for v in RANDOM.normal(size=(count, 4))])
    return Motions(q, RANDOM.normal(size=(count, SIZE - 3)) * SCALES[3:])


def test_cost_gradient_and_normal_equations_are_those_of_the_residuals():
    """Half the square of what is left, in standard deviations, and of the priors; one cell is not used."""
    sample = flight(*STARTS[0], 1, unused=(2,))[0][0]
    motions = of_motions(3)
    values, weights = measured(sample, MODEL)

    def left(changed):
        seen = expected(changed, sample, MODEL).values
        return np.hstack(((seen - values) * weights, changed.numbers[:, 3:] / MODEL.prior[6:]))

    going = varied(motions, MODEL)
    begun = at_priors(motions, MODEL, len(going.q))
    found = add_sample(begun, motions, expected(going, sample, MODEL), sample, MODEL)
    np.testing.assert_allclose(found.costs, 0.5 * (left(motions) ** 2).sum(axis=1))
    assert found.measured.tolist() == [8.0] * 3
    slopes = np.zeros((3, len(values) + SIZE - 6, SIZE))
    for number in range(SIZE):
        step = np.zeros((3, SIZE))
        step[:, number] = 0.01 * SCALES[number]
        slopes[:, :, number] = (left(motions.changed(step)) - left(motions.changed(-step))) / (
            0.02 * SCALES[number]
        )
    across = slopes.transpose(0, 2, 1) * SCALES[:, None]
    normal, gradient = across @ across.transpose(0, 2, 1), (across @ left(motions)[:, :, None])[:, :, 0]
    scaled = found.normal * SCALES[:, None] * SCALES
    np.testing.assert_allclose(scaled, normal, atol=2e-3 * np.abs(normal).max())
    np.testing.assert_allclose(
        found.gradient * SCALES, gradient, rtol=1e-2, atol=2e-3 * np.abs(gradient).max()
    )


def test_without_varied_motions_there_is_only_the_cost():
    sample, motions = flight(*STARTS[0], 1)[0][0], of_motions(2)
    alone, all_of_it = (
        add_sample(
            at_priors(motions, MODEL, len(going.q)), motions, expected(going, sample, MODEL), sample, MODEL
        )
        for going in (motions, varied(motions, MODEL))
    )
    assert alone.normal.size == 0
    np.testing.assert_allclose(alone.costs, all_of_it.costs)


def equations(steps):
    """Coupled equations whose solutions are these steps."""
    count = len(steps)
    mixed = RANDOM.normal(size=(count, SIZE, 2 * SIZE)) / np.sqrt(2.0 * SIZE)
    normal = (mixed @ mixed.transpose(0, 2, 1)) / SCALES[:, None] / SCALES
    gradient = -(normal @ steps[:, :, None])[:, :, 0]
    return Equations(normal, gradient, np.full(count, 30.0), np.full(count, 90.0))


class TestStep:
    """Towards the solution, damped, and at most as far as the equations hold."""

    def test_undamped_it_is_the_solution(self):
        steps = 0.5 * SCALES * RANDOM.normal(size=(2, SIZE))
        np.testing.assert_allclose(improving_step(equations(steps), np.zeros(2)), steps, rtol=1e-6)

    def test_damping_adds_to_the_diagonal(self):
        steps = 0.5 * SCALES * RANDOM.normal(size=(2, SIZE))
        posed, damping = equations(steps), np.array([0.1, 2.0])
        found = improving_step(posed, damping)
        for one in range(2):
            damped = posed.normal[one] + damping[one] * np.diag(posed.normal[one].diagonal())
            np.testing.assert_allclose(damped @ found[one], -posed.gradient[one], rtol=1e-6)

    @pytest.mark.parametrize(("place", "most"), [(1, MOST_TURN_RAD), (4, MOST_RATE_RADPS)])
    def test_too_far_in_attitude_or_in_rate_the_whole_is_shortened(self, place, most):
        steps = np.zeros((1, SIZE))
        steps[0, place], steps[0, 8] = 4.0 * most, 0.001
        found = improving_step(equations(steps), np.zeros(1))[0]
        assert found[place] == pytest.approx(most)
        assert found[8] == pytest.approx(0.001 / 4.0)


def of_age(parameters, omega):
    """The mean age, and how it moves attitude and rate: omega, and J domega/dt = (J omega) x omega, (6)."""
    xx, yy, zz, xy, xz, yz = parameters.inertia_error_kgm2
    inertia = np.add(CONFIG.rotor.inertia_kgm2, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    gained = np.linalg.solve(inertia, np.cross(inertia @ omega, omega))
    return np.mean(parameters.delay_s), np.concatenate((omega, gained))


def test_the_estimate_is_one_step_on_and_as_uncertain_as_twice_what_the_samples_leave():
    """At the end of the motion, to which what was found of it at its beginning is carried, and the age on."""
    step = 0.05 * SCALES * RANDOM.normal(size=(1, SIZE))
    posed, found = equations(step), of_motions(1)
    q, omega = STARTS[1]
    flow = np.eye(SIZE)
    flow[0:6, 0:18] = 0.3 * RANDOM.normal(size=(6, 18)) * SCALES[0:6, None] / SCALES[0:18]
    flow[0:6, 0:6] += np.eye(6)
    ends, rates = [q], [omega]
    for number, difference in enumerate(MODEL.differences):
        moved = difference * flow[0:6, number]
        ends.append(multiply(q, (1.0, *(0.5 * moved[0:3]).tolist())))
        rates.append(tuple(np.add(omega, moved[3:6]).tolist()))
    estimate, cost = estimate_of(found, posed, np.array(ends), np.array(rates), MODEL)

    change = flow @ step[0]
    rate = np.add(omega, change[3:6])
    age_s, motion = of_age(estimate.parameters, rate)
    assert age_s == pytest.approx(0.45)
    expected_q = multiply(q, from_small_rotation(tuple((change[0:3] + age_s * motion[0:3]).tolist())))
    assert estimate.q_body_from_eci == pytest.approx(expected_q, abs=1e-5)
    assert estimate.omega_body_radps == pytest.approx(tuple(rate + age_s * motion[3:]), rel=1e-7)
    assert cost == pytest.approx(30.0 + 0.5 * posed.gradient[0] @ step[0])

    numbers, parts, known = found.numbers[0] + step[0, 3:], CONFIG.layout, estimate.parameters
    named = {
        "dipole_body_am2": (parts.dipole, 6),
        "torque_body_nm": (parts.torque, 9),
        "inertia_error_kgm2": (parts.inertia, 12),
        "mag_bias_t": (parts.mag_bias, 18),
        "cell_excess": (parts.cells, 21),
        "cell_gain": (parts.cell_gain, 27),
        "earth_light": (parts.earth_light, 33),
    }
    places, kept = list(range(6)), list(range(6))
    for name, (place, first) in named.items():
        size = place.stop - place.start
        assert getattr(known, name) == pytest.approx(numbers[first - 3 : first - 3 + size].tolist())
        places += range(place.start, place.stop)
        kept += range(first, first + size)
    covariance = CONFIG.initial_covariance.copy()
    left = 4.0 * flow @ np.linalg.inv(posed.normal[0]) @ flow.T
    covariance[np.ix_(places, places)] = left[np.ix_(kept, kept)]
    turn, cells = parts.sun_turn, range(parts.cells.start, parts.cells.stop)
    covariance[0:3, 0:3] += CONFIG.initial_covariance[turn, turn]
    covariance[cells, cells] += MODEL.excess_varying**2
    by_age = np.eye(len(covariance))
    by_age[0:6, parts.delay] = 0.5 * motion[:, None]
    covariance = by_age @ covariance @ by_age.T
    sigmas = np.sqrt(covariance.diagonal())
    np.testing.assert_allclose(
        estimate.covariance / np.outer(sigmas, sigmas), covariance / np.outer(sigmas, sigmas), atol=1e-5
    )


def reached(config, omega):
    """The estimate of a motion that is reached without a step, and that keeps its errors."""
    model = model_of(config, CELLS)
    size = len(model.prior)
    small = model.differences[0]
    turned = [multiply(STARTS[1][0], (1.0, *(0.5 * small * axis).tolist())) for axis in np.eye(3)]
    q, rates = np.tile(STARTS[1][0], (19, 1)), np.tile(omega, (19, 1))
    q[1:4] = turned
    rates[4:7] += model.differences[3:6] * np.eye(3)
    posed = Equations(np.diag(SCALES**-2.0)[None], np.zeros((1, size)), np.zeros(1), np.zeros(1))
    return estimate_of(Motions(q[:1], np.zeros((1, size - 3))), posed, q, rates, model)[0]


def test_of_samples_of_no_age_it_is_where_the_motion_is():
    config = cell_filter(**MOVING_PRIORS, delay_s=Prior((0.0, 0.0), (0.0, 0.0), mean=(0.0, 0.0)))
    estimate = reached(config, (0.05, -0.06, 0.04))
    assert estimate.q_body_from_eci == pytest.approx(STARTS[1][0], abs=1e-15)
    assert estimate.omega_body_radps == (0.05, -0.06, 0.04)


def test_the_age_that_both_samples_have_in_common_is_an_error_along_the_motion():
    """Of a fast turn the greatest; the filter begins with it, and with its part in attitude and rate."""
    omega = (0.05, -0.06, 0.04)
    estimate, delay = reached(CONFIG, omega), CONFIG.layout.delay
    _, motion = of_age(estimate.parameters, omega)
    shared = estimate.covariance[0:6, delay]
    np.testing.assert_allclose(shared, 0.5 * 0.3**2 * np.tile(motion[:, None], 2), rtol=1e-6, atol=1e-12)
    along = np.array(omega) / np.linalg.norm(omega)
    variance = along @ estimate.covariance[0:3, 0:3] @ along
    assert variance > 0.5 * (0.3 * np.linalg.norm(omega)) ** 2
