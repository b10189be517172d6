"""Fly the populations of random satellites and write docs/population.md with its pictures.

The flights and claims are those of ``torquer validate --only population``; the page shows each satellite too,
and what one difference alone does, from none to twice its bound. Each flight is kept in a file at once: a run
that was stopped goes on where it was, and --render writes the page anew without flying. Exit code 1 when a
claim fails.
"""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from argument_types import count

from sim.campaign.claim import ClaimOutcome, ClaimVerdict, Study
from sim.campaign.flight import FlightResult, Order, fly_order
from sim.campaign.population import POPULATIONS
from sim.campaign.runner import run
from sim.campaign.study import FlightStudy, part_of
from sim.errors import HarnessError
from sim.progress import Watch, progress
from sim.record.destination import check_file
from sim.record.whole_file import replace_text
from sim.validate.flight_rows import FlightRows, order_hash
from sim.validate.population import claims as population
from sim.validate.population.page import page
from sim.validate.population.pictures import SizeSpread, draw_satellites, draw_sweep, spread_of
from sim.validate.population.sweep import QUANTITIES, Quantity, sweep_order, sweep_orders

ROOT = Path(__file__).resolve().parent.parent
PAGE, ROWS = ROOT / "docs" / "population.md", ROOT / "build" / "flights.jsonl"


def fly_missing(orders: Sequence[Order], rows: FlightRows, workers: int) -> None:
    """Fly the orders of which there is no flight yet, and keep each as it comes.

    Raises:
        HarnessError: a flight cannot be flown, or its row not be written; those before it are kept.
    """
    missing = {order_hash(order): order for order in orders if rows.flight(order) is None}
    tasks = tuple(partial(fly_order, order) for order in missing.values())
    print(f"{len(tasks)} satellites to fly, {len(orders) - len(tasks)} are flown", file=sys.stderr)
    flights = Study("flights", tasks, lambda results: [], has_flights=True)
    with counted("flying satellites", len(tasks)) as watch:
        run([flights], workers, watch, lambda study: None, rows.keep)


@contextmanager
def counted(what: str, total: int) -> Iterator[Watch]:
    """A progress bar; where there is no terminal, a line for each."""
    with progress(what, total) as watch:
        if sys.stderr.isatty():
            yield watch
        else:
            yield lambda done: print(f"{what}: {done} of {total}", file=sys.stderr, flush=True)


def flights_of(orders: Sequence[Order], rows: FlightRows) -> list[FlightResult]:
    """Those of the orders that there are."""
    found = (rows.flight(order) for order in orders)
    return [flight for flight in found if flight is not None]


def write(
    studies: Sequence[FlightStudy], sizes: int, seeds: Sequence[int], rows: FlightRows, out: Path
) -> list[ClaimOutcome]:
    """Judge the flights that there are, draw them, and write the page."""
    outcomes = []
    for study in studies:
        flown = part_of(study, lambda order: rows.flight(order) is not None)
        outcomes += flown.conclude(flights_of(flown.orders, rows))
    by_name = {study.id.partition(".")[2]: study for study in studies}
    populations = {name: flights_of(by_name[name].orders, rows) for name in POPULATIONS}
    sweep = {quantity: list(_spreads(quantity, sizes, seeds, rows)) for quantity in QUANTITIES}
    pictures = [out.with_suffix(".svg"), out.with_name(f"{out.stem}-sweep.svg")]
    draw_satellites(populations, pictures[0])
    draw_sweep(sweep, pictures[1])
    orders = [order for study in studies for order in study.orders] + sweep_orders(sizes, seeds)
    names = [picture.name for picture in pictures]
    replace_text(out, page(outcomes, populations, sweep, names, counts(orders, rows)))
    return outcomes


def counts(orders: Sequence[Order], rows: FlightRows) -> str:
    """How many of the orders are flown, and by which code; a sentence."""
    flown = [flight.order for flight in flights_of(orders, rows)]
    others = sum(map(rows.is_of_other_code, flown))
    earlier = f", {others} of them by other versions of the code" if others else ""
    return f"{len(flown)} of {len(orders)} flights{earlier}."


def _spreads(quantity: Quantity, sizes: int, seeds: Sequence[int], rows: FlightRows) -> Iterator[SizeSpread]:
    for size in quantity.sizes(sizes):
        flights = flights_of([sweep_order(quantity, size, seed) for seed in seeds], rows)
        if flights:
            yield spread_of(size, flights)


def main(words: Sequence[str] | None = None) -> int:
    """Fly, judge, write the page; 1 if a claim fails."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--satellites", type=count, help="at most so many of each population; default: all")
    parser.add_argument("--sizes", type=count, default=6, help="of each quantity that is varied alone")
    parser.add_argument("--per-size", type=count, default=4, help="satellites of each size")
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--rows", type=Path, default=ROWS, help="where the flights are kept")
    parser.add_argument("--render", action="store_true", help="fly nothing, of any version of the code")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its pictures lie beside it")
    arguments = parser.parse_args(words)
    studies, seeds = population.studies(arguments.satellites), range(1, 1 + arguments.per_size)
    orders = [order for study in studies for order in study.orders]
    try:
        check_file(arguments.out)
        check_file(arguments.rows)
        rows = FlightRows(arguments.rows, of_any_code=arguments.render)
        orders += sweep_orders(arguments.sizes, seeds)
        if not arguments.render:
            fly_missing(orders, rows, arguments.workers)
        elif not flights_of(orders, rows):
            raise HarnessError(
                f"--rows {arguments.rows} holds none of these flights: there is nothing to render"
            )
        outcomes = write(studies, arguments.sizes, seeds, rows, arguments.out)
    except HarnessError as error:
        print(f"population: {error}", file=sys.stderr)
        return error.exit_code
    print(arguments.out.read_text(encoding="utf-8"))
    return int(any(outcome.verdict is ClaimVerdict.FAIL for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
