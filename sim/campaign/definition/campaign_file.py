"""Campaign files: the schema of their TOML, and the campaign that one describes."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, Strict

from fsw.input.schema import Nested, Section, TableError, merge, read_toml, validated
from fsw.input.toml_text import parse_toml
from sim.campaign.definition.campaign import (
    FILE,
    SCENARIO,
    Campaign,
    IndexLimits,
    StatisticsSection,
    laid_over,
    nominal_values,
    value_at,
)
from sim.campaign.definition.distributions import AnyDispersion, Shape
from sim.campaign.definition.requirements import requirements_in
from sim.flight.record_flight import MOST_IN_MEMORY, ticks_of
from sim.scenario.names import Name
from sim.scenario.schema import load, scenario_of
from sim.scenario.written import values_of

MOST_RUNS = 10**7
MOST_SEED = 10**15


class CampaignTable(Section):
    """A campaign file. ``scenario`` is a shipped one or a path beside the file; ``set`` is for all runs."""

    name: Name | None = None
    scenario: str
    runs: int = Field(ge=1, le=MOST_RUNS)
    orbits: float | None = Field(default=None, gt=0.0)
    seed: int = Field(default=1, ge=0, le=MOST_SEED)
    set: dict[str, Any] = Field(default_factory=dict)
    disperse: Annotated[tuple[AnyDispersion, ...], Strict(False)] = ()
    requirement: dict[str, Any] = Field(default_factory=dict)
    statistics: StatisticsSection = StatisticsSection()
    index: IndexLimits = IndexLimits()


def load_campaign(source: str, over: Nested, settings: Nested) -> Campaign:
    """The campaign of a file, of a folder that has one, or of a scenario whose runs differ by seed alone.

    Args:
        source: a campaign file, a campaign's folder, or a scenario's name or file.
        over: runs, orbits, seed; they override the file.
        settings: laid over the scenario of all runs.

    Raises:
        TableError: the file, or the key of the scenario and what is allowed.
        HarnessError: a run would be too long.
    """
    path = Path(source)
    if path.is_dir():
        path = path / FILE
    if path.suffix != ".toml" or "scenario" not in (values := read_toml(path)):
        content = validated(CampaignTable, {"scenario": source, "runs": 100, **over}, source)
        return _campaign(content, source, source, settings)
    source = str(path)
    content = validated(CampaignTable, {**values, **over}, source)
    scenario_name = content.scenario
    if scenario_name.endswith(".toml"):
        scenario_name = str(path.parent / scenario_name)
    return _campaign(content, scenario_name, source, settings)


def _campaign(content: CampaignTable, scenario_name: str, source: str, settings: Nested) -> Campaign:
    fixed = merge(content.set, settings)
    if content.orbits is not None:
        fixed = merge(fixed, {"time": {"orbits": content.orbits}})
    try:
        scenario = load(scenario_name, fixed)
    except TableError as error:
        raise TableError(f"{source}: {error}" if scenario_name != source else str(error)) from None
    ticks_of(scenario, None, MOST_IN_MEMORY)
    nominal = nominal_values(scenario)
    _check_keys(content, source)
    campaign = Campaign(
        name=content.name or scenario.name,
        base=values_of(scenario),
        nominal=nominal,
        runs=content.runs,
        seed=content.seed,
        disperse=content.disperse,
        shapes=tuple(
            _shapes(entry, nominal, f"{source}: disperse.{place}")
            for place, entry in enumerate(content.disperse)
        ),
        requirements=requirements_in(content.requirement, source),
        statistics=content.statistics,
        index=content.index,
    )
    for place in range(len(campaign.disperse)):
        _probe(campaign, place, f"{source}: disperse.{place}")
    _check_written(campaign)
    return campaign


def _check_written(campaign: Campaign) -> None:
    """Check, before anything is flown, that the folder's files would be read as this campaign."""
    texts = campaign.texts()
    scenario = scenario_of(parse_toml(texts[SCENARIO]), f"scenario {campaign.base['name']}")
    content = validated(CampaignTable, parse_toml(texts[FILE]), f"campaign {campaign.name}")
    again = replace(
        campaign,
        base=values_of(scenario),
        disperse=content.disperse,
        requirements=requirements_in(content.requirement, FILE),
        statistics=content.statistics,
        index=content.index,
    )
    if again.texts() != texts:
        raise TableError(f"campaign {campaign.name}: its files would not be read as the same campaign")


def _check_keys(content: CampaignTable, source: str) -> None:
    keys = [key for entry in content.disperse for key in entry.targets]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice:
        raise TableError(f"{source}: disperse gives {twice} twice")


def _shapes(entry: AnyDispersion, nominal: Nested, where: str) -> tuple[Shape, ...]:
    shapes = []
    for key in entry.targets:
        try:
            shapes.append(entry.shape_of(value_at(nominal, key)))
        except ValueError as error:
            raise TableError(f"{where} ({key}): {error}") from None
    return tuple(shapes)


def _probe(campaign: Campaign, place: int, where: str) -> None:
    """Lay the limits of a dispersion over the scenario, whose schema knows key and range."""
    entry, shapes = campaign.disperse[place], campaign.shapes[place]
    try:
        for values in entry.probes(shapes):
            overrides, _ = laid_over({}, campaign.nominal, entry, values)
            scenario_of(campaign.base, where, overrides)
    except ValueError as error:
        raise TableError(f"{where} ({', '.join(entry.targets)}): {error}") from None
