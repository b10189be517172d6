"""Write docs/cli.md from the help of every command; with --check, exit 1 when the file is stale."""

import sys
from pathlib import Path

import click

from sim.record.whole_file import replace_text
from torquer.cli.main import GROUPS, main

ROOT = Path(__file__).resolve().parents[1]
HEAD, PAGE = ROOT / "tools" / "cli.md.in", ROOT / "docs" / "cli.md"


def page() -> str:
    """The page: its head, then the commands by group."""
    parts: list[str] = []
    for heading, commands in GROUPS.items():
        parts += [f"## {heading}", *(section(name) for name in commands)]
    return HEAD.read_text(encoding="utf-8").replace("{{commands}}", "\n\n".join(parts))


def section(name: str) -> str:
    """A command and, of a group, what is below it."""
    command = main.get_command(click.Context(main), name)
    assert command is not None
    below = command.commands.values() if isinstance(command, click.Group) else ()
    parts = [described(command, f"torquer {name}", "###"), *examples(command)]
    parts += [described(one, f"torquer {name} {one.name}", "####") for one in below]
    return "\n\n".join(parts)


def described(command: click.Command, name: str, heading: str) -> str:
    """Heading, usage, what it does, and the table of its options."""
    context = click.Context(command, info_name=name)
    usage = " ".join([name, *command.collect_usage_pieces(context)])
    records = (one.get_help_record(context) for one in command.params)
    options = [f"| `{cell(names)}` | {cell(text)} |" for names, text in filter(None, records) if text]
    table = ["| option | |", "|---|---|", *options] if options else []
    text = "\n".join(line.strip() for line in (command.help or "").splitlines())
    return "\n\n".join([f"{heading} {name}", f"`{usage}`", text, "\n".join(table)]).strip()


def examples(command: click.Command) -> list[str]:
    """The examples at the end of its help."""
    lines = [line for line in (command.epilog or "").splitlines() if line.startswith("  ")]
    return ["\n".join(["```", *(line.strip() for line in lines), "```"])] if lines else []


def cell(text: str) -> str:
    """A text for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def run() -> int:
    if "--check" in sys.argv[1:]:
        stale = not PAGE.is_file() or PAGE.read_text(encoding="utf-8") != page()
        if stale:
            print(f"{PAGE} is stale: run tools/write_cli.py")
        return int(stale)
    replace_text(PAGE, page())
    return 0


if __name__ == "__main__":
    sys.exit(run())
