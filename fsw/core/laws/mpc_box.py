"""Predictive control within the coils' limits: a quadratic programme over the dipoles of the coming steps.

The steps x+ = F x + G d + N m of ``riccati``, N = -G [B x] C^T with m in body axes, C as it is now, are
substituted one into the next, so that states and cost depend on the dipoles alone:

    min sum_k |theta_k|^2 + rate |Omega_k / w0|^2 + effort |m_k|^2 + x_n^T (P x_n + 2 S d),   |m_i| <= m_max,

P and S the terminal cost, that of the periodic regulator. The first dipole is given for a step; then the
programme is solved anew. While no limit is reached it is ``mpc``; where one is, ``mpc`` scales its dipole
down and loses what this law gives with the other coils and later.

Source: Krogstad, Gravdahl, Tondel 2005; Wood, Chen, Fertin 2006, as in Ovchinnikov, Roldugin 2019,
section 3.3.
"""

from dataclasses import dataclass

import numpy as np

from fsw.core.algebra.quaternion import dcm
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    balanced_pd,
    check_weights,
    expected_torque,
    latitude_argument,
    node,
    orbital_state,
)
from fsw.core.laws.plan.box import box_minimum
from fsw.core.laws.plan.orbit_ahead import check_horizon, orbit_ahead
from fsw.core.laws.plan.riccati import Array, Schedule, pushes_of


@dataclass(frozen=True, slots=True)
class BoxGains:
    """Weights as for ``lqr``, and how far the programme reaches, in orbits."""

    rate: float = 0.0
    effort: float = 0.05
    horizon_orbits: float = 0.5

    def __post_init__(self) -> None:
        """Check what the equations need, and that a programme is soon solved.

        Raises:
            ValueError: a weight or the horizon out of range.
        """
        check_weights(self.rate, self.effort)
        check_horizon(self.horizon_orbits, 0.03, 1.0)


def programme(
    table: Schedule, b_orbit_t: Array, c: Array, state: Array, end_node: int
) -> tuple[Array, Array]:
    """H and g of the programme over the dipoles of all steps, body axes, shapes (3n, 3n) and (3n,).

    Args:
        table: the periodic regulator.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).
        c: attitude, body from orbit.
        state: (Omega, theta, d), orbital axes.
        end_node: step of the table in which the programme ends.
    """
    problem, last = table.problem, table.costs[end_node]
    steps, f, drift = len(b_orbit_t), problem.free[:, :6], problem.free[:, 6:] @ state[6:]
    pushes = pushes_of(problem, b_orbit_t) @ c.T
    h, g = problem.effort * np.eye(3 * steps), np.zeros(3 * steps)
    reach, moved = np.zeros((6, 3 * steps)), state[:6]
    for k in range(steps):
        reach = f @ reach
        reach[:, 3 * k : 3 * k + 3] = pushes[k]
        moved = f @ moved + drift
        if k + 1 < steps:
            cost, slope = np.diag(problem.cost), problem.cost * moved
        else:
            cost, slope = last[:, :6], last @ np.concatenate([moved, state[6:]])
        h += reach.T @ cost @ reach
        g += reach.T @ slope
    return h, g


def mpc_box(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The first dipole of the programme; it is remembered with the tick of its start and given for a step."""
    table, reference, model = config.schedules.get("mpc_box"), inputs.reference, inputs.ephemeris
    if not inputs.attitude.usable or reference is None or model is None or table is None:
        return Demand(memory=memory)
    step_s = table.problem.step_s
    if len(memory) == 4 and 0.0 <= (inputs.tick - memory[0]) * config.tick_s < step_s:
        return Demand((memory[1], memory[2], memory[3]), memory=memory)
    steps = round(config.gains["mpc_box"].horizon_orbits * STEPS)
    unix_s = model.epoch_unix_s + inputs.tick * config.tick_s
    ahead = orbit_ahead(model, [unix_s + (k + 0.5) * step_s for k in range(steps)])
    if ahead is None:
        return Demand()
    c = np.array(dcm(inputs.attitude.q_body_from_orbit))
    state = np.array(orbital_state(inputs.attitude, expected_torque(inputs, table)))
    end = (node(latitude_argument(reference)) + steps) % STEPS
    h, g = programme(table, ahead.b_orbit_t, c, state, end)
    if not np.any(ahead.b_orbit_t):
        return Demand()
    m1, m2, m3 = box_minimum(h, g, config.mean_dipole_am2)[:3].tolist()
    return Demand((m1, m2, m3), memory=(float(inputs.tick), m1, m2, m3))


LAWS = {
    "mpc_box": LawEntry(160, Aim.THREE_AXIS, balanced_pd, mpc_box, BoxGains),
}
