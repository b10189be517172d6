"""The sections of an onboard table, and their checks, in deg, nT and km."""

from collections.abc import Mapping
from dataclasses import fields
from datetime import UTC, date, datetime
from typing import Annotated, Literal, Self

from pydantic import Field, Strict, ValidationInfo, field_validator, model_validator

from fsw.core.algebra.vector import Mat3, Vec3
from fsw.core.laws.entry import Aim
from fsw.core.laws.interface import MAX_GAIN, MAX_SPIN_RADPS
from fsw.core.laws.plan.law_axes import LawAxes, law_axes
from fsw.core.laws.table import LAWS
from fsw.core.orbit.propagation import sgp4_orbit
from fsw.core.orbit.tle import plain_line
from fsw.input.near import did_you_mean
from fsw.input.own_code import given_as, short_name
from fsw.input.schema import NotNegative, Positive, Section, Square, StepNt, StepOfOne, Triple
from fsw.table.inertia import check_inertia, three_numbers, without_rounding

CIRCULAR_KEYS = ("altitude_km", "inclination_deg", "raan_deg", "u0_deg")
"""Keys of a circular orbit; the other kind has ``tle``."""

BodyAxis = Literal["x", "y", "z", "-x", "-y", "-z"]
"""A body axis or its opposite."""

SetpointGain = Annotated[float, Field(ge=0.0, le=MAX_GAIN)]
"""As the ground may set it in flight."""


class TimeTable(Section):
    """Tick rate and the time of tick 0; without ``epoch_utc`` the TLE's epoch, rounded up to a second."""

    tick_hz: int = Field(ge=1, le=100)
    epoch_utc: str | None = None

    @field_validator("epoch_utc", mode="before")
    @classmethod
    def _from_toml_time(cls, value: object) -> object:
        return value.isoformat() if isinstance(value, date) else value

    @field_validator("epoch_utc")
    @classmethod
    def _epoch_is_a_time(cls, value: str | None) -> str | None:
        if value is not None:
            parse_utc(value)
        return value


class OrbitTable(Section):
    """Two TLE lines, or a circular orbit: altitude above 6378.137 km and angles at the epoch."""

    tle: Annotated[tuple[str, str] | None, Strict(False)] = None
    altitude_km: float | None = Field(default=None, ge=150.0, le=40000.0)
    inclination_deg: float = Field(default=0.0, ge=0.0, le=180.0)
    raan_deg: float = Field(default=0.0, ge=-360.0, le=360.0)
    u0_deg: float = Field(default=0.0, ge=-360.0, le=360.0)

    @field_validator("tle")
    @classmethod
    def _plain(cls, value: tuple[str, str] | None) -> tuple[str, str] | None:
        return None if value is None else (plain_line(value[0]), plain_line(value[1]))

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if (self.tle is None) == (self.altitude_km is None):
            raise ValueError("an orbit needs either tle (two lines) or altitude_km (150 to 40000)")
        if self.tle is not None:
            sgp4_orbit(*self.tle)
        return self

    @property
    def perigee_km(self) -> float:
        """Height of the perigee above the equatorial radius."""
        if self.tle is None:
            assert self.altitude_km is not None
            return self.altitude_km
        satellite = sgp4_orbit(*self.tle).satellite
        return float(satellite.altp * satellite.radiusearthkm)


class FieldTable(Section):
    """Onboard field model; ``degree`` is used by igrf14."""

    model: Literal["igrf14", "tilted_dipole", "direct_dipole"]
    degree: int = Field(ge=1, le=10)


class BodyTable(Section):
    """Inertia tensor in body axes, kg m^2: three principal moments or 3 x 3; momentum of a wheel, N m s.

    ``up`` and ``ahead`` are the body axes, or their opposites, that look up and fly ahead in the nominal
    attitude; laws, pointing and spin count by these, sensors, coils and estimate by the body axes.
    """

    inertia_kgm2: Triple | Square
    wheel_nms: Triple = (0.0, 0.0, 0.0)
    up: BodyAxis = "x"
    ahead: BodyAxis = "y"

    @field_validator("inertia_kgm2", mode="before")
    @classmethod
    def _has_the_shape(cls, value: object) -> object:
        rows = value if isinstance(value, list | tuple) else ()
        if not (three_numbers(rows) or (len(rows) == 3 and all(three_numbers(row) for row in rows))):
            raise ValueError("must be three principal moments or 3 x 3 numbers")
        return value

    @field_validator("inertia_kgm2")
    @classmethod
    def _is_symmetric_up_to_rounding(cls, value: Vec3 | Mat3) -> Vec3 | Mat3:
        return without_rounding(value) if isinstance(value[0], tuple) else value

    @model_validator(mode="after")
    def _is_an_inertia(self) -> Self:
        check_inertia(self.inertia)
        return self

    @model_validator(mode="after")
    def _is_across(self) -> Self:
        _ = self.law_axes
        return self

    @property
    def law_axes(self) -> LawAxes | None:
        """The axes that the laws count by; None: the body axes."""
        return law_axes(self.up, self.ahead)

    @property
    def law_inertia(self) -> Mat3:
        """The tensor in the axes of the laws."""
        axes = self.law_axes
        return self.inertia if axes is None else axes.matrix(self.inertia)

    @property
    def law_wheel_nms(self) -> Vec3:
        """The wheel's momentum in the axes of the laws."""
        axes = self.law_axes
        return self.wheel_nms if axes is None else axes.of_body(self.wheel_nms)

    @property
    def inertia(self) -> Mat3:
        """The 3 x 3 tensor."""
        given = self.inertia_kgm2
        if isinstance(given[0], tuple):
            return given
        a, b, c = given
        return ((a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c))


