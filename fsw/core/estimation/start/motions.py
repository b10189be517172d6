"""Many motions of the satellite at once, over some minutes: arrays with one row per motion."""

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.parameters import Rotor

AFTER, BEFORE = [1, 2, 0], [2, 0, 1]
"""The axes after and before each one."""
STEP_RAD, MOST_STEPS = 0.5, 8
"""A motion that turns farther than the first in a leg is integrated in several equal steps, no more than the
second, which keeps the work of a tick short."""


@final
@dataclass(frozen=True, slots=True)
class Leg:
    """What acts between two samples: its length, s, radius direction and field, T, eci, in its middle.

    ``gravity_per_s2`` is 3 mu / r^3, ``m_body_am2`` the mean dipole that was driven, body axes.
    """

    length_s: float
    e1_eci: Matrix
    b_eci_t: Matrix
    gravity_per_s2: float
    m_body_am2: Matrix


@final
@dataclass(frozen=True, slots=True)
class Disturbed:
    """What disturbs each motion: residual dipole, A m^2, and torque, N m, body axes, (n, 3) each.

    ``inertia_kgm2``: xx, yy, zz, xy, xz, yz of the inertia tensor less the table's, (n, 6), to first order.
    """

    dipole_am2: Matrix
    torque_nm: Matrix
    inertia_kgm2: Matrix

    def chosen(self, rows: NDArray[np.bool_]) -> "Disturbed":
        """Some of them."""
        return Disturbed(self.dipole_am2[rows], self.torque_nm[rows], self.inertia_kgm2[rows])


def in_body(q: Matrix, v: Matrix) -> Matrix:
    """C(q_body_from_eci) v for each attitude, (n, 3)."""
    turned: Matrix = all_in_body(q, v[None, :])[0].T
    return turned


def all_in_body(q: Matrix, directions: Matrix) -> Matrix:
    """As ``in_body`` of several vectors, (k, 3), by components, (k, 3, n)."""
    return _in_body(q.T[0], q.T[1:], directions[:, :, None])


def turned_by(q: Matrix, rotation: Matrix) -> Matrix:
    """Attitudes after small further rotations, body axes, (n, 4)."""
    x = q.T
    turned = x + 0.5 * np.vstack(_product(x[0], x[1:], rotation.T))
    unit: Matrix = turned / np.sqrt((turned * turned).sum(axis=0))
    return unit.T


