"""A campaign, and what it gives for each run: scenario, seed and the values that were drawn."""

import hashlib
import json
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
from pydantic import Field

from fsw.input.schema import Nested, Section, merge
from sim.campaign.definition.distributions import AnyDispersion, Direction, Shape
from sim.campaign.definition.requirements import FigureRequirement
from sim.record.whole_file import replace_file
from sim.scenario.schema import Scenario, flight_table, scenario_of
from sim.scenario.written import checked_toml

# --- Values of a scenario by dotted key, as in ``--set``; a number picks an element of a list


def nominal_values(scenario: Scenario) -> Nested:
    """All values of a scenario, ``flight`` being its whole onboard table; without keys that are not set."""
    values = scenario.model_dump(mode="json", exclude_none=True)
    return {**values, "flight": flight_table(scenario).model_dump(mode="json", exclude_none=True)}


def value_at(values: Any, key: str) -> Any:  # noqa: ANN401  (any value of a scenario)
    """The value at a key; None where there is none."""
    for part in key.split("."):
        if isinstance(values, dict):
            values = values.get(part)
        elif isinstance(values, list) and part.isdigit() and int(part) < len(values):
            values = values[int(part)]
        else:
            return None
    return values


def with_value(overrides: Nested, nominal: Nested, key: str, value: object) -> Nested:
    """Overrides that set a key too; the other elements of a list that it picks from keep their values.

    Raises:
        ValueError: there is no such element.
    """
    parts = key.split(".")
    if not all(parts):
        raise ValueError(f"'{key}' is not a key: write for instance sensors.magnetometer.bias_nt")
    names = next((place for place, part in enumerate(parts) if part.isdigit()), len(parts))
    if names < len(parts):
        whole = ".".join(parts[:names])
        found = value_at(overrides, whole)
        found = deepcopy(value_at(nominal, whole) if found is None else found)
        _replace(found, parts[names:], value, key)
        value = found
    for part in reversed(parts[:names]):
        value = {part: value}
    assert isinstance(value, dict)
    return merge(overrides, value)


def _replace(within: Any, parts: Sequence[str], value: object, key: str) -> None:  # noqa: ANN401  (any value of a scenario)
    *way, last = parts
    for part in way:
        within = value_at(within, part)
    if value_at(within, last) is None:
        raise ValueError(f"the scenario has no element {key}")
    within[int(last) if isinstance(within, list) else last] = value


# --- The campaign

FILE, SCENARIO = "campaign.toml", "scenario.toml"


class StatisticsSection(Section):
    """What counts of each run, and how all runs are judged together.

    ``last_orbits`` of each run count; ``window_s`` is the time over which MPE takes the mean and RPE the
    deviation from it; ``probability`` is the fraction of time and ensemble for which a percentile holds,
    ``confidence`` is that of its bound.
    """

    last_orbits: float = Field(default=1.0, gt=0.0)
    window_s: float = Field(default=600.0, gt=0.0)
    probability: float = Field(default=0.95, gt=0.0, lt=1.0)
    confidence: float = Field(default=0.9, gt=0.0, lt=1.0)


class IndexLimits(Section):
    """Upper limits of the percentile of each pointing index over the campaign, deg."""

    ape: float | None = Field(default=None, gt=0.0)
    mpe: float | None = Field(default=None, gt=0.0)
    rpe: float | None = Field(default=None, gt=0.0)
    ake: float | None = Field(default=None, gt=0.0)


@dataclass(frozen=True, slots=True)
class DrawnRun:
    """A run before it is flown: its seed, the values by key, and the same as overrides of the scenario."""

    run: int
    seed: int
    inputs: dict[str, Any]
    overrides: Nested


@dataclass(frozen=True, slots=True)
class Campaign:
    """A campaign whose file was checked; all that a worker needs.

    Attributes:
        name: of the campaign.
        base: the resolved scenario that every run varies, as in its TOML file.
        nominal: its values with the whole onboard table.
        runs: how many; they have the numbers from 0 on.
        seed: of all random streams.
        disperse: what is drawn for each run.
        shapes: for each of ``disperse``, of the values of its keys.
        requirements: what a run must meet.
        statistics: what counts of each run.
        index: limits on the pointing indices.
    """

    name: str
    base: Nested
    nominal: Nested
    runs: int
    seed: int
    disperse: tuple[AnyDispersion, ...]
    shapes: tuple[tuple[Shape, ...], ...]
    requirements: tuple[FigureRequirement, ...]
    statistics: StatisticsSection
    index: IndexLimits

    @property
    def digest(self) -> str:
        """SHA-256 of all that a row depends on: not the number of rows, nor the limits on the indices."""
        content = {**self.as_values(), "scenario": self.base}
        del content["runs"], content["index"]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    def as_values(self) -> Nested:
        """The campaign as in its file, the scenario being the one beside it."""
        return {
            "name": self.name,
            "scenario": SCENARIO,
            "runs": self.runs,
            "seed": self.seed,
            "requirement": {entry.figure: entry.as_value() for entry in self.requirements},
            "statistics": self.statistics.model_dump(),
            "index": self.index.model_dump(exclude_none=True),
            "disperse": [entry.model_dump(mode="json", exclude_none=True) for entry in self.disperse],
        }

    def write(self, folder: Path) -> None:
        """Write campaign.toml and scenario.toml, which are read as the same campaign."""
        for name, text in self.texts().items():
            replace_file(folder / name, text.encode())

    def texts(self) -> dict[str, str]:
        """The two files by name.

        Raises:
            TableError: one could not be read again.
        """
        of_campaign = checked_toml(self.as_values(), f"campaign {self.name}")
        return {SCENARIO: checked_toml(self.base, f"scenario {self.base['name']}"), FILE: of_campaign}

    def draw(self, run: int) -> DrawnRun:
        """The values of a run.

        They depend on seed and run alone; those of a dispersion also on its keys, and on no other dispersion.
        Streams are PCG64 under numpy's SeedSequence, with the run and the CRC-32 of the keys as spawn key.
        """
        overrides: Nested = {}
        inputs: dict[str, Any] = {}
        for entry, shapes in zip(self.disperse, self.shapes, strict=True):
            name = crc32(",".join(entry.targets).encode())
            random = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(run, name)))
            drawn = entry.draw(random, shapes)
            overrides, values = laid_over(overrides, self.nominal, entry, drawn)
            inputs |= values
        state = np.random.SeedSequence(self.seed, spawn_key=(run,)).generate_state(1, np.uint64)
        return DrawnRun(run, int(state[0] >> 1), inputs, overrides)  # 63 bits: SQLite has signed integers

    def scenario(self, drawn: DrawnRun) -> Scenario:
        """The scenario of a run.

        Raises:
            TableError: the values that were drawn are not allowed.
        """
        return scenario_of(self.base, f"run {drawn.run}", drawn.overrides)


def laid_over(
    overrides: Nested, nominal: Nested, entry: AnyDispersion, drawn: Sequence[Any]
) -> tuple[Nested, dict[str, Any]]:
    """The overrides with a dispersion's values, and these values by key.

    Raises:
        ValueError: a key picks an element that the scenario does not have.
    """
    values = {}
    for key, part in zip(entry.targets, drawn, strict=True):
        values[key] = entry.applied(value_at(nominal, key), part)
        if isinstance(entry, Direction):
            values[f"{key}.length"] = hypot(*values[key])
        overrides = with_value(overrides, nominal, key, values[key])
    return overrides, values