class CoilTable(Section):
    """The coil driver: levels per polarity and limits, or the full scale of a continuous one.

    ``on_fraction`` is the fraction of a tick for which a continuous driver drives, ``dipole_per_ampere_am2``
    the dipole of a healthy coil, in A m^2 per A; the currents of pulses are at most 2047 mA.
    """

    driver: Literal["pulsed", "continuous"] = "pulsed"
    max_dipole_am2: float | None = Field(default=None, gt=0.0)
    on_fraction: float = Field(default=0.8, gt=0.0, le=1.0)
    dipole_per_ampere_am2: Positive
    levels_am2: Triple
    pulse_s: float = Field(gt=0.0, le=3.0)
    backoff_s: float = Field(ge=0.0, le=160.0)
    backoff: Literal["shared", "per_coil"]

    @model_validator(mode="after")
    def _levels_rise(self) -> Self:
        low, middle, high = self.levels_am2
        if not 0.0 < low < middle < high:
            raise ValueError("levels_am2 must be three positive, rising dipoles")
        if self.driver == "continuous" and self.max_dipole_am2 is None:
            raise ValueError("a continuous driver needs max_dipole_am2")
        return self

    @property
    def shared(self) -> bool:
        """A pulse of any coil begins the back-off of all three; otherwise each coil has its own."""
        return self.backoff == "shared"

    @property
    def largest_am2(self) -> float:
        """The largest dipole that a coil is driven to."""
        continuous = self.max_dipole_am2 if self.driver == "continuous" else None
        return self.levels_am2[2] if continuous is None else continuous

    @property
    def on_part(self) -> float:
        """The largest fraction of the time for which a coil may be driven."""
        if self.driver == "continuous":
            return self.on_fraction
        return self.pulse_s / (self.pulse_s + self.backoff_s)

    @property
    def levels_ma(self) -> Vec3:
        """Currents of a sound coil at levels 1, 2, 3, mA."""
        first, second, third = (1000.0 * m / self.dipole_per_ampere_am2 for m in self.levels_am2)
        return (first, second, third)


class ControlTable(Section):
    """Pointing law and its gains, spin about body axis 1, leak time of the owed impulse.

    Units: ``k_w`` N m s/T^2, ``k_a`` N m/T^2, ``k_i`` N m/(T^2 s). ``gains`` holds, by law, that law's own
    parameters. ``minimiser`` is how a continuous driver finds the dipole of a predictive law. A law that is
    not in the table of laws is ``FILE.py:NAME`` or the name of an entry point; ``law_sha256`` is the digest
    of its source, by which it is recognised; ``law_withheld`` keeps that source from being executed. One that
    a program gave as an object is ``object MODULE:NAME``, and flies only where the program gives it.
    """

    law_sha256: str | None = Field(default=None, pattern="^[0-9a-f]{64}$")
    law_withheld: bool | None = None
    law: str = Field(max_length=1000)
    k_w: SetpointGain
    k_a: SetpointGain
    k_i: SetpointGain = 0.0
    spin_radps: float = Field(default=0.0, ge=-MAX_SPIN_RADPS, le=MAX_SPIN_RADPS)
    leak_s: Positive
    minimiser: Literal["closed_form", "genetic"] = "closed_form"
    gains: dict[str, dict[str, float]] = Field(default_factory=dict)

    @property
    def own(self) -> bool:
        """Whether the law is not in the table of laws."""
        return self.law not in LAWS

    @property
    def law_name(self) -> str:
        """The law as the setpoint and ``gains`` call it: for FILE.py:NAME, the NAME."""
        return short_name(self.law)

    @field_validator("law")
    @classmethod
    def _law_exists(cls, law: str, info: ValidationInfo) -> str:
        named = info.data.get("law_sha256") is not None
        if law not in LAWS and not named and given_as(law) is None:
            kinds = laws_by_aim({name: entry.aim for name, entry in LAWS.items()})
            raise ValueError(
                f"{law!r}{did_you_mean(law, LAWS)} is not allowed: allowed is a law of docs/laws.md, "
                f"{kinds}, FILE.py:NAME or the entry point of a package"
            )
        if law not in LAWS and short_name(law) in LAWS:
            raise ValueError(f"{law!r} is called like a law of the table: give it another name")
        if law in LAWS and named:
            raise ValueError(f"{law!r} is a law of the table, which has no law_sha256")
        return law

    @model_validator(mode="after")
    def _gains_exist(self) -> Self:
        for law, given in self.gains.items():
            if self.own and law == self.law_name:
                continue  # its source knows them
            own = LAWS[law].gains if law in LAWS else None
            if own is None:
                allowed = ", ".join(name for name, row in LAWS.items() if row.gains is not None)
                raise ValueError(f"gains.{law}: no such law has gains of its own (allowed: {allowed})")
            names = [field.name for field in fields(own)]
            odd = sorted(set(given) - set(names))
            if odd:
                raise ValueError(f"gains.{law}: {', '.join(odd)} is not known (allowed: {', '.join(names)})")
            try:
                own(**given)
            except ValueError as error:
                raise ValueError(f"gains.{law}: {error}") from None
        return self


