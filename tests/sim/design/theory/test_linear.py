"""The linearisation against the plant: its right-hand side, and an orbit of its nonlinear motion."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fsw.core.laws.pd import attitude_error, pd_dipole
from sim.design.theory.bodies import BODIES, Body, diagonal
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import (
    Gains,
    closed_loop,
    conditioning,
    dipole_field,
    free_motion,
    gramian,
    projection,
    resting_torque,
    skew,
)
from sim.plant.config import OrbitConfig
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import TorqueFunction, gravity_gradient, magnetic
from sim.plant.environment.field import DirectDipole
from sim.plant.environment.orbit import CircularOrbit
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import (
    canonical,
    conjugate,
    cross,
    from_matrix,
    from_vector,
    matrix,
    multiply,
    transform,
)

RAAN_RAD = 0.7
STEP = 1e-30
"""Complex step: the derivative is exact to rounding, and nothing is left of the second order."""


def total(a, b):
    return tuple(one + other for one, other in zip(a, b, strict=True))


def difference(a, b):
    return tuple(one - other for one, other in zip(a, b, strict=True))


class NonlinearPlant:
    """The plant's own rigid body and torques, the law in the loop, in the states of the linearisation.

    A complex state goes through it too, as rigid body and torques only add and multiply.
    """

    def __init__(self, body, gains):
        self.body, self.gains, self.w0 = body, gains, body.rate_radps
        self.inertia = body.inertia_kgm2
        self.rigid = RigidBody(self.inertia, body.wheel_nms)
        self.orbit = CircularOrbit(
            OrbitConfig(
                altitude_m=1e3 * body.altitude_km,
                inclination_rad=np.radians(body.inclination_deg),
                raan_rad=RAAN_RAD,
            )
        )

    def place(self, u):
        """Surroundings at an argument of latitude, and the attitude of the orbital frame."""
        t_s = np.array([u / self.w0])
        r_m, v_mps = self.orbit.at(t_s)
        e = r_m[0] / np.linalg.norm(r_m[0])
        n = np.cross(r_m[0], v_mps[0])
        n /= np.linalg.norm(n)
        frame = tuple(map(tuple, np.array([e, np.cross(n, e), n]).tolist()))
        b_eci_t = DirectDipole().at(t_s, r_m)[0]
        around = Surroundings(tuple(e.tolist()), 3.0 * self.w0**2, tuple(b_eci_t.tolist()))
        return around, from_matrix(frame)

    def torque(self, q_orbit):
        """Gravity gradient and the law's torque, where the orbital frame has this attitude."""

        def of(q_body_from_eci, omega_body_radps, around):
            c, to_body = matrix(multiply(conjugate(q_orbit), q_body_from_eci)), matrix(q_body_from_eci)
            b_body_t = transform(to_body, around.b_eci_t)
            omega = difference(omega_body_radps, transform(c, (0.0, 0.0, self.w0)))
            m_body_am2 = pd_dipole(b_body_t, omega, attitude_error(c), self.gains.k_w, self.gains.k_a)
            e_body = transform(to_body, around.e_eci)
            gravity = gravity_gradient(self.inertia, e_body, around.gradient_ps2)
            return total(gravity, magnetic(m_body_am2, b_body_t))

        return TorqueFunction(of)

    def derivative(self, u, x):
        """dx/du at a complex state so small that only its first order counts."""
        around, q_orbit = self.place(u)
        rate, theta = tuple(self.w0 * x[:3]), x[3:]
        q_relative = (1.0, *(0.5 * theta))
        q = multiply(q_orbit, q_relative)
        frame_rate = transform(matrix(q_relative), (0.0, 0.0, self.w0))
        omega = total(rate, frame_rate)
        dq, domega = self.rigid.rates(Motion(q, omega), self.torque(q_orbit), around)
        d_rate = np.array(domega) + np.array(cross(omega, frame_rate))  # the frame's rate turns in body axes
        dq_orbit = multiply(q_orbit, (0.0, 0.0, 0.0, 0.5 * self.w0))
        d_relative = np.array(multiply(conjugate(dq_orbit), q)) + np.array(multiply(conjugate(q_orbit), dq))
        return np.concatenate([d_rate / self.w0, 2.0 * d_relative[1:]]) / self.w0


