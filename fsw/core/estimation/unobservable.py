"""What no sample shows: a turn of the body axes, and a common factor in all that moves the satellite.

Turn everything given in body axes, and the body with it, and no sample changes. Multiply inertia, coils,
residual dipole and torque by one factor, and no motion changes. The directions D of the error state are

    turn phi     dtheta = -phi,  domega = phi x omega,  of magnetometer and Sun sensor phi,  dd = phi x d,
                 dtorque = phi x torque,  dG = [phi x](1 + G),  dJ = [phi x] J - J [phi x]
    factor 1 + f dJ = f J,  dG = f (1 + G),  dd = f d,  dtorque = f torque

Along them there is no information but the table's, as long as it takes none of these as exact and no wheel of
known momentum makes body axes and torque observable. They depend on the estimate, so each correction turns
them. A covariance that did not turn with them would be smaller along the new ones than any sample justifies,
and soon the filter would attribute to them whatever is not modelled. With W the coordinates, W^T D = 1,
those of the turns being the Sun sensor's misalignment, that of the factor the trace of the inertia,

    P <- T P T^T,  T = 1 + (D_after - D_before) W^T,  so that D^T P^-1 D stays what it was.

Source: Huang, Mourikis, Roumeliotis 2010, on filters that gain information where they cannot observe; Barrau,
Bonnabel 2017, on errors along directions that move with the estimate.
"""

from typing import final

import numpy as np

from fsw.core.algebra.vector import ZERO, Vec3, skew
from fsw.core.estimation.kalman import Matrix, turn_along
from fsw.core.estimation.parameters import (
    NOTHING,
    Layout,
    Parameters,
    Rotor,
    Symmetric,
    correct_parameters,
    estimated_inertia,
)

TURNS, FACTOR = slice(0, 3), 3
"""Columns of the directions."""
_AXES: list[Matrix] = [np.array(skew(axis)) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
_UNIT = np.eye(3)
_UPPER = ((0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2))
"""Rows and columns of a symmetric matrix, in the order of ``Parameters.inertia_error_kgm2``."""


@final
class Unobservable:
    """The directions that a filter cannot observe: turns and factor, or the factor alone.

    ``moved``: the m components of the error state in which the directions depend on the estimate; they depend
    on these components alone. ``moving`` (m, m k): what each of the k directions, (m, k) by rows, gains there
    per unit of each. ``coordinates`` (k, n): W^T, its last row, the factor's, times the trace of the inertia;
    ``trace_kgm2``: that trace, by the table.
    """

    __slots__ = ("coordinates", "moved", "moving", "trace_kgm2")

    def __init__(self, moved: slice, moving: Matrix, coordinates: Matrix, trace_kgm2: float) -> None:
        self.moved = moved
        self.moving = moving
        self.coordinates = coordinates
        self.trace_kgm2 = trace_kgm2


def unobservable(parts: Layout, variances: list[float], rotor: Rotor) -> Unobservable | None:
    """Which directions a filter cannot observe; None where there is none.

    Args:
        parts: layout of its error state.
        variances: of the error state, a priori.
        rotor: by the table.
    """

    def free(place: slice | None) -> bool:
        return place is not None and min(variances[place]) > 0.0

    if parts.inertia is None or not (free(parts.inertia) and free(parts.coils)):
        return None
    if rotor.wheel_body_nms != ZERO:
        return None
    coordinates = np.zeros((FACTOR + 1, parts.size))
    coordinates[FACTOR, parts.inertia] = (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    turns = free(parts.mag_turn) and free(parts.sun_turn)
    if turns:
        coordinates[TURNS, parts.sun_turn] = _UNIT
    given = slice(0 if turns else FACTOR, FACTOR + 1)
    nominal = unobservable_directions(ZERO, NOTHING, rotor, parts)
    gained = []
    for error in map(tuple, np.eye(parts.size).tolist()):
        parameters = NOTHING.copy()
        correct_parameters(parameters, error, parts)
        gained.append(unobservable_directions((error[3], error[4], error[5]), parameters, rotor, parts))
    moved = slice(3, parts.inertia.stop)
    moving = np.array([(directions - nominal)[moved, given].ravel() for directions in gained[moved]])
    trace_kgm2 = float(np.trace(rotor.inertia_kgm2))
    return Unobservable(moved, moving, coordinates[given].copy(), trace_kgm2)


def turned_along(
    covariance: Matrix, error: tuple[float, ...], inertia_error_kgm2: Symmetric, directions: Unobservable
) -> Matrix:
    """The covariance of a corrected estimate, turned with the directions that no sample shows.

    Args:
        covariance: after the correction, but along the directions before it, (n, n).
        error: the correction, (n).
        inertia_error_kgm2: as estimated before.
        directions: those of the filter.
    """
    xx, yy, zz, _, _, _ = inertia_error_kgm2
    factor = 1.0 / (directions.trace_kgm2 + xx + yy + zz)
    return turn_along(
        covariance, error, directions.moved.start, factor, directions.coordinates, directions.moving
    )


def unobservable_directions(
    omega_body_radps: Vec3, parameters: Parameters, nominal: Rotor, parts: Layout
) -> Matrix:
    """What the error state changes by, (n, 4): for a turn of 1 rad about each axis, and a factor of 1 + 1.

    Args:
        omega_body_radps: inertial rate.
        parameters: as estimated; inertia and coils are among those carried.
        nominal: inertia by the table.
        parts: layout of the error state.
    """
    inertia = np.array(estimated_inertia(nominal, parameters))
    coils = _UNIT + np.reshape(parameters.coil_error, (3, 3))
    vectors = ((parts.dipole, parameters.dipole_body_am2), (parts.torque, parameters.torque_body_nm))
    change = np.zeros((parts.size, FACTOR + 1))
    change[0:3, TURNS] = -_UNIT
    for place in (parts.mag_turn, parts.sun_turn):
        if place is not None:
            change[place, TURNS] = _UNIT
    for axis, turning in enumerate(_AXES):
        change[3:6, axis] = turning.dot(omega_body_radps)
        change[parts.inertia, axis] = (turning.dot(inertia) - inertia.dot(turning))[_UPPER]
        change[parts.coils, axis] = turning.dot(coils).ravel()
        for place, vector in vectors:
            if place is not None:
                change[place, axis] = turning.dot(vector)
    change[parts.inertia, FACTOR], change[parts.coils, FACTOR] = inertia[_UPPER], coils.ravel()
    for place, vector in vectors:
        if place is not None:
            change[place, FACTOR] = vector
    return change
