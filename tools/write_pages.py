"""Write the pages of docs that follow from code, data and other pages; with --check, 1 when one is stale."""

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import click

from sim.campaign.definition.words import FIGURE_WORDS, KINDS
from sim.fault_table import requirements
from sim.fault_table.render import kinds_page
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


class Evidence(NamedTuple):
    """A page that a command writes from what it measures.

    Attributes:
        page: its name.
        shows: of what it is evidence.
        command: that writes it.
        pattern: of what the verdict is read from; every match counts.
        words: the verdict, with the groups of the first match, ``count`` of all, and ``total``, their sum.
    """

    page: str
    shows: str
    command: str
    pattern: str
    words: str

    def verdict(self) -> str:
        """What the page has come to."""
        found = list(re.finditer(self.pattern, (DOCS / f"{self.page}.md").read_text(encoding="utf-8"), re.M))
        numbers = [int(one[1]) for one in found if one[1].isdigit()]
        return self.words.format(*found[0].groups(), count=len(found), total=sum(numbers))


CLAIMS = r"^(\d+ claims met.*)\.$"
EVIDENCE = (
    Evidence("validation", "published figures, reference data", "make validate", CLAIMS, "{}"),
    Evidence("population", "satellites that differ from their tables", "make population", CLAIMS, "{}"),
    Evidence("faults", "injected faults", "make faults", r"^(\d+ rows, .*?)\. Phases", "{}"),
    Evidence("methods", "the methods of the papers", "write_pages.py", r"Verdicts: (.*)\.$", "{}"),
    Evidence(
        "comparison",
        "every law on six satellites",
        "make comparison",
        r"\| (kept) \|$",
        "{count} flights, limits kept",
    ),
    Evidence(
        "pulse-limits",
        "pulses beside the best dipole",
        "make pulse-limits",
        r"^\| 100 \| ([\d.]+) \| [\d.]+ \| ([\d.]+) \|",
        "`pulse_mpc` {1} deg, the bound {0} deg",
    ),
    Evidence(
        "performance",
        "speed of flights and campaigns",
        "make bench",
        r"^\| microsat, one process \| (\d+) \| ([\d.]+)",
        "{0} times real time, {1} of Basilisk in C",
    ),
    Evidence(
        "basilisk",
        "the flight software over another simulator's plant",
        "make basilisk",
        r"^\| \d+ \| own \| ([\d.]+) \|.*\n\| \d+ \| Basilisk \| ([\d.]+) \|",
        "{1} deg over Basilisk, {0} deg over the own plant",
    ),
    Evidence(
        "scaling",
        "campaigns of many runs",
        "make scaling",
        r"^\| a run, flown and scored \| (.*) \|$",
        "a run {}",
    ),
    Evidence(
        "firmware-qemu",
        "the coil board in C on a Cortex-M3",
        "make firmware-qemu",
        r"^\| [^|]+ \| (\d+) \| \d+ \|.* \| 0 \|$",
        "{total} hostile requests, no limit broken",
    ),
    Evidence("soak", "long runs", "make soak", r"\| (kept) \|$", "{count} budgets kept"),
    Evidence(
        "mutation",
        "changed lines of code",
        "make mutation",
        r"^(\d+ mutants, .*)\.$",
        "{}",
    ),
    Evidence(
        "replay",
        "replay on other machines",
        "make replay-elsewhere",
        r"\| (bit|command)-exact \|",
        "{count} replays with the same commands",
    ),
)


def evidence_page() -> str:
    """evidence.md: of each page of evidence its verdict."""
    rows = (f"| [{one.shows}]({one.page}.md) | {one.verdict()} | `{one.command}` |" for one in EVIDENCE)
    head = (ROOT / "tools" / "evidence.md.in").read_text(encoding="utf-8")
    return head.replace("{{rows}}", "\n".join(rows))


FIGURES_HEAD = """# Figures of a campaign

Written by `tools/write_pages.py`; do not edit. Every figure that a run of a [campaign](campaigns.md) has: its
column in `results.sqlite` and in `[requirement]` of the campaign file, what pages and terminal call it, and
its unit. Figures without a unit are counts or parts.
"""


def figures_page() -> str:
    """campaign-figures.md: the columns of a run by kind, in words."""
    parts = [FIGURES_HEAD]
    for kind in KINDS:
        rows = [
            f"| `{name}` | {words.words} | {words.unit} |"
            for name, words in FIGURE_WORDS.items()
            if words.kind == kind
        ]
        parts.append(
            "\n".join([f"## {kind.capitalize()}", "", "| column | what | unit |", "|---|---|---|", *rows])
        )
    return "\n".join(f"{part.rstrip()}\n" for part in parts)


PAGES: dict[str, Callable[[], str]] = {
    "campaign-figures.md": figures_page,
    "cli.md": cli_page,
    "evidence.md": evidence_page,
    "methods.md": lambda: methods_page(read_methods(), as_figures(read_record(DOCS / "validation.json"))),
    "requirements.md": requirements.document,
    "scenario-faults.md": kinds_page,
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
