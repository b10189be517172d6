"""What the filter estimates besides attitude and rate: constants that the table knows only within bounds."""

from dataclasses import dataclass, fields, replace
from math import nan
from typing import Any, ClassVar, Final, final

from fsw.core.algebra.vector import ZERO, Mat3, Vec3, add, symmetric_inverse
from fsw.wire.value import Value

Matrix3x3 = tuple[float, float, float, float, float, float, float, float, float]
Symmetric = tuple[float, float, float, float, float, float]

UNCHANGED_COILS: Matrix3x3 = (0.0,) * 9
UNCHANGED_INERTIA: Symmetric = (0.0,) * 6
MOST_CELLS: Final = 6
ATTITUDE_AND_RATE: Final = 6
"""How many numbers of the error state come before the parameters."""
NO_NUMBERS: Mat3 = ((nan, nan, nan),) * 3


@final
@dataclass(slots=True)
class Parameters:
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

    def copy(self) -> "Parameters":
        """Parameters with the same values."""
        return Parameters(
            self.mag_bias_t,
            self.torque_body_nm,
            self.dipole_body_am2,
            self.coil_error,
            self.inertia_error_kgm2,
            self.mag_turn_rad,
            self.mag_scale,
            self.sun_turn_rad,
            self.delay_s,
            self.cell_excess,
            self.cell_gain,
            self.earth_light,
        )

    def floats(self) -> tuple[float, ...]:
        """Every component, in the order of its number on the bus."""
        b1, b2, b3 = self.mag_bias_t
        t1, t2, t3 = self.torque_body_nm
        d1, d2, d3 = self.dipole_body_am2
        g11, g12, g13, g21, g22, g23, g31, g32, g33 = self.coil_error
        xx, yy, zz, xy, xz, yz = self.inertia_error_kgm2
        m1, m2, m3 = self.mag_turn_rad
        c1, c2, c3 = self.mag_scale
        s1, s2, s3 = self.sun_turn_rad
        of_field, of_sun = self.delay_s
        first = (b1, b2, b3, t1, t2, t3, d1, d2, d3, g11, g12, g13, g21, g22, g23, g31, g32, g33)
        others = (xx, yy, zz, xy, xz, yz, m1, m2, m3, c1, c2, c3, s1, s2, s3, of_field, of_sun)
        return first + others + self.cell_excess + self.cell_gain + self.earth_light

    def total(self) -> float:
        """The sum of all components: no number unless each is one."""
        g11, g12, g13, g21, g22, g23, g31, g32, g33 = self.coil_error
        xx, yy, zz, xy, xz, yz = self.inertia_error_kgm2
        total = _sum(self.mag_bias_t) + _sum(self.torque_body_nm) + _sum(self.dipole_body_am2)
        total += g11 + g12 + g13 + g21 + g22 + g23 + g31 + g32 + g33 + xx + yy + zz + xy + xz + yz
        total += _sum(self.mag_turn_rad) + _sum(self.mag_scale) + _sum(self.sun_turn_rad)
        total += self.delay_s[0] + self.delay_s[1]
        return total + _sum_of(self.cell_excess) + _sum_of(self.cell_gain) + _sum_of(self.earth_light)


def _sum(v: Vec3) -> float:
    return v[0] + v[1] + v[2]


def _sum_of(numbers: tuple[float, ...]) -> float:
    total = 0.0
    for place in range(len(numbers)):
        total += numbers[place]
    return total


NOTHING = Parameters()
"""A satellite that is as its table says, as far as is known."""

NAMES = tuple([field.name for field in fields(Parameters)])
OF_CELLS = {"cell_excess": MOST_CELLS, "cell_gain": MOST_CELLS, "earth_light": 1}
"""Parameters of a satellite with Sun cells, and how many numbers each has."""
SIZES = {**{name: len(getattr(NOTHING, name)) for name in NAMES}, **OF_CELLS}
"""How many numbers each has if it is carried."""
COMPONENTS = tuple([(name, offset) for name in NAMES for offset in range(SIZES[name])])
"""Of each component, by its number on the bus: the name of its parameter, and its place within that."""


