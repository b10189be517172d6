"""Scenarios: the schema of their TOML files; how they are found, overridden and validated.

A scenario describes one flight in full. The onboard table is derived from it: values that plant and
controller share (orbit, body, coils, control) are written once; ``[flight]`` overrides values of the onboard
table, for instance the inertia that the controller assumes.
"""

import tomllib
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib import resources
from math import pi, sqrt
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from fsw.core.orbit.tle import tle_elements
from fsw.input.near import did_you_mean, toml_files_near
from fsw.input.schema import (
    Nested,
    Section,
    TableError,
    Triple,
    merge,
    read_toml,
    validated,
)
from fsw.input.toml_text import MOST_LEVELS, BoundsError, bounded, parse_toml
from fsw.table import table as onboard
from fsw.table.flown_elements import check_tle
from fsw.table.own_law import named
from fsw.table.sections import CIRCULAR_KEYS, BodyTable, ControlTable, TimeTable
from fsw.table.table import FlightTable
from sim.faults.section import Faults, check_sensors
from sim.scenario.names import Name
from sim.scenario.own_effects import Effects, with_digests
from sim.scenario.requirements import Requirements, check_ids, expectation
from sim.scenario.sections import (
    DisturbanceSection,
    ScenarioBody,
    ScenarioCoils,
    ScenarioOrbit,
    ScenarioWheel,
    SensorsSection,
    onboard_cells,
    onboard_steps,
    onboard_wheel,
)
from sim.scenario.telecommands import Telecommands

MU_M3PS2 = 3.986004418e14
DECAY_TIME_CONSTANTS = 5.0
"""Time constants after which a coil's field is below 1 % of its value."""


class ScenarioTime(TimeTable):
    """Tick rate, epoch and how many orbits are flown."""

    orbits: float = Field(gt=0.0, le=100000.0)


class TruthField(Section):
    """Field model of the plant; ``degree`` applies to igrf14. The onboard model is the same to degree 10.

    ``storm_nt`` is what a geomagnetic storm adds at high latitude at most.
    """

    model: Literal["igrf14", "tilted_dipole", "direct_dipole"] = "igrf14"
    degree: int = Field(default=13, ge=1, le=13)
    storm_nt: float = Field(default=0.0, ge=0.0, le=5000.0)


class InitialState(Section):
    """A turn from the nominal attitude about an axis, and a rate relative to the orbital frame, body axes."""

    axis: Triple = (1.0, 1.0, 1.0)
    angle_deg: float = Field(default=0.0, ge=-180.0, le=180.0)
    rate_degps: Triple = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _axis_has_a_direction(self) -> "InitialState":
        if not any(self.axis):
            raise ValueError("axis must not be zero")
        return self


class PlantSection(Section):
    """Integration of the plant: in steps of ``max_substep_s`` at most, in shorter ones of a fast motion."""

    max_substep_s: float = Field(default=1.0, ge=0.001, le=5.0)


class Scenario(Section):
    """A validated scenario."""

    name: Name
    summary: str
    knowledge: Literal["filter", "perfect"] = "filter"
    time: ScenarioTime
    orbit: ScenarioOrbit
    field: TruthField = TruthField()
    body: ScenarioBody
    initial: InitialState = InitialState()
    coils: ScenarioCoils
    wheel: ScenarioWheel | None = None
    sensors: SensorsSection = SensorsSection()
    disturbance: DisturbanceSection = DisturbanceSection()
    control: ControlTable
    plant: PlantSection = PlantSection()
    telecommand: Telecommands = ()
    fault: Faults = ()
    effect: Effects | None = None
    requirement: Requirements = ()
    flight: dict[str, Any] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        check_tle(self.orbit.tle, self.epoch_unix_s, self.epoch_unix_s)
        for name in ("drag", "solar_pressure"):
            if getattr(self.disturbance, name) is not None and not self.body.plates:
                raise ValueError(f"disturbance.{name} needs body.plates, the flat parts of the surface")
        if self.coils.driver == "continuous" and self.knowledge == "filter":
            self._check_decay()
        if self.coils.resistance_ohm is None and any(one.index == "energy" for one in self.requirement):
            raise ValueError("a requirement on energy needs coils.resistance_ohm")
        check_ids(self.requirement)
        cells = self.sensors.cells
        check_sensors(self.fault, 0 if cells is None else len(cells.normals))
        return self

    def _check_decay(self) -> None:
        off_s = (1.0 - self.coils.on_fraction) / self.time.tick_hz
        decay_s = DECAY_TIME_CONSTANTS * self.coils.time_constant_s
        if off_s < decay_s * (1.0 - 1e-9):
            raise ValueError(
                f"coils.on_fraction = {self.coils.on_fraction:g} leaves the coils {1000.0 * off_s:g} ms to "
                f"lose their current before the sensors sample, which takes {1000.0 * decay_s:g} ms: lower "
                "it, coils.time_constant_s or time.tick_hz"
            )

    @property
    def epoch_unix_s(self) -> int:
        """Time of tick 0, Unix seconds."""
        return onboard.epoch_unix_s(self.time, self.orbit)

    @property
    def own_law(self) -> str | None:
        """The user law that the onboard table names; None: it is one of the table of laws."""
        control = flight_table(self).control
        return control.law if control.own else None


