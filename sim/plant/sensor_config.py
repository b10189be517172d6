"""The configuration of the sensors: their errors, in SI, as frozen values."""

from dataclasses import dataclass
from math import pi

from sim.plant.rotation import ONES, ZERO, Mat3, Vec3

Wiring = tuple[int, int, int]
"""By channel or output, the number of the axis it belongs to, negative for the opposite sense."""
AS_NAMED: Wiring = (1, 2, 3)
NO_COUPLING: Mat3 = (ZERO, ZERO, ZERO)


@dataclass(frozen=True, slots=True)
class MagnetometerConfig:
    """The magnetometer's errors.

    Attributes:
        noise_t: standard deviation per axis and sample.
        bias_t: constant offset, sensor axes.
        orbit_bias_t: amplitude by axis of an offset that follows the orbit, a sin(2 pi t / period + phase).
        orbit_bias_phase_rad: its phase by axis at tick 0.
        orbit_s: its period.
        shadow_bias_t: offset in the Earth's shadow, beside the others.
        scale: factor per sensor axis.
        misalignment_rad: rotation vector that turns the body axes into the sensor's.
        non_orthogonality_rad: right angle minus the angles xy, xz and yz between the sensor axes.
        quantum_t: step of the reading, 0 for none.
        saturation_t: largest magnitude of an axis; beyond it the sample is not valid.
        coil_coupling_t_per_am2: column j is the field at the sensor, body axes, per dipole along body axis j.
        latency_s: age of the values in a sample.
        wiring: by channel, the number of the sensor axis that it shows, negative for its opposite.
    """

    noise_t: float = 0.0
    bias_t: Vec3 = ZERO
    orbit_bias_t: Vec3 = ZERO
    orbit_bias_phase_rad: Vec3 = ZERO
    orbit_s: float = 6000.0
    shadow_bias_t: Vec3 = ZERO
    scale: Vec3 = ONES
    misalignment_rad: Vec3 = ZERO
    non_orthogonality_rad: Vec3 = ZERO
    quantum_t: float = 0.0
    saturation_t: float = 65e-6
    coil_coupling_t_per_am2: Mat3 = NO_COUPLING
    latency_s: float = 0.0
    wiring: Wiring = AS_NAMED


@dataclass(frozen=True, slots=True)
class SunSensorConfig:
    """The Sun sensor's errors.

    Attributes:
        noise_rad: standard deviation of a small rotation about each axis, per sample.
        misalignment_rad: rotation vector that turns the body axes into the sensor's.
        quantum: step of a component of the unit vector, 0 for none.
        latency_s: age of the values in a sample.
        fov_half_rad: half the opening angle of each cone of view.
        boresights_body: unit axes of the cones, body axes; none: it sees in all directions.
        albedo: mean fraction of sunlight that the Earth reflects, which deflects the measured direction.
        albedo_spread: standard deviation of its variation over the clouds, as a fraction of it.
    """

    noise_rad: float = 0.0
    misalignment_rad: Vec3 = ZERO
    quantum: float = 0.0
    latency_s: float = 0.0
    fov_half_rad: float = pi
    boresights_body: tuple[Vec3, ...] = ()
    albedo: float = 0.0
    albedo_spread: float = 0.0


@dataclass(frozen=True, slots=True)
class CellConfig:
    """A Sun cell.

    Attributes:
        normal_body: nominal unit normal, body axes.
        gain: true current over the nominal one.
        turn_rad: rotation vector from the nominal to the true normal, body axes.
        shades: cones in which the satellite shades it: unit axis, cosine of the half-angle.
    """

    normal_body: Vec3
    gain: float = 1.0
    turn_rad: Vec3 = ZERO
    shades: tuple[tuple[Vec3, float], ...] = ()


@dataclass(frozen=True, slots=True)
class SunCellsConfig:
    """Up to six Sun cells; currents are relative to the nominal one in full sunlight.

    Attributes:
        cells: each of them.
        noise: standard deviation per sample.
        quantum: step of a current, 0 for none.
        threshold: below it a current is 0.
        albedo: mean fraction of sunlight that the Earth reflects, 0 for none.
        albedo_spread: standard deviation of its variation over the clouds, as a fraction of it.
        latency_s: age of the values in a sample.

    Raises:
        ValueError: there is no cell, or more than six.
    """

    cells: tuple[CellConfig, ...]
    noise: float = 0.0
    quantum: float = 0.0
    threshold: float = 0.0
    albedo: float = 0.0
    albedo_spread: float = 0.0
    latency_s: float = 0.0

    def __post_init__(self) -> None:
        if not 1 <= len(self.cells) <= 6:
            raise ValueError(f"{len(self.cells)} Sun cells: from 1 to 6 can be read")


PERFECT_MAGNETOMETER = MagnetometerConfig()
PERFECT_SUN_SENSOR = SunSensorConfig()
