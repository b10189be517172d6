"""The calibration of sensors and coil driver: from what the boards count to body axes, and back.

Magnetometer: b_body = M (z - o), z the reading, o its offset; M may mirror, as wrongly wired axes do. Sun
sensor: s_body = R z. Coil driver: each of its three outputs drives the coil along one body axis, in one of
two senses. Beyond this module coil j is the coil along body axis j, with the sense of that axis. Its gain and
its true axis are in ``coil_axes`` of the actuation. A current without a level stays as the board reads it,
in the sense of the output: the status does not tell in which coil it flows.
"""

from dataclasses import dataclass
from typing import NamedTuple

from fsw.core.algebra.vector import Mat3, Vec3, sub, transform, transpose
from fsw.core.gate.readings import Readings
from fsw.wire.messages import (
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilRefused,
    CoilStatus,
    MagField,
    SunVector,
)


class MagnetometerCalibration(NamedTuple):
    """b_body = ``matrix`` (z - ``offset_nt``), nT; z saturates beyond ``range_nt``."""

    offset_nt: Vec3
    matrix: Mat3
    range_nt: float


class Outputs(NamedTuple):
    """By output of the coil driver, the body axis of its coil, and the sense: +1 or -1."""

    axis: tuple[int, int, int]
    sign: tuple[int, int, int]

    def of_axis(self, axis: int) -> int:
        """The output that drives the coil along a body axis."""
        return self.axis.index(axis)


@dataclass(frozen=True, slots=True)
class Calibration:
    """None: as the boards send it."""

    magnetometer: MagnetometerCalibration | None = None
    sun: Mat3 | None = None
    outputs: Outputs | None = None


NO_CALIBRATION = Calibration()


def calibrated(readings: Readings, calibration: Calibration) -> Readings:
    """The readings in body axes, those of the coil driver by coil axis."""
    if calibration is NO_CALIBRATION:
        return readings
    field, sun, outputs = readings.field, readings.sun, calibration.outputs
    if field is not None and calibration.magnetometer is not None:
        readings = readings._replace(
            field=_body_field(field, calibration.magnetometer),
            saturated=() if field.valid else _saturated(field, calibration.magnetometer),
        )
    if sun is not None and calibration.sun is not None:
        readings = readings._replace(sun=_body_sun(sun, calibration.sun))
    return readings if outputs is None else _by_axis(readings, outputs)


def _body_field(sample: MagField, calibration: MagnetometerCalibration) -> MagField:
    x, y, z = transform(calibration.matrix, sub((sample.b_x, sample.b_y, sample.b_z), calibration.offset_nt))
    return MagField(sample.valid, x, y, z, sample.counter)


def _saturated(sample: MagField, calibration: MagnetometerCalibration) -> tuple[Vec3, ...]:
    """Of each axis at the end of its range, what a unit of its reading is in body axes."""
    columns = zip((sample.b_x, sample.b_y, sample.b_z), transpose(calibration.matrix), strict=True)
    return tuple([column for reading, column in columns if abs(reading) >= calibration.range_nt])


def _body_sun(sample: SunVector, body_from_sensor: Mat3) -> SunVector:
    x, y, z = transform(body_from_sensor, (sample.s_x, sample.s_y, sample.s_z))
    return SunVector(sample.valid, x, y, z, sample.counter)


def _by_axis(readings: Readings, outputs: Outputs) -> Readings:
    coil, refused, dipole = readings.coil, readings.refused, readings.dipole
    if coil is not None:
        sign = outputs.sign[coil.coil]
        current_ma = sign * coil.current_ma if coil.level else coil.current_ma
        coil = CoilStatus(
            level=sign * coil.level,
            coil=outputs.axis[coil.coil],
            remaining_ms=coil.remaining_ms,
            current_ma=current_ma,
            lockout_ms=coil.lockout_ms,
            seq=coil.seq,
            counter=coil.counter,
        )
    if refused is not None and refused.coil < len(outputs.axis):
        coil_axis = outputs.axis[refused.coil]
        refused = CoilRefused(coil_axis, refused.seq, refused.reason, refused.tick, refused.counter)
    if dipole is not None:
        driven = (dipole.m_x, dipole.m_y, dipole.m_z)
        x, y, z = (outputs.sign[o] * driven[o] for o in map(outputs.of_axis, range(3)))
        dipole = CoilDipoleStatus(x, y, z, dipole.counter)
    return readings._replace(coil=coil, refused=refused, dipole=dipole)


def for_outputs(request: CoilFire | CoilDipole, calibration: Calibration) -> CoilFire | CoilDipole:
    """A request by coil axis, converted to one for the outputs of the coil driver."""
    outputs = calibration.outputs
    if outputs is None:
        return request
    if isinstance(request, CoilFire):
        output = outputs.of_axis(request.coil)
        level = outputs.sign[output] * request.level
        return CoilFire(level, output, request.seq, request.tick, request.duration_ms, request.counter)
    wanted = (request.m_x, request.m_y, request.m_z)
    x, y, z = (sign * wanted[axis] for axis, sign in zip(*outputs, strict=True))
    return CoilDipole(x, y, z, request.counter)
