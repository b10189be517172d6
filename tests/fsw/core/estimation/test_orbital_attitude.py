"""The attitude relative to the orbital frame: as estimated, and as the plant reports it."""

from dataclasses import replace
from math import degrees, radians

import numpy as np
import pytest
from gate_samples import measured

from fsw.core.algebra.quaternion import canonical, conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, norm, scale, unit
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.orbital_attitude import orbital_attitude, perfect_attitude
from fsw.core.estimation.parameters import Parameters
from fsw.core.orbit.ephemeris import Reference
from fsw.wire.messages import RefAttitude, RefRate

VALID_SIGMA_RAD, USABLE_SIGMA_RAD = radians(2.0), radians(7.0)
FASTEST_RADPS = 0.1
REFERENCE = Reference(
    r_eci_m=(4.0e6, -5.0e6, 3.0e6),
    radius_m=norm((4.0e6, -5.0e6, 3.0e6)),
    b_eci_t=(1.7e-5, -2.3e-5, 3.1e-5),
    sun_eci=unit((-0.8, 0.35, 0.4)),
    lit=True,
    q_orbit_from_eci=normalise((0.3, 0.5, -0.7, 0.4)),
    orbit_rate_radps=1.04e-3,
)
ESTIMATE = Estimate(
    normalise((0.6, -0.4, 0.5, 0.3)),
    (1e-4, 2e-4, -3e-4),
    Parameters(mag_bias_t=(1e-7, 0.0, -1e-7)),
    1e-6 * np.eye(12),
)


def attitude_of(estimate, was_valid=False):
    return orbital_attitude(estimate, REFERENCE, VALID_SIGMA_RAD, USABLE_SIGMA_RAD, FASTEST_RADPS, was_valid)


class TestOrbitalAttitude:
    def test_unknown_before_the_start(self):
        assert attitude_of(None) is UNKNOWN
        assert not UNKNOWN.valid

    def test_is_seen_from_the_orbital_frame(self):
        """q_body_from_eci = q_orbit_from_eci (x) q_body_from_orbit, and the orbit turns about its normal."""
        moving = replace(ESTIMATE, omega_body_radps=(0.011, -0.007, 0.005))
        attitude = attitude_of(moving)
        chained = multiply(REFERENCE.q_orbit_from_eci, attitude.q_body_from_orbit)
        assert canonical(chained) == pytest.approx(canonical(moving.q_body_from_eci), abs=1e-14)
        assert attitude.q_body_from_orbit[0] >= 0.0
        normal_eci = rotate(conjugate(REFERENCE.q_orbit_from_eci), (0.0, 0.0, 1.0))
        normal_body = rotate(moving.q_body_from_eci, normal_eci)
        expected = np.array(moving.omega_body_radps) - 1.04e-3 * np.array(normal_body)
        np.testing.assert_allclose(attitude.omega_body_orbit_radps, expected, atol=1e-15)

    @pytest.mark.parametrize(("rate_radps", "valid"), [(0.099, True), (0.101, False)])
    def test_a_body_that_turns_too_far_in_a_tick_has_no_valid_attitude(self, rate_radps, valid):
        """About whatever axis; its rate is told all the same, and it stays usable for damping."""
        turning = replace(ESTIMATE, omega_body_radps=scale(rate_radps, unit((2.0, -1.0, 3.0))))
        for was_valid in (False, True):
            attitude = attitude_of(turning, was_valid)
            assert (attitude.valid, attitude.usable) == (valid, True)

    def test_a_body_at_rest_in_the_orbital_frame_is(self):
        normal_eci = rotate(conjugate(REFERENCE.q_orbit_from_eci), (0.0, 0.0, 1.0))
        carried = replace(
            ESTIMATE,
            q_body_from_eci=REFERENCE.q_orbit_from_eci,
            omega_body_radps=scale(1.04e-3, rotate(REFERENCE.q_orbit_from_eci, normal_eci)),
        )
        attitude = attitude_of(carried)
        assert attitude.q_body_from_orbit == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-15)
        assert attitude.omega_body_orbit_radps == pytest.approx(ZERO, abs=1e-17)

    @pytest.mark.parametrize(
        ("sigma_deg", "begins", "goes_on", "usable"),
        [
            (0.1, True, True, True),
            (1.999, True, True, True),
            (2.001, False, True, True),
            (2.999, False, True, True),
            (3.001, False, False, True),
            (6.999, False, False, True),
            (7.001, False, False, False),
            (60.0, False, False, False),
        ],
    )
    def test_its_worst_axis_says_whether_it_is_valid_and_serves_control(
        self, sigma_deg, begins, goes_on, usable
    ):
        """Once valid it stays so up to one and a half times the limit; control needs no such certainty."""
        for axis in range(3):
            covariance = np.diag([radians(0.05) ** 2] * 3 + [1e-10, 4e-10, 9e-10] + [1e-14] * 6)
            covariance[axis, axis] = radians(sigma_deg) ** 2
            estimated = replace(ESTIMATE, covariance=covariance)
            attitude = attitude_of(estimated)
            assert attitude.usable is usable
            assert attitude.valid is begins
            assert attitude_of(estimated, was_valid=True).valid is goes_on
            assert degrees(attitude.sigma3_attitude_rad) == pytest.approx(3.0 * sigma_deg)
            assert attitude.sigma3_rate_radps == pytest.approx(9e-5)

    def test_no_direction_between_the_axes_is_less_certain_than_the_limit(self):
        """Errors about two axes that are correlated are larger about a third one."""
        variance, correlation = radians(1.5) ** 2, 0.9
        covariance = np.diag([variance] * 3 + [1e-10] * 3 + [1e-14] * 6)
        assert attitude_of(replace(ESTIMATE, covariance=covariance)).valid  # 1.5 deg, of 2
        covariance[0, 1] = covariance[1, 0] = -correlation * variance
        assert np.linalg.eigvalsh(covariance[0:3, 0:3])[-1] > radians(2.0) ** 2
        assert not attitude_of(replace(ESTIMATE, covariance=covariance)).valid

    def test_the_sigmas_are_those_of_the_worst_axis_of_attitude_and_of_rate(self):
        for first, second in (([3.0, 1.0, 2.0], [40.0, 20.0, 30.0]), ([1.0, 2.0, 3.0], [20.0, 30.0, 40.0])):
            covariance = 1e-6 * np.diag([*first, *second, *[500.0] * 6])
            attitude = attitude_of(replace(ESTIMATE, covariance=covariance))
            assert attitude.sigma3_attitude_rad == pytest.approx(3.0 * (3e-6) ** 0.5)
            assert attitude.sigma3_rate_radps == pytest.approx(3.0 * (40e-6) ** 0.5)


