"""The Sun law: its torque, and the momentum brought to the Sun with and without a known rate."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.interface import FieldSample
from fsw.core.laws.sun_pointing import sun_dipole, sun_pointing

SUN = (0.2, -0.7, 0.5)
SUN_SEEN = np.array([0.6, 0.0, 0.8])
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v)).filter(lambda b: np.linalg.norm(b) > 1e-6)
directions = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: np.array(v) / np.linalg.norm(v))
rates = vectors.map(lambda v: 0.05 * np.array(v))


@pytest.mark.long
@given(fields, directions, rates)
def test_across_the_sun_the_torque_is_a_drag(b, sun, omega):
    """M = k cos(alpha) (s (omega . b) - omega (s . b)): across s it is -k |b| cos(alpha)^2 omega_across."""
    field_t = np.linalg.norm(b)
    cos_alpha = sun @ b / field_t
    torque = np.cross(sun_dipole(tuple(np.cross(sun, omega)), cos_alpha, 100.0), b)
    across = torque - (torque @ sun) * sun
    omega_across = omega - (omega @ sun) * sun
    np.testing.assert_allclose(across, -100.0 * field_t * cos_alpha**2 * omega_across, atol=1e-15)


@pytest.fixture(scope="module")
def run(bench):
    def fly(omega, known=True):
        orbit = bench.Orbit()
        return bench.fly(
            sun_pointing,
            bench.setpoint(k_w=1e7),
            orbit=orbit,
            body=bench.Body(inertia=np.diag([1.0, 1.2, 2.0]), gravity=False),
            omega_body=omega,
            seconds=0.8 * orbit.period_s,
            step_s=2.5,
            sun_eci=SUN,
            known=known,
        )

    return fly


@pytest.mark.long
class TestFlights:
    @pytest.mark.parametrize("known", [True, False])
    def test_momentum_and_axis_of_most_inertia_come_to_the_sun(self, run, known):
        """With the rate estimated, or by the Sun sensor alone."""
        flight = run((0.01, 0.03, 0.04), known)
        assert flight.axis_to_deg(2, SUN)[0] > 40.0
        assert flight.angle_to_deg(SUN)[-1] < 0.1
        assert flight.axis_to_deg(2, SUN)[-1] < 0.5
        assert np.linalg.norm(flight.omega_body[-1]) > 0.02

    def test_a_momentum_away_from_the_sun_goes_to_the_far_end_of_its_line(self, run):
        flight = run((0.02, -0.01, -0.05))
        assert flight.angle_to_deg(SUN)[0] > 120.0
        assert flight.angle_to_deg(SUN)[-1] > 170.0


class TestWithoutRate:
    @pytest.fixture
    def fly(self, bench, turned):
        settings, point = bench.config(bench.Body(), 1.0), bench.setpoint(k_w=1e7)

        def at(tick, memory, sun=SUN_SEEN):
            c = turned((1, 2, 3), 0.5 * tick)
            inputs = bench.inputs_at(
                bench.Orbit(), tick, 1.0, c, np.zeros(3), FieldSample(), sun, known=False
            )
            return sun_pointing(inputs, memory, point, settings)

        return at

    def test_two_sun_vectors_are_needed(self, fly):
        first = fly(30, ())
        assert first.m_body_am2 == (0.0, 0.0, 0.0)
        assert fly(31, first.memory).m_body_am2 != (0.0, 0.0, 0.0)

    def test_ticks_that_were_missed_do_not_count_as_speed(self, fly):
        """Two ticks later the vector has moved twice as far in twice the time."""
        first = fly(30, ())
        one, two = fly(31, first.memory).m_body_am2, fly(32, first.memory).m_body_am2
        np.testing.assert_allclose(two, one, rtol=0.1, atol=0.02 * np.linalg.norm(one))

    def test_a_vector_of_long_ago_is_none(self, fly):
        assert fly(41, fly(30, ()).memory).m_body_am2 == (0.0, 0.0, 0.0)

    def test_eclipse_wipes_the_memory(self, fly):
        dark = fly(31, fly(30, ()).memory, sun=None)
        assert dark.m_body_am2 == (0.0, 0.0, 0.0)
        assert dark.memory == ()
