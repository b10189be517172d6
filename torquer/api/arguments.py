"""The arguments that several functions take, checked."""

from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path

from fsw.input.schema import Model, TableError, merge, validated
from fsw.table.own_law import named
from sim.scenario.schema import Scenario, load, scenario_of
from sim.scenario.settings import nested, plain
from sim.scenario.written import values_of

ScenarioLike = str | PathLike[str] | Scenario
"""The name of a shipped scenario, the path of a file, or a scenario."""
Settings = Mapping[str, object]
"""Values by key, ``{"time.tick_hz": 10}`` or ``{"time": {"tick_hz": 10}}``."""


def chosen_scenario(
    scenario: ScenarioLike, settings: Settings | None, law: str | PathLike[str] | None = None
) -> Scenario:
    """The scenario with a law of one's own and settings laid over it.

    Raises:
        TableError: there is none, or a key is unknown or out of range.
    """
    given = {} if law is None else {"control": {"law": path_text(law, "law")}}
    over = named(merge(given, nested(settings)), Path())
    if isinstance(scenario, Scenario) and not over:
        return scenario
    if isinstance(scenario, Scenario):
        return scenario_of(values_of(scenario), scenario.name, over)
    return load(path_text(scenario, "scenario"), over)


def path_text(path: object, name: str) -> str:
    """A path as text.

    Raises:
        TableError: it is none.
    """
    text = fspath(path) if isinstance(path, str | PathLike) else None
    if not isinstance(text, str) or not text:
        raise TableError(f"{name} = {path!r:.80}: give a path or a name")
    return text


def optional_path(path: str | PathLike[str] | None, name: str) -> Path | None:
    """The path, if one is given."""
    return None if path is None else Path(path_text(path, name))


def checked(model: type[Model], function: str, **values: object) -> Model:
    """Arguments of a function, checked by a model; numbers of numpy are numbers.

    Raises:
        TableError: the function, the argument and what is allowed.
    """
    return validated(model, {name: plain(value) for name, value in values.items()}, function)
