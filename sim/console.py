"""What a command says, and where: its result on stdout as lines or as one JSON document, the rest on stderr.

The console of the command that runs is set by ``speaking`` and found by the functions of this module, so that
the code of a command says what there is to say and does not ask how much of it is wanted.
"""

import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from fractions import Fraction
from importlib.metadata import version
from math import isfinite
from os import PathLike, fspath
from typing import Any

import click

from fsw.input.error_text import error_text, lines_text

SCHEMA_VERSION = 1
"""Of the documents of ``--json``: a key that changes its meaning, or is removed, changes it."""
_HEAD = ("command", "torquer_version", "schema_version", "exit_code", "warnings")


@dataclass(slots=True)
class Console:
    """How a command speaks.

    Attributes:
        command: its name.
        quiet: only failures are said.
        verbose: so is what is done, with which files, in what time.
        as_json: stdout is one JSON document.
        warnings: the warnings so far.
        answer: what the document holds.
    """

    command: str = ""
    quiet: bool = False
    verbose: bool = False
    as_json: bool = False
    warnings: list[str] = field(default_factory=list)
    answer: dict[str, Any] | None = None


_console: ContextVar[Console | None] = ContextVar("console", default=None)


def current() -> Console:
    """The console of the command that runs; one that says all lines where none does."""
    return _console.get() or Console()


@contextmanager
def speaking(console: Console) -> Iterator[Console]:
    """Make it the console of what runs inside."""
    token = _console.set(console)
    try:
        yield console
    finally:
        _console.reset(token)


def say(text: str, failed: bool = False) -> None:
    """A part of the result, on stdout; one that tells of a failure is said by a quiet command too."""
    console = current()
    if not console.as_json and (failed or not console.quiet):
        click.echo(lines_text(text))


def detail(text: str) -> None:
    """What a verbose command is doing, on stderr."""
    if current().verbose:
        click.echo(error_text(text), err=True)


def warn(text: str) -> None:
    """What is allowed and most likely wrong, on stderr and in the document."""
    console = current()
    console.warnings.append(text)
    if not console.quiet:
        click.echo(f"torquer: warning: {error_text(text)}", err=True)


def fail(text: str) -> None:
    """Why a verdict failed: one sentence on stderr."""
    click.echo(f"torquer: {error_text(text)}", err=True)


def answer(values: Mapping[str, Any]) -> None:
    """What the JSON document holds; it is printed when the command has ended with a verdict."""
    console = current()
    console.answer = {**(console.answer or {}), **values}


def document(console: Console, exit_code: int) -> dict[str, Any]:
    """The JSON document: the same head for each command, then its answer.

    What JSON has no number for, an infinite one, is null.
    """
    head = (console.command, version("torquer"), SCHEMA_VERSION, exit_code, console.warnings)
    document: dict[str, Any] = plain({**dict(zip(_HEAD, head, strict=True)), **(console.answer or {})})
    return document


def print_document(console: Console, exit_code: int) -> None:
    """Print it, alone on stdout."""
    json.dump(document(console, exit_code), sys.stdout, indent=2, allow_nan=False)
    sys.stdout.write("\n")


def plain(value: Any) -> Any:  # noqa: ANN401  (any value of JSON)
    """A value in the types of JSON: paths as strings, fractions as numbers, null for an infinite one."""
    match value:
        case Mapping():
            return {str(key): plain(one) for key, one in value.items()}
        case list() | tuple() | set() | frozenset():
            return [plain(one) for one in value]
        case Fraction():
            return float(value)
        case float() if not isfinite(value):
            return None
        case PathLike():
            return fspath(value)
    return value


def counted(number: int, noun: str) -> str:
    """The noun with its number: 1 run, 2 runs."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