def flown(
    q: Matrix,
    omega: Matrix,
    leg: Leg,
    disturbed: Disturbed,
    rotor: Rotor,
    alike: int | None = None,
) -> tuple[Matrix, Matrix]:
    """Attitudes and rates after a leg, by the fourth-order Runge-Kutta method, fast ones in shorter steps.

    Args:
        q: attitudes, body from eci, (k n, 4).
        omega: inertial rates, body axes, rad/s, (k n, 3).
        leg: what acts on all of them.
        disturbed: what acts on each.
        rotor: inertia.
        alike: n; each further n differ little from the first, and take the same steps, since derivatives are
            made of the differences; None: each takes its own.
    """
    own = steps_of_leg(omega[:alike], leg.length_s)
    steps = np.tile(own, len(q) // len(own))
    if steps.max() == 1:
        return _stepped(q, omega, leg, disturbed, rotor)
    ends, rates = np.empty_like(q), np.empty_like(omega)
    for count in sorted(set(steps.tolist())):
        rows, part = steps == count, replace(leg, length_s=leg.length_s / count)
        some, turning, acting = q[rows], omega[rows], disturbed.chosen(rows)
        for _ in range(count):
            some, turning = _stepped(some, turning, part, acting, rotor)
        ends[rows], rates[rows] = some, turning
    return ends, rates


def steps_of_leg(omega: Matrix, length_s: float) -> NDArray[np.int64]:
    """In how many steps each motion is integrated over a leg, (n); one where its rate is not a number."""
    wanted = np.ceil(length_s / STEP_RAD * np.sqrt((omega * omega).sum(axis=1)))
    steps: NDArray[np.int64] = np.clip(np.nan_to_num(wanted), 1, MOST_STEPS).astype(int)
    return steps


def _stepped(q: Matrix, omega: Matrix, leg: Leg, disturbed: Disturbed, rotor: Rotor) -> tuple[Matrix, Matrix]:
    acting, h = _acting(leg, disturbed, rotor), leg.length_s
    x = np.vstack((q.T, omega.T))
    k1 = _rates(x, acting)
    k2 = _rates(x + 0.5 * h * k1, acting)
    k3 = _rates(x + 0.5 * h * k2, acting)
    k4 = _rates(x + h * k3, acting)
    x = x + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    q = x[:4] / np.sqrt((x[:4] * x[:4]).sum(axis=0))
    return q.T, x[4:].T


@final
@dataclass(frozen=True, slots=True)
class _Acting:
    """A leg by components: radius direction and field, (2, 3, 1); inertia, (3, 3, n); J^-1 - J^-1 dJ J^-1."""

    seen: Matrix
    gravity_per_s2: float
    wheel_nms: Matrix
    dipole_am2: Matrix
    torque_nm: Matrix
    inertia: Matrix
    response: Matrix


def _acting(leg: Leg, disturbed: Disturbed, rotor: Rotor) -> _Acting:
    inverse = np.array(rotor.inertia_inverse)
    change = disturbed.inertia_kgm2.T[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3, -1)
    less = np.einsum("ij,jkn,kl->iln", inverse, change, inverse)
    return _Acting(
        np.array((leg.e1_eci, leg.b_eci_t))[:, :, None],
        leg.gravity_per_s2,
        np.array(rotor.wheel_body_nms)[:, None],
        leg.m_body_am2[:, None] + disturbed.dipole_am2.T,
        disturbed.torque_nm.T,
        np.array(rotor.inertia_kgm2)[:, :, None] + change,
        inverse[:, :, None] - less,
    )


def _rates(x: Matrix, acting: _Acting) -> Matrix:
    """dq/dt = 1/2 q (0, w), J dw/dt = (m + d) x b + 3 mu/r^3 e1 x J e1 - w x (J w + h) + t, (7, n)."""
    scalar, vector, omega = x[0], x[1:4], x[4:7]
    e1, b = _in_body(scalar, vector, acting.seen)
    turned = (acting.inertia * np.stack((e1, omega))[:, None]).sum(axis=2)
    first = np.stack((acting.gravity_per_s2 * e1, -omega, acting.dipole_am2))
    second = np.stack((turned[0], turned[1] + acting.wheel_nms, b))
    torque = _crossed(first, second).sum(axis=0) + acting.torque_nm
    q_rate = _product(scalar, vector, 0.5 * omega)
    return np.vstack((*q_rate, (acting.response * torque).sum(axis=1)))


def _in_body(scalar: Matrix, vector: Matrix, directions: Matrix) -> Matrix:
    """Directions, (k, 3, 1), seen in the body, (k, 3, n)."""
    along = (directions * vector).sum(axis=1)[:, None]
    square = scalar * scalar - (vector * vector).sum(axis=0)
    turned: Matrix = square * directions + 2.0 * (along * vector - scalar * _crossed(vector, directions))
    return turned


def _crossed(a: Matrix, b: Matrix) -> Matrix:
    """The cross product of components along the last axis but one."""
    product: Matrix = a[..., AFTER, :] * b[..., BEFORE, :] - a[..., BEFORE, :] * b[..., AFTER, :]
    return product


def _product(scalar: Matrix, vector: Matrix, v: Matrix) -> tuple[Matrix, Matrix]:
    """Scalar and vector of q (x) (0, v)."""
    return -(vector * v).sum(axis=0), scalar * v + _crossed(vector, v)
