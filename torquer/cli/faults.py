"""``torquer faults``: the fault campaign."""

from pathlib import Path

import click

from torquer.cli.completions import of_fault_rows
from torquer.cli.options import JSON, JUNIT, WholeNumber, examples, sentences

EXAMPLES = examples(
    "torquer faults --list",
    "torquer faults --only mag-bias --phases 4 --seeds 3",
    "torquer faults --junit faults.xml --quiet",
)


@click.command(epilog=EXAMPLES)
@click.option(
    "--only",
    "--row",
    "rows",
    multiple=True,
    metavar="NAME",
    shell_complete=of_fault_rows,
    help="These rows alone, by their first words.",
)
@click.option("--phases", default=1, show_default=True, type=WholeNumber(min=1), help="Of each row.")
@click.option("--seeds", default=1, show_default=True, type=WholeNumber(min=1), help="Of each phase.")
@click.option("--list", "listing", is_flag=True, help="Print the rows and what they expect.")
@click.option(
    "--out", "-o", type=click.Path(path_type=Path), help="Folder of faults.xml (JUnit), .html and .json."
)
@click.option("--workers", "-n", type=WholeNumber(min=1), help="Processes. Default: one a core.")
@click.option("--slow", is_flag=True, help="Also rows that run real processes: minutes.")
@click.option("--write-docs", is_flag=True, help="Write docs/faults.md of the repository.")
@JUNIT
@JSON
@sentences
def faults(
    rows: tuple[str, ...],
    phases: int,
    seeds: int,
    listing: bool,
    out: Path | None,
    workers: int | None,
    slow: bool,
    write_docs: bool,
    junit: Path | None,
) -> int:
    """Inject every fault of the table, in several phases and with several seeds: a verdict per row.

    A run that was stopped goes on where it was.
    """
    from sim.fault_table import command

    if listing:
        return command.list_rows(rows)
    return command.faults(rows, phases, seeds, out, workers, write_docs, slow, junit)
