"""Runs the command line of a node: a wrong option is one sentence, without the usage before it."""

from collections.abc import Sequence

import click

from fsw.input.error_text import error_text


def run(command: click.Command, name: str, arguments: Sequence[str] | None = None) -> int:
    """Run a command: its exit code.

    Args:
        command: what it does; it may end by ``sys.exit`` too.
        name: begins the sentence.
        arguments: None: those of this process.
    """
    try:
        code = command.main(arguments, prog_name=f"python -m {name}", standalone_mode=False)
    except click.ClickException as error:
        click.echo(f"{name}: {error_text(error.format_message())}", err=True)
        return error.exit_code
    except click.Abort:
        return 130
    return code or 0