@final
@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of a parameter a priori, by component: standard deviation, random walk, and mean.

    The walk is per square root of a second; an empty mean is zero.
    """

    sigma: tuple[float, ...]
    walk: tuple[float, ...]
    mean: tuple[float, ...] = ()


@final
@dataclass(frozen=True, slots=True)
class Layout:
    """Where each carried parameter stands in the error state; None where it is not carried.

    ``carried``: of each one carried, its name and its place in the error state; ``components``: the number of
    each component carried; both in the order of the error state.
    """

    size: int
    carried: tuple[tuple[str, slice], ...]
    components: tuple[int, ...]
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
    size = ATTITUDE_AND_RATE
    for name, length in SIZES.items():
        places.append(slice(size, size + length) if name in carried else None)
        size += length if name in carried else 0
    known = tuple([(name, place) for name, place in zip(NAMES, places, strict=True) if place is not None])
    components = tuple([number for number, (name, _) in enumerate(COMPONENTS) if name in carried])
    return Layout(size, known, components, *places)


def correct_parameters(parameters: Parameters, error: tuple[float, ...], places: Layout) -> None:
    """Add to the parameters their part of an error state."""
    at = ATTITUDE_AND_RATE
    if places.mag_bias is not None:
        parameters.mag_bias_t = _moved(parameters.mag_bias_t, error, at)
        at += 3
    if places.torque is not None:
        parameters.torque_body_nm = _moved(parameters.torque_body_nm, error, at)
        at += 3
    if places.dipole is not None:
        parameters.dipole_body_am2 = _moved(parameters.dipole_body_am2, error, at)
        at += 3
    if places.coils is not None:
        g11, g12, g13, g21, g22, g23, g31, g32, g33 = parameters.coil_error
        parameters.coil_error = (
            g11 + error[at],
            g12 + error[at + 1],
            g13 + error[at + 2],
            g21 + error[at + 3],
            g22 + error[at + 4],
            g23 + error[at + 5],
            g31 + error[at + 6],
            g32 + error[at + 7],
            g33 + error[at + 8],
        )
        at += 9
    if places.inertia is not None:
        xx, yy, zz, xy, xz, yz = parameters.inertia_error_kgm2
        parameters.inertia_error_kgm2 = (
            xx + error[at],
            yy + error[at + 1],
            zz + error[at + 2],
            xy + error[at + 3],
            xz + error[at + 4],
            yz + error[at + 5],
        )
        at += 6
    if places.mag_turn is not None:
        parameters.mag_turn_rad = _moved(parameters.mag_turn_rad, error, at)
        at += 3
    if places.mag_scale is not None:
        parameters.mag_scale = _moved(parameters.mag_scale, error, at)
        at += 3
    if places.sun_turn is not None:
        parameters.sun_turn_rad = _moved(parameters.sun_turn_rad, error, at)
        at += 3
    if places.delay is not None:
        of_field, of_sun = parameters.delay_s
        parameters.delay_s = (of_field + error[at], of_sun + error[at + 1])
        at += 2
    if places.cells is not None:
        parameters.cell_excess = _all_moved(parameters.cell_excess, error, at)
        at += MOST_CELLS
    if places.cell_gain is not None:
        parameters.cell_gain = _all_moved(parameters.cell_gain, error, at)
        at += MOST_CELLS
    if places.earth_light is not None:
        parameters.earth_light = _all_moved(parameters.earth_light, error, at)


def _moved(v: Vec3, error: tuple[float, ...], at: int) -> Vec3:
    x, y, z = v
    return (x + error[at], y + error[at + 1], z + error[at + 2])


def _all_moved(values: tuple[float, ...], error: tuple[float, ...], at: int) -> tuple[float, ...]:
    return tuple([value + error[at + place] for place, value in enumerate(values)])


def difference(before: Parameters, after: Parameters, places: Layout) -> list[float]:
    """What was added to the parameters that are carried, in the order of the error state."""
    were, are = before.floats(), after.floats()
    return [are[number] - were[number] for number in places.components]


def component_places(places: Layout) -> dict[int, int]:
    """By the number of each component that is carried, its place in the error state; in the order of both."""
    return {number: place for place, number in enumerate(places.components, ATTITUDE_AND_RATE)}


def component(parameters: Parameters, number: int) -> float:
    """One component; zero where the satellite has no such parameter."""
    name, offset = COMPONENTS[number]
    part: tuple[float, ...] = getattr(parameters, name)
    return part[offset] if part else 0.0


def with_component(parameters: Parameters, number: int, value: float) -> Parameters:
    """The parameters with another value of one component."""
    name, offset = COMPONENTS[number]
    part = list(getattr(parameters, name) or (0.0,) * SIZES[name])
    part[offset] = value
    changed: dict[str, Any] = {name: tuple(part)}
    return replace(parameters, **changed)


@final
class Rotor(Value):
    """What turns: inertia tensor and its inverse, momentum of a wheel; body axes."""

    FIELDS: ClassVar[tuple[str, ...]] = ("inertia_kgm2", "inertia_inverse", "wheel_body_nms")
    __slots__ = FIELDS

    def __init__(self, inertia_kgm2: Mat3, inertia_inverse: Mat3, wheel_body_nms: Vec3) -> None:
        self.inertia_kgm2 = inertia_kgm2
        self.inertia_inverse = inertia_inverse
        self.wheel_body_nms = wheel_body_nms


def with_momentum(rotor: Rotor, momentum_body_nms: Vec3) -> Rotor:
    """The rotor with the momentum of a driven wheel beside a constant one."""
    wheel_body_nms = add(rotor.wheel_body_nms, momentum_body_nms)
    return Rotor(rotor.inertia_kgm2, rotor.inertia_inverse, wheel_body_nms)


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
