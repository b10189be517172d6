"""Options that commands share, and the way from their errors to a sentence and an exit code."""

import sys
import time
from collections.abc import Callable, Mapping
from functools import wraps
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

import click

from fsw.bus.open_bus import KINDS
from sim.console import Console, detail, fail, print_document, speaking
from torquer.cli.completions import of_buses, of_laws, of_paces, of_scenarios, of_settings

if TYPE_CHECKING:
    from sim.commissioning.report import CommissioningReport
    from sim.scenario.schema import Scenario

# --- Numbers as arguments: named as a reader would, in the help and where one is wrong


class Number(click.FloatRange):
    """A number within limits."""

    name = "number"


class WholeNumber(click.IntRange):
    """A whole number within limits."""

    name = "whole number"


# --- Options

Parameters = ParamSpec("Parameters")

SEEDS = WholeNumber(0, 2**64 - 1)
BUSES = f"auto, {KINDS}"
RUN_OR_LOG = click.argument("run_or_log", metavar="RUN|LOG", type=click.Path(path_type=Path))
SETTINGS = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="KEY=VALUE",
    shell_complete=of_settings,
    help="Override a key of the scenario.",
)
LAW_AGAIN = click.option(
    "--law", metavar="FILE.py:NAME", help="The user law that the run flew; without it none is executed."
)
COMPRESS = click.option(
    "--compress", is_flag=True, help="Write the log as bus.log.gz, a fourth of the size of bus.log."
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON document alone on stdout.")
JUNIT = click.option(
    "--junit",
    "--junit-xml",
    "--junitxml",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Write the verdicts as JUnit XML.",
)
OUT_FILE = click.option(
    "--out", "-o", required=True, metavar="FILE", type=click.Path(path_type=Path), help="The file to write."
)
SCENARIO_OF_LOG = click.option(
    "--scenario", metavar="SCENARIO", shell_complete=of_scenarios, help="Of a log that has none beside it."
)
PACE = click.option(
    "--pace",
    default="lockstep",
    show_default=True,
    shell_complete=of_paces,
    help="lockstep or realtime[:FACTOR].",
)
TEXT_OUT = click.option(
    "--out",
    "-o",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="The file to write. Default: stdout.",
)
FORCE = click.option("--force", is_flag=True, help="Replace FILE if it is there.")
SIGN = click.option(
    "--sign",
    metavar="KEY",
    type=click.Path(path_type=Path),
    help="Sign the run: a private Ed25519 key in PEM. Needs torquer[sign].",
)
CHANNEL = click.option("--channel", metavar="NAME", help="The channel to read, of a log that has several.")
VERIFY = click.option(
    "--verify",
    metavar="PUBLIC_KEY",
    type=click.Path(path_type=Path),
    help="The run must be signed: its public Ed25519 key in PEM. Needs torquer[sign].",
)
_QUIET = click.option("-q", "--quiet", is_flag=True, help="Print failures only.")
_VERBOSE = click.option(
    "-v", "--verbose", is_flag=True, help="Say on stderr what is done, with which files, in what time."
)
_MODES = ("quiet", "verbose", "as_json")


def scenario_argument(default: str | None = None, required: bool = True) -> Callable[..., Any]:
    """The argument SCENARIO, a name or a path; one with a default is not required."""
    return click.argument(
        "scenario",
        default=default,
        required=required and default is None,
        metavar="SCENARIO" if required and default is None else "[SCENARIO]",
        shell_complete=of_scenarios,
    )


def bus_option(more: str = "") -> Callable[..., Any]:
    """The option ``--bus``."""
    return click.option(
        "--bus", default="auto", show_default=True, shell_complete=of_buses, help=BUSES + more
    )


def examples(*lines: str) -> str:
    """The end of a command's help: command lines that work as they stand, what they do behind a ``#``."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def sentences(command: Callable[Parameters, int | None]) -> Callable[..., None]:
    """The options of every command, and an error that the user can correct as one sentence with an exit code.

    With ``--json`` the document is printed once the command has ended with a verdict: an error leaves stdout
    empty.
    """

    @_QUIET
    @_VERBOSE
    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> None:  # noqa: ANN401  (those of the command, and of this wrapper)
        name = click.get_current_context().command.name or ""
        quiet, verbose, as_json = (bool(kwargs.pop(mode, False)) for mode in _MODES)
        _check_finite(kwargs)
        with speaking(Console(name, quiet, verbose, as_json)) as console:
            began = _begin(name)
            code, judged = _verdict(command, *args, **kwargs)
            detail(f"{name}: exit code {code} after {time.monotonic() - began:.1f} s")
            if console.as_json and judged:
                print_document(console, code)
        sys.exit(code)

    return run


def _check_finite(options: Mapping[str, Any]) -> None:
    """Refuse nan and inf, with which comparisons go one way only.

    Raises:
        UsageError: naming option and value.
    """
    for parameter in click.get_current_context().command.params:
        value = options.get(parameter.name or "")
        for number in value if isinstance(value, tuple) else (value,):
            if isinstance(number, float) and not isfinite(number):
                raise click.UsageError(f"{parameter.opts[0]} {number}: is not a finite number")


def _begin(name: str) -> float:
    """Say what runs; the time."""
    from importlib.metadata import version
    from platform import platform, python_version

    detail(f"{name}: torquer {version('torquer')}, Python {python_version()}, {platform()}")
    return time.monotonic()


def _verdict(command: Callable[..., int | None], *args: Any, **kwargs: Any) -> tuple[int, bool]:  # noqa: ANN401  those of any command
    """The exit code, and whether the command itself gave it."""
    from fsw.bus.interface import BusError
    from fsw.input.schema import TableError
    from sim.errors import HarnessError
    from sim.plant.errors import PlantError
    from sim.signals import EndedBySignal, raise_on_signals
    from torquer.api.errors import Error

    try:
        with raise_on_signals():
            return command(*args, **kwargs) or 0, True
    except (Error, TableError, BusError, HarnessError, PlantError) as error:
        fail(str(error))
        return getattr(error, "exit_code", 2), False
    except KeyboardInterrupt:
        fail("interrupted; what was written so far is kept")
        return 130, False
    except EndedBySignal as end:
        fail(str(end))
        return end.exit_code, False


def law_and_settings(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of a command that flies a scenario: ``--set``, and ``--law`` for a user law."""

    @SETTINGS
    @click.option(
        "--law",
        metavar="FILE.py:NAME",
        shell_complete=of_laws,
        help="Fly this law of your own, or an installed one by its name.",
    )
    @wraps(command)
    def run(*args: Any, law: str | None, settings: tuple[str, ...], **kwargs: Any) -> Any:  # noqa: ANN401  (as click calls it)
        if law is not None:
            _check_law(law)
        named = () if law is None else (f"control.law={law}",)
        return command(*args, settings=(*named, *settings), **kwargs)

    return run


def _check_law(law: str) -> None:
    """Refuse a file without the name of a law in it, and a name that is meant to be a file's.

    Raises:
        UsageError: with what to write.
    """
    file, _, name = law.rpartition(":")
    if law.endswith(".py"):
        raise click.UsageError(f"--law {law}: which law of the file? Write {law}:NAME")
    if file and not file.endswith(".py") and Path(f"{file}.py").is_file():
        raise click.UsageError(f"--law {law}: did you mean {file}.py:{name}?")


def load_scenario(
    name_or_path: str, settings: tuple[str, ...], ticks_of_run: "Callable[[Scenario], int] | None" = None
) -> "Scenario":
    """The scenario with settings laid over it; what is most likely wrong in it, or in a run so long, is said.

    Raises:
        TableError: not found, or not valid.
    """
    from torquer.api.arguments import warn_of

    scenario = read_scenario(name_or_path, settings)
    warn_of(scenario, None if ticks_of_run is None else ticks_of_run(scenario))
    return scenario


def read_scenario(name_or_path: str, settings: tuple[str, ...]) -> "Scenario":
    """The same for what says itself what is most likely wrong.

    Raises:
        TableError: not found, or not valid.
    """
    from sim.scenario.schema import load, parse_settings

    scenario = load(name_or_path, parse_settings(settings))
    detail(f"scenario {scenario.name} of {name_or_path}{', ' + ', '.join(settings) if settings else ''}")
    return scenario


def say_report(found: "CommissioningReport") -> int:
    """Print what was found; return the exit code."""
    from sim.console import answer, say

    for line in found.lines:
        say(line.text, failed=line.failed)
    answer(found.values)
    return int(not found.ok)


def write_text_out(out: Path | None, text: str, force: bool) -> None:
    """Write a text to a file, or to stdout where none is named.

    Raises:
        UsageError: there is no file that could be replaced.
        HarnessError: it cannot be written, or is there and may not be replaced.
    """
    from sim.console import say
    from sim.result_files import write_text

    if out is None:
        if force:
            raise click.UsageError("--force replaces the file of --out, and none is named")
        click.echo(text, nl=False)
        return
    write_text(out, text, force)
    say(f"written: {out}")


def report_failures(failures: Mapping[str, str]) -> int:
    """Print what failed, in one sentence; return the exit code."""
    from sim.report.verdict import flight_failed

    if failures:
        fail(flight_failed(failures))
    return int(bool(failures))
