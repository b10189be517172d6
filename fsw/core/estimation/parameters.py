"""What the filter estimates besides attitude and rate: constants that the table knows only within bounds."""

from dataclasses import dataclass
from math import nan
from typing import Any, NamedTuple

from fsw.core.algebra.vector import ZERO, Mat3, Vec3, symmetric_inverse

Matrix3x3 = tuple[float, float, float, float, float, float, float, float, float]
Symmetric = tuple[float, float, float, float, float, float]

UNCHANGED_COILS: Matrix3x3 = (0.0,) * 9
UNCHANGED_INERTIA: Symmetric = (0.0,) * 6
MOST_CELLS = 6
NO_NUMBERS: Mat3 = ((nan, nan, nan),) * 3


class Parameters(NamedTuple):
    """How the satellite differs from its table; zero: not at all.

    Attributes:
        mag_bias_t: bias of the magnetometer, T.
        torque_body_nm: disturbance torque, N m, body axes.
        dipole_body_am2: residual dipole, A m^2, body axes.
        coil_error: G by rows, the coils' dipole being (1 + G) times the one driven, body axes.
        inertia_error_kgm2: xx, yy, zz, xy, xz, yz of the inertia tensor less the table's, body axes.
        mag_turn_rad: misalignment of the magnetometer, a small rotation of its axes from the body's, rad.
        mag_scale: relative error of its scale, by axis.
        sun_turn_rad: misalignment of the Sun sensor, rad.
        delay_s: age of the samples of magnetometer and Sun sensor, s.
        cell_excess: what each Sun cell shows beyond its model, as a fraction of full sunlight; empty, as are
            the next two, for a satellite with a Sun sensor instead.
        cell_gain: relative error of the gain of each.
        earth_light: error of the albedo: fraction of the sunlight that the Earth reflects beyond the table's.
    """

    mag_bias_t: Vec3 = ZERO
    torque_body_nm: Vec3 = ZERO
    dipole_body_am2: Vec3 = ZERO
    coil_error: Matrix3x3 = UNCHANGED_COILS
    inertia_error_kgm2: Symmetric = UNCHANGED_INERTIA
    mag_turn_rad: Vec3 = ZERO
    mag_scale: Vec3 = ZERO
    sun_turn_rad: Vec3 = ZERO
    delay_s: tuple[float, float] = (0.0, 0.0)
    cell_excess: tuple[float, ...] = ()
    cell_gain: tuple[float, ...] = ()
    earth_light: tuple[float, ...] = ()

    def floats(self) -> tuple[float, ...]:
        """Every component, in the order of its number on the bus; for the checksum of the state too."""
        return (
            *self.mag_bias_t,
            *self.torque_body_nm,
            *self.dipole_body_am2,
            *self.coil_error,
            *self.inertia_error_kgm2,
            *self.mag_turn_rad,
            *self.mag_scale,
            *self.sun_turn_rad,
            *self.delay_s,
            *self.cell_excess,
            *self.cell_gain,
            *self.earth_light,
        )


NOTHING = Parameters()
"""A satellite that is as its table says, as far as is known."""

NAMES = Parameters._fields
OF_CELLS = {"cell_excess": MOST_CELLS, "cell_gain": MOST_CELLS, "earth_light": 1}
"""Parameters of a satellite with Sun cells, and how many numbers each has."""
SIZES = {**dict(zip(NAMES, map(len, NOTHING), strict=True)), **OF_CELLS}
"""How many numbers each has if it is carried."""
COMPONENTS = tuple((index, offset) for index, name in enumerate(NAMES) for offset in range(SIZES[name]))
"""Of each component, by its number on the bus: the index of its parameter, and its place within that."""


