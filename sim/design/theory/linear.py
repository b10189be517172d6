"""The attitude equations linearised about body = orbit, over the argument of latitude u.

With x = (w, theta): w = Omega / w0 the rate relative to the orbital frame and theta the small rotation vector
that turns the orbital axes into the body's, both in body axes; J the inertia tensor, diagonal or not; h the
momentum of wheels:

    w' = J^-1 { ([(J e3 + h / w0) x] - [e3 x] J)(w + e3 x theta)
                + 3 ([e1 x] J - [J e1 x])(e1 x theta) + T / w0^2 } - e3 x w
    theta' = w,   xi' = theta (with an integral term)
    T / w0^2 = -G(u) { k_w B0^2 / w0 w + 2 k_a B0^2 / w0^2 theta + 2 k_i B0^2 / w0^3 xi }

G = |B|^2 I - B B^T with B = (-2 sin u sin i, cos u sin i, cos i), the direct dipole's field in units of B0.
The factor 2 comes from S = 2 theta. Where J is not diagonal, or h not along axis 3, a constant torque is left
on the nominal attitude (``resting_torque``): it is then no equilibrium, and the linearisation is about it
nonetheless.

Source: Ovchinnikov, Roldugin, Ivanov, Penkov 2015, eq. 4, derived again: for principal axes it is their
equation with B0^2 in all three rows and the kinematics psi' = w1, phi' = w2, theta' = w3.
"""

from collections.abc import Callable
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.design.theory.bodies import Body
from sim.value_types import Array

Number = float | Array
System = Callable[[Array], Array]
"""The matrix A(u) of x' = A x: from u of shape (k,) to (..., k, n, n)."""

E1, E3 = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


class Gains(NamedTuple):
    """Gains of m = -b x (k_w Omega + k_a S + k_i integral of S dt): numbers, or arrays of one shape.

    Attributes:
        k_w: of the rate relative to the orbital frame, N m s / T^2.
        k_a: of S, about twice the small rotation, N m / T^2.
        k_i: of the time integral of S, N m / (T^2 s); None: no such term, and six states instead of nine.
    """

    k_w: Number
    k_a: Number
    k_i: Number | None = None

    def scaled(self, factor: Number) -> "Gains":
        """All of them times a factor."""
        return Gains(factor * self.k_w, factor * self.k_a, None if self.k_i is None else factor * self.k_i)


def closed_loop(body: Body, gains: Gains, inertia_kgm2: ArrayLike | None = None) -> System:
    """The matrix of the controlled motion, as in the head of this module.

    Args:
        body: the satellite and its orbit.
        gains: broadcast against the leading shape of the inertia.
        inertia_kgm2: (..., 3, 3) in place of the body's own.

    Returns:
        A(u), shape (..., k, n, n) for u of shape (k,); n = 6, or 9 with an integral term.
    """
    inertia = np.asarray(body.inertia_kgm2 if inertia_kgm2 is None else inertia_kgm2, dtype=np.float64)
    size = 6 if gains.k_i is None else 9
    free = free_motion(body, size, inertia)[..., None, :, :]
    inverse = np.linalg.inv(inertia)[..., None, :, :]
    feedback = feedback_scales(body, gains)[..., None, None, :]

    def matrix(u: Array) -> Array:
        torque = -inverse @ projection(u, body)
        blocks = (torque[..., None] * feedback[..., None, :]).swapaxes(-1, -2)  # (..., k, 3, blocks, 3)
        rows = blocks.reshape(*blocks.shape[:-2], size)
        whole = np.broadcast_to(free, (*rows.shape[:-2], size, size)).copy()
        whole[..., :3, :] += rows
        return whole

    return matrix


def feedback_scales(body: Body, gains: Gains) -> Array:
    """(..., 2 or 3): k_w B0^2 / w0, 2 k_a B0^2 / w0^2 and, with k_i, 2 k_i B0^2 / w0^3, all in kg m^2."""
    w0, square = body.rate_radps, body.field_t**2
    factors = (square / w0, 2.0 * square / w0**2, 2.0 * square / w0**3)
    given = np.broadcast_arrays(*(gain for gain in gains if gain is not None))
    return np.stack([f * np.asarray(g, dtype=np.float64) for f, g in zip(factors, given, strict=False)], -1)


