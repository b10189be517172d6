"""Faults of a scenario: a ``[[fault]]`` gives kind, start, duration and parameters."""

from collections.abc import Sequence
from math import ceil
from random import Random
from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from fsw.input.near import did_you_mean
from fsw.input.schema import Positive, Section, TableError
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.faults.kinds import KINDS, make
from sim.plant.config import PlantConfig
from sim.plant.own_effects import NO_EFFECTS, OwnEffects
from sim.plant.plant import Plant

ROUNDING = 1e-6
"""Of a tick: 0.14 s at 50 Hz is tick 7, though the product of the two numbers is a little more."""


class FaultSection(Section):
    """One fault. It begins with the first tick at or after ``at_s``; without ``lasts_s`` it is permanent."""

    kind: str
    at_s: float = Field(ge=0.0)
    lasts_s: Positive | None = None
    parameters: dict[str, float] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _is_of_the_table(self) -> Self:
        kind = KINDS.get(self.kind)
        if kind is None or not kind.in_plant:
            names = [name for name, kind in KINDS.items() if kind.in_plant]
            raise ValueError(
                f"kind '{self.kind}'{did_you_mean(self.kind, names)} is none of {', '.join(names)}"
            )
        for name, value in self.parameters.items():
            allowed = kind.parameters.get(name)
            if allowed is None:
                there = ", ".join(kind.parameters) or "none"
                hint = did_you_mean(name, kind.parameters)
                raise ValueError(f"parameters.{name}: {self.kind} has no such parameter{hint}, but {there}")
            if not allowed.low <= value <= allowed.high:
                raise ValueError(
                    f"parameters.{name} = {value:g} is outside {allowed.low:g} to {allowed.high:g}"
                )
        return self


Faults = Annotated[tuple[FaultSection, ...], Strict(False)]


def check_sensors(faults: Sequence[FaultSection], cells: int) -> None:
    """Check that the satellite has what each fault acts on.

    Args:
        faults: of a scenario.
        cells: number of its Sun cells; 0: it has a Sun sensor.

    Raises:
        ValueError: a fault would do nothing.
    """
    for number, fault in enumerate(faults):
        sensor, place = KINDS[fault.kind].sensor, f"fault[{number}]"
        if sensor == "sun" and cells:
            raise ValueError(
                f"{place}.kind = '{fault.kind}' acts on the Sun sensor, in whose place there is sensors.cells"
            )
        if sensor == "cells" and not cells:
            raise ValueError(
                f"{place}.kind = '{fault.kind}' acts on Sun cells, and there is no sensors.cells"
            )
        cell = fault.parameters.get("cell", 1.0)
        if round(cell) > cells and sensor == "cells":
            raise ValueError(
                f"{place}.parameters.cell = {cell:g} is none of the {cells} of sensors.cells.normals"
            )


def break_frames(faults: Sequence[FaultSection]) -> bool:
    """Whether a fault of the scenario may corrupt frames of the coil driver."""
    return any(KINDS[fault.kind].breaks for fault in faults)


def forge_sync(faults: Sequence[FaultSection]) -> bool:
    """Whether a fault of the scenario sends SYNC."""
    return any(KINDS[fault.kind].forges_sync for fault in faults)


def forge_answers(faults: Sequence[FaultSection]) -> bool:
    """Whether a fault of the scenario sends under identifiers of the flight software."""
    return any(KINDS[fault.kind].forges for fault in faults)


def make_plant(
    config: PlantConfig, faults: Sequence[FaultSection], effects: OwnEffects = NO_EFFECTS
) -> Plant:
    """The plant of a flight with its faults scheduled; their random numbers come from the plant's seed.

    Raises:
        TableError: the scenario is consistent in itself, but orbit or field do not exist at its epoch, or a
            part cannot be built with its numbers.
    """
    try:
        if not faults:
            return Plant(config, own=effects)
        scheduled = [_schedule(number, fault, config) for number, fault in enumerate(faults)]
        return FaultyPlant(config, scheduled, effects=effects)
    except ValueError as error:
        raise TableError(f"the scenario's plant: {error}") from None


def _schedule(number: int, fault: FaultSection, config: PlantConfig) -> ScheduledFault:
    first = ceil(fault.at_s * config.tick_hz - ROUNDING)
    lasts = None if fault.lasts_s is None else max(1, round(fault.lasts_s * config.tick_hz))
    rng = Random(f"fault {number}/{config.seed}")
    end = None if lasts is None else first + lasts
    return ScheduledFault(make(fault.kind, fault.parameters, rng), first, end)
