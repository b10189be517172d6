"""The least error under a constant torque: a motion of the linearised body, a bound that laws approach."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.design.theory.bodies import BODIES, Body, diagonal
from sim.design.theory.feedforward import answer, least_error
from sim.design.theory.linear import Gains, closed_loop, dipole_field, free_motion
from sim.design.theory.periodic_lqr import Augmented, Weights, design

BODY = Body("oblique", ((1.02, 0.05, -0.03), (0.05, 1.85, 0.1), (-0.03, 0.1, 1.95)), 800.0, 98.6)
TORQUE = (1e-7, -2e-7, 5e-8)


def response(body, torque, dipole, orbits, start):
    """Integrate x' = A x + J^-1 (v x B + d / w0^2) with v the dipole of (u, x); theta over the last orbit."""
    w0, inverse = body.rate_radps, np.linalg.inv(np.array(body.inertia_kgm2))
    free, pushed = free_motion(body), inverse @ np.array(torque) / w0**2

    def change(u, x):
        v = dipole(u, x) * body.field_t / w0**2
        out = free @ x
        out[:3] += inverse @ np.cross(v, dipole_field(np.array(u), body)) + pushed
        return out

    times = 2.0 * np.pi * (orbits - 1.0 + np.arange(32) / 32)
    flown = solve_ivp(change, (0.0, 2.0 * np.pi * orbits), start, t_eval=times, rtol=1e-9, atol=1e-11)
    return flown.y[3:].T


def fourier(values):
    """The function of period 2 pi through values at equal nodes."""
    waves, parts = np.fft.fftfreq(len(values), 1.0 / len(values)), np.fft.fft(values, axis=0) / len(values)
    return lambda u: (np.exp(1j * waves * u) @ parts).real


def rms(theta):
    return float(np.sqrt(np.mean(np.sum(theta**2, axis=1))))


def test_the_answer_is_a_periodic_motion_of_the_linearised_body():
    """Integrated from its own first state for one orbit, the body moves as computed."""
    found = least_error(BODY, TORQUE)
    waves = np.fft.fftfreq(32, 1.0 / 32)
    rate = np.fft.ifft(1j * waves[:, None] * np.fft.fft(found.theta_rad, axis=0), axis=0).real[0]
    dipole = fourier(found.dipole_am2)
    theta = response(BODY, TORQUE, lambda u, x: dipole(u), 1, np.concatenate([rate, found.theta_rad[0]]))
    assert theta == pytest.approx(found.theta_rad, abs=1e-3 * np.abs(found.theta_rad).max())
    assert rms(theta) == pytest.approx(found.rms_rad, rel=1e-3)


@pytest.mark.long
def test_cheap_dipoles_bring_the_regulator_to_it_and_none_under_it():
    """Another way to the same bound: the periodic regulator that knows the torque."""
    body, torque = BODIES[2], (1e-7, 1e-7, 1e-7)
    least = least_error(body, torque).rms_rad

    def flown(effort):
        law = design(body, Weights(rate=0.0, effort=effort), Augmented.TORQUE, nodes=128)
        gain = fourier(law.gain.reshape(128, 27))

        def dipole(u, x):
            si = np.concatenate([body.rate_radps * x[:3], x[3:], torque])
            return gain(u).reshape(3, 9) @ si

        return rms(response(body, torque, dipole, 4, np.zeros(6)))

    dear, cheap = flown(0.5), flown(0.03)
    assert least < cheap < 1.02 * least
    assert dear > 1.1 * least


def test_a_given_field_takes_the_place_of_the_direct_dipoles():
    elsewhere = replace(BODY, inclination_deg=20.0)
    field = dipole_field(2.0 * np.pi / 32 * np.arange(32), elsewhere)
    given = least_error(BODY, TORQUE, b_orbit=field).rms_rad
    assert given == least_error(elsewhere, TORQUE).rms_rad
    assert given > 1.1 * least_error(BODY, TORQUE).rms_rad


def test_the_answer_to_a_varying_torque_is_what_the_regulated_body_comes_to():
    """Integrated for forty orbits from rest: what began has died away."""
    gains = Gains(8e6, 1.6e3)
    u = 2.0 * np.pi / 32 * np.arange(32)
    torque = np.stack([1e-7 * np.cos(u), -2e-7 * np.sin(2.0 * u), 5e-8 * np.sin(u)], axis=1)
    at, matrix, w0 = fourier(torque), closed_loop(BODY, gains), BODY.rate_radps
    inverse = np.linalg.inv(np.array(BODY.inertia_kgm2))

    def change(now, x):
        out = matrix(np.array([now]))[0] @ x
        out[:3] += inverse @ at(now) / w0**2
        return out

    times = 2.0 * np.pi * 39.0 + u
    flown = solve_ivp(change, (0.0, times[-1]), np.zeros(6), t_eval=times, rtol=1e-8, atol=1e-11)
    found = answer(BODY, gains, torque)
    np.testing.assert_allclose(flown.y[3:].T, found, atol=0.01 * np.abs(found).max())


def test_without_a_dipole_the_error_is_larger():
    found = least_error(BODIES[2], (1e-7, 1e-7, 1e-7))
    free = free_motion(BODIES[2])
    pushed = np.linalg.solve(np.array(BODIES[2].inertia_kgm2), np.full(3, 1e-7)) / BODIES[2].rate_radps ** 2
    at_rest = np.linalg.solve(free, -np.concatenate([pushed, np.zeros(3)]))[3:]
    assert found.rms_rad < 0.1 * np.linalg.norm(at_rest)


def test_the_answer_scales_with_the_torque():
    one, three = least_error(BODY, TORQUE), least_error(BODY, tuple(3.0 * part for part in TORQUE))
    assert three.rms_rad == pytest.approx(3.0 * one.rms_rad, rel=1e-9)
    assert three.dipole_am2 == pytest.approx(3.0 * one.dipole_am2, rel=1e-6, abs=1e-9)


def test_nodes_enough():
    body = Body("50 kg", diagonal((1.02, 1.85, 1.95)), 800.0, 98.6)
    torque = (1e-7, 1e-7, 1e-7)
    assert least_error(body, torque).rms_rad == pytest.approx(least_error(body, torque, 48).rms_rad, rel=1e-9)
