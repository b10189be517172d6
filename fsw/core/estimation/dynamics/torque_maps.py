"""What the error dynamics are linear in: maps from what moves to the entries of the system matrix."""

from typing import NamedTuple

import numpy as np

from fsw.core.estimation.kalman import Matrix


class TorqueMaps(NamedTuple):
    """Derivatives of the torque by the error state, each linear in what moves.

    By attitude and rate, (3, 6): ``moving`` (216, 6) by each component of J, then by each of the rate and of
    g e1 e1^T, g being 3 mu/r^3; ``driven`` (18, 9) by each of m b^T. By the dipole, (3, 3): ``dipole`` (9, 3)
    by each of b; by the coils, (3, 9): ``coils`` (27, 9) by each of m_driven b^T; by the inertia, (3, 6):
    ``inertia`` (18, 21) by each of g e1 e1^T, omega omega^T and domega/dt.
    """

    moving: Matrix
    driven: Matrix
    dipole: Matrix
    coils: Matrix
    inertia: Matrix


def system_maps(j: Matrix, j_inverse: Matrix) -> Matrix:
    """Derivatives of the upper left 6x6 of the system matrix by what it is linear in, (36, 21).

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
    return columns.reshape(21, 36).T.copy()


def cross_matrix(a: Matrix) -> Matrix:
    """The matrix [a x]."""
    return np.cross(a, np.eye(3)).T


def _torque_maps() -> TorqueMaps:
    """The torque is m x b + g e1 x J e1 - omega x J omega - J domega/dt, J as xx, yy, zz, xy, xz, yz."""
    axes = np.eye(3)
    moving, coils, inertia = np.zeros((18, 12, 6)), np.zeros((3, 9, 9)), np.zeros((3, 6, 21))
    for index, (row, column) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))):
        change = np.zeros((3, 3))
        change[row, column] = change[column, row] = 1.0
        moving[:, :, index] = system_maps(change, axes)[18:, :12]
        inertia[:, index, 18:] = -change
        for i in range(3):
            effect = np.cross(axes[i], change.T)  # a row for each k: e_i x (dJ e_k)
            inertia[:, index, 3 * i : 3 * i + 3] = effect.T
            inertia[:, index, 9 + 3 * i : 12 + 3 * i] = -effect.T
    for i in range(3):
        for j in range(3):
            coils[:, 3 * i + j, 3 * j : 3 * j + 3] = cross_matrix(axes[i])
    dipole = np.array([-cross_matrix(axis) for axis in axes]).reshape(3, 9).T
    return TorqueMaps(
        moving.reshape(216, 6),
        system_maps(axes, axes)[18:, 12:].copy(),
        dipole.copy(),
        coils.reshape(27, 9),
        inertia.reshape(18, 21),
    )


TORQUES = _torque_maps()