class EstimatorTable(Section):
    """Noise of the sensors, rate at start-up, and standard deviations up to which the attitude serves.

    ``usable_sigma_deg``: up to which laws and modes go by it; it becomes valid below ``valid_sigma_deg``, and
    stays so up to 1.5 times that. ``magnetometer_quantum_nt`` and ``sun_quantum`` are steps of a
    component of field and Sun vector, where they are coarser than those of the bus; 0: they are not.
    ``algebra``: what computes the filter's matrices.
    """

    magnetometer_sigma_nt: Positive
    magnetometer_quantum_nt: StepNt = 0.0
    sun_sigma_deg: Positive
    sun_quantum: StepOfOne = 0.0
    rate_sigma_degps: Positive
    valid_sigma_deg: Positive
    usable_sigma_deg: Positive
    algebra: Literal["kernel", "filterpy"] = "kernel"


class ModesTable(Section):
    """Thresholds and dwell times of the mode table."""

    slow_degps: Positive
    fast_degps: Positive
    near_deg: float = Field(gt=0.0, le=180.0)
    far_deg: float = Field(gt=0.0, le=180.0)
    axis_only: bool
    recover_s: NotNegative
    settle_s: NotNegative
    lose_s: NotNegative
    hold_s: NotNegative
    trips_to_stay_safe: int = Field(ge=1)
    stale_after_s: Positive

    @model_validator(mode="after")
    def _hysteresis(self) -> Self:
        if not (self.slow_degps < self.fast_degps and self.near_deg < self.far_deg):
            raise ValueError("slow_degps must lie under fast_degps and near_deg under far_deg")
        return self


class FdirTable(Section):
    """What fault detection is to guarantee; every other limit follows from bounds and noise.

    ``false_alarm_days``: mean time between false alarms of a unit. A coil is weak below ``weak_coil_part`` of
    its nominal current or effect, and tried again after ``coil_retest_s``.
    """

    false_alarm_days: float = Field(ge=1.0, le=36525.0)
    weak_coil_part: float = Field(gt=0.2, lt=1.0)
    coil_retest_s: Positive
    second_sender_s: Positive
    event_spacing_s: NotNegative


class TelemetryTable(Section):
    """Periods of the reports and of the ephemeris nodes, s; at least one tick.

    ``parameter_s`` is the time from one estimated number to the next; they are reported in turn.
    """

    attitude_s: NotNegative
    quality_s: NotNegative
    parameter_s: NotNegative
    heartbeat_s: NotNegative
    ephemeris_s: int = Field(ge=10, le=30)


def parse_utc(text: str) -> int:
    """Unix seconds of a UTC time such as 2025-03-20T12:00:00Z.

    Raises:
        ValueError: not a UTC time, or not a whole second.
    """
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise ValueError(f"'{text}' is not a time such as 2025-03-20T12:00:00Z") from None
    moment = moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment
    if moment.microsecond:
        raise ValueError(f"'{text}' is not a whole second")
    return int(moment.timestamp())


# --- The laws by what they are for, as a message lists them: some of each kind, and how many more there are

FEW = 5
"""Named of a kind."""


def laws_by_aim(aims: Mapping[str, Aim]) -> str:
    """``three_axis (pd, lqr and 35 more), rate (...)``, of laws with their aims, in their order."""
    kinds = []
    for aim in Aim:
        names = [name for name, its in aims.items() if its is aim]
        more = f" and {len(names) - FEW} more" if len(names) > FEW else ""
        if names:
            kinds.append(f"{aim.value} ({', '.join(names[:FEW])}{more})")
    return ", ".join(kinds)
