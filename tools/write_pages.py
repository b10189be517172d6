"""Write the pages of docs that follow from code and data alone; with --check, exit 1 when one is stale."""

import sys
from collections.abc import Callable
from pathlib import Path

import click

from sim.fault_table import requirements
from sim.methods import page as methods_page
from sim.methods import read_methods
from sim.record.whole_file import replace_text
from sim.scenario.keys import editor_schema
from sim.scenario.keys import page as keys
from sim.validate.outcomes import as_figures, read_record
from torquer.cli.main import GROUPS, main

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"


def cli_page() -> str:
    """cli.md: its head, then the commands by group."""
    parts: list[str] = []
    for heading, commands in GROUPS.items():
        parts += [f"## {heading}", *(_section(name) for name in commands)]
    head = (ROOT / "tools" / "cli.md.in").read_text(encoding="utf-8")
    return head.replace("{{commands}}", "\n\n".join(parts))


def _section(name: str) -> str:
    """A command and, of a group, what is below it."""
    command = main.get_command(click.Context(main), name)
    assert command is not None
    below = command.commands.values() if isinstance(command, click.Group) else ()
    parts = [_described(command, f"torquer {name}", "###"), *_examples(command)]
    parts += [_described(one, f"torquer {name} {one.name}", "####") for one in below]
    return "\n\n".join(parts)


def _described(command: click.Command, name: str, heading: str) -> str:
    """Heading, usage, what it does, and the table of its options."""
    context = click.Context(command, info_name=name)
    usage = " ".join([name, *command.collect_usage_pieces(context)])
    records = (one.get_help_record(context) for one in command.params)
    options = [f"| `{_cell(names)}` | {_cell(text)} |" for names, text in filter(None, records) if text]
    table = ["| option | |", "|---|---|", *options] if options else []
    text = "\n".join(line.strip() for line in (command.help or "").splitlines())
    return "\n\n".join([f"{heading} {name}", f"`{usage}`", text, "\n".join(table)]).strip()


def _examples(command: click.Command) -> list[str]:
    """The examples at the end of its help."""
    lines = [line for line in (command.epilog or "").splitlines() if line.startswith("  ")]
    return ["\n".join(["```", *(line.strip() for line in lines), "```"])] if lines else []


def _cell(text: str) -> str:
    """A text for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


PAGES: dict[str, Callable[[], str]] = {
    "cli.md": cli_page,
    "methods.md": lambda: methods_page(read_methods(), as_figures(read_record(DOCS / "validation.json"))),
    "requirements.md": requirements.document,
    "scenario-keys.md": keys.page,
    "scenario.schema.json": editor_schema.as_text,
}


def run() -> int:
    stale = 0
    for name, text in PAGES.items():
        path = DOCS / name
        if "--check" not in sys.argv[1:]:
            replace_text(path, text())
        elif not path.is_file() or path.read_text(encoding="utf-8") != text():
            print(f"{path} is stale: run tools/write_pages.py")
            stale = 1
    return stale


if __name__ == "__main__":
    sys.exit(run())
