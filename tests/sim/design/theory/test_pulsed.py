"""The pulsed loop against a direct integration of its pulses, and against the continuous loop it tends to."""

from dataclasses import replace
from math import exp, pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.design.theory.bodies import BODIES
from sim.design.theory.linear import Gains, closed_loop, dipole_field, free_motion, skew
from sim.design.theory.pulsed import PulsedLoop, Pulsing
from sim.design.theory.search import continuous

MICROSAT = BODIES[2]
GAINS = Gains(5.0e6, 900.0)


def fly(body, gains, pulsing, periods, start):
    """One orbit of (x, r), pulse by pulse: an adaptive integrator between the edges."""
    size = len(start) - 3
    free, loop = free_motion(body, size), closed_loop(body, gains)
    inertia, leak = np.asarray(body.inertia_kgm2), pulsing.leak_s * body.rate_radps
    period = 2.0 * pi / periods
    pulse = period * pulsing.duty

    def demanded(u, x):
        return inertia @ ((loop(np.array([u]))[0] - free) @ x)[:3]

    def derivative(torque):
        def of(u, y):
            x, owed = y[:size], y[size:]
            push = np.concatenate([np.linalg.solve(inertia, torque), np.zeros(size - 3)])
            return np.concatenate([free @ x + push, demanded(u, x) - owed / leak])

        return of

    y = np.array(start)
    for k in range(periods):
        u = k * period
        due = y[size:] + 0.5 * period * demanded(u, y[:size])
        paid = nearest(due, dipole_field(np.array(u + 0.5 * pulse), body), inertia, pulsing.in_turn, k)
        y[size:] -= paid
        for torque, edges in ((paid / pulse, (u, u + pulse)), (np.zeros(3), (u + pulse, u + period))):
            y = solve_ivp(derivative(torque), edges, y, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    return y


def nearest(due, field, inertia, in_turn, k):
    """By least squares over the dipoles: what coils can pay, |J^-1 (d - m x b)| least."""
    coils = np.eye(3)[:, [k % 3]] if in_turn else np.eye(3)
    given = -skew(field) @ coils
    inverse = np.linalg.inv(inertia)
    dipole = np.linalg.lstsq(inverse @ given, inverse @ due, rcond=1e-10)[0]
    return given @ dipole


@pytest.mark.long
@pytest.mark.parametrize("in_turn", [False, True], ids=["all coils", "one coil in turn"])
def test_an_orbit_of_pulses_flown_one_by_one_is_the_monodromy_matrix(skewed, in_turn):
    pulsing = Pulsing(pulse_s=60.0, backoff_s=590.0, leak_s=900.0, in_turn=in_turn)
    loop = PulsedLoop(skewed, pulsing)
    start = np.array([0.3, -0.2, 0.5, 0.1, 0.4, -0.6, 0.7, -0.5, 0.2])
    flown = fly(skewed, GAINS, pulsing, loop.periods, start)
    assert loop.monodromy(GAINS) @ start == pytest.approx(flown, abs=1e-8 * np.abs(flown).max())


def test_an_integral_is_owed_and_paid_too(skewed):
    pulsing = Pulsing(pulse_s=60.0, backoff_s=590.0, leak_s=900.0)
    gains, loop = GAINS._replace(k_i=0.3), PulsedLoop(skewed, pulsing, 9)
    start = np.array([0.3, -0.2, 0.5, 0.1, 0.4, -0.6, 0.8, 0.3, -0.4, 0.7, -0.5, 0.2])
    flown = fly(skewed, gains, pulsing, loop.periods, start)
    assert loop.monodromy(gains) @ start == pytest.approx(flown, abs=1e-8 * np.abs(flown).max())


def test_short_periods_tend_to_the_continuous_loop():
    expected = continuous(MICROSAT)(GAINS)
    away = [
        abs(float(PulsedLoop(MICROSAT, Pulsing(0.03 * p, p, leak_s=600.0)).degree(GAINS) - expected))
        for p in (100.0, 10.0, 1.0)
    ]
    assert away[0] > 3.0 * away[1] > 9.0 * away[2]
    assert away[2] < 2e-3


def test_periods_are_counted_in_whole_and_coils_in_turn_by_three():
    assert Pulsing().periods_per_orbit(MICROSAT) == 59
    assert Pulsing(in_turn=True).periods_per_orbit(MICROSAT) == 60
    assert Pulsing(backoff_s=1e6).periods_per_orbit(MICROSAT) == 1


def test_the_duty_of_the_default_pulses():
    assert Pulsing().duty == pytest.approx(3.0 / 103.0)


def test_without_gains_what_is_owed_is_paid_or_forgotten():
    loop = PulsedLoop(MICROSAT, Pulsing(leak_s=300.0))
    whole = loop.monodromy(Gains(0.0, 0.0))
    assert (whole[6:, :6] == 0.0).all()
    assert np.abs(whole[6:, 6:]).max() < exp(-6052.0 / 300.0)


def test_many_gains_at_once_are_the_same_one_by_one():
    loop = PulsedLoop(MICROSAT, Pulsing(in_turn=True))
    k_w, k_a = np.array([2e6, 6e6]), np.array([700.0, 1500.0])
    alone = [float(loop.degree(Gains(w, a))) for w, a in zip(k_w, k_a, strict=True)]
    assert loop.degree(Gains(k_w, k_a)) == pytest.approx(alone, abs=1e-12)


def test_a_coil_along_the_field_pays_nothing():
    equator = replace(MICROSAT, inclination_deg=0.0)
    loop = PulsedLoop(equator, Pulsing(in_turn=True))
    assert float(loop.degree(Gains(1e6, 300.0))) == pytest.approx(0.0, abs=1e-6)
