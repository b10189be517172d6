"""Sections of a scenario with keys that only the plant uses: orbit, surface, sensors, disturbances."""

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, Strict, field_validator, model_validator

from fsw.input.schema import (
    Nested,
    NotNegative,
    Positive,
    Section,
    Square,
    StepNt,
    StepOfOne,
    StepPercent,
    Triple,
)
from fsw.table.cells import CellShapes
from fsw.table.sections import BodyTable, CoilTable, OrbitTable
from fsw.table.wheel import WheelTable

Part = Annotated[float, Field(ge=0.0, le=1.0)]
Skew = Annotated[float, Field(ge=-10.0, le=10.0)]
Latency = Annotated[float, Field(ge=0.0, le=60.0)]


def _signed_axes(wiring: tuple[int, int, int]) -> tuple[int, int, int]:
    if sorted(map(abs, wiring)) != [1, 2, 3]:
        raise ValueError("must be 1, 2 and 3 in any order, each with either sign")
    return wiring


Wiring = Annotated[tuple[int, int, int], Strict(False), AfterValidator(_signed_axes)]


class ScenarioOrbit(OrbitTable):
    """The onboard orbit, and how far ahead of it along its track the satellite is."""

    along_track_km: float = Field(default=0.0, ge=-20000.0, le=20000.0)


class PlateSection(Section):
    """A flat part of the surface: area, outward normal, centre of pressure from the mass centre, body axes.

    ``specular`` and ``diffuse`` are the fractions of light reflected specularly and diffusely.
    """

    area_m2: Positive
    normal: Triple
    centre_m: Triple = (0.0, 0.0, 0.0)
    drag_coefficient: NotNegative = 2.2
    specular: Part = 0.0
    diffuse: Part = 0.0

    @model_validator(mode="after")
    def _is_a_plate(self) -> Self:
        if not any(self.normal):
            raise ValueError("normal must not be zero")
        if self.specular + self.diffuse > 1.0:
            raise ValueError("specular and diffuse together must not be above 1")
        return self


class ScenarioBody(BodyTable):
    """Inertia, momentum of a wheel, and the surface.

    ``inertia_kgm2`` holds the principal moments, or the rows of the tensor J about the mass centre, with
    J_xx = integral of (y^2 + z^2) dm and J_xy = - integral of x y dm. Where a program gives products with the
    other sign, change it: ``torquer size`` shows by how much the principal axes are turned.
    """

    plates: Annotated[tuple[PlateSection, ...], Strict(False)] = ()


class ScenarioCoils(CoilTable):
    """Limits and levels, and the physics of coil and driver.

    ``misalignment_deg`` holds, by coil, the rotation vector from its nominal to its true axis, body axes;
    ``wiring``, by output of the driver, the axis of its coil, negative for its opposite. ``resistance_ohm``,
    of each coil, gives the energy dissipated in the coils.
    """

    pulse_s: float = Field(default=3.0, gt=0.0, le=3.0)
    backoff_s: float = Field(default=100.0, ge=0.0, le=160.0)
    backoff: Literal["shared", "per_coil"] = "shared"
    time_constant_s: Positive = 0.01
    dipole_scale: Triple = (1.0, 1.0, 1.0)
    misalignment_deg: Square = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    resistance_ohm: Positive | None = None
    wiring: Wiring | None = None


class ScenarioWheel(WheelTable):
    """A reaction wheel that is driven, and the physics of wheel and motor.

    ``momentum_nms`` is its momentum at the epoch, relative to the body; the motor torque follows a request
    with ``time_constant_s``. ``torque_scale`` and ``friction_scale`` are true over nominal.
    """

    momentum_nms: float = 0.0
    time_constant_s: NotNegative = 0.05
    torque_scale: Positive = 1.0
    friction_scale: NotNegative = 1.0

    @model_validator(mode="after")
    def _begins_within_its_range(self) -> Self:
        if abs(self.momentum_nms) > self.max_momentum_nms:
            raise ValueError(f"momentum_nms must lie within max_momentum_nms, {self.max_momentum_nms:g}")
        return self


def onboard_wheel(section: ScenarioWheel) -> Nested:
    """The wheel as the onboard table has it."""
    return section.model_dump(include=set(WheelTable.model_fields))


class MagnetometerSection(Section):
    """Physics of the magnetometer, body axes.

    ``orbit_bias_nt`` is the amplitude of an offset that follows the orbit as a sine, beside ``bias_nt``, by
    axis, ``orbit_bias_phase_deg`` its phase at the epoch, ``shadow_bias_nt`` an offset in the Earth's shadow,
    ``non_orthogonality_deg`` is a right angle minus the angles xy, xz and yz between its axes,
    ``wiring``, by channel, the sensor axis that it shows, negative for its opposite.
    """

    noise_nt: NotNegative = 200.0
    bias_nt: Triple = (0.0, 0.0, 0.0)
    orbit_bias_nt: Triple = (0.0, 0.0, 0.0)
    orbit_bias_phase_deg: Triple = (0.0, 0.0, 0.0)
    shadow_bias_nt: Triple = (0.0, 0.0, 0.0)
    scale: Triple = (1.0, 1.0, 1.0)
    misalignment_deg: Triple = (0.0, 0.0, 0.0)
    non_orthogonality_deg: Annotated[tuple[Skew, Skew, Skew], Strict(False)] = (0.0, 0.0, 0.0)
    quantum_nt: StepNt = 2.0
    saturation_nt: Positive = 65000.0
    latency_s: Latency = 0.0
    coil_field_nt_per_am2: Annotated[tuple[Triple, Triple, Triple], Strict(False)] = (
        (2000.0, 0.0, 0.0),
        (0.0, 2000.0, 0.0),
        (0.0, 0.0, 2000.0),
    )
    wiring: Wiring | None = None


