"""State-dependent Riccati equation: the regulator of the motion as it is at this attitude and rate.

With q = (q0, qv) body from orbit, theta = 2 qv, Omega in body axes, an axis e of the orbital frame has the
body components e_b = e + D_e qv, D_e = 2 (q0 E - [qv x]) [e x]. So the motion is, without approximation,

    J dOmega/dt = J A_w Omega + J A_q qv + m x b + d,    dtheta/dt = (q0 E + [qv x]) Omega,
    J A_w = [(J omega + h) x] - w0 [e3b x] J - w0 J [e3b x],    omega = Omega + w0 e3b,
    J A_q = 3 w0^2 ([e1 x] J - [J e1b x]) D_1 - w0^2 ([e3 x] J - [J e3b x]) D_3 + w0 [h x] D_3,

d including the torque on the nominal attitude. The Riccati equation is solved along the field of half an
orbit ahead for the present A and attitude; the motion that its gains give yields A and the field in body axes
of each step, for which it is solved again, and so on. The terminal cost is that of ``lqr``. The first steps
are applied by feedback. About the nominal attitude it is ``mpc``. The factors A are not unique; these take
the present rate in each product.

Source: Rodriguez-Vazquez, Martin-Prats, Bernelli-Zazzera 2012 (ASRE), as in Ovchinnikov, Roldugin 2019,
section 3.2. The review has no equation: the factors are derived here from the rigid body's.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt, tau

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, canonical, dcm
from fsw.core.algebra.vector import Mat3, Vec3, cross, skew
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    LqrGains,
    exact_torque,
    latitude_argument,
    node,
    within,
)
from fsw.core.laws.motion import wheel_momentum
from fsw.core.laws.plan.orbit_ahead import orbit_ahead
from fsw.core.laws.plan.riccati import E1, E3, Array, Problem, Schedule, backward, stepped

SEQUENCE = 3
"""Number of solutions, each along the motion of the one before."""
HORIZON_STEPS = STEPS // 2
"""Half an orbit."""
APPLIED_STEPS = 2
"""Steps of the solution that are applied."""
_NUMBERS = 3 * 9


@dataclass(frozen=True, slots=True)
class SdreGains(LqrGains):
    """Weights of rate and dipole against that of attitude, as for ``lqr``."""


def factors(
    q_body_from_orbit: Quaternion,
    omega_body_orbit_radps: Vec3,
    orbit_rate_radps: float,
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
) -> Array:
    """A of d(Omega, theta)/dt = A (Omega, theta, d), body axes, shape (6, 9).

    Args:
        q_body_from_orbit: attitude; the one of q and -q with q0 >= 0 is taken.
        omega_body_orbit_radps: Omega, body axes.
        orbit_rate_radps: w0.
        inertia_kgm2: J, body axes.
        wheel_body_nms: h, body axes.
    """
    q0, *vector = canonical(q_body_from_orbit)
    j, h, w0, unit = np.array(inertia_kgm2), np.array(wheel_body_nms), orbit_rate_radps, np.eye(3)
    turned = 2.0 * (q0 * unit - _skew(vector))
    d1, d3 = turned @ _skew(E1), turned @ _skew(E3)
    e1b, e3b = np.array(E1) + d1 @ vector, np.array(E3) + d3 @ vector
    omega = np.array(omega_body_orbit_radps) + w0 * e3b
    by_rate = _skew(j @ omega + h) - w0 * _skew(e3b) @ j
    gravity = 3.0 * w0**2 * (_skew(E1) @ j - _skew(j @ e1b)) @ d1
    turning = -(w0**2) * (_skew(E3) @ j - _skew(j @ e3b)) @ d3 + w0 * _skew(h) @ d3
    whole = np.zeros((6, 9))
    whole[:3] = np.linalg.solve(j, np.hstack([by_rate, 0.5 * (gravity + turning), unit]))
    whole[:3, :3] -= w0 * _skew(e3b)
    whole[3:, :3] = q0 * unit + _skew(vector)
    return whole


def _skew(v: object) -> Array:
    x, y, z = np.asarray(v, dtype=np.float64).tolist()
    return np.array(skew((x, y, z)))


def solution(
    table: Schedule,
    start: Array,
    torque_nm: Vec3,
    b_orbit_t: Array,
    end_node: int,
    orbit_rate_radps: float,
    config: ControlConfig,
) -> Array | None:
    """Gains of the first steps, from (Omega, theta, d) to the dipole, body axes, (APPLIED_STEPS, 3, 9).

    None where there is no solution: the body turns around within a step, for which A is held, or the motion,
    which begins under gains for another, diverges.

    Args:
        table: the periodic regulator, whose cost is the terminal cost.
        start: present (Omega, theta), body axes.
        torque_nm: d, body axes.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (steps, 3).
        end_node: step of the table in which the solution ends.
        orbit_rate_radps: w0.
        config: the body and the bound of the dipole.
    """
    if float(np.linalg.norm(start[:3])) * table.problem.step_s > tau:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        gains, last = _sequence(table, start, torque_nm, b_orbit_t, end_node, orbit_rate_radps, config)
    return gains[:APPLIED_STEPS] if np.isfinite(last).all() else None


def _sequence(
    table: Schedule,
    start: Array,
    torque_nm: Vec3,
    b_orbit_t: Array,
    end_node: int,
    orbit_rate_radps: float,
    config: ControlConfig,
) -> tuple[Array, Array]:
    """The gains of all steps, and the last state of the motion under them; not finite: no solution."""
    states = [start] * (len(b_orbit_t) + 1)
    gains = np.empty((len(b_orbit_t), 3, 9))
    for _ in range(SEQUENCE):
        attitudes = [_attitude(state) for state in states]
        three = np.kron(np.eye(3), np.array(dcm(attitudes[-1])))
        ahead = three[:6, :6] @ table.costs[end_node] @ three.T
        problems = []
        for q, state in zip(attitudes[:-1], states[:-1], strict=True):
            w1, w2, w3 = state[:3].tolist()
            motion = factors(q, (w1, w2, w3), orbit_rate_radps, config.inertia_kgm2, config.wheel_body_nms)
            problems.append(replace(table.problem, free=stepped(motion, table.problem.step_s)))
        fields = np.array([dcm(q) for q in attitudes[:-1]]) @ b_orbit_t[:, :, None]
        for k in range(len(problems) - 1, -1, -1):
            try:
                first, costs = backward(problems[k], fields[k].T, ahead)
            except np.linalg.LinAlgError:
                return gains, np.full(6, np.nan)
            gains[k], ahead = first[0], costs[0]
        states = _course(problems, fields, gains, start, torque_nm, config.mean_dipole_am2)
    return gains, states[-1]


def _course(
    problems: Sequence[Problem], fields: Array, gains: Array, start: Array, torque_nm: Vec3, most_am2: float
) -> list[Array]:
    """The states at the beginning of each step and at the end of the last, under these gains."""
    states = [start]
    for problem, b, gain in zip(problems, fields[:, :, 0], gains, strict=True):
        known = np.concatenate([states[-1], torque_nm])
        m1, m2, m3 = (gain @ known).tolist()
        b1, b2, b3 = b.tolist()
        known[6:] += cross(within((m1, m2, m3), most_am2), (b1, b2, b3))
        states.append(problem.free @ known)
    return states


def _attitude(state: Array) -> Quaternion:
    """The quaternion of theta = 2 qv; for a theta beyond half a turn, that of half a turn."""
    vector = 0.5 * state[3:]
    size = float(np.sqrt(vector @ vector))
    q1, q2, q3 = (vector / max(1.0, size)).tolist()
    return (sqrt(max(0.0, 1.0 - min(1.0, size) ** 2)), q1, q2, q3)


def sdre(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The step of the solution in memory (tick of its start, its gains); a new one where it has ended."""
    table, reference, model = config.schedules.get("sdre"), inputs.reference, inputs.ephemeris
    if not inputs.attitude.usable or reference is None or model is None or table is None:
        return Demand()
    attitude, step_s = inputs.attitude, table.problem.step_s
    _, q1, q2, q3 = canonical(attitude.q_body_from_orbit)
    torque = exact_torque(inputs, reference, table, config)
    state = np.array((*attitude.omega_body_orbit_radps, 2.0 * q1, 2.0 * q2, 2.0 * q3, *torque))
    step = _step(memory, inputs.tick, config.tick_s / step_s)
    if step is None:
        unix_s = model.epoch_unix_s + inputs.tick * config.tick_s
        ahead = orbit_ahead(model, [unix_s + (k + 0.5) * step_s for k in range(HORIZON_STEPS)])
        if ahead is None:
            return Demand()
        end = (node(latitude_argument(reference)) + HORIZON_STEPS) % STEPS
        body = replace(config, wheel_body_nms=wheel_momentum(inputs, config))
        gains = solution(table, state[:6], torque, ahead.b_orbit_t, end, reference.orbit_rate_radps, body)
        if gains is None:
            return Demand()
        memory, step = (float(inputs.tick), *gains.ravel().tolist()), 0
    gain = np.array(memory[1 + step * _NUMBERS : 1 + (step + 1) * _NUMBERS]).reshape(3, 9)
    m1, m2, m3 = (gain @ state).tolist()
    return Demand(within((m1, m2, m3), config.mean_dipole_am2), memory=memory)


def _step(memory: Memory, tick: int, steps_per_tick: float) -> int | None:
    """The step of the solution in memory that this tick belongs to; None where there is none."""
    if len(memory) != 1 + APPLIED_STEPS * _NUMBERS or tick < memory[0]:
        return None
    step = int((tick - memory[0]) * steps_per_tick)
    return step if step < APPLIED_STEPS else None


LAWS = {
    "sdre": LawEntry(46, Aim.THREE_AXIS, sdre, sdre, SdreGains),
}
