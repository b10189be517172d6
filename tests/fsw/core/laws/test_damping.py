"""The damping laws: equations, that they never add energy, and that both are one law."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.core.laws.damping import bdot_dipole, rate_damping_dipole

K_W = 6.2694e6
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(0.1 * c for c in v))


@pytest.mark.long
@given(fields, rates)
def test_the_equation(b, omega):
    """m = -k_w b x omega."""
    expected = -K_W * np.cross(b, omega)
    np.testing.assert_allclose(rate_damping_dipole(b, omega, K_W), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.long
@given(fields, rates, st.floats(0.0, 1e8))
def test_rate_damping_never_adds_energy(b, omega, k_w):
    """The power omega . (m x b) is -k_w |b x omega|^2."""
    power = np.dot(omega, np.cross(rate_damping_dipole(b, omega, k_w), b))
    assert power == pytest.approx(-k_w * np.linalg.norm(np.cross(b, omega)) ** 2, rel=1e-6, abs=1e-20)
    assert power <= 1e-20


def test_a_rate_along_the_field_is_out_of_reach():
    b = (1e-5, -2e-5, 3e-5)
    assert rate_damping_dipole(b, (0.01, -0.02, 0.03), K_W) == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


@pytest.mark.long
@given(fields, fields, st.floats(0.01, 10.0))
def test_the_equation_of_bdot(b, before, interval_s):
    """m = -k_w (b - b_before) / interval."""
    expected = -K_W * (np.array(b) - before) / interval_s
    np.testing.assert_allclose(bdot_dipole(b, before, interval_s, K_W), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("interval_s", [0.1, 1.0])
def test_bdot_is_rate_damping_while_the_body_turns_slowly(interval_s):
    """LawInput from a body that turns with omega in a field that stands still, db/dt = b x omega.

    The difference over an interval is the derivative in its middle, up to (omega h)^2 / 24.
    """
    omega = np.array([0.011, -0.007, 0.005])
    b_eci_t = np.array([1.7e-5, -2.3e-5, 3.1e-5])

    def field_at(t_s):
        return tuple(Rotation.from_rotvec(omega * t_s).as_matrix().T @ b_eci_t)

    by_difference = np.array(bdot_dipole(field_at(interval_s), field_at(0.0), interval_s, K_W))
    by_rate = np.array(rate_damping_dipole(field_at(0.5 * interval_s), tuple(omega), K_W))
    assert np.linalg.norm(by_difference - by_rate) < 1e-5 * np.linalg.norm(by_rate)


def test_bdot_of_a_tumbling_body_takes_energy_away_too():
    omega = np.array([0.11, -0.17, 0.07])
    b_eci_t = np.array([1.7e-5, -2.3e-5, 3.1e-5])
    for t_s in range(100):
        now, before = (tuple(Rotation.from_rotvec(omega * t).as_matrix().T @ b_eci_t) for t in (t_s, t_s - 1))
        assert np.dot(omega, np.cross(bdot_dipole(now, before, 1.0, K_W), now)) < 0.0
