"""The ``torquer`` command. Errors are one sentence and exit code 2; a failed verdict is exit code 1.

Each kind of input is checked where it enters, and reported there. Any other exception that leaves a command
is a defect of this program: it stays a traceback (exit code 1), which shows where.
"""

import errno
import math
import os
import sys
from importlib import import_module
from io import TextIOWrapper
from typing import Any

import click

from fsw.input.error_text import error_text
from fsw.input.near import did_you_mean
from sim.errors import NO_ROOM, is_out_of_memory

GROUPS = {
    "Fly": {
        "sil": "Fly SCENARIO (realsat): plant and flight software as two processes on a bus.",
        "hil": "SCENARIO in real time: flight software against boards, stubs or hardware.",
        "plant": "Fly SCENARIO against a flight software on the same bus.",
        "fsw": "Fly on a bus: answer the SYNC of a plant.",
        "board": "Run one board on a bus, until Ctrl-C.",
    },
    "From bench to orbit": {
        "phasing": "Which way coils and magnetometer are wired, from pulses of each coil.",
        "calibrate": "Calibrate sensors, coils and body by a log with pulses or recorded telemetry.",
        "telemetry": "Run the flight filter over recorded telemetry, judged by what it did not use.",
    },
    "Look at a flight": {
        "watch": "Watch a bus, or a log at any pace; it only listens.",
        "report": "Rebuild summary.json and report.html of a run.",
        "check": "Audit the actuator limits in a candump log.",
        "replay": "Replay a log and compare the answers byte for byte.",
    },
    "Your own satellite": {
        "scenarios": "List the shipped scenarios, one line each.",
        "new": "Write a scenario for your own satellite, which flies at once.",
        "size": "Coil levels, and what pointing to expect.",
        "design": "Gains of the PD law by Floquet theory.",
    },
    "Many flights": {
        "compare": "Fly every applicable control law on SCENARIO, all else the same.",
        "campaign": "Fly many runs, drawn from the dispersions of CAMPAIGN.toml.",
        "faults": "Inject every fault of the table: a verdict per row.",
        "validate": "Check every published figure and reference.",
    },
    "Your own flight software": {
        "judge": "Fly SCENARIO against any flight software, and judge it.",
        "header": "Write the messages of the bus, and the limits of SCENARIO, as C.",
        "vectors": "Write a flight as golden vectors: what comes in and goes out, tick by tick.",
    },
    "Other tools": {
        "export": "Write a run for Foxglove, CANalyzer, SavvyCAN, pandas or xarray.",
        "dbc": "Write the messages of the bus as a DBC with cycle times.",
        "xtce": "Write the messages of the bus as XTCE, for mission control systems.",
    },
    "This machine": {
        "doctor": "What torquer needs: what is there, what is missing, what to type.",
        "completion": "Print the completion script of a shell.",
    },
}
"""The commands by what a user wants to do, with what they do: help need not load them for it."""
COMMANDS = tuple(name for group in GROUPS.values() for name in group)
"""The commands; each is in the module of its name."""
LEAST_MEMORY_MB = 400
"""Address space of the libraries and a page; where it is less, OpenBLAS may wait for it without end."""


