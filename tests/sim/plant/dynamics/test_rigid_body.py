"""The integrator against histories made by other software, and against what rigid bodies conserve."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque, TorqueFunction
from sim.plant.environment.orbit import MU_M3PS2
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, normalise

DIPOLE_TM3 = 7.812e15
ROW_S = 60


def two_body(r0_m, v0_mps, times):
    """Positions of Keplerian motion."""

    def rates(_, y):
        return [*y[3:], *(-MU_M3PS2 / np.linalg.norm(y[:3]) ** 3 * y[:3])]

    span = (0.0, times[-1])
    return solve_ivp(rates, span, [*r0_m, *v0_mps], "DOP853", times, rtol=1e-12, atol=1e-6).y[:3].T


def constant(torque_nm):
    return TorqueFunction(lambda q, omega, around: torque_nm)


@dataclass
class Case:
    """A body in its surroundings, and the history that is known of it."""

    inertia: tuple
    start: Motion
    dipole: tuple
    m_hat: list
    gravity: bool
    r0_m: list
    v0_mps: list
    q: np.ndarray
    omega: np.ndarray
    r_km: np.ndarray

    def around(self, step_s, rows):
        """Surroundings at every half step."""
        times = 0.5 * step_s * np.arange(round(rows * ROW_S / step_s) * 2 + 1)
        r = two_body(self.r0_m, self.v0_mps, times)
        r_norm = np.linalg.norm(r, axis=1)[:, None]
        e = r / r_norm
        b = DIPOLE_TM3 / r_norm**3 * (3.0 * (e @ self.m_hat)[:, None] * e - self.m_hat)
        gradient = self.gravity * 3.0 * MU_M3PS2 / r_norm[:, 0] ** 3
        rows = zip(e.tolist(), gradient.tolist(), b.tolist(), strict=True)
        return r, [Surroundings(tuple(e), g, tuple(b)) for e, g, b in rows]

    def fly(self, step_s, rows):
        """Attitudes and rates at the rows of the history."""
        body, motion = RigidBody(self.inertia), self.start
        _, around = self.around(step_s, rows)

        torque = BodyTorque(self.inertia, self.dipole)
        history = [motion]
        steps = round(ROW_S / step_s)
        for step in range(rows * steps):
            motion = body.step(motion, torque, step_s, *around[2 * step : 2 * step + 3])
            if (step + 1) % steps == 0:
                history.append(motion)
        return np.array([m.q_body_from_eci for m in history]), np.array([m.omega_body_radps for m in history])


@pytest.fixture(scope="module")
def load(reference):
    def load(name):
        data = reference(f"attitude_{name}.csv")
        magnetic = any(line.startswith("dipole m_body") for line in data.comments)
        return Case(
            inertia=tuple(map(tuple, np.reshape(data.header("J (kg m^2"), (3, 3)).tolist())),
            start=Motion(normalise(tuple(data.header("q0 (body<-"))), tuple(data.header("w0_rad_s"))),
            dipole=(0.06, -0.035, 0.09) if magnetic else ZERO,
            m_hat=[0.118771137369734, -0.07918075824649, -0.98975947808112],
            gravity=any("gravity gradient ON" in line for line in data.comments),
            r0_m=data.header("r0_m"),
            v0_mps=data.header("v0_m_s"),
            q=data.columns("q0", "q1", "q2", "q3"),
            omega=data.columns("omega_x_rad_s", "omega_y_rad_s", "omega_z_rad_s"),
            r_km=data.columns("r_eci_x_km", "r_eci_y_km", "r_eci_z_km"),
        )

    return load


CASES = ["a_torquefree", "b1_gravgrad", "b2_boom", "c_dipole", "d_offdiag"]


@pytest.mark.long
@pytest.mark.parametrize("name", CASES)
def test_three_orbits_in_steps_of_half_a_second(load, rotation_angle, name):
    case = load(name)
    q, omega = case.fly(0.5, len(case.q) - 1)
    assert rotation_angle(q, case.q).max() < 1e-7
    assert np.abs(omega - case.omega).max() < 1e-9


@pytest.mark.parametrize("name", CASES)
def test_a_short_flight_in_small_steps(load, rotation_angle, name):
    case, rows = load(name), 30
    q, omega = case.fly(0.1, rows)
    assert rotation_angle(q, case.q[: rows + 1]).max() < 1e-9
    assert np.abs(omega - case.omega[: rows + 1]).max() < 1e-11


def test_the_method_is_of_fourth_order(load, rotation_angle):
    case, rows = load("c_dipole"), 20
    coarse, fine = (
        rotation_angle(case.fly(step_s, rows)[0], case.q[: rows + 1])[-1] for step_s in (6.0, 3.0)
    )
    assert 12.0 < coarse / fine < 20.0


def test_the_positions_of_these_tests_are_those_of_the_history(load):
    case = load("c_dipole")
    r, _ = case.around(60.0, len(case.q) - 1)
    assert 1e-3 * r[::2] == pytest.approx(case.r_km, abs=1e-5)


def test_a_free_body_conserves_momentum_and_energy(load):
    case = load("d_offdiag")
    case.gravity = False
    q, omega = case.fly(0.5, 30)
    inertia = np.array(case.inertia)
    momentum = omega @ inertia
    w, v = q[:, :1], q[:, 1:]
    inertial = momentum + 2.0 * np.cross(v, w * momentum + np.cross(v, momentum))  # C^T h
    energy = 0.5 * (omega * momentum).sum(axis=1)
    assert np.linalg.norm(inertial - inertial[0], axis=1).max() < 1e-9 * np.linalg.norm(inertial[0])
    assert energy == pytest.approx(energy[0], rel=1e-9)
    assert np.linalg.norm(q, axis=1) == pytest.approx(1.0, abs=1e-15)


def test_a_constant_torque_about_a_principal_axis_spins_it_up():
    body = RigidBody(((2.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, 0.0, 5.0)))
    nowhere = Surroundings((1.0, 0.0, 0.0), 0.0, ZERO)
    motion = Motion((1.0, 0.0, 0.0, 0.0), ZERO)
    for _ in range(100):
        motion = body.step(motion, constant((0.0, 0.0, 0.02)), 0.1, nowhere, nowhere, nowhere)
    assert motion.omega_body_radps == pytest.approx((0.0, 0.0, 0.04))
    assert motion.q_body_from_eci == pytest.approx((np.cos(0.1), 0.0, 0.0, np.sin(0.1)))  # angle 0.2


def test_the_inverse_of_a_full_inertia_tensor():
    inertia = (
        (3.241557, -0.89669, -0.29707),
        (-0.89669, 3.116613, -0.135273),
        (-0.29707, -0.135273, 3.34183),
    )
    nowhere = Surroundings((1.0, 0.0, 0.0), 0.0, ZERO)
    torque = np.array([0.03, -0.01, 0.02])
    step_s = 1e-6
    motion = RigidBody(inertia).step(
        Motion((1.0, 0.0, 0.0, 0.0), ZERO), constant(tuple(torque)), step_s, nowhere, nowhere, nowhere
    )
    assert np.array(motion.omega_body_radps) / step_s == pytest.approx(np.linalg.solve(inertia, torque))
