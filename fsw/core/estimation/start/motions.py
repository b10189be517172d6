"""Many motions of the satellite at once, over some minutes: arrays with one row per motion."""

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from fsw.core.estimation.components import directions_in_body, multiplied
from fsw.core.estimation.kalman import Matrix, move_bodies
from fsw.core.estimation.parameters import Rotor

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
    return directions_in_body(q.T[0], q.T[1:], directions[:, :, None])


def turned_by(q: Matrix, rotation: Matrix) -> Matrix:
    """Attitudes after small further rotations, body axes, (n, 4)."""
    x = q.T
    turned = x + 0.5 * np.vstack(multiplied(x[0], x[1:], rotation.T))
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
    """Attitudes and rates after a leg in one step."""
    inverse = np.array(rotor.inertia_inverse)
    change = disturbed.inertia_kgm2.T[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3, -1)
    less = np.einsum("ij,jkn,kl->iln", inverse, change, inverse)  # J^-1 dJ J^-1
    x = move_bodies(
        np.vstack((q.T, omega.T)),
        leg.length_s,
        (tuple(leg.e1_eci.tolist()), tuple(leg.b_eci_t.tolist()), rotor.wheel_body_nms, leg.gravity_per_s2),
        leg.m_body_am2[:, None] + disturbed.dipole_am2.T,
        disturbed.torque_nm.T,
        (np.array(rotor.inertia_kgm2)[:, :, None] + change).reshape(9, -1),
        (inverse[:, :, None] - less).reshape(9, -1),
    )
    return x[:4].T, x[4:].T
