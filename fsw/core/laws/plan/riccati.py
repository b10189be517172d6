"""The linear-quadratic problem of a dipole in a given field, solved backwards in time.

About the nominal attitude (body = orbit), with Omega the rate relative to the orbital frame, theta the small
rotation vector and d a constant torque, all in orbital axes, x = (Omega, theta):

    dOmega/dt = J^-1 { (w0 [J e3 x] - w0 [e3 x] J + [h x]) (Omega + w0 e3 x theta)
                       + 3 w0^2 ([e1 x] J - [J e1 x]) (e1 x theta) + m x b + d } - w0 e3 x Omega
    dtheta/dt = Omega

h is the momentum of a wheel. The dipole m is held over a step, and b is taken at the middle of it:
x+ = F x + G (d - [b x] m). The cost is the sum over the steps of

    rate |Omega / w0|^2 + |theta|^2 + effort |m B0 / (w0^2 J_mean)|^2

B0 the field above the equator. The torque d is given and not controlled: the optimal cost is
x^T P x + 2 x^T S d + ..., the optimal dipole m = M (x, d). P and S are stored as one matrix (P S), 6 x 9.

Source: Ovchinnikov, Roldugin 2019, section 3.2 (after Wisniewski 1996); damaged in the scan, derived anew.
The joining of steps in pairs and the doubling: Chu, Fan, Lin, Wang 2004 (periodic Riccati equations).
"""

from dataclasses import dataclass, field
from math import frexp

import numpy as np
from numpy.typing import NDArray

from fsw.core.algebra.vector import Mat3, Vec3, add, cross, scale, skew, sub, transform

Array = NDArray[np.float64]
E1: Vec3 = (1.0, 0.0, 0.0)
E3: Vec3 = (0.0, 0.0, 1.0)
DOUBLINGS = 8
"""The periodic solution is reached from 2^8 orbits ahead."""
SETTLED = 1e-6
"""Largest relative change over an orbit."""
TAYLOR, SHORT_RAD = 14, 1.0
"""Terms of the exponential of a step, and by how much a rate may turn in it at most."""


class NotHeldError(Exception):
    """The problem has no periodic solution that is stable."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Steps of equal length with one cost, ready to be solved for any field.

    Attributes:
        step_s: length of a step.
        free: (F G), shape (6, 9).
        cost: of the state, diagonal, shape (6,).
        effort: cost of |m|^2, per (A m^2)^2.
        resting_nm: torque on the nominal attitude, body axes.
    """

    step_s: float
    free: Array
    cost: Array
    effort: float
    resting_nm: Vec3


@dataclass(frozen=True, slots=True)
class Schedule:
    """A periodic solution: M and (P S) of each step of an orbit, shapes (n, 3, 9) and (n, 6, 9).

    ``observer``, (n, 6, 6): Sigma / (v^2 step) of a law with its own estimate (``field_only``), or empty.
    """

    problem: Problem
    gains: Array
    costs: Array
    observer: Array = field(default_factory=lambda: np.empty((0, 6, 6)))


def regulator_problem(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    field_t: float,
    step_s: float,
    rate: float,
    effort: float,
) -> Problem:
    """The problem of a body on a circular orbit.

    Args:
        inertia_kgm2: J, body axes.
        wheel_body_nms: h, body axes.
        orbit_rate_radps: w0.
        field_t: B0.
        step_s: length of a step.
        rate: weight of a rate of w0, against that of a radian.
        effort: weight of the dipole that accelerates the mean moment by w0^2, against that of a radian.
    """
    dipole_am2 = orbit_rate_radps**2 * float(np.trace(np.array(inertia_kgm2))) / 3.0 / field_t
    return Problem(
        step_s=step_s,
        free=free_step(inertia_kgm2, wheel_body_nms, orbit_rate_radps, step_s),
        cost=np.repeat([rate / orbit_rate_radps**2, 1.0], 3),
        effort=effort / dipole_am2**2,
        resting_nm=resting_torque(inertia_kgm2, wheel_body_nms, orbit_rate_radps),
    )


def free_step(inertia_kgm2: Mat3, wheel_body_nms: Vec3, orbit_rate_radps: float, step_s: float) -> Array:
    """(F G), 6 x 9: the state after a step, from the state before and a constant torque."""
    j, w0 = np.array(inertia_kgm2), orbit_rate_radps
    e1, e3 = np.array(skew(E1)), np.array(skew(E3))
    gyroscopic = w0 * (skews(j[:, 2]) - e3 @ j) + np.array(skew(wheel_body_nms))
    gravity = 3.0 * w0**2 * (e1 @ j - skews(j[:, 0])) @ e1
    motion = np.zeros((6, 9))
    motion[:3] = np.linalg.solve(j, np.hstack([gyroscopic, w0 * gyroscopic @ e3 + gravity, np.eye(3)]))
    motion[:3, :3] -= w0 * e3
    motion[3:, :3] = np.eye(3)
    return stepped(motion, step_s)


def stepped(motion: Array, step_s: float) -> Array:
    """(F G), 6 x 9, of a constant A over a step, from d(Omega, theta)/dt = A (Omega, theta, d), 6 x 9.

    Where a rate turns by more than ``SHORT_RAD``, as beside the momentum of a wheel, the series is that of a
    half, a quarter, ... of the step, and is squared.
    """
    change = np.vstack([motion, np.zeros((3, 9))])
    turn_rad = step_s * float(np.abs(motion[:3, :3]).sum(axis=1).max())
    halvings = max(0, frexp(turn_rad / SHORT_RAD)[1])
    short_s = step_s / 2.0**halvings
    term = whole = np.eye(9)
    for power in range(1, TAYLOR):
        term = term @ change * (short_s / power)
        whole = whole + term
    for _ in range(halvings):
        whole = whole @ whole
    return np.asarray(whole[:6], dtype=np.float64)