class SunSensorSection(Section):
    """Physics of the Sun sensor, body axes: in view within ``fov_half_deg`` of a boresight.

    ``albedo`` is the mean fraction of sunlight that the Earth reflects, true for 0.3, and deflects the
    measured direction; ``albedo_spread`` its relative standard deviation over the clouds.
    """

    noise_deg: NotNegative = 0.5
    misalignment_deg: Triple = (0.0, 0.0, 0.0)
    quantum: StepOfOne = 0.0
    latency_s: Latency = 0.0
    fov_half_deg: float | None = Field(default=None, gt=0.0, le=180.0)
    boresights: Annotated[tuple[Triple, ...], Strict(False)] = ()
    albedo: Part = 0.0
    albedo_spread: Part = 0.0

    @field_validator("albedo", mode="before")
    @classmethod
    def _is_that_of_the_earth(cls, given: object) -> object:
        """``true`` is the mean of the Earth."""
        return MEAN_ALBEDO * given if isinstance(given, bool) else given

    @model_validator(mode="after")
    def _has_cones(self) -> Self:
        if (self.fov_half_deg is None) == bool(self.boresights):
            raise ValueError("a field of view needs both fov_half_deg and boresights")
        if not all(any(axis) for axis in self.boresights):
            raise ValueError("boresights must not be zero")
        return self


class CellsSection(CellShapes):
    """Physics of Sun cells, which replace the Sun sensor; lists are by cell, in the order of ``normals``.

    ``gain`` is the current over the nominal one, ``turn_deg`` the rotation vector from the nominal to the
    true normal, body axes. Currents are in percent of the nominal one in full sunlight, ``quantum_percent``
    is their step, 0: that of the bus. ``albedo`` is the mean fraction of sunlight that the Earth reflects,
    ``albedo_spread`` its relative standard deviation.
    """

    gain: Annotated[tuple[Positive, ...], Strict(False)] | None = None
    turn_deg: Annotated[tuple[Triple, ...], Strict(False)] | None = None
    noise_percent: NotNegative = 1.0
    quantum_percent: StepPercent = 0.0
    threshold_percent: NotNegative = 2.0
    albedo: Part = 0.3
    albedo_spread: Part = 0.3
    latency_s: Latency = 0.0

    @model_validator(mode="after")
    def _each_has_its_errors(self) -> Self:
        for name in ("gain", "turn_deg"):
            given = getattr(self, name)
            if given is not None and len(given) != len(self.normals):
                raise ValueError(f"{name} must have {len(self.normals)} entries, one for each of normals")
        return self


class SensorsSection(Section):
    """Magnetometer, and Sun sensor or Sun cells."""

    magnetometer: MagnetometerSection = MagnetometerSection()
    sun: SunSensorSection = SunSensorSection()
    cells: CellsSection | None = None


class DragSection(Section):
    """Drag on the plates: density relative to that of the static exponential atmosphere."""

    density_scale: NotNegative = 1.0


class SolarPressureSection(Section):
    """Pressure of sunlight on the plates: flux at 1 au."""

    flux_wpm2: NotNegative = 1361.0


class DisturbanceSection(Section):
    """Constant torque, residual dipole, eddy currents (k of k (omega x b) x b), white torque; drag, sunlight.

    ``torque_noise_nm_rts`` is the root of the spectral density of the white torque per axis,
    ``torque_daily_part`` the amplitude of the constant torque's daily variation as a fraction of it,
    ``penumbra_torque_nm`` is added while the Sun is partly hidden, ``residual_dipole_eclipse_am2`` to the
    residual dipole in shadow; ``remanence_part`` is the fraction of its last pulse's dipole that a coil keeps
    until its next.
    """

    torque_nm: Triple = (0.0, 0.0, 0.0)
    torque_daily_part: Part = 0.0
    penumbra_torque_nm: Triple = (0.0, 0.0, 0.0)
    residual_dipole_am2: Triple = (0.0, 0.0, 0.0)
    residual_dipole_eclipse_am2: Triple = (0.0, 0.0, 0.0)
    remanence_part: Part = 0.0
    eddy_nms_per_t2: NotNegative = 0.0
    torque_noise_nm_rts: NotNegative = 0.0
    drag: DragSection | None = None
    solar_pressure: SolarPressureSection | None = None


def onboard_cells(section: CellsSection) -> Nested:
    """The cells as the onboard table has them: what is nominal, with the mean of the Earth's light."""
    nominal = section.model_dump(include={"normals", "shades", "albedo"})
    return {
        **nominal,
        "noise_percent": max(section.noise_percent, LEAST_CELL_NOISE_PERCENT),
        "quantum_percent": _coarser(section.quantum_percent, BUS_STEP_PERCENT),
    }


def onboard_steps(section: SensorsSection) -> Nested:
    """The steps of magnetometer and Sun sensor as the onboard table has them: those that the bus shows."""
    return {
        "magnetometer_quantum_nt": _coarser(section.magnetometer.quantum_nt, BUS_STEP_NT),
        "sun_quantum": _coarser(section.sun.quantum, BUS_STEP_SUN),
    }


def _coarser(step: float, of_bus: float) -> float:
    return step if step > of_bus else 0.0


MEAN_ALBEDO = 0.3
"""0.05 over open ocean, 0.6 over high clouds or ice (ECSS-E-ST-10-04C, annex F)."""
LEAST_CELL_NOISE_PERCENT = 0.1
BUS_STEP_NT, BUS_STEP_SUN, BUS_STEP_PERCENT = 2.0, 2.0**-14, 100.0 * 2.0**-7
"""Steps of field, Sun vector and cell current in their messages."""
