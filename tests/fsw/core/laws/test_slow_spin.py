"""The slow spin about the orbit normal: the push, alone and with B-dot beside it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.damping import rate_damping_dipole
from fsw.core.laws.interface import Demand
from fsw.core.laws.slow_spin import push_dipole, slow_spin
from fsw.core.laws.spin import SpinGains

component = st.floats(-1.0, 1.0, allow_subnormal=False)
fields = st.tuples(component, component, component).map(lambda v: tuple(4e-5 * c for c in v))
rates = st.tuples(component, component, component).map(lambda v: tuple(0.01 * c for c in v))
GAINS = {"slow_spin": SpinGains(3.0)}


def test_of_the_third_axis_by_hand():
    """K (e3 x b) = k (-b2, b1, 0): the third coil is off."""
    assert push_dipole((1e-5, 2e-5, 3e-5), 2, 1e5) == pytest.approx((-2.0, 1.0, 0.0))


@given(fields, st.integers(0, 2))
def test_it_turns_the_body_about_minus_e(b, axis):
    torque = np.cross(push_dipole(b, axis, 5.0), b)
    across = np.delete(np.array(b), axis)
    assert torque[axis] == pytest.approx(-5.0 * across @ across, abs=1e-20)


@pytest.mark.long
@given(fields, rates)
def test_with_damping_it_is_damping_about_the_spin(b, omega):
    """-k_w b x omega - k_w w_ref e x b = -k_w b x (omega - w_ref e)."""
    both = np.array(rate_damping_dipole(b, omega, 6e6)) + push_dipole(b, 2, -6e6 * 0.004)
    about = rate_damping_dipole(b, (omega[0], omega[1], omega[2] - 0.004), 6e6)
    np.testing.assert_allclose(both, about, atol=1e-12)


@pytest.mark.long
class TestFlights:
    @pytest.fixture
    def flown(self, bench, turned):
        def fly(law, spin_radps, orbits):
            return bench.fly(
                law,
                bench.setpoint(k_w=6e6, spin_radps=spin_radps),
                gains=GAINS,
                c_body_from_orbit=turned((1, 1, 0), 70.0),
                omega_body=(0.005, -0.005, 0.005),
                seconds=orbits * bench.Orbit().period_s,
                step_s=5.0,
                known=False,
            )

        return fly

    @pytest.mark.parametrize("spin_radps", [0.004, -0.01])
    def test_the_axis_comes_to_the_normal_and_turns_slowly(self, flown, bench, spin_radps):
        """Along the normal or against it, as the spin is; without an attitude."""
        run = flown(slow_spin, spin_radps, 3.0)
        off = np.degrees(np.arccos(run.c_body_from_orbit[:, 2, 2]))
        assert off[0] > 60.0
        assert (off[-1] if spin_radps > 0.0 else 180.0 - off[-1]) < 7.0
        assert run.omega_body[-1, 2] == pytest.approx(spin_radps, abs=2.5 * bench.Orbit().rate_radps)

    def test_the_push_alone_has_no_end(self, flown):
        """The equation as the review prints it."""

        def push(inputs, memory, setpoint, config):
            return Demand(push_dipole(inputs.b_body_t, 2, -6e6 * setpoint.spin_radps))

        spin = flown(push, 0.004, 1.0).omega_body[:, 2]
        assert spin[-1] > 0.03
        assert spin[-1] > 1.5 * spin[len(spin) // 2] > 0.0