def loops():
    tensor = ((1.02, 0.11, -0.07), (0.11, 1.85, 0.05), (-0.07, 0.05, 2.35))
    skewed = Body("skewed", tensor, 731.0, 63.0, (0.004, -0.003, 0.007))
    yield skewed, Gains(6.0e6, 1200.0)
    for body in BODIES:
        moment = max(map(max, body.inertia_kgm2))
        scale = moment * body.rate_radps / body.field_t**2
        yield body, Gains(0.8 * scale, 0.3 * scale * body.rate_radps)


@pytest.mark.interpreted  # compiled, the rigid body takes no complex numbers
@pytest.mark.parametrize(("body", "gains"), list(loops()), ids=lambda it: getattr(it, "name", ""))
@pytest.mark.parametrize("u", [0.0, 0.4, 2.1, 5.5])
def test_it_is_the_derivative_of_the_plants_right_hand_side(body, gains, u):
    plant = NonlinearPlant(body, gains)
    columns = [plant.derivative(u, 1j * STEP * direction).imag / STEP for direction in np.eye(6)]
    ours = closed_loop(body, gains)(np.array([u]))[0]
    # Every row holds sums of terms as large as its largest: that is what rounding is relative to.
    sizes = np.abs(ours).max(axis=1, keepdims=True)
    assert (np.abs(np.array(columns).T - ours) / sizes).max() < 1e-9


def test_the_plants_right_hand_side_at_rest_is_the_resting_torque():
    (body, gains), *_ = loops()
    plant = NonlinearPlant(body, gains)
    acceleration = plant.derivative(1.3, np.zeros(6))[:3] * body.rate_radps**2
    assert np.asarray(body.inertia_kgm2) @ acceleration == pytest.approx(resting_torque(body), rel=1e-9)
    assert np.abs(resting_torque(body)).min() > 1e-9


def test_principal_axes_feel_no_resting_torque():
    assert all((resting_torque(body) == 0.0).all() for body in BODIES)


def test_without_control_it_is_the_equation_of_the_source():
    body = BODIES[2]
    a, b, c = (body.inertia_kgm2[i][i] for i in range(3))
    expected = np.zeros((6, 6))
    expected[0, [1, 0, 3]] = 1.0, 0.0, (b - c) / a
    expected[0, 1] += (b - c) / a
    expected[1, [0, 4]] = -1.0 + (c - a) / b, -4.0 * (c - a) / b
    expected[2, 5] = 3.0 * (a - b) / c
    expected[3:, :3] = np.eye(3)
    assert free_motion(body) == pytest.approx(expected, abs=1e-14)


def test_the_integral_is_of_theta_and_acts_through_the_field(skewed):
    gains = Gains(6.0e6, 1200.0, 0.3)
    u, w0, b0 = np.array([0.9]), skewed.rate_radps, skewed.field_t
    with_k_i, without = closed_loop(skewed, gains)(u)[0], closed_loop(skewed, gains._replace(k_i=None))(u)[0]
    assert (with_k_i[:6, :6] == without).all()
    assert (with_k_i[6:] == np.hstack([np.zeros((3, 3)), np.eye(3), np.zeros((3, 3))])).all()
    torque = -2.0 * 0.3 * b0**2 / w0**3 * projection(u, skewed)[0]
    assert with_k_i[:3, 6:] == pytest.approx(np.linalg.solve(skewed.inertia_kgm2, torque), rel=1e-12)


def test_the_projection_is_the_law_in_the_field():
    u, body = np.array([0.3, 4.0]), BODIES[0]
    cross_b = skew(dipole_field(u, body))
    assert projection(u, body) == pytest.approx(cross_b.swapaxes(-1, -2) @ cross_b, rel=1e-13)


