"""Options that commands share, and the way from their errors to a sentence and an exit code."""

import sys
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import click

from fsw.bus.interface import BusError
from fsw.bus.open_bus import KINDS
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from sim.errors import HarnessError
from sim.plant.errors import PlantError
from sim.signals import EndedBySignal, raise_on_signals
from torquer.api.errors import Error

Parameters = ParamSpec("Parameters")

SEEDS = click.IntRange(0, 2**64 - 1)
BUSES = f"auto, {KINDS}"
RUN_OR_LOG = click.argument("run_or_log", metavar="RUN|LOG", type=click.Path(path_type=Path))
SETTINGS = click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="Override a key of the scenario."
)
LAW_AGAIN = click.option(
    "--law", metavar="FILE.py:NAME", help="The law of its own that the run flew: only then it is executed."
)
COMPRESS = click.option(
    "--compress", is_flag=True, help="Write the log as bus.log.gz, a fourth of the size of bus.log."
)

OUT_FILE = click.option(
    "--out", required=True, metavar="FILE", type=click.Path(path_type=Path), help="The file to write."
)

SIGN = click.option(
    "--sign",
    metavar="KEY",
    type=click.Path(path_type=Path),
    help="Sign the run: a private Ed25519 key in PEM. Needs torquer[sign].",
)
VERIFY = click.option(
    "--verify",
    metavar="PUBLIC_KEY",
    type=click.Path(path_type=Path),
    help="The run must be signed: its public Ed25519 key in PEM. Needs torquer[sign].",
)


def sentences(command: Callable[Parameters, int | None]) -> Callable[Parameters, None]:
    """Turn an error that the user can correct into one sentence on stderr and an exit code."""

    @wraps(command)
    def run(*args: Parameters.args, **kwargs: Parameters.kwargs) -> None:
        try:
            with raise_on_signals():
                code = command(*args, **kwargs)
        except (Error, TableError, BusError, HarnessError, PlantError) as error:
            click.echo(f"torquer: {error_text(error)}", err=True)
            code = getattr(error, "exit_code", 2)
        except KeyboardInterrupt:
            click.echo("torquer: interrupted; what was written so far is kept", err=True)
            code = 130
        except EndedBySignal as end:
            click.echo(f"torquer: {end}", err=True)
            code = end.exit_code
        sys.exit(code or 0)

    return run


def law_and_settings(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of a command that flies a scenario: ``--set``, and ``--law`` for a law of one's own."""

    @SETTINGS
    @click.option(
        "--law", metavar="FILE.py:NAME", help="Fly this law of your own, or an installed one by its name."
    )
    @wraps(command)
    def run(*args: Any, law: str | None, settings: tuple[str, ...], **kwargs: Any) -> Any:  # noqa: ANN401  (as click calls it)
        named = () if law is None else (f"control.law={law}",)
        return command(*args, settings=(*named, *settings), **kwargs)

    return run


def report_failures(failures: Mapping[str, str]) -> int:
    """Print what failed, in one sentence; return the exit code."""
    from sim.report.verdict import flight_failed

    if failures:
        click.echo(f"torquer: {flight_failed(failures)}", err=True)
    return int(bool(failures))
