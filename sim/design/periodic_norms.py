"""The H2 and H-infinity norms of a body on its orbit under a periodic linear law.

The steps of ``fsw/core/laws/plan/riccati.py`` with a torque w in each,

    x+ = (F - G [b x] M) x + G w,    z = (Q^1/2 x, effort^1/2 M x),

w in units of w0^2 J_mean. Over an orbit of n steps they are one step of a constant system from the n torques
to the n errors (lifting); its H-infinity norm is the largest singular value of its frequency response, and
the H2 norm the root of the mean square of z under white torque of unit variance.

Source: Bittanti, Colaneri 2009, Periodic Systems, sections 6.2 (lifting) and 9.1 (norms).
"""

from typing import NamedTuple

import numpy as np

from fsw.core.laws.plan.riccati import Array, Problem, pushes_of

FREQUENCIES = 33
"""Between zero and half an orbit's, at which the frequency response is taken."""


class Norms(NamedTuple):
    """In rad for a torque of w0^2 J_mean."""

    h2: float
    h_infinity: float


class UnstableLoopError(Exception):
    """The loop has no norms."""


def norms(
    problem: Problem, b_orbit_t: Array, gains: Array, unit_nm: float, frequencies: int = FREQUENCIES
) -> Norms:
    """The norms of a loop.

    Args:
        problem: steps and weights.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).
        gains: M of each step, from (Omega, theta) to the dipole, orbital axes, shape (n, 3, 6).
        unit_nm: the torque that counts as one, w0^2 J_mean.
        frequencies: how many are taken.

    Raises:
        UnstableLoopError: a motion of the loop does not decay.
    """
    f, g = problem.free[:, :6], unit_nm * problem.free[:, 6:]
    closed = f + pushes_of(problem, b_orbit_t) @ gains
    seen = np.concatenate(
        [
            np.broadcast_to(np.diag(np.sqrt(problem.cost)), (len(gains), 6, 6)),
            np.sqrt(problem.effort) * gains,
        ],
        axis=1,
    )
    whole, driven, told, direct = _lifted(closed, g, seen)
    if np.abs(np.linalg.eigvals(whole)).max() >= 1.0:
        raise UnstableLoopError("the loop is not stable")
    return Norms(_h2(closed, g, seen, whole), _h_infinity(whole, driven, told, direct, frequencies))


def _lifted(closed: Array, g: Array, seen: Array) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of an orbit as one step."""
    steps = len(closed)
    state, reach = np.eye(6), np.zeros((6, 3 * steps))
    told, direct = np.zeros((steps, 9, 6)), np.zeros((steps, 9, 3 * steps))
    for k in range(steps):
        told[k], direct[k] = seen[k] @ state, seen[k] @ reach
        state, reach = closed[k] @ state, closed[k] @ reach
        reach[:, 3 * k : 3 * k + 3] = g
    return state, reach, told.reshape(-1, 6), direct.reshape(9 * steps, -1)


def _h2(closed: Array, g: Array, seen: Array, whole: Array) -> float:
    """The root of the mean over the steps of the trace of z's covariance."""
    driven = np.zeros((6, 6))
    for step in closed:
        driven = step @ driven @ step.T + g @ g.T
    scale = np.sqrt(np.diag(driven))
    scaled, motion = driven / np.outer(scale, scale), whole * scale / scale[:, None]
    flat = np.linalg.solve(np.eye(36) - np.kron(motion, motion), scaled.ravel())
    covariance, total = flat.reshape(6, 6) * np.outer(scale, scale), 0.0
    for step, sees in zip(closed, seen, strict=True):
        total += float(np.trace(sees @ covariance @ sees.T))
        covariance = step @ covariance @ step.T + g @ g.T
    return float(np.sqrt(total / len(closed)))


def _h_infinity(whole: Array, driven: Array, told: Array, direct: Array, frequencies: int) -> float:
    """The largest singular value over the frequencies."""
    largest = 0.0
    for angle in np.linspace(0.0, np.pi, frequencies):
        response = direct + told @ np.linalg.solve(np.exp(1j * angle) * np.eye(6) - whole, driven)
        largest = max(largest, float(np.linalg.eigvalsh(response.conj().T @ response)[-1]))
    return float(np.sqrt(largest))
