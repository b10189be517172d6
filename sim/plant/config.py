"""The configuration of a plant: every number that the physics needs, in SI, as frozen values."""

import dataclasses
from dataclasses import dataclass
from math import isclose
from typing import Literal

from hil_stub.coils.coil_driver import CoilLimits
from sim.plant.rotation import ONES, ZERO, Mat3, Quaternion, Vec3
from sim.plant.sensor_config import (
    AS_NAMED,
    PERFECT_MAGNETOMETER,
    PERFECT_SUN_SENSOR,
    MagnetometerConfig,
    SunCellsConfig,
    SunSensorConfig,
    Wiring,
)
from sim.plant.wheel_config import WheelConfig

FieldModel = Literal["igrf14", "tilted_dipole", "direct_dipole"]


@dataclass(frozen=True, slots=True)
class OrbitConfig:
    """The orbit: two lines of a TLE for SGP4, or a circle given by the other four.

    Attributes:
        tle: the two lines, or None for the circular orbit.
        altitude_m: above 6378.137 km.
        inclination_rad: to the equator of the frame ``eci``.
        raan_rad: right ascension of the ascending node.
        u0_rad: argument of latitude at the epoch.
        along_track_m: how far the satellite is ahead of this orbit, along its track.
    """

    tle: tuple[str, str] | None = None
    altitude_m: float = 0.0
    inclination_rad: float = 0.0
    raan_rad: float = 0.0
    u0_rad: float = 0.0
    along_track_m: float = 0.0


@dataclass(frozen=True, slots=True)
class FieldConfig:
    """The geomagnetic field.

    Attributes:
        model: IGRF-14; its degree 1 alone; or the dipole along the Earth's axis.
        degree: highest degree of ``igrf14``, 1 to 13.
        storm_t: what a storm adds to it at high latitude at most, as in ``environment.field.Storm``.
    """

    model: FieldModel = "igrf14"
    degree: int = 13
    storm_t: float = 0.0


@dataclass(frozen=True, slots=True)
class PlateConfig:
    """A flat plate of the surface, on whose outer side air and light act.

    Attributes:
        area_m2: its area.
        normal_body: unit normal, outward, body axes.
        centre_body_m: centre of pressure from the mass centre, body axes.
        drag_coefficient: C_D.
        specular: fraction of the light that is reflected specularly.
        diffuse: fraction of the light that is reflected diffusely; the rest is absorbed.

    Raises:
        ValueError: the normal is not of unit length, or another quantity is out of range.
    """

    area_m2: float
    normal_body: Vec3
    centre_body_m: Vec3 = ZERO
    drag_coefficient: float = 2.2
    specular: float = 0.0
    diffuse: float = 0.0

    def __post_init__(self) -> None:
        if not self.area_m2 > 0.0:
            raise ValueError("area_m2 must be positive")
        if not isclose(sum(part * part for part in self.normal_body), 1.0, abs_tol=1e-9):
            raise ValueError("normal_body is not of unit length")
        if not self.drag_coefficient >= 0.0:
            raise ValueError("drag_coefficient must not be negative")
        if not (self.specular >= 0.0 and self.diffuse >= 0.0 and self.specular + self.diffuse <= 1.0):
            raise ValueError("specular and diffuse must not be negative, nor together above 1")


@dataclass(frozen=True, slots=True)
class BodyConfig:
    """The rigid body.

    Attributes:
        inertia_kgm2: rows of the inertia tensor about the mass centre, body axes.
        wheel_body_nms: constant angular momentum of wheels relative to the body, body axes.
        plates: its surface, convex: no plate shades another.

    Raises:
        ValueError: the tensor is not symmetric and positive definite.
    """

    inertia_kgm2: Mat3
    wheel_body_nms: Vec3 = ZERO
    plates: tuple[PlateConfig, ...] = ()

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
    """Disturbances other than the gravity gradient.

    Attributes:
        torque_body_nm: constant torque, body axes; if it varies daily, its mean.
        residual_dipole_body_am2: constant magnetic dipole, body axes; if it varies, that in sunlight.
        density_scale: air density over that of the model, None for no drag on the plates.
        solar_flux_wpm2: of sunlight at 1 au, None for no solar pressure on the plates.
        eddy_nms_per_t2: k_e of the eddy currents' torque k_e (omega x b) x b, 0 for none.
        torque_noise_nm_rts: root of the spectral density of a white torque per axis [N m s^(1/2)].
        torque_daily_part: amplitude of the daily variation of ``torque_body_nm``, as a fraction of it.
        residual_dipole_eclipse_body_am2: what the Earth's shadow adds to the residual dipole, body axes.
        penumbra_torque_body_nm: torque while the Sun is partly hidden, body axes.

    Raises:
        ValueError: a quantity that cannot be negative is, or the daily part is above 1.
    """

    torque_body_nm: Vec3 = ZERO
    residual_dipole_body_am2: Vec3 = ZERO
    density_scale: float | None = None
    solar_flux_wpm2: float | None = None
    eddy_nms_per_t2: float = 0.0
    torque_noise_nm_rts: float = 0.0
    torque_daily_part: float = 0.0
    residual_dipole_eclipse_body_am2: Vec3 = ZERO
    penumbra_torque_body_nm: Vec3 = ZERO

    def __post_init__(self) -> None:
        for name in ("density_scale", "solar_flux_wpm2", "eddy_nms_per_t2", "torque_noise_nm_rts"):
            if not (getattr(self, name) or 0.0) >= 0.0:
                raise ValueError(f"{name} must not be negative")
        if not 0.0 <= self.torque_daily_part <= 1.0:
            raise ValueError("torque_daily_part must lie between 0 and 1")


