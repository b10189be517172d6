"""A torque shared between coils and thrusters with the least propellant.

Thrusters give torques t_k d_k, 0 <= t_k <= 1 the part of the time for which they fire; coils give m x b:

    min sum of t_k    under    m x b + sum of t_k d_k = M_ref,   |m_i| <= m_max,   0 <= t_k <= 1,

a linear programme. It has no solution where the torque along b, which coils cannot give, is more than the
thrusters can, or where what they give beside it is more than the coils can take back.

Source: Pulecchi, Lovera 2007, as in Ovchinnikov, Roldugin 2019, section 2.4, which has no equation and says
that the sharing of a torque is near to optimisation under limits; the programme is derived here.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from fsw.core.laws.plan.riccati import Array, skews
from sim.design.theory.bodies import Body


class Shared(NamedTuple):
    """Dipole, A m^2, body axes, and the parts of the time for which the thrusters fire."""

    m_body_am2: Array
    parts: Array


def pairs(torque_nm: float, axes: tuple[int, ...]) -> Array:
    """The torques d_k of a pair of thrusters to either side about each of some body axes, (2 n, 3)."""
    rows = np.eye(3)[list(axes)]
    both: Array = torque_nm * np.vstack([rows, -rows])
    return both


def share(torque_body_nm: Array, b_body_t: Array, thrusters_nm: Array, most_am2: float) -> Shared | None:
    """The sharing with the least propellant; None where the torque cannot be given.

    Args:
        torque_body_nm: M_ref, (3,).
        b_body_t: field, (3,).
        thrusters_nm: d_k, (n, 3), body axes.
        most_am2: limit of each coil; 0: no coils.
    """
    size = float(np.linalg.norm(torque_body_nm))
    if size == 0.0:
        return Shared(np.zeros(3), np.zeros(len(thrusters_nm)))
    unit = most_am2 or 1.0
    across = -skews(b_body_t) * unit if most_am2 else np.zeros((3, 3))
    count = len(thrusters_nm)
    found = linprog(
        np.concatenate([np.zeros(3), np.ones(count)]),
        A_eq=np.hstack([across, thrusters_nm.T]) / size,
        b_eq=torque_body_nm / size,
        bounds=[(-1.0, 1.0)] * 3 + [(0.0, 1.0)] * count,
    )
    if found.x is None or found.status != 0:
        return None
    return Shared(unit * found.x[:3] if most_am2 else np.zeros(3), found.x[3:])


class Demands(NamedTuple):
    """Torques and fields of as many moments, body axes, (n, 3) each."""

    torques_nm: Array
    fields_t: Array


def demands(body: Body, torque_nm: float, count: int, seed: int) -> Demands:
    """Torques of one size to all sides, at places all over the orbit, body in its nominal attitude."""
    random = np.random.default_rng(seed)
    sides, u = random.standard_normal((count, 3)), random.uniform(0.0, 2.0 * np.pi, count)
    across, along = np.sin(np.radians(body.inclination_deg)), np.cos(np.radians(body.inclination_deg))
    fields = np.stack([-2.0 * across * np.sin(u), across * np.cos(u), np.full(count, along)], axis=1)
    return Demands(torque_nm * sides / np.linalg.norm(sides, axis=1, keepdims=True), body.field_t * fields)


def given(wanted: Demands, thrusters_nm: Array, most_am2: float) -> float:
    """The share of the demands that can be met."""
    met = [share(*one, thrusters_nm, most_am2) is not None for one in zip(*wanted, strict=True)]
    return float(np.mean(met))


def propellant(wanted: Demands, thrusters_nm: Array, most_am2: float) -> float:
    """The mean of the sum of t_k over the demands that can be met; not a number where none can."""
    parts = [share(*one, thrusters_nm, most_am2) for one in zip(*wanted, strict=True)]
    return float(np.mean([float(np.sum(one.parts)) for one in parts if one is not None] or [np.nan]))
