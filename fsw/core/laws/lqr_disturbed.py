"""Periodic regulator with the disturbance modelled by periodic functions of the argument of latitude.

    d(u) = c0 + c1 cos u + c2 sin u + c3 cos 2u + c4 sin 2u,   c in orbital axes, 15 numbers

is known to the regulator as ``lqr`` knows a constant one: with P, M and Fc = F - G [b x] M of the periodic
problem, and Phi_k the matrix of d = Phi c in step k,

    S_k = Fc_k^T (S_k+1 + P_k+1 G Phi_k),   the same after an orbit,
    m_k = M_k x - (N^T P_k+1 N + effort E)^-1 N^T (P_k+1 G Phi_k + S_k+1) c,   N = -G [b x].

The numbers c are learned in flight: the change of rate beyond the expected, as a torque tau, is slowly added
to c, c0' = a tau, c1' = 2 a cos u tau and so on, a = learning / period. That is the steepest descent of the
mean square of tau, the functions being orthogonal over an orbit. The expected change includes the torque that
the filter estimates, and c0 has only what is beyond it.

Source: Lovera, de Marchi, Bittanti 2002, as in Ovchinnikov, Roldugin 2019, section 3.2. The review has no
equation; S is derived from the step of ``riccati``, and the learning in place of the source's observer.
"""

from dataclasses import dataclass
from math import cos, pi, sin
from typing import NamedTuple

import numpy as np

from fsw.core.algebra.quaternion import dcm, rotate
from fsw.core.algebra.vector import (
    Mat3,
    Vec3,
    add,
    cross,
    scale,
    sub,
    transform,
    transpose,
)
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    LqrGains,
    balanced_pd,
    dipole,
    exact_torque,
    latitude_argument,
    middles,
    node,
    orbit_problem,
    schedule,
    within,
)
from fsw.core.laws.motion import wheel_momentum
from fsw.core.laws.plan.riccati import Array, Problem, Schedule, pushes_of
from fsw.core.laws.predictive import free_rate_change
from fsw.core.orbit.ephemeris import Reference

FUNCTIONS = 5
LONGEST_S = 60.0
"""Between two estimates; after a longer gap nothing is learned from their difference."""


@dataclass(frozen=True, slots=True)
class DisturbedGains(LqrGains):
    """Weights as for ``lqr``, and how fast the disturbance is learned.

    Attributes:
        learning: share of an unknown torque that is learned in an orbit, as a rate, 1/orbit.
    """

    learning: float = 1.0

    def __post_init__(self) -> None:
        """Check what the equations need.

        Raises:
            ValueError: a weight or the learning out of range.
        """
        LqrGains.__post_init__(self)
        if not 0.0 <= self.learning <= 20.0:
            raise ValueError(f"learning must be 0 to 20, not {self.learning:g}")


class Learned(NamedTuple):
    """What is remembered: the tick, the rate and its expected change then, the dipole given, and c."""

    tick: float
    omega_body_radps: Vec3
    change_radps2: Vec3
    m_body_am2: Vec3
    torques_orbit_nm: tuple[float, ...]

    def memory(self) -> Memory:
        """25 numbers."""
        return (
            self.tick,
            *self.omega_body_radps,
            *self.change_radps2,
            *self.m_body_am2,
            *self.torques_orbit_nm,
        )


def functions(u_rad: float) -> tuple[float, ...]:
    """1, cos u, sin u, cos 2u, sin 2u."""
    return (1.0, cos(u_rad), sin(u_rad), cos(2.0 * u_rad), sin(2.0 * u_rad))


def disturbed_schedule(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    inclination_rad: float,
    field_t: float,
    gains: DisturbedGains,
) -> Schedule:
    """The regulator of ``lqr`` with 15 columns appended: gains (n, 3, 24) and costs (n, 6, 24)."""
    orbit = (inertia_kgm2, wheel_body_nms, orbit_rate_radps, inclination_rad, field_t)
    _, b_orbit_t = orbit_problem(*orbit, gains)
    plain = schedule(*orbit, gains)
    by_torque, coupling = _periodic_parts(plain.problem, b_orbit_t, plain)
    return Schedule(
        plain.problem,
        np.concatenate([plain.gains, by_torque], axis=2),
        np.concatenate([plain.costs, coupling], axis=2),
    )


