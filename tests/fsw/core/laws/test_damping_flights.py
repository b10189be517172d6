"""The damping laws flown: where B-dot stops and omega x b does not, the energy, and the switched gain."""

import numpy as np
import pytest

from fsw.core.laws.damping import (
    SwitchedGains,
    bdot,
    bdot_switched,
    rate_damping,
    rate_damping_dipole,
    switched_gain,
)
from fsw.core.laws.interface import Demand
from fsw.core.laws.motion import motion

TUMBLE = (0.02, -0.03, 0.025)
K_W = 6.27e6


def absolute_damping(inputs, memory, setpoint, config):
    """m = -k_w b x omega with the absolute rate, as the review has it."""
    omega = motion(inputs, config).omega_body_radps
    return Demand(rate_damping_dipole(inputs.b_body_t, omega, setpoint.k_w))


@pytest.fixture(scope="module")
def damped(bench):
    """Rates against the orbital rate, an orbit a row, of a body without gravity gradient."""

    def fly(law, inclination_deg, orbits, k_w=K_W, gains=None, most_am2=1e9, step_s=5.0):
        orbit = bench.Orbit(inclination_deg=inclination_deg)
        return orbit, bench.fly(
            law,
            bench.setpoint(k_w=k_w),
            gains=gains,
            orbit=orbit,
            body=bench.Body(gravity=False, most_am2=most_am2),
            omega_body=TUMBLE,
            seconds=orbits * orbit.period_s,
            step_s=step_s,
        )

    return fly


def in_orbital_rates(orbit, run):
    return np.linalg.norm(run.omega_body, axis=1) / orbit.rate_radps


@pytest.mark.long
def test_bdot_stops_just_under_twice_the_orbital_rate(damped):
    """On a polar orbit the field itself turns at 2 w0 on the mean, and the body with it."""
    orbit, run = damped(bdot, 90.0, orbits=4)
    rate = in_orbital_rates(orbit, run)[-2 * len(run.t_s) // 4 :]
    assert 1.8 < rate.mean() < 2.0
    assert rate.min() > 1.2


@pytest.mark.long
def test_damping_by_the_rate_does_not_stop_there(damped):
    orbit, run = damped(absolute_damping, 90.0, orbits=2.5)
    rate = in_orbital_rates(orbit, run)
    assert rate[-1] < 0.05
    assert np.all(np.diff(run.energy_j) <= 0.0)


@pytest.mark.long
def test_its_decay_is_exponential_and_slower_where_the_field_turns_less(bench):
    """A sphere comes to lose an equal logarithm each orbit; at 30 deg less than over the poles."""
    lost = {}
    for inclination_deg in (30.0, 90.0):
        orbit = bench.Orbit(inclination_deg=inclination_deg)
        run = bench.fly(
            absolute_damping,
            bench.setpoint(k_w=1e6),
            orbit=orbit,
            body=bench.Body(inertia=1.9 * np.eye(3), gravity=False),
            omega_body=TUMBLE,
            seconds=5.01 * orbit.period_s,
            step_s=orbit.period_s / 600,
        )
        by_orbit = np.log(in_orbital_rates(orbit, run))[::600]
        fourth, fifth = -np.diff(by_orbit)[3:]
        assert fifth == pytest.approx(fourth, rel=0.01)
        lost[inclination_deg] = fifth
    assert 0.7 < lost[30.0] < 0.5 * lost[90.0]


@pytest.mark.long
def test_damping_of_the_relative_rate_takes_the_jacobi_integral_down(bench):
    """Under gravity gradient: 1/2 Omega J Omega + 3/2 w0^2 e1 J e1 - 1/2 w0^2 e3 J e3."""
    orbit, body = bench.Orbit(), bench.Body()
    run = bench.fly(rate_damping, bench.setpoint(), omega_body=(0.004, -0.003, 0.002), seconds=9000.0)
    e1, e3, rate = run.c_body_from_orbit[:, :, 0], run.c_body_from_orbit[:, :, 2], run.relative_body
    half = [0.5 * np.einsum("ti,ij,tj->t", v, body.inertia, v) for v in (rate, e1, e3)]
    jacobi = half[0] + orbit.rate_radps**2 * (3.0 * half[1] - half[2])
    assert np.all(np.diff(jacobi) <= 1e-13)
    assert np.linalg.norm(rate[-1]) < 0.5 * np.linalg.norm(rate[0])


class TestSwitchedGain:
    @pytest.mark.long
    def test_a_larger_gain_at_the_end_is_faster_where_the_first_still_holds_the_coils_busy(self, damped):
        gains = {"bdot_switched": SwitchedGains(below_radps=0.01, factor=5.0)}
        _, fixed = damped(bdot, 98.6, orbits=2.5, k_w=6e5, most_am2=2.0)
        orbit, switched = damped(bdot_switched, 98.6, orbits=2.5, k_w=6e5, most_am2=2.0, gains=gains)
        slow = [in_orbital_rates(orbit, run) < 4.0 for run in (fixed, switched)]
        assert slow[1].sum() > 2 * slow[0].sum() > 0
        fast = np.linalg.norm(fixed.omega_body, axis=1) > 0.03
        np.testing.assert_array_equal(fixed.m_body[fast], switched.m_body[fast])

    def test_the_gain_changes_at_the_rate_that_is_set(self):
        b, across = (0.0, 3e-5, 0.0), (3e-5, 0.0, 0.0)
        fast, slow = tuple(0.011 * c for c in across), tuple(0.009 * c for c in across)
        assert switched_gain(fast, b, 2.0, 0.01, 5.0) == 2.0
        assert switched_gain(slow, b, 2.0, 0.01, 5.0) == 10.0