class Commands(click.Group):
    """The commands; a wrong option, like any other error, is one sentence, without the usage before it."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """In the order in which they are shown."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command, from the module of its name: only that module is loaded."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f"torquer.cli.{cmd_name}"), cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command that the arguments begin with.

        Raises:
            UsageError: there is no such command.
        """
        if args and not ctx.resilient_parsing and args[0] not in COMMANDS and not args[0].startswith("-"):
            hint = did_you_mean(args[0], COMMANDS)
            raise click.UsageError(f"there is no command {args[0]!r}{hint}; `torquer --help` lists them")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The commands, by group."""
        for heading, commands in GROUPS.items():
            with formatter.section(heading):
                formatter.write_dl([(name.ljust(10), line) for name, line in commands.items()])

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments; none may hold a NUL character."""
        if any("\0" in word for word in args):
            raise click.UsageError("an argument holds a NUL character")
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401  (as in click)
        """Run the command, where this process may have the memory that it needs."""
        allowed_mb = _memory_limit_mb()
        if allowed_mb < LEAST_MEMORY_MB:
            raise click.ClickException(
                f"there is not enough memory: this process may have {allowed_mb:.0f} MB (ulimit -v), "
                f"and torquer needs {LEAST_MEMORY_MB} MB"
            )
        return super().invoke(ctx)

    def main(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401  (as in click)
        """Run a command line and exit."""
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads cost memory, and matrices are small
        _open_closed_streams()
        if isinstance(sys.stdout, TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # a path need not be valid text
        try:
            code = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.ClickException as error:
            click.echo(f"torquer: {error_text(_sentence(error))}", err=True)
            code = error.exit_code
        except (OSError, MemoryError, ImportError) as error:
            sentence, code = _of_the_system(error)
            click.echo(f"torquer: {error_text(sentence)}", err=True)
        except click.Abort:
            code = 130
        sys.exit(code)


def _open_closed_streams() -> None:
    """Open the null device for each standard stream that the caller has closed, the lowest number first.

    Python has None in its place, and the next file that is opened would get its number.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115  (until the process ends)


def _memory_limit_mb() -> float:
    """The address space that this process may have."""
    if sys.platform == "win32":
        return math.inf
    import resource  # not on Windows

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    return math.inf if limit == resource.RLIM_INFINITY else limit / 1e6


def _of_the_system(error: OSError | MemoryError | ImportError) -> tuple[str, int]:
    """A sentence and an exit code, where it is no defect: no memory, no room, a file that cannot be used.

    An error need not say of which file it is; then neither does the sentence.
    """
    if is_out_of_memory(error):
        return "there is not enough memory; what was written before is kept", 1
    if not isinstance(error, OSError) or error.errno is None:
        raise error
    if error.errno in NO_ROOM:
        of = "" if error.filename is None else f"{error.filename}: "
        return f"{of}there is no room to write ({error.strerror}); what was written before is kept", 1
    if error.filename is not None:
        return f"{error.filename}: {error.strerror}", 2
    if error.errno == errno.ENOENT and not _has_folder():
        return "the folder that this runs in is no longer there: cd to another", 2
    return f"the system refuses ({error.strerror}), and does not say of which file", 2


def _has_folder() -> bool:
    """Whether the folder that this runs in is there: the error itself does not say what is missing."""
    try:
        os.getcwd()
    except FileNotFoundError:
        return False
    return True


def _sentence(error: click.ClickException) -> str:
    """What click says of a wrong option or value, with what may have been meant."""
    if isinstance(error, click.NoSuchOption) and error.ctx is not None:
        options = [word for one in error.ctx.command.params for word in (*one.opts, *one.secondary_opts)]
        known = [word for word in options if word.startswith("-")]
        return f"{error.message.rstrip('.')}{did_you_mean(error.option_name, known)}"
    text = error.format_message()
    if isinstance(error, click.MissingParameter):
        text = " ".join(text.split())  # a choice is listed by lines
    kind = error.param.type if isinstance(error, click.BadParameter) and error.param is not None else None
    if isinstance(kind, click.Choice):
        given = text.partition("'")[2].rpartition("' is not")[0].rpartition("'")[2]
        text = f"{text.rstrip('.')}{did_you_mean(given, map(str, kind.choices))}"
    return text


@click.group(
    cls=Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Each command has a help of its own, with examples: torquer sil --help",
)
@click.version_option(None, "--version", "-V", package_name="torquer", prog_name="torquer")
@click.pass_context
def main(context: click.Context) -> None:
    """Magnetic attitude control as flight software: fly it, replay it, audit it."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


if __name__ == "__main__":
    main()