def free_motion(body: Body, size: int = 6, inertia_kgm2: ArrayLike | None = None) -> Array:
    """The constant matrix (..., n, n) of the uncontrolled motion.

    Args:
        body: the satellite and its orbit.
        size: n = 6, or 9 with the integral of theta behind.
        inertia_kgm2: (..., 3, 3) in place of the body's own.
    """
    j = np.asarray(body.inertia_kgm2 if inertia_kgm2 is None else inertia_kgm2, dtype=np.float64)
    e1, e3 = skew(E1), skew(E3)
    gyroscopic = skew(j @ E3 + np.asarray(body.wheel_nms) / body.rate_radps) - e3 @ j
    gravity = 3.0 * (e1 @ j - skew(j @ E1)) @ e1
    inverse = np.linalg.inv(j)
    matrix = np.zeros((*j.shape[:-2], size, size))
    matrix[..., :3, :3] = inverse @ gyroscopic - e3
    matrix[..., :3, 3:6] = inverse @ (gyroscopic @ e3 + gravity)
    matrix[..., 3:, : size - 3] = np.eye(size - 3)
    return matrix


def resting_torque(body: Body) -> Array:
    """Torque on the nominal attitude, w0^2 (3 e1 x J e1 - e3 x (J e3 + h / w0)), body axes, N m."""
    j, w0 = np.asarray(body.inertia_kgm2), body.rate_radps
    held = 3.0 * skew(E1) @ j @ E1 - skew(E3) @ (j @ E3 + np.asarray(body.wheel_nms) / w0)
    torque: Array = w0**2 * held
    return torque


def dipole_field(u: Array, body: Body) -> Array:
    """The direct dipole's field, orbital axes, in units of B0: shape (..., 3) for u of shape (...)."""
    i = np.radians(body.inclination_deg)
    return np.stack(
        [-2.0 * np.sin(u) * np.sin(i), np.cos(u) * np.sin(i), np.full_like(u, np.cos(i))], axis=-1
    )


def projection(u: Array, body: Body) -> Array:
    """G = |B|^2 I - B B^T, shape (..., 3, 3) for u of shape (...)."""
    field = dipole_field(u, body)
    cross = skew(field)
    return -cross @ cross


def skew(v: Array) -> Array:
    """[v x], shape (..., 3, 3) for v of shape (..., 3)."""
    x, y, z = np.moveaxis(np.asarray(v, dtype=np.float64), -1, 0)
    zero = np.zeros_like(x)
    return np.stack(
        [np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2
    )


# --- Controllability: whether coils alone can bring the motion to rest within an orbit

STEPS = 360
"""Of the integral, an orbit: the integrand is smooth and nearly periodic."""


def gramian(body: Body) -> Array:
    """The Gramian W over one orbit from u = 0, (6, 6).

    At no instant can coils turn the satellite about the field, but the field turns along the orbit. The
    linear motion x' = A x - J^-1 [B x] m of x = (Omega / w0, theta) is controllable over one orbit if its
    Gramian

        W = integral over u of P(u) B(u) B(u)^T P(u)^T,  P(u) = exp(A (2 pi - u)), B(u) = (-J^-1 [b x]; 0)

    has no zero eigenvalue, b the direct dipole's field in units of B0 and J in units of its mean moment. The
    least eigenvalue beside the greatest tells how much more effort the worst motion takes than the best one.

    Source: Bhat, Dham 2003; Bhat 2005; Yang 2016, as in Ovchinnikov, Roldugin 2019, introduction [4, 5, 9].
    """
    from scipy.linalg import expm  # noqa: PLC0415  (slow to load)

    inertia = np.asarray(body.inertia_kgm2)
    turn = np.linalg.inv(inertia / (np.trace(inertia) / 3.0))
    u = np.linspace(0.0, 2.0 * pi, STEPS, endpoint=False) + pi / STEPS
    push = np.zeros((STEPS, 6, 3))
    push[:, :3] = -turn @ skew(dipole_field(u, body))
    step = expm(free_motion(body) * 2.0 * pi / STEPS)
    onward = expm(free_motion(body) * pi / STEPS)
    total = np.zeros((6, 6))
    for pushed in push[::-1]:  # from the last step to the first
        reached = onward @ pushed
        total += reached @ reached.T
        onward = onward @ step
    whole: Array = 2.0 * pi / STEPS * total
    return whole


def conditioning(body: Body) -> float:
    """Least over greatest eigenvalue of the Gramian: zero if there is a motion that no dipole stops."""
    values = np.linalg.eigvalsh(gramian(body))
    return float(max(0.0, values[0]) / values[-1])
