"""``torquer validate``: the published figures and reference checks."""

from pathlib import Path

import click

from torquer.cli.numbers import WholeNumber
from torquer.cli.options import JSON, JUNIT, examples, sentences

EXAMPLES = examples(
    "torquer validate --quick",
    "torquer validate --only population --satellites 20",
    "torquer validate --out validation.md",
)


@click.command(epilog=EXAMPLES)
@click.option(
    "--reference",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Check against the reference files in this folder alone.",
)
@click.option(
    "--flight-data",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Make the claims on recorded passes, s3_*.csv and tle.txt in this folder, alone.",
)
@click.option(
    "--only", multiple=True, metavar="ID", help="These claims alone, by the first words of their ids."
)
@click.option("--quick", is_flag=True, help="Leave out flights.")
@click.option(
    "--satellites",
    type=WholeNumber(min=1),
    help="At most so many of each population. A claim on the median or mean of more is then not judged. "
    "Default: all.",
)
@click.option("--workers", type=WholeNumber(min=1), help="Processes. Default: one a core.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="The page. Default, if all is run: docs/validation.md of the repository, else validation.md.",
)
@click.option(
    "--record",
    is_flag=True,
    help="Put the outcomes among those of validation.json, and write the page of all.",
)
@JUNIT
@JSON
@sentences
def validate(
    reference: Path | None,
    flight_data: Path | None,
    only: tuple[str, ...],
    quick: bool,
    satellites: int | None,
    workers: int | None,
    out: Path | None,
    junit: Path | None,
    record: bool,
) -> int:
    """Check every published figure and reference: claim, source, our figure, verdict.

    All take an hour or more, most of it flights. A run that was stopped goes on where it was.
    """
    from sim.validate.command import validate

    return validate(reference, only, out, quick, workers, satellites, junit, flight_data, record)
