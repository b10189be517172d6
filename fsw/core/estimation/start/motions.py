"""Many motions of the satellite at once, over some minutes: arrays with one row a motion."""

from typing import NamedTuple

import numpy as np

from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.parameters import Rotor


class Leg(NamedTuple):
    """What acts between two samples: its length, s, radius direction and field, T, eci, in its middle.

    ``gravity_per_s2`` is 3 mu / r^3, ``m_body_am2`` the mean dipole that was driven, body axes.
    """

    length_s: float
    e1_eci: Matrix
    b_eci_t: Matrix
    gravity_per_s2: float
    m_body_am2: Matrix


def in_body(q: Matrix, v: Matrix) -> Matrix:
    """C(q_body_from_eci) v for each attitude, (n, 3)."""
    scalar, vector = q[:, :1], q[:, 1:]
    along = vector.dot(v)[:, None]
    square = scalar * scalar - (vector * vector).sum(axis=1)[:, None]
    turned: Matrix = square * v + 2.0 * along * vector - 2.0 * scalar * crossed(vector, v)
    return turned


def crossed(a: Matrix, b: Matrix) -> Matrix:
    """The cross product by rows."""
    product: Matrix = a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]
    return product


def turned_by(q: Matrix, rotation: Matrix) -> Matrix:
    """Attitudes after small further turns, body axes, (n, 4)."""
    return _unit(q + 0.5 * _product(q, rotation))


class Disturbed(NamedTuple):
    """What disturbs each motion: residual dipole, A m^2, and torque, N m, body axes, (n, 3) each.

    ``inertia_kgm2``: xx, yy, zz, xy, xz, yz of the inertia tensor less the table's, (n, 6), to first order.
    """

    dipole_am2: Matrix
    torque_nm: Matrix
    inertia_kgm2: Matrix


def flown(q: Matrix, omega: Matrix, leg: Leg, disturbed: Disturbed, rotor: Rotor) -> tuple[Matrix, Matrix]:
    """Attitudes and rates after a leg, by Runge and Kutta's method of the fourth order.

    Args:
        q: attitudes, body from eci, (n, 4).
        omega: inertial rates, body axes, rad/s, (n, 3).
        leg: what acts on all of them.
        disturbed: what acts on each.
        rotor: inertia.
    """
    h = leg.length_s
    k1 = _rates(q, omega, leg, disturbed, rotor)
    k2 = _rates(q + 0.5 * h * k1[0], omega + 0.5 * h * k1[1], leg, disturbed, rotor)
    k3 = _rates(q + 0.5 * h * k2[0], omega + 0.5 * h * k2[1], leg, disturbed, rotor)
    k4 = _rates(q + h * k3[0], omega + h * k3[1], leg, disturbed, rotor)
    turn, change = (a + 2.0 * (b + c) + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True))
    return _unit(q + h / 6.0 * turn), omega + h / 6.0 * change


def _rates(q: Matrix, omega: Matrix, leg: Leg, disturbed: Disturbed, rotor: Rotor) -> tuple[Matrix, Matrix]:
    """dq/dt = 1/2 q (0, w), J dw/dt = (m + d) x b + 3 mu/r^3 e1 x J e1 - w x (J w + h) + t."""
    inertia, inverse, e1 = (
        np.array(rotor.inertia_kgm2),
        np.array(rotor.inertia_inverse),
        in_body(q, leg.e1_eci),
    )
    change, gravity = disturbed.inertia_kgm2, leg.gravity_per_s2
    torque = gravity * crossed(e1, e1.dot(inertia) + _symmetric(change, e1))
    torque -= crossed(omega, omega.dot(inertia) + _symmetric(change, omega) + np.array(rotor.wheel_body_nms))
    torque += crossed(leg.m_body_am2 + disturbed.dipole_am2, in_body(q, leg.b_eci_t)) + disturbed.torque_nm
    return 0.5 * _product(q, omega), (torque - _symmetric(change, torque.dot(inverse))).dot(inverse)


def _symmetric(entries: Matrix, v: Matrix) -> Matrix:
    """M v by rows, M being given by xx, yy, zz, xy, xz, yz."""
    first, second = entries[:, [0, 3, 4]], entries[:, [3, 1, 5]]
    product: Matrix = np.stack(
        ((first * v).sum(axis=1), (second * v).sum(axis=1), (entries[:, [4, 5, 2]] * v).sum(axis=1)), axis=1
    )
    return product


def _product(q: Matrix, v: Matrix) -> Matrix:
    """Q (x) (0, v) by rows."""
    scalar = -(q[:, 1:] * v).sum(axis=1)[:, None]
    return np.hstack((scalar, q[:, :1] * v + crossed(q[:, 1:], v)))


def _unit(q: Matrix) -> Matrix:
    scaled: Matrix = q / np.sqrt((q * q).sum(axis=1))[:, None]
    return scaled
