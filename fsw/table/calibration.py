"""The calibration of a table: the section of its file, and what the core uses of it.

A key that is left out, or that repeats what holds without it, changes nothing and costs nothing.
"""

from dataclasses import replace
from itertools import permutations
from math import ceil, floor, sqrt
from typing import Self

from pydantic import Field, model_validator

from fsw.core.actuation.own_field import OwnField
from fsw.core.algebra.vector import Mat3, Vec3, dot, inverse, norm, product, scale, transpose
from fsw.core.gate.calibration import NO_CALIBRATION, Calibration, MagnetometerCalibration, Outputs
from fsw.core.laws.plan.pulse_model import AXES
from fsw.input.schema import Section, Square, Triple
from fsw.table.sections import CoilTable

NO_FIELD: Mat3 = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
NO_OFFSET: Vec3 = (0.0, 0.0, 0.0)
LEAST_GAIN, LARGEST_GAIN = 0.2, 5.0
"""Of what is calibrated, as a fraction of the nominal."""
NEAR_AXIS = sqrt(0.5)
"""Least cosine between a coil and the body axis that it serves."""
ORTHONORMAL = 1e-3
UNCHANGED = Outputs((0, 1, 2), (1, 1, 1))
LEAST_RANGE_NT, ORDINARY_RANGE_NT, BUS_RANGE_NT = 20000.0, 65000.0, 65534.0
"""Largest readings: the least that a table may state (the weakest field of an orbit), the one assumed where
it states none, and the one that the message carries."""
EDGE_TICKS = 0.05
"""A delay this close to a whole number of ticks counts as that number."""


class MagnetometerTable(Section):
    """b_body = matrix (reading - offset_nt): offset; scale, non-orthogonality and misalignment as one matrix.

    Beyond a reading of ``range_nt`` an axis saturates; None: as ordinary magnetometers do.
    """

    offset_nt: Triple = NO_OFFSET
    matrix: Square = AXES
    range_nt: float | None = Field(default=None, ge=LEAST_RANGE_NT, le=BUS_RANGE_NT)

    @property
    def most_nt(self) -> float:
        """The largest reading of an axis."""
        return self.range_nt or ORDINARY_RANGE_NT

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        if max(map(abs, self.offset_nt)) > 2e5:
            raise ValueError("offset_nt must be three numbers from -200000 to 200000")
        if not all(LEAST_GAIN < norm(row) < LARGEST_GAIN for row in self.matrix) or _flat(self.matrix):
            raise ValueError(
                f"matrix must be regular, its rows {LEAST_GAIN:g} to {LARGEST_GAIN:g} long: nT of the body "
                "axes by nT of the reading"
            )
        return self


def _flat(matrix: Mat3) -> bool:
    """Whether the rows lie nearly in a plane."""
    a, b, c = (scale(1.0 / norm(row), row) for row in matrix)
    (p, q, r), (s, t, u), (v, w, x) = a, b, c
    return abs(p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v)) < 0.2


class CoilsTable(Section):
    """Column j of ``matrix``: the dipole, body axes, of a nominal 1 A m^2 of output j of the coil driver.

    Column j of ``field_nt_per_am2`` is its field at the magnetometer, body axes; a sample shows it
    ``field_delay_s`` late.
    """

    matrix: Square | None = None
    field_nt_per_am2: Square | None = None
    field_delay_s: float | None = Field(default=None, ge=0.0, le=60.0)

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        if self.matrix is not None:
            outputs_of(self.matrix)
        if self.field_delay_s is not None and self.field_nt_per_am2 is None:
            raise ValueError("field_delay_s needs field_nt_per_am2")
        return self


class SunTable(Section):
    """s_body = matrix s: the orientation of the Sun sensor, which may include a reflection."""

    matrix: Square = AXES

    @model_validator(mode="after")
    def _is_orthonormal(self) -> Self:
        squared = product(self.matrix, transpose(self.matrix))
        off = max(
            abs(x - y)
            for one, other in zip(squared, AXES, strict=True)
            for x, y in zip(one, other, strict=True)
        )
        if off > ORTHONORMAL:
            raise ValueError("matrix must be orthonormal: its rows are the body axes in those of the sensor")
        return self