class Prior(NamedTuple):
    """What is known of a parameter a priori, by component: standard deviation, random walk, and mean.

    The walk is per square root of a second; an empty mean is zero.
    """

    sigma: tuple[float, ...]
    walk: tuple[float, ...]
    mean: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Layout:
    """Where each carried parameter stands in the error state; None where it is not carried.

    ``carried``: of each one carried, its place among the ``Parameters`` and in the error state.
    """

    size: int
    carried: tuple[tuple[int, slice], ...]
    mag_bias: slice | None
    torque: slice | None
    dipole: slice | None
    coils: slice | None
    inertia: slice | None
    mag_turn: slice | None
    mag_scale: slice | None
    sun_turn: slice | None
    delay: slice | None
    cells: slice | None
    cell_gain: slice | None
    earth_light: slice | None


def layout(carried: set[str]) -> Layout:
    """The error state with these parameters after attitude and rate, in the order of ``Parameters``.

    Args:
        carried: names of fields of ``Parameters``.
    """
    places: list[slice | None] = []
    size = 6
    for name, length in SIZES.items():
        places.append(slice(size, size + length) if name in carried else None)
        size += length if name in carried else 0
    known = tuple((index, place) for index, place in enumerate(places) if place is not None)
    return Layout(size, known, *places)


def corrected_parameters(parameters: Parameters, error: list[float], places: Layout) -> Parameters:
    """The parameters plus their part of an error state."""
    parts = list(parameters)
    for index, place in places.carried:
        parts[index] = tuple(map(float.__add__, parts[index], error[place]))
    return Parameters._make(parts)


def added(before: Parameters, after: Parameters, places: Layout) -> list[float]:
    """What was added to the parameters that are carried, in the order of the error state."""
    return [
        now - was for index, _ in places.carried for was, now in zip(before[index], after[index], strict=True)
    ]


def component_places(places: Layout) -> dict[int, int]:
    """By the number of each component that is carried, its place in the error state; in the order of both."""
    parts = dict(places.carried)
    return {
        number: parts[index].start + offset
        for number, (index, offset) in enumerate(COMPONENTS)
        if index in parts
    }


def with_component(parameters: Parameters, number: int, value: float) -> Parameters:
    """The parameters with another value of one component."""
    index, offset = COMPONENTS[number]
    part = list(parameters[index] or (0.0,) * SIZES[NAMES[index]])
    part[offset] = value
    changed: dict[str, Any] = {NAMES[index]: tuple(part)}
    return parameters._replace(**changed)


class Rotor(NamedTuple):
    """What turns: inertia tensor and its inverse, momentum of a wheel; body axes."""

    inertia_kgm2: Mat3
    inertia_inverse: Mat3
    wheel_body_nms: Vec3


def estimated_inertia(nominal: Rotor, parameters: Parameters) -> Mat3:
    """The inertia tensor with its estimated error, body axes, kg m^2."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = nominal.inertia_kgm2
    by_xx, by_yy, by_zz, by_xy, by_xz, by_yz = parameters.inertia_error_kgm2
    xy, xz, yz = xy + by_xy, xz + by_xz, yz + by_yz
    return ((xx + by_xx, xy, xz), (xy, yy + by_yy, yz), (xz, yz, zz + by_zz))


def estimated_rotor(nominal: Rotor, parameters: Parameters) -> Rotor:
    """The rotor with the estimated error of its inertia; the inverse of a singular one is NaN.

    Such an estimate is no longer healthy after a prediction, and the filter restarts.
    """
    inertia = estimated_inertia(nominal, parameters)
    try:
        inverse = symmetric_inverse(inertia)
    except ZeroDivisionError:
        inverse = NO_NUMBERS
    return Rotor(inertia, inverse, nominal.wheel_body_nms)


def estimated_dipole(m_driven_am2: Vec3, parameters: Parameters) -> Vec3:
    """The dipole m = (1 + G) m_driven + d, body axes, A m^2."""
    x, y, z = m_driven_am2
    g11, g12, g13, g21, g22, g23, g31, g32, g33 = parameters.coil_error
    d1, d2, d3 = parameters.dipole_body_am2
    return (
        x + d1 + g11 * x + g12 * y + g13 * z,
        y + d2 + g21 * x + g22 * y + g23 * z,
        z + d3 + g31 * x + g32 * y + g33 * z,
    )