class TestPerfectKnowledge:
    BEFORE = Attitude((0.8, 0.6, 0.0, 0.0), (0.1, 0.2, 0.3), 0.0, 0.0, True)
    Q = RefAttitude(1, 0.5, -0.25, 0.125)
    W = RefRate(1, 0.01, -0.02, 0.03)

    def test_it_is_what_the_plant_reports(self):
        attitude = perfect_attitude(measured(ref_attitude=self.Q, ref_rate=self.W), self.BEFORE)
        assert attitude.q_body_from_orbit[1:] == pytest.approx((0.5, -0.25, 0.125), rel=1e-12)
        assert sum(c * c for c in attitude.q_body_from_orbit) == pytest.approx(1.0, abs=1e-15)
        assert attitude.q_body_from_orbit[0] > 0.0
        assert attitude.omega_body_orbit_radps == (0.01, -0.02, 0.03)
        assert (attitude.sigma3_attitude_rad, attitude.sigma3_rate_radps, attitude.valid) == (0.0, 0.0, True)

    @pytest.mark.parametrize(
        "changes",
        [
            {},
            {"ref_attitude": Q},
            {"ref_rate": W},
            {"ref_attitude": Q.replace(valid=0), "ref_rate": W},
            {"ref_attitude": Q, "ref_rate": W.replace(valid=0)},
        ],
    )
    def test_without_both_the_one_before_stays_and_is_not_valid(self, changes):
        attitude = perfect_attitude(measured(**changes), self.BEFORE)
        assert attitude == self.BEFORE.invalid()

    def test_upside_down_the_wire_s_rounding_still_gives_a_unit_quaternion(self):
        for vector in ((0.6, -0.48, 0.64), (0.57735027, 0.57735027, 0.57735027), (0.999985, 0.0, 0.0)):
            decoded = RefAttitude.decode(RefAttitude(1, *vector).encode().data)
            attitude = perfect_attitude(measured(ref_attitude=decoded, ref_rate=self.W), self.BEFORE)
            assert sum(c * c for c in attitude.q_body_from_orbit) == pytest.approx(1.0, abs=1e-15)
