"""Planted schedulers: how reliably and how fast ``sim.testing`` finds each, and that correct ones pass.

    python tools/planted.py [NAME ...] [--runs N] [--workers N]

A run is what a user would have: 100 examples, shrunk, from a seed of its own and without a database. Prints a
table. Exit code 1 if a planted fault was missed, a correct scheduler failed, or a run took 60 s or more.
"""

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from argument_types import count
from hypothesis import HealthCheck, Phase, given, seed, settings

sys.path.insert(0, str(Path(__file__).parent))
from correct_schedulers import CORRECT
from planted_schedulers import PLANTED, UNSOUND

from sim.testing import Flight, Violation, audit_scheduler, dipoles, flights, unsound_dipoles

EXAMPLES = 100
LONGEST_S = 60.0
SCHEDULERS = {one.__name__: one for one in (*PLANTED, *CORRECT)}


class Run(NamedTuple):
    """One run of Hypothesis: how long it took, and the first violation; None if there was none."""

    name: str
    seconds: float
    violation: str | None


def run(name: str, number: int, phases: tuple[Phase, ...] = tuple(Phase), examples: int = EXAMPLES) -> Run:
    """Run the test as a user would, from the seed ``number``."""
    make, violations = SCHEDULERS[name], list[Violation]()
    demands = dipoles() | unsound_dipoles() if name in UNSOUND else None

    @settings(
        max_examples=examples,
        deadline=None,
        database=None,
        derandomize=False,
        phases=phases,
        report_multiple_bugs=False,
        print_blob=False,
        suppress_health_check=[HealthCheck.too_slow],
    )
    @seed(number)
    @given(flights(demands=demands))
    def keeps_the_limits(flight: Flight) -> None:
        report = audit_scheduler(make, flight)
        violations[:] = report.violations
        assert report.ok

    began = time.monotonic()
    try:
        keeps_the_limits()
    except AssertionError:
        return Run(name, time.monotonic() - began, str(violations[0]))
    return Run(name, time.monotonic() - began, None)


def row(name: str, runs: list[Run]) -> tuple[str, bool]:
    """A row of the table, and whether it is as required."""
    found = [one.violation for one in runs if one.violation is not None]
    longest_s = max(one.seconds for one in runs)
    passed = len(found) == (0 if SCHEDULERS[name] in CORRECT else len(runs)) and longest_s < LONGEST_S
    shortest = min(found, key=len, default="")
    what = (SCHEDULERS[name].__doc__ or name).splitlines()[0]
    text = f"{what:62} {len(found)} of {len(runs)}  {longest_s:5.1f} s  {shortest}"
    return text + ("" if passed else "  <-- WRONG"), passed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="classes of *_schedulers.py; default: all",
    )
    parser.add_argument("--runs", type=count, default=4, help="seeds of each (4)")
    parser.add_argument("--workers", type=count, default=1, help="runs at a time (1)")
    options = parser.parse_args()
    unknown = sorted(set(options.names) - SCHEDULERS.keys())
    if unknown:
        parser.error(f"no scheduler {', '.join(unknown)} in planted_schedulers.py or correct_schedulers.py")
    names = options.names or list(SCHEDULERS)
    seeds = range(1, options.runs + 1)
    runs_to_do = [(name, number) for name in names for number in seeds]
    print(f"{'fault':62} found in, longest run, shortest violation")
    all_passed = True
    with ProcessPoolExecutor(options.workers) as pool:
        done = pool.map(run, *zip(*runs_to_do, strict=True))
        for name, runs in groupby(done, key=lambda one: one.name):
            text, passed = row(name, list(runs))
            all_passed = all_passed and passed
            print(text, flush=True)
    print(
        "OK"
        if all_passed
        else f"FAIL: a fault missed, a correct scheduler failed, or a run of {LONGEST_S:.0f} s or more"
    )
    return 0 if all_passed else 1


if __name__ == "__main__":
    sys.exit(main())
