"""A law on the plant's rigid body: what is conserved, what acts, and what the law sees."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from fsw.core.laws.field_tracking import HandOverGains
from sim.plant.dynamics.jacobi import jacobi_integral
from sim.validate.review.law_flight import LawFlight, angle_deg, fly

FULL = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
IDLE = LawFlight(
    "rate_damping", FULL, omega_body_radps=(0.02, -0.01, 0.03), rotation_rad=(0.3, -0.4, 0.5), orbits=0.2
)


@dataclass(frozen=True)
class Push:
    """A torque about body axis 1."""

    torque_nm: float

    def __call__(self, c_body_from_eci, velocity_eci_mps):
        return (self.torque_nm, 0.0, 0.0)


def with_(**changes):
    return fly(replace(IDLE, **changes))


def test_without_torques_the_momentum_stays_in_space_wheel_included():
    run = with_(gravity=False, wheel_body_nms=(0.01, -0.02, 0.03), step_s=1.0)
    np.testing.assert_allclose(run.momentum_eci_nms - run.momentum_eci_nms[0], 0.0, atol=1e-7)
    assert np.ptp(run.omega_body_radps, axis=0).min() > 1e-3


def test_under_gravity_the_jacobi_integral_stays():
    run = fly(LawFlight("rate_damping", FULL, rotation_rad=(0.3, -0.4, 0.5), relative=True, orbits=0.5))
    integral = jacobi_integral(
        np.array(FULL), run.q_body_from_orbit, run.relative_body_radps, run.orbit_rate_radps
    )
    np.testing.assert_allclose(integral, integral[0], rtol=1e-9)
    assert np.ptp(run.angle_deg) > 1.0


def test_it_begins_where_it_is_told():
    run = with_(relative=True)
    assert run.angle_deg[0] == pytest.approx(np.degrees(np.sqrt(0.5)))
    assert run.relative_body_radps[0] == pytest.approx(IDLE.omega_body_radps)
    assert with_().omega_body_radps[0] == pytest.approx(IDLE.omega_body_radps)


def test_a_further_torque_acts():
    """Of a sphere at rest: omega = T t / J."""
    sphere = ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0))
    run = with_(inertia_kgm2=sphere, omega_body_radps=(0.0, 0.0, 0.0), gravity=False, extra=Push(1e-6))
    np.testing.assert_allclose(run.omega_body_radps[:, 0], 5e-7 * run.t_s, atol=1e-12)


def test_a_coil_gives_its_most_and_a_law_without_what_it_needs_nothing():
    assert np.abs(with_(k_w=1e8, most_am2=0.5).m_body_am2).max() == 0.5
    assert not with_(k_w=1e8, attitude_known=False).m_body_am2.any()
    assert not with_(law="sun_panels", k_w=1e8).m_body_am2.any()
    assert with_(law="sun_panels", k_w=1e6, sun_eci=(0.6, 0.0, 0.8)).m_body_am2.any()


def test_the_form_of_point_takes_over_when_it_is_told():
    """Until then both flights are one."""
    gains = {"law": "field_tracking_pd", "gains": HandOverGains(), "k_w": 1e6, "k_a": 500.0}
    never, handed = with_(**gains), with_(**gains, hand_over_orbits=0.1)
    same = never.orbits < 0.0999
    np.testing.assert_array_equal(never.m_body_am2[same], handed.m_body_am2[same])
    assert not np.allclose(never.m_body_am2[~same], handed.m_body_am2[~same])


def test_angles_are_those_of_the_direction_whatever_its_length():
    assert angle_deg(np.array([[0.0, 2.0, 0.0], [1.0, 0.0, 0.0]]), (0.0, 3.0, 0.0)) == pytest.approx(
        [0.0, 90.0]
    )
