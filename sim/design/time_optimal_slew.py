"""The slew of least time by coils, and how far its copy goes astray.

The dipoles of n equal steps of a time T that is free too, within the limits, are sought for

    T + penalties of theta(T) and Omega(T) -> min,

theta = 2 qv and Omega of the body against the orbital frame at the end. The penalties are taken so large that
the end is met. The equations stand over the fixed interval of s = t / T: d/ds is T d/dt, and T is one number
more. Gravity gradient and field are those of a circular orbit in the direct dipole.

For a T the plan with the least largest dipole is found by linear programmes, one after the other, each about
the course of the one before: min p with |m_i| <= p and the end met to first order. That p falls with T, about
as 1 / T^2, and where it is the limit of the coils, T is the least.

Source: Liang, Fullmer, Chen 2004, as in Ovchinnikov, Roldugin 2019, section 3.2, where the functional is
damaged: its terms are those that the text names. The search is this project's.
"""

from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from sim.design.theory.bodies import Body
from sim.design.theory.linear import dipole_field
from sim.value_types import Array

UNIT_RADPS = 1e-3
"""With which a rate counts as much as a radian."""
DIFFERENCE = 1e-4
"""Of the limit of the dipole, by which the slope is found."""
PROGRAMMES, TIMES = 40, 8
"""Most programmes of one time, most times."""
MET, SETTLED = 1e-4, 2e-3
"""Of the end, rad and units of rate; of the largest dipole."""
MOVED, LESS = 0.5, 0.88
"""How far the first programme may move a dipole, of the limit; each further one, of the one before."""
SLACK = 1e3
"""Price of an end that is not met, against the limit."""


class NoSlewError(Exception):
    """No plan meets the end."""


@dataclass(frozen=True, slots=True)
class Slew:
    """What is to be turned to the orbital frame.

    Attributes:
        body: inertia and orbit; the argument of latitude is ``u0_rad`` at the start.
        q0_body_from_orbit: attitude at the start, scalar first.
        omega0_radps: rate against the orbital frame then, body axes.
        most_am2: limit of each coil.
        steps: n.
        u0_rad: argument of latitude at the start.
    """

    body: Body
    q0_body_from_orbit: tuple[float, float, float, float]
    omega0_radps: tuple[float, float, float]
    most_am2: float
    steps: int = 20
    u0_rad: float = 0.0


class Plan(NamedTuple):
    """The time, the dipoles of its steps, (n, 3), and the error at its end."""

    seconds: float
    dipoles_am2: Array
    error_deg: float
    rate_radps: float


def ends(case: Slew, seconds: Array, dipoles_am2: Array) -> tuple[Array, Array]:
    """Quaternion and rate against the orbital frame at the end of each plan, (plans, 4) and (plans, 3).

    Args:
        case: what is turned.
        seconds: T of each plan, (plans,).
        dipoles_am2: body axes, (plans, n, 3).
    """
    q = np.tile(np.array(case.q0_body_from_orbit), (len(seconds), 1))
    w = np.tile(np.array(case.omega0_radps), (len(seconds), 1))
    h = seconds / case.steps
    for step in range(case.steps):
        m, t = dipoles_am2[:, step], step * h
        q1, w1 = _change(case, q, w, m, t)
        q2, w2 = _change(case, q + _by(0.5 * h, q1), w + _by(0.5 * h, w1), m, t + 0.5 * h)
        q3, w3 = _change(case, q + _by(0.5 * h, q2), w + _by(0.5 * h, w2), m, t + 0.5 * h)
        q4, w4 = _change(case, q + _by(h, q3), w + _by(h, w3), m, t + h)
        q = q + _by(h / 6.0, q1 + 2.0 * q2 + 2.0 * q3 + q4)
        w = w + _by(h / 6.0, w1 + 2.0 * w2 + 2.0 * w3 + w4)
    return q / np.linalg.norm(q, axis=1, keepdims=True), w


def _by(factor: Array, vectors: Array) -> Array:
    scaled: Array = factor[:, None] * vectors
    return scaled


def _change(case: Slew, q: Array, relative: Array, m: Array, t_s: Array) -> tuple[Array, Array]:
    """dq/dt and dOmega/dt of each plan."""
    inertia, w0 = np.array(case.body.inertia_kgm2), case.body.rate_radps
    b_orbit = case.body.field_t * dipole_field(case.u0_rad + w0 * t_s, case.body)
    e1, e3 = (_turned(q, np.tile(axis, (len(q), 1))) for axis in np.eye(3)[[0, 2]])
    omega = relative + w0 * e3
    torque = np.cross(m, _turned(q, b_orbit)) + 3.0 * w0**2 * np.cross(e1, e1 @ inertia)
    change = (torque - np.cross(omega, omega @ inertia)) @ np.linalg.inv(inertia)
    scalar, vector = q[:, :1], q[:, 1:]
    turned = np.hstack(
        [-np.sum(vector * relative, axis=1, keepdims=True), scalar * relative + np.cross(vector, relative)]
    )
    return 0.5 * turned, change + w0 * np.cross(relative, e3)


