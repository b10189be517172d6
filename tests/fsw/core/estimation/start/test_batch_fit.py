"""The motion behind a batch: found where the samples tell it, as uncertain as it is, and not else."""

import numpy as np
import pytest
from cell_samples import CELLS, REFERENCE, cell_filter

from fsw.core.algebra.quaternion import conjugate, multiply, normalise
from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.cells.coarse_sun import coarse_sun
from fsw.core.estimation.parameters import Prior
from fsw.core.estimation.start.batch import SPACING_S, UNKNOWN, BatchSample
from fsw.core.estimation.start.batch_fit import fitted
from fsw.core.estimation.start.motions import Disturbed, Leg, flown, in_body
from fsw.core.orbit.earth import MU_M3PS2

CONFIG = cell_filter(
    torque_body_nm=Prior((3e-8,) * 3, (0.0,) * 3),
    dipole_body_am2=Prior((0.01,) * 3, (0.0,) * 3),
    inertia_error_kgm2=Prior((0.03, 0.05, 0.04, 0.01, 0.01, 0.01), (0.0,) * 6),
)
EXCESS = np.array((0.05, -0.06, 0.04, -0.05, 0.06, 0.03))
BIAS_T = np.array((2e-7, -3e-7, 2.5e-7))
NONE = {0, 1, 2, 3, 4, 5}


def flight(q, omega, count, *, unused=(), seed=1, coarse=False):
    """Samples of a flight with excess, bias and noise, and attitude and rate at its end."""
    random = np.random.default_rng(seed)
    q, omega = np.array([q]), np.array([omega])
    rotor = CONFIG.rotor
    disturbed = Disturbed(np.full((1, 3), 0.004), np.full((1, 3), 1e-8), np.full((1, 6), 0.004))
    samples = []
    along = np.cross(REFERENCE.r_eci_m, (0.3, 0.2, 0.9))
    along *= REFERENCE.radius_m / np.linalg.norm(along)
    normals = np.array(CELLS.normals_body)
    s = np.array(REFERENCE.sun_eci)
    for number in range(count):
        angle = 1.04e-3 * SPACING_S * number
        r = np.cos(angle) * np.array(REFERENCE.r_eci_m) + np.sin(angle) * along
        b = np.array(REFERENCE.b_eci_t) + 2e-5 * angle * np.array((0.5, 1.2, -0.8))
        earth = 0.3 * max(0.0, float(r @ s) / REFERENCE.radius_m) * 0.8
        light = np.maximum(0.0, in_body(q, s)[0] @ normals.T)
        light += earth * (0.5 + 0.5 * in_body(q, -r / REFERENCE.radius_m)[0] @ normals.T) ** 2
        shown = light + EXCESS * (light > 0.1) + 0.01 * random.normal(size=6)
        currents = tuple(
            UNKNOWN if cell in unused else max(0.0, float(one)) for cell, one in enumerate(shown)
        )
        field = in_body(q, b)[0] + BIAS_T + 2e-7 * random.normal(size=3)
        sun = coarse_sun(currents, CELLS) if coarse else None
        since = SPACING_S if number else 0.0
        samples.append(
            BatchSample(
                since, ZERO, tuple(field), currents, tuple(b), REFERENCE.sun_eci, tuple(r), 1.0, earth, sun
            )
        )
        if number < count - 1:
            step = 1.04e-3 * SPACING_S
            middle = np.cos(angle + step / 2) * np.array(REFERENCE.r_eci_m) + np.sin(angle + step / 2) * along
            gravity = 3.0 * MU_M3PS2 / REFERENCE.radius_m**3
            after = Leg(SPACING_S, middle / REFERENCE.radius_m, b, gravity, np.zeros(3))
            q, omega = flown(q, omega, after, disturbed, rotor)
    return tuple(samples), q[0], omega[0]


def error(estimate, q, omega):
    """Attitude and rate, rad and rad/s, (6), of the truth less the estimate."""
    turn = np.array(multiply(conjugate(estimate.q_body_from_eci), tuple(q)))
    turn *= np.sign(turn[0])
    return np.concatenate((2.0 * turn[1:], omega - np.array(estimate.omega_body_radps)))


STARTS = [
    (normalise((0.6, 0.4, -0.5, -0.3)), (0.002, -0.003, 0.0015)),
    (normalise((0.1, -0.7, 0.2, 0.6)), (-0.004, 0.001, 0.003)),
    (normalise((-0.5, 0.3, 0.7, 0.2)), (0.0, 0.0, 0.0)),
]


@pytest.mark.parametrize(("q", "omega"), STARTS)
def test_over_minutes_three_cells_tell_the_motion(q, omega):
    """Also where only one or two of them ever see the Sun."""
    samples, end, rate = flight(q, omega, 25, unused=(1, 3, 5))
    estimate = fitted(samples, CONFIG)
    off = error(estimate, end, rate)
    assert np.degrees(np.linalg.norm(off[:3])) < 6.0
    nees = off @ np.linalg.solve(estimate.covariance[0:6, 0:6], off)
    assert nees < 16.8  # chi-square of 6, 1 in 100
    assert np.degrees(np.sqrt(estimate.covariance.diagonal()[0:3])).max() < 12.0


def test_three_lit_cells_tell_it_sooner():
    q, omega = STARTS[0]
    samples, end, rate = flight(q, omega, 6, coarse=True)
    assert all(sample.coarse for sample in samples)
    estimate = fitted(samples, CONFIG)
    off = error(estimate, end, rate)
    assert off @ np.linalg.solve(estimate.covariance[0:6, 0:6], off) < 16.8
    assert np.degrees(np.linalg.norm(off[:3])) < 12.0


def test_the_field_alone_does_not():
    samples, _, _ = flight(*STARTS[0], 8, unused=NONE)
    assert fitted(samples, CONFIG) is None


def test_what_fits_no_motion_is_not_believed():
    """Cells 1 and 3 connected crosswise."""
    samples, _, _ = flight(*STARTS[0], 25)
    crossed = [
        sample._replace(
            currents=(*sample.currents[2:3], sample.currents[1], sample.currents[0], *sample.currents[3:])
        )
        for sample in samples
    ]
    assert fitted(tuple(crossed), CONFIG) is None


def test_what_it_finds_of_the_parameters_goes_into_the_filter_with_what_is_left():
    samples, _, _ = flight(*STARTS[0], 25)
    estimate, parts = fitted(samples, CONFIG), CONFIG.layout
    bias = np.array(estimate.parameters.mag_bias_t)
    assert np.linalg.norm(bias - BIAS_T) < np.linalg.norm(BIAS_T)
    assert np.abs(estimate.covariance[0:3, parts.dipole]).max() > 0.0
    np.testing.assert_array_equal(estimate.covariance, estimate.covariance.T)
    assert (
        np.linalg.eigvalsh(
            estimate.covariance / np.outer(*2 * [np.sqrt(estimate.covariance.diagonal())])
        ).min()
        > 0.0
    )
    assert estimate.parameters.cell_excess == (0.0,) * 6


@pytest.mark.parametrize("bad", [float("nan"), 1e300])
def test_damaged_samples_give_none(bad):
    samples, _, _ = flight(*STARTS[0], 25)
    broken = samples[4]._replace(field_t=(bad, 0.0, 0.0))
    assert fitted((*samples[:4], broken, *samples[5:]), CONFIG) is None
