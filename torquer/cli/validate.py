"""``torquer validate``: the published figures and reference checks."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from torquer.cli.options import JSON, JUNIT, WholeNumber, examples, sentences

if TYPE_CHECKING:
    from sim.campaign.claim import ClaimOutcome

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
@click.option("--workers", "-n", type=WholeNumber(min=1), help="Processes. Default: one a core.")
@click.option(
    "--out",
    "-o",
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
    from sim.console import answer, say, warn
    from sim.validate.page import as_json
    from torquer.api.validate import validate

    done = validate(
        reference=reference,
        flight_data=flight_data,
        only=only,
        quick=quick,
        satellites=satellites,
        workers=workers,
        out=out,
        record=record,
        junit=junit,
        tell=_say,
        progress=True,
    )
    for name, file in (("figures", done.found.figures), ("page", done.page)):
        if file is not None:
            say(f"{name}: {file}")
    for doubt in done.doubts:
        warn(doubt)
    if done.found.not_claimed:
        say(done.found.not_claimed)
    say(done.found.tally)
    answer({"wall_s": done.found.wall_s, "page": done.page, "claims": list(map(as_json, done.outcomes))})
    return int(not done.ok)


def _say(outcome: "ClaimOutcome") -> None:
    from sim.campaign.claim import ClaimVerdict
    from sim.console import say
    from sim.validate.page import line

    say(line(outcome), failed=outcome.verdict is ClaimVerdict.FAIL)
