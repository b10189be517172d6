"""Periodic motions under a torque: the least over all periodic dipoles, and that under PD feedback.

A dipole gives no torque along the field, so a constant torque d can only be balanced on the mean, by a
periodic motion. With x' = A x + J^-1 (v x B + d / w0^2) as in ``linear``, v = m B0 / w0^2, all of period
2 pi, Fourier collocation at N nodes makes the motion linear in the dipoles at the nodes; their least squares
is the result. In the long run no law does better, for small angles. The field is the direct dipole's, or a
given one, which is taken for that of every orbit. Under feedback A has the period of the field, and the same
collocation solves for the motion at once.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains, closed_loop, dipole_field, free_motion, skew
from sim.value_types import Array

NODES = 32
"""Nodes an orbit: the field has two harmonics, the response a few more."""
TOLERANCE = 1e-9
"""Dipoles with less than this fraction of the effect of the most effective one are not used."""


class PeriodicResponse(NamedTuple):
    """The best periodic response to a constant torque, at the nodes u = 2 pi k / N.

    Attributes:
        rms_rad: root mean square of |theta| over an orbit.
        theta_rad: small rotation vector, (N, 3).
        dipole_am2: the dipole, (N, 3).
    """

    rms_rad: float
    theta_rad: Array
    dipole_am2: Array


def least_error(
    body: Body, torque_nm: ArrayLike, nodes: int = NODES, b_orbit: Array | None = None
) -> PeriodicResponse:
    """The periodic dipole with the least mean square of theta under a constant or periodic torque.

    Args:
        body: the satellite and its orbit.
        torque_nm: torque, body axes, beside that on the body at rest in the nominal attitude: constant, (3,),
            or at the nodes, (N, 3).
        nodes: their number, even.
        b_orbit: field at the nodes, orbital axes, in units of B0, (N, 3); None: the direct dipole's.
    """
    u = 2.0 * np.pi / nodes * np.arange(nodes, dtype=np.float64)
    w0, inverse = body.rate_radps, np.linalg.inv(np.asarray(body.inertia_kgm2))
    motion = np.kron(_derivative(nodes), np.eye(6)) - np.kron(np.eye(nodes), free_motion(body))
    response = np.linalg.inv(motion).reshape(nodes, 6, nodes, 6)[:, 3:, :, :3]
    by_torque = np.einsum("kilj,jm->kilm", response, inverse)
    given_nm = np.broadcast_to(np.asarray(torque_nm), (nodes, 3))
    turned = np.einsum("kilm,lm->ki", by_torque, given_nm) / w0**2
    field = dipole_field(u, body) if b_orbit is None else b_orbit
    by_dipole = np.einsum("kilm,lmn->kiln", by_torque, -skew(field))
    rows = by_dipole.reshape(3 * nodes, 3 * nodes)
    dipoles = np.linalg.lstsq(rows, -turned.ravel(), rcond=TOLERANCE)[0]
    theta = turned + (rows @ dipoles).reshape(nodes, 3)
    rms = float(np.sqrt(np.mean(np.sum(theta**2, axis=1))))
    return PeriodicResponse(rms, theta, dipoles.reshape(nodes, 3) * w0**2 / body.field_t)


def answer(body: Body, gains: Gains, torque_nm: ArrayLike) -> Array:
    """The periodic motion under PD feedback, in the direct dipole's field, and a torque.

    Args:
        body: the satellite and its orbit.
        gains: without an integral term.
        torque_nm: torque at the nodes u = 2 pi k / N, body axes, (N, 3).

    Returns:
        theta at the nodes, the small rotation vector [rad], (N, 3).
    """
    torque = np.asarray(torque_nm, dtype=np.float64)
    nodes = len(torque)
    motion = np.kron(_derivative(nodes), np.eye(6)).reshape(nodes, 6, nodes, 6)
    each = np.arange(nodes)
    motion[each, :, each, :] -= closed_loop(body, gains)(2.0 * np.pi / nodes * each.astype(np.float64))
    pushed = np.zeros((nodes, 6))
    pushed[:, :3] = torque @ np.linalg.inv(np.asarray(body.inertia_kgm2)).T / body.rate_radps**2
    state = np.linalg.solve(motion.reshape(6 * nodes, 6 * nodes), pushed.ravel())
    theta: Array = state.reshape(nodes, 6)[:, 3:]
    return theta


def _derivative(nodes: int) -> Array:
    """The matrix that differentiates a function of period 2 pi given at equal nodes."""
    waves = np.fft.fftfreq(nodes, 1.0 / nodes)
    waves[nodes // 2] = 0.0  # the highest wave of an even number of nodes has no derivative
    matrix: Array = np.fft.ifft(1j * waves[:, None] * np.fft.fft(np.eye(nodes), axis=0), axis=0).real
    return matrix
