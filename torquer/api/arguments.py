"""The arguments that several functions take, checked."""

from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path

from fsw.input.schema import Model, Nested, TableError, merge, validated
from sim.console import warn
from sim.scenario.schema import Scenario, load
from sim.scenario.settings import nested, plain

ScenarioLike = str | PathLike[str] | Scenario
"""The name of a shipped scenario, the path of a file, or a scenario."""
Settings = Mapping[str, object]
"""Values by key, ``{"time.tick_hz": 10}`` or ``{"time": {"tick_hz": 10}}``."""


def chosen_scenario(
    scenario: ScenarioLike, settings: Settings | None, law: str | PathLike[str] | None = None
) -> Scenario:
    """The scenario with a user law and settings laid over it.

    Raises:
        TableError: there is none, or a key is unknown or out of range.
    """
    return load(scenario_source(scenario), laid_over(settings, law))


def warn_of(scenario: Scenario, ticks: int | None = None) -> None:
    """Say what is most likely wrong in a scenario of which a run takes so many ticks."""
    from sim.sizing.scenario_warnings import scenario_warnings  # noqa: PLC0415  loaded when something flies

    for doubt in scenario_warnings(scenario, ticks):
        warn(doubt)


def laid_over(settings: Settings | None, law: str | PathLike[str] | None = None) -> Nested:
    """Settings as sections, over a user law.

    Raises:
        TableError: they are no settings, or the law is no path.
    """
    given = {} if law is None else {"control": {"law": path_text(law, "law")}}
    return merge(given, nested(settings))


def scenario_source(scenario: ScenarioLike) -> str | Scenario:
    """A scenario, or the name or path of one.

    Raises:
        TableError: it is none of these.
    """
    return scenario if isinstance(scenario, Scenario) else path_text(scenario, "scenario")


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
