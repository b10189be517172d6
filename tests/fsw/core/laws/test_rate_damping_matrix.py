"""Damping with a matrix gain: its equation, and that it never adds energy, as the other order would."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.damping import rate_damping
from fsw.core.laws.rate_damping_matrix import MatrixGains, matrix_damping_dipole, rate_damping_matrix

FULL = MatrixGains(1.5, 0.8, 1.2, 0.3, -0.2, 0.1)
K_W = 6.27e6
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(0.1 * c for c in v))


def test_the_equation_by_hand():
    """b x Omega = (1, 2, -1) * (0, 1, 2) = (5, -2, 1) e-7; H of it; -2e6 of that."""
    gains = MatrixGains(2.0, 3.0, 1.0, 0.5, 0.0, -1.0)
    m = matrix_damping_dipole((1e-5, 2e-5, -1e-5), (0.0, 0.01, 0.02), gains.matrix, 2e6)
    assert m == pytest.approx((-1.8, 0.9, -0.6))


@pytest.mark.long
@given(fields, rates)
def test_it_never_adds_energy(b, omega):
    power = np.dot(omega, np.cross(matrix_damping_dipole(b, omega, FULL.matrix, K_W), b))
    across = np.cross(b, omega)
    assert power == pytest.approx(-K_W * across @ np.array(FULL.matrix) @ across, rel=1e-6, abs=1e-20)
    assert power <= 1e-20


def test_the_other_order_would():
    """m = -k_w b x (H Omega) with the same kind of H: a rate that grows."""
    h, b = np.diag([10.0, 1.0, 1.0]), np.array([1e-5, 2.5e-5, 0.0])
    omega = np.array([0.01, 0.1, 0.0])
    assert omega @ np.cross(-K_W * np.cross(b, h @ omega), b) > 0.0
    gains = MatrixGains(10.0)
    assert omega @ np.cross(matrix_damping_dipole(tuple(b), tuple(omega), gains.matrix, K_W), b) < 0.0


@pytest.mark.parametrize("values", [{"h11": 0.0}, {"h22": -1.0}, {"h12": 1.3}, {"h13": 2.0}])
def test_a_matrix_that_is_not_positive_definite_is_refused(values):
    with pytest.raises(ValueError, match="not positive definite"):
        MatrixGains(**values)


@pytest.mark.long
class TestFlights:
    @pytest.fixture
    def flown(self, bench):
        def fly(law, gains=None, spin_radps=0.0):
            return bench.fly(
                law,
                bench.setpoint(spin_radps=spin_radps),
                gains=gains,
                omega_body=(0.004, -0.003, 0.002),
                seconds=6000.0,
            )

        return fly

    def test_the_identity_is_the_scalar_law(self, flown):
        same = flown(rate_damping_matrix, {"rate_damping_matrix": MatrixGains(1.0, 1.0, 1.0)}, 0.003)
        np.testing.assert_allclose(same.m_body, flown(rate_damping, None, 0.003).m_body, atol=1e-9)

    def test_the_jacobi_integral_falls(self, bench, flown):
        """Of 1/2 Omega J Omega + 3/2 w0^2 e1 J e1 - 1/2 w0^2 e3 J e3."""
        run = flown(rate_damping_matrix, {"rate_damping_matrix": FULL})
        orbit, inertia = bench.Orbit(), bench.Body().inertia
        e1, e3 = run.c_body_from_orbit[:, :, 0], run.c_body_from_orbit[:, :, 2]
        half = [0.5 * np.einsum("ti,ij,tj->t", v, inertia, v) for v in (run.relative_body, e1, e3)]
        jacobi = half[0] + orbit.rate_radps**2 * (3.0 * half[1] - half[2])
        assert np.all(np.diff(jacobi) <= 1e-13)
        assert np.linalg.norm(run.relative_body[-1]) < 0.5 * np.linalg.norm(run.relative_body[0])