def flown_degree(plant, deviation=1e-5, steps=600):
    """The degree of stability of the nonlinear motion: its state transition over an orbit, by differences."""
    step_s = 2.0 * pi / plant.w0 / steps
    places = [plant.place(pi * k / steps) for k in range(2 * steps + 1)]
    attitudes = {around.e_eci: q_orbit for around, q_orbit in places}

    def law(q_body_from_eci, omega_body_radps, around):
        return plant.torque(attitudes[around.e_eci]).at(q_body_from_eci, omega_body_radps, around)

    def fly(x):
        q_relative = from_vector(tuple(x[3:]))
        omega = total(plant.w0 * x[:3], transform(matrix(q_relative), (0.0, 0.0, plant.w0)))
        motion = Motion(multiply(places[0][1], q_relative), omega)
        for k in range(steps):
            around = [place[0] for place in places[2 * k : 2 * k + 3]]
            motion = plant.rigid.step(motion, TorqueFunction(law), step_s, *around)
        q_relative = canonical(multiply(conjugate(places[-1][1]), motion.q_body_from_eci))
        frame_rate = transform(matrix(q_relative), (0.0, 0.0, plant.w0))
        rate = difference(motion.omega_body_radps, frame_rate)
        return np.array([*(part / plant.w0 for part in rate), *(2.0 * part for part in q_relative[1:])])

    columns = [(fly(deviation * way) - fly(-deviation * way)) / (2.0 * deviation) for way in np.eye(6)]
    return float(degree_of_stability(np.array(columns).T))


@pytest.mark.long
@pytest.mark.parametrize(("k_w", "k_a"), [(3.0e6, 800.0), (4.0e6, 3200.0)], ids=["stable", "unstable"])
def test_the_exponents_are_those_of_the_nonlinear_plant(k_w, k_a):
    body = Body("50 kg", diagonal((1.02, 1.85, 1.95)), 800.0, 98.6)
    gains = Gains(k_w, k_a)
    expected = float(degree_of_stability(monodromy(closed_loop(body, gains))))
    assert flown_degree(NonlinearPlant(body, gains)) == pytest.approx(expected, abs=1e-3)


def test_gains_are_scaled_alike():
    assert Gains(2.0, 3.0, 4.0).scaled(1.5) == (3.0, 4.5, 6.0)
    assert Gains(2.0, 3.0).scaled(1.5) == (3.0, 4.5, None)


# --- The Gramian of an orbit: by its definition, regular on an inclined orbit, singular over the equator

FULL = Body("full", ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95)), 800.0, 98.6)


def test_it_is_what_dipoles_of_an_orbit_reach():
    """W' = F W + W F^T + P P^T from nothing, by an adaptive integrator."""
    inertia = np.array(FULL.inertia_kgm2) / (np.trace(FULL.inertia_kgm2) / 3.0)
    free = free_motion(FULL)

    def change(u, flat):
        reached, push = flat.reshape(6, 6), np.zeros((6, 3))
        push[:3] = -np.linalg.solve(inertia, skew(dipole_field(np.array(u), FULL)))
        return (free @ reached + reached @ free.T + push @ push.T).ravel()

    flown = solve_ivp(change, (0.0, 2.0 * np.pi), np.zeros(36), method="DOP853", rtol=1e-10, atol=1e-12)
    reached = flown.y[:, -1].reshape(6, 6)
    assert gramian(FULL) == pytest.approx(reached, rel=1e-4, abs=1e-5 * np.abs(reached).max())


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_on_an_inclined_orbit_every_motion_can_be_stopped(body):
    assert conditioning(body) > 1e-5


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_over_the_equator_pitch_cannot(body):
    """The dipole's field stands along the normal: no torque about it."""
    assert conditioning(replace(body, inclination_deg=0.0)) < 1e-12
