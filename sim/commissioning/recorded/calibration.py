"""What calibration knows of a satellite's sensors and body, and the file that carries it."""

from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field, Strict, field_validator
from scipy.spatial.transform import Rotation

from fsw.input.schema import Positive, Section, Square, Triple, read_toml, validated
from sim.value_types import Array

LEAST_GAIN, MOST_GAIN = 1e-3, 1e3
"""Of a matrix, in any direction."""
_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class PassMagnetometerTable(Section):
    """``[calibration.magnetometer]``: the field in body axes is matrix (raw - offset)."""

    offset_nt: Triple = (0.0, 0.0, 0.0)
    matrix: Square = _IDENTITY

    @field_validator("matrix")
    @classmethod
    def _is_regular(cls, matrix: Square) -> Square:
        gains = np.linalg.svd(np.array(matrix), compute_uv=False)
        if not LEAST_GAIN <= gains[-1] <= gains[0] <= MOST_GAIN:
            raise ValueError(
                f"it takes a field in one direction times {gains[-1]:.3g}, in another times {gains[0]:.3g}; "
                f"allowed is {LEAST_GAIN:g} to {MOST_GAIN:g}: a singular matrix loses a direction"
            )
        return matrix


class PassCellTable(Section):
    """``[[recorded.cell]]``: its current is full_scale times the cosine between face and Sun."""

    name: str
    face_body: Triple
    full_scale: Positive

    @field_validator("face_body")
    @classmethod
    def _has_a_direction(cls, face_body: Triple) -> Triple:
        if not any(face_body):
            raise ValueError("(0, 0, 0) is no direction")
        return face_body


class PassBodyTable(Section):
    """``[recorded.body]``: moments of inertia as parts of the greatest, about axes that are turned.

    ``principal_axes_turn_deg`` is the rotation vector that turns the body axes into the principal axes.
    """

    inertia_ratios: Annotated[tuple[Positive, Positive, Positive], Strict(False)] = (1.0, 1.0, 1.0)
    principal_axes_turn_deg: Triple = (0.0, 0.0, 0.0)


class PassSensorsTable(Section):
    """``[calibration]``, as in the onboard table."""

    magnetometer: PassMagnetometerTable = PassMagnetometerTable()


class RecordedTable(Section):
    """``[recorded]``: what the onboard table has no place for, and a recorded pass needs."""

    cell: Annotated[tuple[PassCellTable, ...], Strict(False)] = Field(default=(), max_length=12)
    body: PassBodyTable = PassBodyTable()


class PassCalibrationTable(Section):
    """The file; ``[uncertainty]`` is for the onboard table alone."""

    calibration: PassSensorsTable = PassSensorsTable()
    recorded: RecordedTable = RecordedTable()
    uncertainty: dict[str, Any] = Field(default_factory=dict)


class KnownCell(NamedTuple):
    """A Sun cell: its name, the normal of its face in body axes, its current at normal incidence."""

    name: str
    face_body: Array
    full_scale: float


class PassCalibration(NamedTuple):
    """What is known of sensors and body.

    ``inertia``: tensor in body axes, the greatest principal moment being 1; only ratios show without torque.
    """

    offset_nt: Array
    matrix: Array
    cells: tuple[KnownCell, ...]
    inertia: Array

    def field_nt(self, mag_nt: Array) -> Array:
        """Samples of the magnetometer, (n, 3), as fields in body axes."""
        field: Array = (mag_nt - self.offset_nt) @ self.matrix.T
        return field

    @property
    def spin_axis(self) -> Array:
        """The axis of greatest inertia, about which a body spins in the end; its largest part > 0."""
        axis: Array = np.linalg.eigh(self.inertia)[1][:, -1]
        return axis * float(np.copysign(1.0, axis[np.argmax(np.abs(axis))]))


def read_calibration(path: Path) -> PassCalibration:
    """The calibration in a TOML file.

    Raises:
        TableError: it cannot be read, a key is unknown, or a value is out of range.
    """
    return calibration(validated(PassCalibrationTable, read_toml(path), str(path)))


def calibration(table: PassCalibrationTable) -> PassCalibration:
    """The values of a table; without one, raw samples of a body that is a sphere."""
    magnetometer, recorded = table.calibration.magnetometer, table.recorded
    cells = tuple(_cell(one) for one in recorded.cell)
    turn = np.radians(recorded.body.principal_axes_turn_deg)
    inertia = turned_inertia(np.array(recorded.body.inertia_ratios), turn)
    return PassCalibration(np.array(magnetometer.offset_nt), np.array(magnetometer.matrix), cells, inertia)


def turned_inertia(ratios: Array, turn_rad: Array) -> Array:
    """The inertia tensor of these principal moments about the body axes turned so; the greatest is 1."""
    axes = Rotation.from_rotvec(turn_rad).as_matrix()
    inertia: Array = axes @ np.diag(ratios / np.max(ratios)) @ axes.T
    return inertia


UNCALIBRATED = calibration(PassCalibrationTable())


def _cell(table: PassCellTable) -> KnownCell:
    face = np.array(table.face_body)
    return KnownCell(table.name, face / np.linalg.norm(face), table.full_scale)
