"""The ``torquer`` command. Errors are one sentence and exit code 2; a failed verdict is exit code 1.

Each kind of input is checked where it enters, and reported there. Any other exception that leaves a command
is a defect of this program: it stays a traceback (exit code 1), which shows where.
"""

import sys
from importlib import import_module
from io import TextIOWrapper
from typing import Any

import click

from fsw.input.error_text import error_text
from sim.errors import DISK_FULL

COMMANDS = (
    "scenarios",
    "sil",
    "replay",
    "check",
    "report",
    "validate",
    "design",
    "compare",
    "campaign",
    "faults",
    "hil",
    "watch",
    "plant",
    "fsw",
    "board",
    "export",
    "dbc",
    "xtce",
)
"""The commands; each is in the module of its name."""


class Commands(click.Group):
    """The commands; a wrong option, like any other error, is one sentence, without the usage before it."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """In the order in which they are used."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command, from the module of its name: only that module is loaded."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f"torquer.cli.{cmd_name}"), cmd_name)
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments; none may hold a NUL character."""
        if any("\0" in word for word in args):
            raise click.UsageError("an argument holds a NUL character")
        return super().parse_args(ctx, args)

    def main(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401  (as in click)
        """Run a command line and exit."""
        if isinstance(sys.stdout, TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # a path need not be valid text
        try:
            code = super().main(*args, **{**kwargs, "standalone_mode": False})
        except click.ClickException as error:
            click.echo(f"torquer: {error_text(error.format_message())}", err=True)
            code = error.exit_code
        except OSError as error:
            if error.errno not in DISK_FULL:
                raise
            click.echo(
                f"torquer: the disk is full ({error.strerror}); what was written before is kept", err=True
            )
            code = 1
        except click.Abort:
            code = 130
        sys.exit(code)


@click.group(
    cls=Commands, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(package_name="torquer", prog_name="torquer")
@click.pass_context
def main(context: click.Context) -> None:
    """Magnetic attitude control as flight software: fly it, replay it, audit it."""
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


if __name__ == "__main__":
    main()