def _periodic_parts(problem: Problem, b_orbit_t: Array, plain: Schedule) -> tuple[Array, Array]:
    """The gains of c, (n, 3, 15), and S at the beginning of each step, (n, 6, 15)."""
    f, g, pushes = problem.free[:, :6], problem.free[:, 6:], pushes_of(problem, b_orbit_t)
    shapes = np.array([np.kron(functions(u), np.eye(3)) for u in middles().tolist()])
    gains, couplings = np.empty((STEPS, 3, 3 * FUNCTIONS)), np.empty((STEPS, 6, 3 * FUNCTIONS))
    whole, last = np.eye(6), np.zeros((6, 3 * FUNCTIONS))
    for second in (False, True):
        if second:
            last = np.linalg.lstsq(np.eye(6) - whole, couplings[0], rcond=None)[0]
        ahead = last
        for k in range(STEPS - 1, -1, -1):
            cost, push = plain.costs[(k + 1) % STEPS, :, :6], pushes[k]
            closed = f + push @ plain.gains[k, :, :6]
            pulled = cost @ g @ shapes[k] + ahead
            curvature = push.T @ cost @ push + problem.effort * np.eye(3)
            gains[k] = -np.linalg.solve(curvature, push.T @ pulled)
            ahead = closed.T @ pulled
            couplings[k] = ahead
            whole = whole if second else closed.T @ whole
    return gains, couplings


def lqr_disturbed(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The gain of (Omega, theta, d, c); c is learned and remembered."""
    table, reference = config.schedules.get("lqr_disturbed"), inputs.reference
    if not inputs.attitude.usable or reference is None or table is None:
        return Demand(memory=memory)
    gains: DisturbedGains = config.gains["lqr_disturbed"]
    u_rad = latitude_argument(reference)
    known = exact_torque(inputs, reference, table, config)
    torques = _learn(inputs, _recalled(memory), u_rad, gains.learning, reference, config)
    gain = table.gains[node(u_rad)]
    given = dipole(gain[:, :9].ravel().tolist(), inputs.attitude, known)
    more = (gain[:, 9:] @ np.array(torques)).tolist()
    m = within(
        add(given, rotate(inputs.attitude.q_body_from_orbit, (more[0], more[1], more[2]))),
        config.mean_dipole_am2,
    )
    now = Learned(
        float(inputs.tick),
        inputs.attitude.omega_body_orbit_radps,
        _expected_change(inputs, m, u_rad, torques, reference, config),
        m,
        torques,
    )
    return Demand(m, memory=now.memory())


def _recalled(memory: Memory) -> Learned | None:
    """What the memory holds; None where it is empty or another law's."""
    if len(memory) != 10 + 3 * FUNCTIONS:
        return None
    t, w1, w2, w3, r1, r2, r3, m1, m2, m3, *torques = memory
    return Learned(t, (w1, w2, w3), (r1, r2, r3), (m1, m2, m3), tuple(torques))


def _learn(
    inputs: LawInput,
    before: Learned | None,
    u_rad: float,
    learning: float,
    reference: Reference,
    config: ControlConfig,
) -> tuple[float, ...]:
    """The c of this tick."""
    if before is None:
        return (0.0,) * (3 * FUNCTIONS)
    torques, seconds = before.torques_orbit_nm, (inputs.tick - before.tick) * config.tick_s
    if not 0.0 < seconds <= LONGEST_S:
        return torques
    now = _expected_change(inputs, before.m_body_am2, u_rad, torques, reference, config)
    expected = scale(0.5 * seconds, add(before.change_radps2, now))
    beyond = sub(sub(inputs.attitude.omega_body_orbit_radps, before.omega_body_radps), expected)
    impulse_nms = transform(
        transpose(dcm(inputs.attitude.q_body_from_orbit)), transform(config.inertia_kgm2, beyond)
    )
    share = learning * reference.orbit_rate_radps / (2.0 * pi)
    taken = [share * value * (2.0 if k else 1.0) for k, value in enumerate(functions(u_rad))]
    return tuple(torque + taken[k // 3] * impulse_nms[k % 3] for k, torque in enumerate(torques))


def _expected_change(
    inputs: LawInput,
    m_body_am2: Vec3,
    u_rad: float,
    torques: tuple[float, ...],
    reference: Reference,
    config: ControlConfig,
) -> Vec3:
    """The change of Omega under a dipole and all known torques, body axes, rad/s^2."""
    attitude = inputs.attitude
    free = free_rate_change(
        attitude.omega_body_orbit_radps,
        dcm(attitude.q_body_from_orbit),
        reference.orbit_rate_radps,
        reference.radius_m,
        config.inertia_kgm2,
        config.inertia_inverse,
        wheel_momentum(inputs, config),
    )
    shape = functions(u_rad)
    c1, c2, c3 = (sum((shape[k] * torques[3 * k + axis] for k in range(FUNCTIONS)), 0.0) for axis in range(3))
    learned = rotate(attitude.q_body_from_orbit, (c1, c2, c3))
    torque = add(add(cross(m_body_am2, inputs.b_body_t), inputs.torque_body_nm), learned)
    return add(free, transform(config.inertia_inverse, torque))


LAWS = {
    "lqr_disturbed": LawEntry(45, Aim.THREE_AXIS, balanced_pd, lqr_disturbed, DisturbedGains),
}