def orbit_period_s(scenario: Scenario) -> float:
    """The period of the scenario's orbit: from the mean motion of the TLE, or of the circle."""
    if scenario.orbit.tle is not None:
        return 86400.0 / tle_elements(*scenario.orbit.tle).motion_revpday
    radius_m = 6378137.0 + 1000.0 * (scenario.orbit.altitude_km or 0.0)
    return 2.0 * pi * sqrt(radius_m**3 / MU_M3PS2)


def shipped() -> list[Scenario]:
    """The scenarios that ship, by name."""
    return [load(name) for name in shipped_names()]


def load(scenario: str | Scenario, overrides: Nested | None = None) -> Scenario:
    """A shipped scenario by its name, a file by its path, or a scenario, with overrides laid over it.

    Raises:
        TableError: not found, not TOML, or a key that is unknown, missing, of the wrong type or out of range.
    """
    if isinstance(scenario, Scenario):
        if not overrides:
            return scenario
        values, source = scenario.model_dump(mode="json", exclude_none=True), f"scenario {scenario.name}"
    else:
        values, source = _read(scenario)
    return scenario_of(values, source, with_digests(named(overrides or {}, Path()), Path()))


def scenario_of(values: Nested, source: str, overrides: Nested | None = None) -> Scenario:
    """A scenario from the values of its file, with overrides laid over them.

    Raises:
        TableError: naming ``source``, and a key that is unknown, missing, of the wrong type or out of range.
    """
    try:
        resolved = bounded(onboard.lay_over(values, overrides or {}))
    except BoundsError as error:
        raise TableError(f"{source}: {error}") from None
    scenario = validated(Scenario, resolved, source)
    flight_table(scenario, source)
    return scenario


def expecting(scenario: Scenario, texts: Sequence[str], orbits: float) -> Scenario:
    """The scenario with further requirements, texts such as ``ape<2``, on a flight of ``orbits`` orbits.

    Raises:
        TableError: one of them cannot be read, or the scenario lacks what it needs.
    """
    expected = tuple(expectation(text, orbits) for text in texts)
    values = scenario.model_dump(mode="json", exclude_none=True)
    values["requirement"] += [one.model_dump(mode="json", exclude_none=True) for one in expected]
    return validated(Scenario, values, "--expect") if expected else scenario


_latest: tuple[Scenario, FlightTable] | None = None


def flight_table(scenario: Scenario, source: str = "scenario") -> FlightTable:
    """The onboard table that this scenario flies with; neither of the two ever changes.

    That of the latest scenario is kept: a flight asks for it again and again. One with a user law is
    not, as the law's file may change.

    Raises:
        TableError: ``[flight]`` holds a key or value that the onboard table does not accept.
    """
    global _latest  # noqa: PLW0603  (what is kept follows from the scenario alone)
    latest = _latest
    if latest is not None and latest[0] is scenario:
        return latest[1]
    table = _table_of(scenario, source)
    if not table.control.own:
        _latest = scenario, table
    return table


