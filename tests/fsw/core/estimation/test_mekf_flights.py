"""What the filter finds in flight, what it cannot tell apart, and what it gets wrong without the states.

Half an hour of a slow tumble under a field that turns, with pulses of the coils in turn.
"""

from dataclasses import replace
from math import cos, radians, sin

import numpy as np
import pytest
from filter_steps import predict, update_field, update_sun

from fsw.core.algebra.quaternion import multiply, normalise
from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.mekf import start
from fsw.core.estimation.parameters import NAMES, NOTHING, OF_CELLS, Parameters
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque
from sim.plant.environment.surroundings import Surroundings

SECONDS = 1800
PULSE_S, GAP_S = 3, 57
AMPLITUDE_AM2 = 8.0
START_OFF = normalise((1.0, 0.02, -0.015, 0.01))
RATE = (0.003, -0.005, 0.004)
BEYOND = 22.5
"""99.9 % of the chi-square of 6 degrees of freedom: attitude and rate."""

NO_EXCESS = replace(NOTHING, **{name: (0.0,) * size for name, size in OF_CELLS.items()})
"""Of a filter that carries what cells may be wrong by."""


def driven_am2(second):
    """Each coil in turn, for some seconds of a minute, forward and backward."""
    pulse, into = divmod(second, PULSE_S + GAP_S)
    if into >= PULSE_S:
        return ZERO
    sign = -1.0 if pulse % 2 else 1.0
    return tuple(sign * AMPLITUDE_AM2 if axis == pulse % 3 else 0.0 for axis in range(3))


def field_t(u):
    return tuple(2.2e-5 * c for c in (-2.0 * sin(u), 0.3 + cos(u), 0.4 - 0.5 * sin(u)))


def flown(satellite, true):
    """The estimate after a flight of a satellite that differs from its table by ``true``; also its motion."""
    random = np.random.default_rng(20000)
    xx, yy, zz, xy, xz, yz = true.inertia_error_kgm2
    error = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    inertia = tuple(map(tuple, np.add(satellite.inertia_kgm2, error).tolist()))
    coils = np.eye(3) + np.reshape(true.coil_error, (3, 3))
    body, motion = RigidBody(inertia), Motion(satellite.q, RATE)
    config, gravity = satellite.config(torque_noise_nm_rts=1e-9), satellite.gravity_ps2
    estimate = start(multiply(satellite.q, START_OFF), ZERO, config)
    for second in range(1, SECONDS + 1):
        u, driven = 0.00104 * second, driven_am2(second)
        e1, b = (cos(u), sin(u), 0.0), field_t(u)
        dipole = tuple((coils @ driven + true.dipole_body_am2).tolist())
        torque, around = BodyTorque(inertia, dipole, true.torque_body_nm), Surroundings(e1, gravity, b)
        motion = body.step(motion, torque, 1.0, around, around, around)
        estimate = predict(estimate, e1, b, gravity, driven, config)
        truth = replace(
            estimate,
            q_body_from_eci=motion.q_body_from_eci,
            omega_body_radps=motion.omega_body_radps,
            parameters=true,
        )
        seen = satellite.measured("both", truth, b) + random.normal(0.0, satellite.sigma["both"])
        measured = tuple(seen.tolist())
        if driven == ZERO:
            estimate = update_field(estimate, measured[:3], b, config) or estimate
        estimate = update_sun(estimate, measured[3:], satellite.s_eci, config) or estimate
    return estimate, truth


def nees(satellite, estimate, truth, size=6):
    """Normalised square of the error of attitude and rate: 6 on average if the filter is honest."""
    error = satellite.error(estimate, truth)[:size]
    return error @ np.linalg.solve(estimate.covariance[:size, :size], error)


@pytest.mark.long
def test_every_state_is_found_within_its_sigma(satellite):
    estimate, truth = flown(satellite, satellite.parameters)
    error, sigma = satellite.error(estimate, truth), np.sqrt(estimate.covariance.diagonal())
    assert (np.abs(error) < 4.0 * sigma).all()
    assert nees(satellite, estimate, truth) < BEYOND
    assert nees(satellite, estimate, truth, satellite.size()) < 2.0 * satellite.size()


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in NAMES if name not in OF_CELLS])
class TestOneDifferenceFromTheTable:
    """Attitude and rate stay honest by the state that stands for it, and by no other.

    What cells are wrong by shows in cells alone, of which this satellite has none.
    """

    def test_with_its_state_the_filter_is_honest_and_finds_it(self, name, carrying):
        satellite = carrying(name)
        estimate, truth = flown(satellite, satellite.parameters)
        assert nees(satellite, estimate, truth) < BEYOND
        place, config = satellite.place(name), satellite.config()
        sigma = np.sqrt(estimate.covariance.diagonal()[place])
        assert np.median(sigma / np.sqrt(config.initial_covariance.diagonal()[place])) < 0.8
        off = np.subtract(getattr(estimate.parameters, name), getattr(truth.parameters, name))
        assert (np.abs(off) < 4.0 * sigma).all()

    def test_without_it_the_filter_is_sure_and_wrong(self, name, full, carrying):
        true = Parameters(**{name: getattr(full.parameters, name)})
        estimate, truth = flown(carrying(), true)
        assert nees(carrying(), estimate, truth) > BEYOND
        assert np.sqrt(estimate.covariance.diagonal()[0:3]).max() < radians(0.5)


@pytest.fixture(scope="module")
def flight(full):
    """With everything carried, and different from the table."""
    return flown(full, full.parameters)


class TestTurnsOfTheSensors:
    """Field and Sun tell how the two sensors stand to each other, and never how both stand to the body."""

    @pytest.mark.long
    def test_the_attitude_has_a_floor_that_no_measurement_lowers(self, flight, full):
        """By axis s_m s_s / sqrt(s_m^2 + s_s^2), but for what the motion tells of the attitude."""
        estimate, _ = flight
        prior = np.sqrt(full.config().initial_covariance.diagonal())
        mag, sun = prior[full.place("mag_turn_rad")], prior[full.place("sun_turn_rad")]
        floor = mag * sun / np.hypot(mag, sun)
        sigma = np.sqrt(estimate.covariance.diagonal()[0:3])
        np.testing.assert_allclose(sigma, floor, rtol=0.1)

    @pytest.mark.long
    def test_the_relative_turn_is_found(self, flight, full):
        estimate, truth = flight
        difference = np.zeros((3, full.size()))
        difference[:, full.place("mag_turn_rad")], difference[:, full.place("sun_turn_rad")] = (
            np.eye(3),
            -np.eye(3),
        )
        after, before = (
            np.sqrt((difference @ covariance @ difference.T).diagonal())
            for covariance in (estimate.covariance, full.config().initial_covariance)
        )
        assert (after < 0.2 * before).all()
        assert (np.abs(difference @ full.error(estimate, truth)) < 4.0 * after).all()

    @pytest.mark.long
    def test_a_common_turn_goes_into_the_attitude_unseen_and_inside_its_sigma(self, full):
        turned = (0.004, -0.003, 0.005)
        estimate, truth = flown(full, replace(NO_EXCESS, mag_turn_rad=turned, sun_turn_rad=turned))
        error, sigma = full.error(estimate, truth), np.sqrt(estimate.covariance.diagonal())
        np.testing.assert_allclose(error[0:3], np.negative(turned), atol=0.4 * np.linalg.norm(turned))
        assert (np.abs(error[0:3]) < 3.0 * sigma[0:3]).all()
