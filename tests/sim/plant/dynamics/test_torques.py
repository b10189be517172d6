import numpy as np
import pytest

from sim.plant.dynamics import torques
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, from_vector, matrix, transform

J = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
Q = from_vector((0.4, -0.7, 1.1))
E = tuple(np.array([0.6, -0.48, 0.64]))
AROUND = Surroundings(E, 3.2e-6, (1.1e-5, -2.3e-5, 3.1e-5))
DIPOLE, BIAS = (0.3, -0.2, 0.5), (3e-8, -2e-8, 1e-8)


def test_gravity_gradient_by_its_equation():
    expected = 3.2e-6 * np.cross(E, np.array(J) @ E)
    assert torques.gravity_gradient(J, E, 3.2e-6) == pytest.approx(expected)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_gravity_gradient_vanishes_with_a_principal_axis_on_the_radius(axis):
    diagonal = ((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0))
    e = tuple(float(i == axis) for i in range(3))
    assert torques.gravity_gradient(diagonal, e, 3.2e-6) == (0.0, 0.0, 0.0)


def test_gravity_gradient_turns_the_long_axis_to_the_radius():
    """The radius is turned from body axis 1 towards axis 2: so is the torque, about +3."""
    long_axis_1 = ((1.0, 0.0, 0.0), (0.0, 9.0, 0.0), (0.0, 0.0, 9.5))
    torque = torques.gravity_gradient(long_axis_1, (np.cos(0.1), np.sin(0.1), 0.0), 3.2e-6)
    assert torque == pytest.approx((0.0, 0.0, 3.2e-6 * 8.0 * np.cos(0.1) * np.sin(0.1)))


def test_magnetic_torque_turns_the_dipole_to_the_field():
    assert torques.magnetic((2.0, 0.0, 0.0), (0.0, 3e-5, 0.0)) == pytest.approx((0.0, 0.0, 6e-5))
    assert torques.magnetic(DIPOLE, DIPOLE) == pytest.approx((0.0, 0.0, 0.0))


def test_the_total_is_the_sum_of_the_sources():
    c = matrix(Q)
    e_body, b_body = transform(c, AROUND.e_eci), transform(c, AROUND.b_eci_t)
    parts = [torques.gravity_gradient(J, e_body, 3.2e-6), torques.magnetic(DIPOLE, b_body), BIAS]
    assert torques.BodyTorque(J, DIPOLE, BIAS).at(Q, ZERO, AROUND) == pytest.approx(
        np.sum(parts, axis=0), rel=1e-12
    )


def test_eddy_currents_by_the_identity_of_the_double_product():
    """(w x b) x b = b (b . w) - w |b|^2."""
    w, b = np.array([0.3, -0.2, 0.5]), np.array([1.1e-5, -2.3e-5, 3.1e-5])
    expected = 40.0 * (b * (b @ w) - w * (b @ b))
    assert torques.eddy(40.0, tuple(w), tuple(b)) == pytest.approx(expected)


def test_eddy_currents_never_add_energy_and_leave_a_turn_along_the_field():
    rng = np.random.default_rng(2)
    for w, b in zip(rng.standard_normal((50, 3)), 3e-5 * rng.standard_normal((50, 3)), strict=True):
        torque = torques.eddy(40.0, tuple(w), tuple(b))
        assert np.dot(torque, w) < 0.0
        assert np.dot(torque, b) == pytest.approx(0.0, abs=1e-15 * np.linalg.norm(torque))
        assert torques.eddy(40.0, tuple(3.0 * b), tuple(b)) == pytest.approx((0.0, 0.0, 0.0), abs=1e-22)


def test_a_thin_sphere_is_braked_as_its_currents_dissipate():
    """Power by Ohm's law over the shell, w across b: in body axes the field changes by b x w a second.

    It drives E = 1/2 |w x b| r sin about the axis of that change: along the shell, so that no charge gathers.
    """
    radius_m, conductivity, thickness_m, rate, b = 0.25, 3.5e7, 1e-3, 0.05, 3e-5
    cosine, weight = np.polynomial.legendre.leggauss(20)
    field = 0.5 * rate * b * radius_m * np.sqrt(1.0 - cosine**2)
    power = 2.0 * np.pi * radius_m**2 * thickness_m * conductivity * (weight @ field**2)
    k = 2.0 / 3.0 * np.pi * radius_m**4 * conductivity * thickness_m
    torque = torques.eddy(k, (0.0, 0.0, rate), (b, 0.0, 0.0))
    assert -np.dot(torque, (0.0, 0.0, rate)) == pytest.approx(power, rel=1e-12)
