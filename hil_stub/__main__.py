"""Run one board on a named bus: ``python -m hil_stub coil|dipole|magnetometer|sun|cells --bus BUS``."""

import sys
from typing import Final

import click

from fsw.input.error_text import error_text
from hil_stub.process.command import board

EXIT_BAD_INPUT: Final = 2


def main(arguments: list[str] | None = None) -> int:
    """Run the command line: the exit code, and one sentence on stderr when it is not 0."""
    try:
        board.main(arguments, prog_name="python -m hil_stub", standalone_mode=False)
    except click.UsageError as error:
        click.echo(error_text(error.format_message()), err=True)
        return EXIT_BAD_INPUT
    except click.ClickException as error:
        click.echo(error_text(error.format_message()), err=True)
        return error.exit_code
    except click.Abort:
        pass
    return 0


if __name__ == "__main__":
    sys.exit(main())