@dataclass(frozen=True, slots=True)
class ContinuousConfig:
    """A continuous driver.

    Attributes:
        max_dipole_am2: nominal full scale of each coil.
        on_fraction: fraction of a tick for which it drives.
    """

    max_dipole_am2: float
    on_fraction: float = 0.8


@dataclass(frozen=True, slots=True)
class CoilConfig:
    """Three coils, nominally along the body axes.

    Attributes:
        levels_am2: nominal dipoles of levels 1, 2, 3, rising.
        dipole_per_ampere_am2: nominal dipole of one ampere.
        time_constant_s: of the current's rise and decay, 0 for none.
        dipole_scale: true over nominal dipole of each coil: 1 is right, -1 is wired the wrong way round.
        continuous: the continuous driver; None: one that gives pulses of the levels.
        misalignment_rad: by coil, the rotation vector from the body axis to its axis, body axes.
        remanence_part: fraction of the dipole of its last pulse that a coil keeps until its next.
        wiring: by output of the driver, the number of the body axis of its coil, negative for its opposite.

    Raises:
        ValueError: the levels do not rise from above zero, or a quantity is out of range.
    """

    levels_am2: Vec3
    dipole_per_ampere_am2: float = 10.0
    time_constant_s: float = 0.01
    dipole_scale: Vec3 = ONES
    continuous: ContinuousConfig | None = None
    misalignment_rad: Mat3 = (ZERO, ZERO, ZERO)
    remanence_part: float = 0.0
    wiring: Wiring = AS_NAMED

    def __post_init__(self) -> None:
        low, middle, high = self.levels_am2
        if not 0.0 < low < middle < high:
            raise ValueError("levels_am2 must rise from above zero")
        if not self.dipole_per_ampere_am2 > 0.0:
            raise ValueError("dipole_per_ampere_am2 must be positive")
        if not self.time_constant_s >= 0.0:
            raise ValueError("time_constant_s must not be negative")
        if not 0.0 <= self.remanence_part <= 1.0:
            raise ValueError("remanence_part must lie between 0 and 1")


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
        disturbance: disturbance torques and dipoles.
        magnetometer: its errors.
        sun_sensor: its errors; or the cells in its place.
        coils: the coils.
        limits: what the coil driver's interlock enforces.
        max_substep_s: longest integration step; a fast motion is integrated in shorter ones.
        perfect_knowledge: whether the plant sends its true attitude and rate.
        wheel: a reaction wheel that is driven; None: there is none.

    Raises:
        ValueError: a number is out of range, or the tick rates of board and plant differ.
    """

    epoch_unix_s: int
    tick_hz: int
    seed: int
    orbit: OrbitConfig
    field: FieldConfig = FieldConfig()
    body: BodyConfig
    initial: InitialConfig = InitialConfig()
    disturbance: DisturbanceConfig = DisturbanceConfig()
    magnetometer: MagnetometerConfig = PERFECT_MAGNETOMETER
    sun_sensor: SunSensorConfig | SunCellsConfig = PERFECT_SUN_SENSOR
    coils: CoilConfig
    limits: CoilLimits
    max_substep_s: float = 1.0
    perfect_knowledge: bool = False
    wheel: WheelConfig | None = dataclasses.field(default=None, repr=False)

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
        if self.wheel is not None:
            BodyConfig(self.wheel.rest_of(self.body.inertia_kgm2))  # raises if none is left