class CalibrationTable(Section):
    """What was measured of the sensors and coils of this particular satellite."""

    magnetometer: MagnetometerTable | None = None
    coils: CoilsTable | None = None
    sun: SunTable | None = None


def outputs_of(matrix: Mat3) -> Outputs:
    """Which axis each output serves, and in which sense.

    Raises:
        ValueError: the coils are not three, each nearest to an axis of its own, within 45 deg.
    """
    columns = transpose(matrix)
    for axes in permutations(range(3)):
        along = [dot(column, AXES[axis]) for column, axis in zip(columns, axes, strict=True)]
        lengths = [norm(column) for column in columns]
        if all(
            abs(part) > NEAR_AXIS * length and LEAST_GAIN < length < LARGEST_GAIN
            for part, length in zip(along, lengths, strict=True)
        ):
            first, second, third = (1 if part > 0.0 else -1 for part in along)
            return Outputs((axes[0], axes[1], axes[2]), (first, second, third))
    raise ValueError(
        "matrix must have a column for each coil, its dipole per nominal one: each along a body axis of its "
        f"own within 45 deg, and {LEAST_GAIN:g} to {LARGEST_GAIN:g} long"
    )


def largest_field_nt(offset_nt: Vec3, matrix: Mat3, range_nt: float) -> float:
    """The strongest field that saturates no axis, whatever its direction; negative if there is none."""
    sensed = inverse(matrix)
    return min((range_nt - abs(offset)) / norm(row) for offset, row in zip(offset_nt, sensed, strict=True))


def calibration(table: CalibrationTable) -> Calibration:
    """What the core applies to samples and requests."""
    magnetometer, coils, sun = table.magnetometer, table.coils, table.sun
    found = NO_CALIBRATION
    if magnetometer is not None and magnetometer != MagnetometerTable():
        of_field = MagnetometerCalibration(magnetometer.offset_nt, magnetometer.matrix, magnetometer.most_nt)
        found = replace(found, magnetometer=of_field)
    if sun is not None and sun != SunTable():
        found = replace(found, sun=sun.matrix)
    if coils is not None and coils.matrix is not None and outputs_of(coils.matrix) != UNCHANGED:
        found = replace(found, outputs=outputs_of(coils.matrix))
    return found


def coil_axes(table: CoilsTable | None) -> Mat3:
    """By body axis, the dipole per nominal one of the coil that serves it, body axes."""
    return AXES if table is None or table.matrix is None else _by_axis(table.matrix, outputs_of(table.matrix))


def stray_axes(table: CoilsTable | None) -> Mat3:
    """As ``coil_axes``, but in the sense of the output, which a current without a level has."""
    if table is None or table.matrix is None:
        return AXES
    columns, outputs = transpose(table.matrix), outputs_of(table.matrix)
    first, second, third = (columns[output] for output in map(outputs.of_axis, range(3)))
    return first, second, third


def own_field(table: CoilsTable | None, coils: CoilTable, tick_hz: int) -> OwnField | None:
    """The own field of pulsed coils, None where the table has none."""
    if table is None or table.field_nt_per_am2 is None:
        return None
    outputs = outputs_of(table.matrix or AXES)
    late = (table.field_delay_s or 0.0) * tick_hz
    return OwnField(
        field_nt_per_am2=transpose(_by_axis(table.field_nt_per_am2, outputs)),
        newest=floor(late + EDGE_TICKS),
        oldest=max(0, ceil(late - EDGE_TICKS)),
        levels_am2=coils.levels_am2,
        current_ma=coils.levels_ma,
    )


def _by_axis(matrix: Mat3, outputs: Outputs) -> Mat3:
    """The columns of a matrix of the outputs, for a nominal dipole along each axis."""
    columns = transpose(matrix)
    first, second, third = (
        scale(outputs.sign[output], columns[output]) for output in map(outputs.of_axis, range(3))
    )
    return first, second, third
