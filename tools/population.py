"""Fly the populations of random satellites and write docs/population.md with its pictures.

The flights and claims are those of ``torquer validate --only population``; the page shows each satellite too,
and what one difference alone does, from none to twice its bound. A run that was stopped goes on where it was.
Exit code 1 when a claim fails.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from argument_types import count

from sim.campaign.claim import ClaimVerdict, Study
from sim.campaign.flight import fly_order
from sim.campaign.population import POPULATIONS
from sim.campaign.runner import run
from sim.campaign.study_cache import with_cache
from sim.errors import HarnessError
from sim.progress import progress
from sim.record.destination import check_file
from sim.record.whole_file import replace_text
from sim.validate.population import claims as population
from sim.validate.population.page import draw_satellites, draw_sweep, page, spread_of
from sim.validate.population.sweep import QUANTITIES, sweep_order

PAGE = Path(__file__).resolve().parent.parent / "docs" / "population.md"


def write(satellites: int | None, sizes: int, seeds: Sequence[int], workers: int, out: Path) -> bool:
    """Fly, judge, draw, and write the page: whether every claim is met.

    Raises:
        HarnessError: a flight cannot be flown; those before it are kept.
    """
    populations = population.studies(satellites)
    sweeps = {
        (quantity, size): Study(
            f"{quantity.name}-{size:g}",
            tuple(partial(fly_order, sweep_order(quantity, size, seed)) for seed in seeds),
            lambda flights: [],
            has_flights=True,
        )
        for quantity in QUANTITIES
        for size in quantity.sizes(sizes)
    }
    studies = [*populations, *sweeps.values()]
    with progress("flying satellites", sum(len(study.tasks) for study in studies)) as watch:
        finished = run(with_cache(studies), workers, watch, lambda study: None)
    outcomes = [outcome for study in finished for outcome in study.outcomes]
    flights = {study.study.id.removeprefix("population."): study.results for study in finished}
    of_population = {name: flights[name] for name in POPULATIONS}
    lifted = {name: flights[name] for name in flights if name.endswith("_continuous")}
    swept = dict(zip(sweeps, finished[len(populations) :], strict=True))
    sweep = {
        quantity: [spread_of(size, swept[quantity, size].results) for size in quantity.sizes(sizes)]
        for quantity in QUANTITIES
    }
    pictures = [out.with_suffix(".svg"), out.with_name(f"{out.stem}-sweep.svg")]
    draw_satellites(of_population, pictures[0])
    draw_sweep(sweep, pictures[1])
    flown = sum(len(study.results) for study in finished)
    names = [picture.name for picture in pictures]
    replace_text(out, page(outcomes, of_population, lifted, sweep, names, f"{flown} flights."))
    return not any(outcome.verdict is ClaimVerdict.FAIL for outcome in outcomes)


def main(words: Sequence[str] | None = None) -> int:
    """Fly, judge, write the page; 1 if a claim fails."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--satellites", type=count, help="at most so many of each population; default: all")
    parser.add_argument("--sizes", type=count, default=6, help="of each quantity that is varied alone")
    parser.add_argument("--per-size", type=count, default=4, help="satellites of each size")
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its pictures lie beside it")
    arguments = parser.parse_args(words)
    try:
        check_file(arguments.out)
        seeds = range(1, 1 + arguments.per_size)
        met = write(arguments.satellites, arguments.sizes, seeds, arguments.workers, arguments.out)
    except HarnessError as error:
        print(f"population: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print("population: interrupted; flights that are done are not flown again", file=sys.stderr)
        return 130
    print(arguments.out)
    return int(not met)


if __name__ == "__main__":
    sys.exit(main())
