"""TOML that is about to be written, checked by reading it: what flies can be read again."""

import tomllib
from collections.abc import Callable
from pathlib import Path

import tomli_w
from pydantic import BaseModel

from fsw.input.schema import Nested, TableError
from fsw.input.toml_text import MOST_BYTES, BoundsError, parse_toml
from fsw.table import table as onboard
from sim.scenario.schema import Scenario, flight_table, scenario_of


def scenario_toml(scenario: Scenario, source: str = "scenario") -> str:
    """A scenario as TOML.

    Raises:
        TableError: the text would not be read as this scenario.
    """
    return toml_of(scenario, lambda values: scenario_of(values, source), source)


def toml_of(model: BaseModel, read: Callable[[Nested], BaseModel], source: str) -> str:
    """The values of a model as TOML.

    Args:
        model: what is to be written.
        read: makes a model of the values in a file.
        source: begins the sentence of an error.

    Raises:
        TableError: the text would not be read as this model.
    """
    values = values_of(model)
    text = checked_toml(values, source)
    if values_of(read(parse_toml(text))) != values:
        raise TableError(f"{source}: its file would not be read as what it was written from")
    return text


def checked_toml(values: Nested, source: str) -> str:
    """Values as TOML that can be read.

    Raises:
        TableError: they cannot be written, or the text could not be read.
    """
    try:
        text = tomli_w.dumps(values)
        size = len(text.encode("utf-8"))
        parse_toml(text)
    except UnicodeEncodeError as error:
        wrong = error.object[error.start]
        raise TableError(f"{source}: cannot be written: {wrong!r} is no character of a text") from None
    except (TypeError, BoundsError, tomllib.TOMLDecodeError) as error:
        raise TableError(f"{source}: could not be read again: {error}") from None
    if size > MOST_BYTES:
        raise TableError(f"{source}: could not be read again: {size} bytes, at most {MOST_BYTES} are read")
    return text


def values_of(model: BaseModel) -> Nested:
    """The values of a model as in its file: what is not set is left out."""
    return model.model_dump(mode="json", exclude_none=True)


# --- The onboard table of a scenario as a file, for flight software in a process of its own

FLIGHT_TABLE = "flight.toml"


def write_flight_table(folder: Path, scenario: Scenario) -> Path:
    """Write the resolved table into a folder, and return its path.

    Raises:
        TableError: the scenario's ``[flight]`` holds what the onboard table does not take, or the table could
            not be read again.
        OSError: it cannot be written.
    """
    path = folder / FLIGHT_TABLE
    source = f"onboard table of scenario {scenario.name}"
    text = toml_of(flight_table(scenario), lambda values: onboard.flight_table(values, source), source)
    path.write_text(text, encoding="utf-8")
    return path
