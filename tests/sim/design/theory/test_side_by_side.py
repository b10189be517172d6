"""Many flights at once: each is the plant's own of one satellite."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.design.theory.side_by_side import angle_deg, in_body, quaternion_rate, step
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import TorqueFunction, magnetic
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import matrix, transform

INERTIA = ((3.1, 0.2, -0.1), (0.2, 2.2, 0.3), (-0.1, 0.3, 1.7))
DIPOLE_AM2 = (0.4, -1.1, 0.7)
FIELDS_T = np.array([[2e-5, -1e-5, 3e-5], [1e-5, 1e-5, 3e-5], [-1e-5, 2e-5, 2e-5]])
STARTS = np.array(
    [
        [0.6, -0.48, 0.36, 0.528, 0.01, -0.02, 0.03],
        [-0.1, 0.7, -0.5, 0.5, -0.03, 0.02, 0.005],
        [0.9, 0.1, 0.3, -0.3, 0.0, 0.0, 0.0],
    ]
)
STARTS[:, :4] /= np.linalg.norm(STARTS[:, :4], axis=1)[:, None]


def rates(x, b_t):
    """Of a body with a dipole that stays, in a frame that does not turn."""
    q, omega, inertia = x[:, :4], x[:, 4:], np.array(INERTIA)
    torque = np.cross(DIPOLE_AM2, in_body(q, b_t)) - np.cross(omega, omega @ inertia)
    return np.concatenate([quaternion_rate(q, omega), torque @ np.linalg.inv(inertia)], axis=1)


@pytest.mark.parametrize("flight", range(len(STARTS)))
def test_a_step_is_the_plant_s(flight):
    def torque(q, _, at):
        return magnetic(DIPOLE_AM2, transform(matrix(q), at.b_eci_t))

    places = [Surroundings((1.0, 0.0, 0.0), 0.0, tuple(field)) for field in FIELDS_T.tolist()]
    start = STARTS[flight].tolist()
    motion = Motion(tuple(start[:4]), tuple(start[4:]))
    plant = RigidBody(INERTIA).step(motion, TorqueFunction(torque), 0.2, *places)
    ours = step(rates, STARTS, FIELDS_T, 0.2)[flight]
    np.testing.assert_allclose(ours, (*plant.q_body_from_eci, *plant.omega_body_radps), rtol=0.0, atol=1e-14)


@pytest.mark.long
def test_the_error_of_a_step_falls_with_its_fifth_power():
    def error(h_s):
        finer = STARTS
        for _ in range(64):
            finer = step(rates, finer, FIELDS_T[[1, 1, 1]], h_s / 64)
        return np.abs(step(rates, STARTS, FIELDS_T[[1, 1, 1]], h_s) - finer).max()

    assert error(20.0) / error(10.0) == pytest.approx(32.0, rel=0.2)


def test_a_vector_is_turned_as_the_attitude_is():
    v = np.array([0.3, -1.2, 0.7])
    expected = Rotation.from_quat(STARTS[:, [1, 2, 3, 0]]).inv().apply(v)
    np.testing.assert_allclose(in_body(STARTS[:, :4], v), expected, rtol=1e-12)


def test_the_angle_is_the_shorter_way():
    expected = np.degrees(Rotation.from_quat(STARTS[:, [1, 2, 3, 0]]).magnitude())
    np.testing.assert_allclose(angle_deg(STARTS), expected, rtol=1e-9)
    np.testing.assert_allclose(angle_deg(-STARTS), expected, rtol=1e-9)


def test_flights_do_not_touch_each_other():
    ours = step(rates, STARTS, FIELDS_T, 20.0)
    for flight in range(len(STARTS)):
        others = STARTS[[1, 2, 0]].copy()
        others[flight] = STARTS[flight]
        np.testing.assert_array_equal(step(rates, others, FIELDS_T, 20.0)[flight], ours[flight])