def _table_of(scenario: Scenario, source: str) -> FlightTable:
    shared = scenario.model_dump(
        include={
            "knowledge": True,
            "orbit": {"tle", *CIRCULAR_KEYS},
            "body": set(BodyTable.model_fields),
            "coils": {
                "driver",
                "max_dipole_am2",
                "on_fraction",
                "dipole_per_ampere_am2",
                "levels_am2",
                "pulse_s",
                "backoff_s",
                "backoff",
            },
            "control": True,
        },
        exclude_none=True,
    )
    epoch = datetime.fromtimestamp(scenario.epoch_unix_s, UTC)  # the plant's, not that of [flight]
    shared["time"] = {"tick_hz": scenario.time.tick_hz, "epoch_utc": epoch.isoformat()}
    shared["field"] = {"model": scenario.field.model}
    shared["estimator"] = {
        "magnetometer_sigma_nt": _with_floor(scenario.sensors.magnetometer.noise_nt, FIELD_MODEL_ERROR_NT),
        "sun_sigma_deg": _with_floor(scenario.sensors.sun.noise_deg, SUN_MODEL_ERROR_DEG),
        **onboard_steps(scenario.sensors),
    }
    if scenario.sensors.cells is not None:
        shared["cells"] = onboard_cells(scenario.sensors.cells)
    if scenario.wheel is not None:
        shared["wheel"] = onboard_wheel(scenario.wheel)
    defaults = onboard.default_values()
    defaults.pop("orbit")
    values = onboard.lay_over(merge(defaults, shared), scenario.flight)
    return validated(FlightTable, values, f"{source}: [flight]")


FIELD_MODEL_ERROR_NT = 20.0
"""Contribution of degrees 11 to 13 of the field in low orbits, and rounding on the wire."""
SUN_MODEL_ERROR_DEG = 0.02
"""Error of the almanac's Sun, and rounding on the wire."""


def parse_settings(settings: tuple[str, ...]) -> Nested:
    """``KEY=VALUE`` settings as nested values; VALUE is TOML, or a bare word taken as a string.

    Raises:
        TableError: a setting without '=' or with an empty key, or beyond the bounds of ``toml_text``.
    """
    values: Nested = {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        parts = key.strip().split(".")
        if not equals or not all(parts):
            raise TableError(f"--set {setting}: write KEY=VALUE, for instance time.tick_hz=10")
        if len(parts) > MOST_LEVELS:
            raise TableError(f"--set {key[:40]}...: a key has more than {MOST_LEVELS} parts")
        try:
            value = parse_toml(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text
        except BoundsError as error:
            raise TableError(f"--set {key}: {error}") from None
        for part in reversed(parts):
            value = {part: value}
        values = merge(values, value)
    return values


def _with_floor(sigma: float, floor: float) -> float:
    return float((sigma * sigma + floor * floor) ** 0.5)


def _read(name_or_path: str) -> tuple[Nested, str]:
    path = Path(name_or_path)
    if name_or_path.endswith(".toml") or _is_misspelt_path(path, name_or_path):
        return with_digests(named(read_toml(path), path.parent), path.parent), name_or_path
    names = shipped_names()
    if name_or_path not in names:
        hint = did_you_mean(name_or_path, [*names, *toml_files_near(path)])
        raise TableError(
            f"there is no scenario {name_or_path!r}{hint}: choose one of "
            f"{', '.join(names)}, or a path that ends in .toml"
        )
    shipped_file = resources.files("sim.scenario.shipped").joinpath(f"{name_or_path}.toml")
    return tomllib.loads(shipped_file.read_text(encoding="utf-8")), f"scenario {name_or_path}"


def _is_misspelt_path(path: Path, text: str) -> bool:
    """Whether a text is no name, but the path of no file, and is near that of one that there is."""
    try:
        is_path = ("." in text or "/" in text) and not path.exists()
    except OSError:  # too long to be one
        return False
    return is_path and bool(toml_files_near(path))


def shipped_names() -> list[str]:
    """The names of the scenarios that ship."""
    folder = resources.files("sim.scenario.shipped")
    return sorted(
        entry.name.removesuffix(".toml") for entry in folder.iterdir() if entry.name.endswith(".toml")
    )