def _turned(q: Array, v: Array) -> Array:
    """Vectors of the orbital frame in body axes: C(q) v."""
    scalar, vector = q[:, :1], q[:, 1:]
    twice = 2.0 * np.cross(vector, v)
    turned: Array = v - scalar * twice + np.cross(vector, twice)
    return turned


def best(case: Slew, first_s: float) -> Plan:
    """The slew of least time.

    Args:
        case: what is turned.
        first_s: a time from which the search begins.

    Raises:
        NoSlewError: no plan meets the end, or no time is found for which its largest dipole is the limit.
    """
    seconds, dipoles = first_s, np.zeros((case.steps, 3))
    for _ in range(TIMES):
        dipoles = least_peak(case, seconds, dipoles)
        part = float(np.abs(dipoles).max()) / case.most_am2
        if abs(part - 1.0) <= SETTLED:
            return _plan(case, np.array([seconds]), dipoles[None])
        seconds, dipoles = seconds * sqrt(part), dipoles / part
    raise NoSlewError(f"no time of a slew found from {first_s:g} s")


def least_peak(case: Slew, seconds: float, dipoles_am2: Array) -> Array:
    """The plan of a time with the least largest dipole, (n, 3), from another plan.

    Raises:
        NoSlewError: no plan is found that meets the end.
    """
    count, by = 3 * case.steps, DIFFERENCE * case.most_am2
    m, before = dipoles_am2.ravel(), np.inf
    for programme in range(PROGRAMMES):
        around = np.vstack([m, m + by * np.eye(count)]).reshape(-1, case.steps, 3)
        found = _off(case, np.full(len(around), seconds), around)
        peak = float(np.abs(m).max())
        if np.abs(found[0]).max() <= MET and abs(peak - before) <= SETTLED * case.most_am2:
            return m.reshape(case.steps, 3)
        slope, reach = ((found[1:] - found[0]) / by).T, MOVED * LESS**programme
        m, before = _programme(case, m, found[0], slope, reach), peak
    raise NoSlewError(f"no plan of {seconds:g} s found that meets the end")


def _off(case: Slew, seconds: Array, dipoles_am2: Array) -> Array:
    """Theta and Omega at the end, rad and units of rate, (plans, 6)."""
    q, w = ends(case, seconds, dipoles_am2)
    return np.hstack([2.0 * np.where(q[:, :1] < 0.0, -q[:, 1:], q[:, 1:]), w / UNIT_RADPS])


def _programme(case: Slew, m: Array, off: Array, slope: Array, reach: float) -> Array:
    """The dipoles that meet the end to first order with the least largest one."""
    count, unit = len(m), case.most_am2
    cost = np.concatenate([np.zeros(count), [1.0], np.full(12, SLACK)])
    meets = np.hstack([slope * unit, np.zeros((6, 1)), np.eye(6), -np.eye(6)])
    within = np.hstack([np.vstack([np.eye(count), -np.eye(count)]), -np.ones((2 * count, 1))])
    found = linprog(
        cost,
        A_ub=np.hstack([within, np.zeros((2 * count, 12))]),
        b_ub=np.zeros(2 * count),
        A_eq=meets,
        b_eq=slope @ m - off,
        bounds=[*((part - reach, part + reach) for part in (m / unit).tolist()), *[(0.0, None)] * 13],
    )
    if found.x is None:
        raise NoSlewError(f"the dipoles of a step are not found: {found.message}")
    moved: Array = unit * found.x[:count]
    return moved


def flown(case: Slew, plan: Plan) -> Plan:
    """The end of a plan that was made for another case: the dipoles as they are, no look at the attitude."""
    return _plan(case, np.array([plan.seconds]), plan.dipoles_am2[None])


def _plan(case: Slew, seconds: Array, dipoles_am2: Array) -> Plan:
    q, w = ends(case, seconds, dipoles_am2)
    angle = np.degrees(2.0 * np.arcsin(min(1.0, float(np.linalg.norm(q[0, 1:])))))
    return Plan(float(seconds[0]), dipoles_am2[0], float(angle), float(np.linalg.norm(w[0])))
