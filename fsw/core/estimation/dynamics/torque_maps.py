"""Linear maps from the quantities that vary over a flight to the entries of the system matrix."""

import numpy as np

from fsw.core.algebra.vector import Vec3, is_zero, skew
from fsw.core.estimation.dynamics.motion import BodyFields, BodyMotion, outer
from fsw.core.estimation.kalman import Matrix, linear
from fsw.core.estimation.parameters import Layout, Rotor

_PULL, _ACTING, _FIELD = slice(3, 12), slice(12, 21), slice(21, 24)
_SPIN, _ALPHA, _DRIVEN = slice(24, 33), slice(33, 36), slice(36, 45)
"""Places among the numbers that the torque's derivatives are linear in: after the rate, g e1 e1^T (g being
3 mu/r^3), m b^T, b, omega omega^T, domega/dt and m_driven b^T."""
_NUMBERS = 45
_NOTHING = np.zeros((12, 18))
_MOMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Rows and columns of xx, yy, zz, xy, xz, yz."""


def torque_map(parts: Layout) -> tuple[Matrix, Matrix] | None:
    """Derivatives of the torque by the error state, less those that are also linear in J.

    Those that are constant, (3, m), and what they gain by each of 45 numbers, (45, 3 m).

    By the first m components of the error state; the others have no effect. None where the derivative by
    every estimated parameter is constant.
    """
    if parts.dipole is None and parts.coils is None and parts.inertia is None:
        return None
    axes = np.eye(3)
    acting = (parts.torque, parts.dipole, parts.coils, parts.inertia)
    size = max(part.stop for part in acting if part is not None)
    constant, rows = np.zeros((3, size)), np.zeros((3, size, _NUMBERS))
    rows[:, 0:6, _ACTING] = system_maps(axes, axes)[12:, 18:].T.reshape(3, 6, 9)
    if parts.torque is not None:
        constant[:, parts.torque] = axes
    if parts.dipole is not None:
        rows[:, parts.dipole, _FIELD] = -np.array([cross_matrix(axis) for axis in axes]).transpose(1, 2, 0)
    if parts.coils is not None:
        by_error = rows[:, parts.coils, _DRIVEN]
        for i in range(3):
            for j in range(3):
                by_error[:, 3 * i + j, 3 * j : 3 * j + 3] = cross_matrix(axes[i])
    if parts.inertia is not None:
        by_moment = rows[:, parts.inertia]
        for index, change in enumerate(_changes_of_inertia()):
            by_moment[:, index, _ALPHA] = -change
            effects = np.hstack([np.cross(axis, change).T for axis in axes])  # e_i x (dJ e_k)
            by_moment[:, index, _PULL], by_moment[:, index, _SPIN] = effects, -effects
    return constant, np.ascontiguousarray(rows.reshape(-1, _NUMBERS).T)


def torque_rows(
    motion: BodyMotion, around: BodyFields, m_driven: Vec3, rotor: Rotor, by_error: tuple[Matrix, Matrix]
) -> Matrix:
    """The torque's derivative by the first m numbers of the error state, (3, m).

    The torque is m x b + g e1 x J e1 - omega x (J omega + h) - J domega/dt.

    Args:
        motion: in the middle of the tick.
        around: radius direction and field there.
        m_driven: dipole that the coils are driven to, A m^2.
        rotor: inertia as estimated, and the momentum of a wheel.
        by_error: the map of the filter, as ``torque_map`` gives it.
    """
    constant, gains = by_error
    omega, b = motion.omega, around.b_t
    pull, acting, spin = around.pull(), outer(motion.m_am2, b), outer(omega, omega)
    numbers = (omega, pull, acting, b, spin, motion.alpha, outer(m_driven, b))
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = rotor.inertia_kgm2
    moving = linear(_NOTHING, (xx, yy, zz, xy, xz, yz), _BY_INERTIA)
    rows = linear(linear(constant, numbers, gains), (omega, pull), moving)
    if not is_zero(rotor.wheel_body_nms):
        rows[:, 3:6] += skew(rotor.wheel_body_nms)
    return rows


def system_maps(j: Matrix, j_inverse: Matrix) -> Matrix:
    """Derivatives of the upper left 6x6 of the system matrix by what it is linear in, (21, 36).

    By the rate (3), by 3 mu/r^3 e1 e1^T (9) and by m b^T (9).
    """
    axes = np.eye(3)
    columns = np.zeros((21, 6, 6))
    for k in range(3):
        columns[k, 0:3, 0:3] = -cross_matrix(axes[k])
        columns[k, 3:6, 3:6] = j_inverse @ (cross_matrix(j[k]) - cross_matrix(axes[k]) @ j)
        for i in range(3):
            pull = cross_matrix(axes[i]) @ j - cross_matrix(j[i])
            columns[3 + 3 * i + k, 3:6, 0:3] = j_inverse @ pull @ cross_matrix(axes[k])
            columns[12 + 3 * i + k, 3:6, 0:3] = j_inverse @ cross_matrix(axes[i]) @ cross_matrix(axes[k])
    return columns.reshape(21, 36)


def cross_matrix(a: Matrix) -> Matrix:
    """The matrix [a x]."""
    return np.cross(a, np.eye(3)).T


def _changes_of_inertia() -> list[Matrix]:
    """The inertia matrix of a unit of each moment, (3, 3)."""
    changes = [np.zeros((3, 3)) for _ in _MOMENTS]
    for change, (row, column) in zip(changes, _MOMENTS, strict=True):
        change[row, column] = change[column, row] = 1.0
    return changes


_BY_INERTIA: Matrix = np.stack(
    [system_maps(change, np.eye(3))[:12, 18:] for change in _changes_of_inertia()]
).reshape(6, 216)
"""By moment, the derivatives by attitude and rate, (3, 6), per component of rate and g e1 e1^T, (12)."""
