"""What a plant is made of: every number the physics needs, in SI, as frozen values."""

from dataclasses import dataclass
from math import isclose
from typing import Literal

from hil_stub.coil_driver import CoilLimits
from sim.plant.rotation import ZERO, Mat3, Quaternion, Vec3

FieldModel = Literal["igrf14", "tilted_dipole", "direct_dipole"]

ONES: Vec3 = (1.0, 1.0, 1.0)
NO_COUPLING: Mat3 = (ZERO, ZERO, ZERO)


@dataclass(frozen=True, slots=True)
class OrbitConfig:
    """The orbit: two lines of a TLE for SGP4, or a circle for which the other four stand.

    Attributes:
        tle: the two lines, or None for the circular orbit.
        altitude_m: above 6378.137 km.
        inclination_rad: to the equator of the frame ``eci``.
        raan_rad: right ascension of the ascending node.
        u0_rad: argument of latitude at the epoch.
    """

    tle: tuple[str, str] | None = None
    altitude_m: float = 0.0
    inclination_rad: float = 0.0
    raan_rad: float = 0.0
    u0_rad: float = 0.0


@dataclass(frozen=True, slots=True)
class FieldConfig:
    """The geomagnetic field.

    Attributes:
        model: IGRF-14; its degree 1 alone; or the dipole along the Earth's axis.
        degree: highest degree of ``igrf14``, 1 to 13.
    """

    model: FieldModel = "igrf14"
    degree: int = 13


@dataclass(frozen=True, slots=True)
class BodyConfig:
    """The rigid body.

    Attributes:
        inertia_kgm2: rows of the inertia tensor about the mass centre, body axes.

    Raises:
        ValueError: the tensor is not symmetric and positive definite.
    """

    inertia_kgm2: Mat3

    def __post_init__(self) -> None:
        (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = self.inertia_kgm2
        if (xy, xz, yz) != (yx, zx, zy):
            raise ValueError("inertia_kgm2 is not symmetric")
        minor = xx * yy - xy * xy
        determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
        if not (xx > 0.0 and minor > 0.0 and determinant > 0.0):
            raise ValueError("inertia_kgm2 is not positive definite")


@dataclass(frozen=True, slots=True)
class InitialConfig:
    """Attitude and rate at the epoch.

    Attributes:
        q_body_from_orbit: attitude against the orbital frame.
        omega_body_orbit_radps: rate relative to the orbital frame, body axes.

    Raises:
        ValueError: the quaternion is not of unit norm.
    """

    q_body_from_orbit: Quaternion = (1.0, 0.0, 0.0, 0.0)
    omega_body_orbit_radps: Vec3 = ZERO

    def __post_init__(self) -> None:
        if not isclose(sum(part * part for part in self.q_body_from_orbit), 1.0, abs_tol=1e-6):
            raise ValueError("q_body_from_orbit is not of unit norm")


@dataclass(frozen=True, slots=True)
class DisturbanceConfig:
    """What disturbs the body beside the gravity gradient.

    Attributes:
        torque_body_nm: constant torque, body axes.
        residual_dipole_body_am2: constant magnetic dipole, body axes.
    """

    torque_body_nm: Vec3 = ZERO
    residual_dipole_body_am2: Vec3 = ZERO


@dataclass(frozen=True, slots=True)
class MagnetometerConfig:
    """The magnetometer's errors.

    Attributes:
        noise_t: standard deviation per axis and sample.
        bias_t: constant offset, sensor axes.
        scale: factor per sensor axis.
        misalignment_rad: rotation vector that turns the body axes into the sensor's.
        quantum_t: step of the reading, 0 for none.
        saturation_t: largest magnitude of an axis; beyond it the sample is not valid.
        coil_coupling_t_per_am2: column j is the field at the sensor, body axes, per dipole of coil j.
    """

    noise_t: float = 0.0
    bias_t: Vec3 = ZERO
    scale: Vec3 = ONES
    misalignment_rad: Vec3 = ZERO
    quantum_t: float = 0.0
    saturation_t: float = 65e-6
    coil_coupling_t_per_am2: Mat3 = NO_COUPLING


@dataclass(frozen=True, slots=True)
class SunSensorConfig:
    """The Sun sensor's errors.

    Attributes:
        noise_rad: standard deviation of a small rotation about each axis, per sample.
        misalignment_rad: rotation vector that turns the body axes into the sensor's.
        quantum: step of a component of the unit vector, 0 for none.
    """

    noise_rad: float = 0.0
    misalignment_rad: Vec3 = ZERO
    quantum: float = 0.0


@dataclass(frozen=True, slots=True)
class CoilConfig:
    """Three coils along the body axes.

    Attributes:
        levels_am2: nominal dipoles of levels 1, 2, 3, rising.
        dipole_per_ampere_am2: nominal dipole of one ampere.
        time_constant_s: of the current's rise and decay, 0 for none.
        dipole_scale: true over nominal dipole of each coil: 1 is right, -1 is wired the wrong way round.

    Raises:
        ValueError: the levels do not rise from above zero, or a quantity is out of range.
    """

    levels_am2: Vec3
    dipole_per_ampere_am2: float = 10.0
    time_constant_s: float = 0.01
    dipole_scale: Vec3 = ONES

    def __post_init__(self) -> None:
        low, middle, high = self.levels_am2
        if not 0.0 < low < middle < high:
            raise ValueError("levels_am2 must rise from above zero")
        if not self.dipole_per_ampere_am2 > 0.0:
            raise ValueError("dipole_per_ampere_am2 must be positive")
        if not self.time_constant_s >= 0.0:
            raise ValueError("time_constant_s must not be negative")


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantConfig:
    """A whole plant.

    Attributes:
        epoch_unix_s: time of tick 0, UTC.
        tick_hz: ticks a second.
        seed: of all random streams.
        orbit: the orbit.
        field: the geomagnetic field.
        body: the rigid body.
        initial: attitude and rate at the epoch.
        disturbance: torques and dipoles that disturb.
        magnetometer: its errors.
        sun_sensor: its errors.
        coils: the coils.
        limits: what the coil driver's interlock enforces.
        max_substep_s: longest integration step.
        perfect_knowledge: whether the plant sends its true attitude and rate.

    Raises:
        ValueError: a number is out of range, or board and plant do not tick alike.
    """

    epoch_unix_s: int
    tick_hz: int
    seed: int
    orbit: OrbitConfig
    field: FieldConfig = FieldConfig()
    body: BodyConfig
    initial: InitialConfig = InitialConfig()
    disturbance: DisturbanceConfig = DisturbanceConfig()
    magnetometer: MagnetometerConfig = MagnetometerConfig()
    sun_sensor: SunSensorConfig = SunSensorConfig()
    coils: CoilConfig
    limits: CoilLimits
    max_substep_s: float = 1.0
    perfect_knowledge: bool = False

    def __post_init__(self) -> None:
        if self.tick_hz < 1:
            raise ValueError("tick_hz must be at least 1")
        if self.limits.tick_hz != self.tick_hz:
            raise ValueError("the coil driver's limits are for another tick_hz")
        if not self.max_substep_s > 0.0:
            raise ValueError("max_substep_s must be positive")
        if self.seed < 0:
            raise ValueError("seed must not be negative")
        if not 0 <= self.epoch_unix_s < 2**32:
            raise ValueError("epoch_unix_s must fit into 32 bits")
