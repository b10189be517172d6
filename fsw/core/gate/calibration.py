"""The calibration of sensors and coil driver: from what the boards count to body axes, and back.

Magnetometer: b_body = M (z - o), z the reading, o its offset; M may mirror, as wrongly wired axes do. Sun
sensor: s_body = R z. Coil driver: each of its three outputs drives the coil along one body axis, in one of
two senses. Beyond this module coil j is the coil along body axis j, with the sense of that axis. Its gain and
its true axis are in ``coil_axes`` of the actuation. A current without a level stays as the board reads it,
in the sense of the output: the status does not tell in which coil it flows.
"""

from dataclasses import dataclass

from fsw.core.algebra.vector import Mat3, Vec3, sub, transform, transpose
from fsw.core.gate.measurements import (
    CellReading,
    CoilReport,
    FieldReading,
    Measurements,
    ReferenceReading,
    Refusal,
    SunReading,
    WheelReading,
)
from fsw.core.gate.readings import Readings
from fsw.wire.messages import CoilDipole, CoilFire, CoilRefused, MagField


@dataclass(frozen=True, slots=True)
class MagnetometerCalibration:
    """b_body = ``matrix`` (z - ``offset_nt``), nT; z saturates beyond ``range_nt``."""

    offset_nt: Vec3
    matrix: Mat3
    range_nt: float


@dataclass(frozen=True, slots=True)
class Outputs:
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


def measure(readings: Readings, calibration: Calibration) -> Measurements:
    """What was sent, in body axes, that of the coil driver by coil axis."""
    measurements = Measurements()
    _measure_field(measurements, readings.field, calibration.magnetometer)
    _measure_sun(measurements, readings, calibration.sun)
    _measure_coils(measurements, readings, calibration.outputs)
    if readings.wheel is not None:
        measurements.wheel = WheelReading(readings.wheel.valid != 0, readings.wheel.speed)
    attitude, rate = readings.ref_attitude, readings.ref_rate
    if attitude is not None:
        q_vector = (attitude.q_x, attitude.q_y, attitude.q_z)
        measurements.ref_attitude = ReferenceReading(attitude.valid != 0, q_vector)
    if rate is not None:
        measurements.ref_rate = ReferenceReading(rate.valid != 0, (rate.w_x, rate.w_y, rate.w_z))
    if readings.end is not None:
        measurements.end_ticks = readings.end.ticks
    measurements.telecommands, measurements.repeated = readings.telecommands, readings.repeated
    measurements.under_own_id = readings.under_own_id
    return measurements


def _measure_field(
    measurements: Measurements, sample: MagField | None, calibration: MagnetometerCalibration | None
) -> None:
    if sample is None:
        return
    valid, b_nt = sample.valid != 0, (sample.b_x, sample.b_y, sample.b_z)
    if calibration is not None:
        if not valid:
            measurements.saturated = _saturated(b_nt, calibration)
        b_nt = transform(calibration.matrix, sub(b_nt, calibration.offset_nt))
    measurements.field = FieldReading(valid, b_nt)


def _saturated(b_nt: Vec3, calibration: MagnetometerCalibration) -> tuple[Vec3, ...]:
    """Of each axis at the end of its range, what a unit of its reading is in body axes."""
    columns = transpose(calibration.matrix)
    return tuple([columns[axis] for axis in range(3) if abs(b_nt[axis]) >= calibration.range_nt])


def _measure_sun(measurements: Measurements, readings: Readings, body_from_sensor: Mat3 | None) -> None:
    sun, cells = readings.sun, readings.cells
    if sun is not None:
        s = (sun.s_x, sun.s_y, sun.s_z)
        s_body = s if body_from_sensor is None else transform(body_from_sensor, s)
        measurements.sun = SunReading(sun.valid != 0, s_body)
    if cells is not None:
        currents = (cells.cell_1, cells.cell_2, cells.cell_3, cells.cell_4, cells.cell_5, cells.cell_6)
        measurements.cells = CellReading(cells.valid != 0, currents)


def _measure_coils(measurements: Measurements, readings: Readings, outputs: Outputs | None) -> None:
    coil, dipole = readings.coil, readings.dipole
    if coil is not None:
        axis, sign = (coil.coil, 1) if outputs is None else (outputs.axis[coil.coil], outputs.sign[coil.coil])
        current_ma = sign * coil.current_ma if coil.level else coil.current_ma
        measurements.coil = CoilReport(
            sign * coil.level, axis, coil.remaining_ms, current_ma, coil.lockout_ms, coil.seq
        )
    measurements.refused = tuple([_refusal(refused, outputs) for refused in readings.refused])
    if dipole is not None:
        driven = (dipole.m_x, dipole.m_y, dipole.m_z)
        measurements.dipole = driven if outputs is None else _dipole_by_axis(driven, outputs)
    measurements.coil_booted = readings.coil_boot is not None


def _refusal(refused: CoilRefused, outputs: Outputs | None) -> Refusal:
    """By coil axis; the board names what was requested, and that may be no output."""
    axis = refused.coil
    if outputs is not None and axis < len(outputs.axis):
        axis = outputs.axis[axis]
    return Refusal(axis, refused.seq, refused.reason, refused.tick)


def _dipole_by_axis(driven: Vec3, outputs: Outputs) -> Vec3:
    a, b, c = outputs.of_axis(0), outputs.of_axis(1), outputs.of_axis(2)
    return (outputs.sign[a] * driven[a], outputs.sign[b] * driven[b], outputs.sign[c] * driven[c])


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
    (a, b, c), (of_a, of_b, of_c) = outputs.axis, outputs.sign
    return CoilDipole(of_a * wanted[a], of_b * wanted[b], of_c * wanted[c], request.counter)
