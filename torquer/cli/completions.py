"""What a shell may complete: scenarios, keys of ``--set`` and their values, buses, laws, rows of faults."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import click
from click.shell_completion import CompletionItem

if TYPE_CHECKING:
    from pydantic import BaseModel

_Items = list[CompletionItem]


def of_scenarios(context: click.Context, parameter: click.Parameter, begun: str) -> _Items:
    """The scenarios that ship, by name, and files."""
    from sim.scenario.schema import shipped_names

    return _or_files(begun, shipped_names())


def of_settings(context: click.Context, parameter: click.Parameter, begun: str) -> _Items:
    """Keys of a scenario, each with its ``=``; after it the values, where they are words."""
    from fsw.core.laws.table import LAWS
    from sim.scenario.schema import Scenario

    key, equals, _ = begun.partition("=")
    values = {**dict(keys_of(Scenario)), "control.law": tuple(LAWS)}
    words = (
        (f"{key}={value}" for value in values.get(key, ()))
        if equals
        else (f"{key}=" for key, _ in keys_of(Scenario))
    )
    return _beginning(begun, words)


def of_buses(context: click.Context, parameter: click.Parameter, begun: str) -> _Items:
    """Kinds of bus, and the CAN interfaces of this machine; of a command that takes a run, files."""
    from sim.doctor import can_interfaces

    in_one_process = ["virtual"] if context.command.name == "sil" else []
    interfaces = (f"socketcan:{name}" for name in can_interfaces())
    words = ["auto", "loop", "slcan:", *in_one_process, *interfaces]
    return _or_files(begun, words) if parameter.param_type_name == "argument" else _beginning(begun, words)


def of_paces(context: click.Context, parameter: click.Parameter, begun: str) -> _Items:
    """Lockstep, and real time with or without its factor."""
    return _beginning(begun, ("lockstep", "realtime", "realtime:"))


def of_laws(context: click.Context, parameter: click.Parameter, begun: str) -> _Items:
    """Laws, the last of a list with commas; files, of which one may have a law."""
    from fsw.core.laws.table import LAWS

    before, comma, _ = begun.rpartition(",")
    return _or_files(begun, (f"{before}{comma}{name}" for name in LAWS))


def of_fault_rows(context: click.Context, parameter: click.Parameter, begun: str) -> _Items:
    """Rows of the table of faults."""
    from sim.fault_table.rows.table import ROWS

    return _beginning(begun, (row.name for row in ROWS))


def keys_of(model: "type[BaseModel]", prefix: str = "") -> Iterator[tuple[str, tuple[str, ...]]]:
    """The keys of a section and of those below it, with dots, each with the words that are its values."""
    from fsw.input.schema import section_in, words_of

    for name, field in model.model_fields.items():
        below = section_in(field.annotation)
        if below is not None:
            yield from keys_of(below, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", words_of(field.annotation)


def _or_files(begun: str, words: Iterable[str]) -> _Items:
    return _beginning(begun, words) or [CompletionItem(begun, type="file")]


def _beginning(begun: str, words: Iterable[str]) -> _Items:
    return [CompletionItem(word) for word in words if word.startswith(begun)]
