"""Sections of a scenario with keys that only the plant uses: orbit, surface, sensors, disturbances."""

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from fsw.input.schema import NotNegative, Positive, Section, Triple
from fsw.table.sections import BodyTable, OrbitTable

Part = Annotated[float, Field(ge=0.0, le=1.0)]
Skew = Annotated[float, Field(ge=-10.0, le=10.0)]
Latency = Annotated[float, Field(ge=0.0, le=60.0)]


class ScenarioOrbit(OrbitTable):
    """The onboard orbit, and how far along its track the satellite is ahead of it."""

    along_track_km: float = Field(default=0.0, ge=-20000.0, le=20000.0)


class PlateSection(Section):
    """A flat part of the surface: area, outward normal, centre of pressure from the mass centre, body axes.

    ``specular`` and ``diffuse`` are the parts of the light reflected as by a mirror and scattered.
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
    """Inertia, momentum of a wheel, and the surface."""

    plates: Annotated[tuple[PlateSection, ...], Strict(False)] = ()


class MagnetometerSection(Section):
    """Physics of the magnetometer, body axes.

    ``non_orthogonality_deg`` is what the angles xy, xz and yz between its axes lack of a right angle.
    """

    noise_nt: NotNegative = 200.0
    bias_nt: Triple = (0.0, 0.0, 0.0)
    scale: Triple = (1.0, 1.0, 1.0)
    misalignment_deg: Triple = (0.0, 0.0, 0.0)
    non_orthogonality_deg: Annotated[tuple[Skew, Skew, Skew], Strict(False)] = (0.0, 0.0, 0.0)
    quantum_nt: NotNegative = 2.0
    saturation_nt: Positive = 65000.0
    latency_s: Latency = 0.0
    coil_field_nt_per_am2: Annotated[tuple[Triple, Triple, Triple], Strict(False)] = (
        (2000.0, 0.0, 0.0),
        (0.0, 2000.0, 0.0),
        (0.0, 0.0, 2000.0),
    )


class SunSensorSection(Section):
    """Physics of the Sun sensor, body axes: in view within ``fov_half_deg`` of a boresight.

    With ``albedo`` the light of the Earth turns what it measures.
    """

    noise_deg: NotNegative = 0.5
    misalignment_deg: Triple = (0.0, 0.0, 0.0)
    quantum: NotNegative = 0.0
    latency_s: Latency = 0.0
    fov_half_deg: float | None = Field(default=None, gt=0.0, le=180.0)
    boresights: Annotated[tuple[Triple, ...], Strict(False)] = ()
    albedo: bool = False

    @model_validator(mode="after")
    def _has_cones(self) -> Self:
        if (self.fov_half_deg is None) == bool(self.boresights):
            raise ValueError("a field of view needs both fov_half_deg and boresights")
        if not all(any(axis) for axis in self.boresights):
            raise ValueError("boresights must not be zero")
        return self


class SensorsSection(Section):
    """Both sensors."""

    magnetometer: MagnetometerSection = MagnetometerSection()
    sun: SunSensorSection = SunSensorSection()


class DragSection(Section):
    """Drag of the air on the plates: density over that of the static exponential atmosphere."""

    density_scale: NotNegative = 1.0


class SolarPressureSection(Section):
    """Pressure of sunlight on the plates: flux at 1 au."""

    flux_wpm2: NotNegative = 1361.0


class DisturbanceSection(Section):
    """Constant torque, residual dipole, eddy currents (k of k (omega x b) x b), white torque; drag and light.

    ``torque_noise_nm_rts`` is the root of the spectral density of the white torque per axis,
    ``torque_daily_part`` the amplitude of the constant torque's daily variation as a part of it,
    ``residual_dipole_eclipse_am2`` what is added to the residual dipole in shadow, ``remanence_part`` what a
    coil keeps of the dipole of its last pulse until its next.
    """

    torque_nm: Triple = (0.0, 0.0, 0.0)
    torque_daily_part: Part = 0.0
    residual_dipole_am2: Triple = (0.0, 0.0, 0.0)
    residual_dipole_eclipse_am2: Triple = (0.0, 0.0, 0.0)
    remanence_part: Part = 0.0
    eddy_nms_per_t2: NotNegative = 0.0
    torque_noise_nm_rts: NotNegative = 0.0
    drag: DragSection | None = None
    solar_pressure: SolarPressureSection | None = None