def resting_torque(inertia_kgm2: Mat3, wheel_body_nms: Vec3, orbit_rate_radps: float) -> Vec3:
    """Torque on the nominal attitude, 3 w0^2 e1 x J e1 - w0 e3 x (w0 J e3 + h), body axes, N m."""
    gravity = scale(3.0 * orbit_rate_radps**2, cross(E1, transform(inertia_kgm2, E1)))
    momentum = add(scale(orbit_rate_radps, transform(inertia_kgm2, E3)), wheel_body_nms)
    return sub(gravity, scale(orbit_rate_radps, cross(E3, momentum)))


def backward(problem: Problem, b_orbit_t: Array, last: Array) -> tuple[Array, Array]:
    """Solve from the last step to the first.

    Args:
        problem: the problem.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).
        last: (P S) at the end of the last step, shape (6, 9).

    Returns:
        M of each step, (n, 3, 9), and (P S) at the beginning of each, (n, 6, 9).
    """
    gains, costs = np.empty((len(b_orbit_t), 3, 9)), np.empty((len(b_orbit_t), 6, 9))
    pushes = pushes_of(problem, b_orbit_t)
    f, ahead = problem.free[:, :6], last
    for k in range(len(b_orbit_t) - 1, -1, -1):
        push = pushes[k]
        reached = ahead[:, :6] @ problem.free
        reached[:, 6:] += ahead[:, 6:]
        pushed = ahead[:, :6] @ push
        gain = -np.linalg.solve(push.T @ pushed + problem.effort * np.eye(3), push.T @ reached)
        ahead = f.T @ (reached + pushed @ gain)
        ahead[:, :6] += np.diag(problem.cost)
        gains[k], costs[k] = gain, ahead
    return gains, costs


def periodic(problem: Problem, b_orbit_t: Array) -> tuple[Array, Array]:
    """Solve for an orbit whose field repeats.

    The steps are joined into one step per orbit, x+ = A x - G p+, p = H x + A^T p+ (p half the slope of the
    cost), and that step is doubled.

    Args:
        problem: the problem.
        b_orbit_t: as for ``backward``, over one orbit.

    Returns:
        As ``backward``.

    Raises:
        NotHeldError: no periodic dipole holds the attitude.
    """
    f, pushes = problem.free[:, :6], pushes_of(problem, b_orbit_t)
    try:
        with np.errstate(all="ignore"):
            reach = pushes @ pushes.swapaxes(-1, -2) / problem.effort
            last = np.hstack([orbit_cost(problem, reach), np.zeros((6, 3))])
            gains, costs = backward(problem, b_orbit_t, last)
            closed = np.eye(6)
            for push, gain in zip(pushes, gains, strict=True):
                closed = (f + push @ gain[:, :6]) @ closed
            last[:, 6:] = np.linalg.solve(np.eye(6) - closed.T, costs[0, :, 6:])
            gains, costs = backward(problem, b_orbit_t, last)
            change = np.abs(costs[0] - last).max(axis=0)
            settled = bool(np.all(change <= SETTLED * np.abs(last).max(axis=0)))
    except np.linalg.LinAlgError:
        settled = False
    if not settled:
        raise NotHeldError("no periodic dipole holds this body on this orbit")
    return gains, costs


def orbit_cost(problem: Problem, reach: Array) -> Array:
    """P at the beginning of the first of many orbits, (6, 6).

    Args:
        problem: the problem.
        reach: G of each step, the pushes squared over their effort, shape (n, 6, 6).
    """
    shape = reach.shape
    parts: tuple[Array, ...] = (
        np.broadcast_to(problem.free[:, :6], shape),
        reach,
        np.broadcast_to(np.diag(problem.cost), shape),
    )
    while (count := len(parts[0])) > 1:
        even = count - count % 2
        joined = _joined(*(tuple(part[first:even:2] for part in parts) for first in (0, 1)))
        parts = tuple(np.concatenate([new, part[even:]]) for new, part in zip(joined, parts, strict=True))
    for _ in range(DOUBLINGS):
        parts = _joined(parts, parts)
    cost: Array = parts[2][0]
    return cost


def _joined(first: tuple[Array, ...], second: tuple[Array, ...]) -> tuple[Array, ...]:
    """Two steps, one after the other, as one: (A, G, H), each (..., 6, 6)."""
    (a1, g1, h1), (a2, g2, h2) = first, second
    between = np.linalg.inv(np.eye(6) + g1 @ h2)
    through = a2 @ between
    back = a1.swapaxes(-1, -2) @ h2 @ between
    return through @ a1, g2 + through @ g1 @ a2.swapaxes(-1, -2), h1 + back @ a1


def pushes_of(problem: Problem, b_orbit_t: Array) -> Array:
    """-G [b x] of each step, (n, 6, 3): what a dipole adds to the state."""
    pushes: Array = -problem.free[:, 6:] @ skews(b_orbit_t)
    return pushes


def skews(v: Array) -> Array:
    """[v x], shape (..., 3, 3) for v of shape (..., 3)."""
    whole = np.zeros((*v.shape, 3))
    whole[..., 2, 1], whole[..., 0, 2], whole[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    whole[..., 1, 2], whole[..., 2, 0], whole[..., 0, 1] = -v[..., 0], -v[..., 1], -v[..., 2]
    return whole
