"""The filter between samples: its motion beside the plant's."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_samples import angle_rad
from filter_steps import predict

from fsw.core.algebra.vector import ZERO, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.mekf import start
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque
from sim.plant.environment.surroundings import Surroundings

SLOW = (0.0011, -0.0009, 0.0013)
"""A rate of flight, 0.1 deg/s."""


class TestPropagation:
    """Beside the plant's motion of a body that differs from its table as the parameters say."""

    def flown(self, satellite, tick_s, seconds, omega, driven_am2):
        config = satellite.config(tick_s=tick_s)
        estimate = replace(satellite.estimate(), omega_body_radps=omega)
        for _ in range(round(seconds / tick_s)):
            estimate = predict(
                estimate, satellite.e1_eci, satellite.b_eci_t, satellite.gravity_ps2, driven_am2, config
            )
        return estimate

    def by_plant(self, satellite, seconds, omega, driven_am2):
        parameters = satellite.parameters
        xx, yy, zz, xy, xz, yz = parameters.inertia_error_kgm2
        error = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        inertia = tuple(map(tuple, np.add(satellite.inertia_kgm2, error).tolist()))
        coils = np.eye(3) + np.reshape(parameters.coil_error, (3, 3))
        dipole = tuple((coils @ driven_am2 + parameters.dipole_body_am2).tolist())
        torque = BodyTorque(inertia, dipole, parameters.torque_body_nm)
        body, motion = RigidBody(inertia), Motion(satellite.q, omega)
        place = Surroundings(satellite.e1_eci, satellite.gravity_ps2, satellite.b_eci_t)
        for _ in range(seconds * 20):
            motion = body.step(motion, torque, 0.05, place, place, place)
        return motion

    def test_sixty_seconds_with_a_coil_driven(self, satellite):
        flight = (satellite.omega, satellite.driven_am2)
        ours, plant = self.flown(satellite, 1.0, 60, *flight), self.by_plant(satellite, 60, *flight)
        assert angle_rad(ours.q_body_from_eci, plant.q_body_from_eci) < 2e-4
        np.testing.assert_allclose(ours.omega_body_radps, plant.omega_body_radps, atol=5e-6)
        assert angle_rad(ours.q_body_from_eci, satellite.q) > 0.5

    def test_sixty_seconds_of_coasting_at_a_flight_rate(self, satellite):
        """What the filter adds in a minute is far below what it measures."""
        ours, plant = self.flown(satellite, 1.0, 60, SLOW, ZERO), self.by_plant(satellite, 60, SLOW, ZERO)
        assert angle_rad(ours.q_body_from_eci, plant.q_body_from_eci) < 1e-7
        np.testing.assert_allclose(ours.omega_body_radps, plant.omega_body_radps, atol=1e-9)

    def test_the_error_falls_with_the_square_of_the_tick(self, satellite):
        flight = (scale(0.5, satellite.omega), satellite.driven_am2)
        plant = self.by_plant(satellite, 20, *flight)
        coarse, fine = (
            angle_rad(self.flown(satellite, tick_s, 20, *flight).q_body_from_eci, plant.q_body_from_eci)
            for tick_s in (1.0, 0.5)
        )
        assert coarse / fine == pytest.approx(4.0, rel=0.15)

    @pytest.mark.parametrize("degps", [3.0, 5.0])
    def test_sixty_seconds_of_a_fast_turn(self, full, degps):
        """The middle of each tick alone would leave hundred times as much."""
        flight = (tuple(np.radians(degps) * np.array([0.48, -0.64, 0.6])), ZERO)
        ours, plant = self.flown(full, 1.0, 60, *flight), self.by_plant(full, 60, *flight)
        assert angle_rad(ours.q_body_from_eci, plant.q_body_from_eci) < 2e-7
        np.testing.assert_allclose(ours.omega_body_radps, plant.omega_body_radps, rtol=0.0, atol=4e-9)

    def test_the_parameters_stay_and_the_quaternion_stays_unit(self, satellite):
        ours = self.flown(satellite, 1.0, 60, satellite.omega, satellite.driven_am2)
        assert ours.parameters == satellite.parameters
        assert sum(c * c for c in ours.q_body_from_eci) == pytest.approx(1.0, abs=1e-14)

    @pytest.mark.parametrize("tick_s", [1.0, 0.25])
    def test_what_innovations_were_on_the_mean_is_forgotten_over_a_minute(self, satellite, tick_s):
        lag = (0.7, -0.4, 0.3, -0.9, 0.5, 0.2)
        estimate = replace(satellite.estimate(), lag=lag)
        after = predict(
            estimate, satellite.e1_eci, satellite.b_eci_t, 0.0, ZERO, satellite.config(tick_s=tick_s)
        )
        assert after.lag == pytest.approx([(1.0 - tick_s / 60.0) * mean for mean in lag])

    def test_an_hour_without_measurement_keeps_the_covariance_sound(self, satellite):
        config, estimate = satellite.config(), start(satellite.q, SLOW, satellite.config())
        for _ in range(3600):
            estimate = predict(
                estimate, satellite.e1_eci, satellite.b_eci_t, satellite.gravity_ps2, ZERO, config
            )
        sigma = np.sqrt(estimate.covariance.diagonal())
        scaled = estimate.covariance / np.outer(sigma, sigma)
        np.testing.assert_allclose(scaled, scaled.T, rtol=0.0, atol=1e-9)
        assert np.linalg.eigvalsh(scaled).min() > -1e-9
        assert mekf.healthy(estimate)
