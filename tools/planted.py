"""Planted schedulers: how surely and how fast ``sim.testing`` finds each, and that it blames no correct one.

    python tools/planted.py [NAME ...] [--runs N] [--workers N]

A run is what a user would have: 100 examples, shrunk, from a seed of its own and without a database. Prints a
table. Exit code 1 if a planted fault was missed, a correct scheduler blamed, or a run took 60 s or more.
"""

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from hypothesis import HealthCheck, Phase, given, seed, settings

sys.path.insert(0, str(Path(__file__).parent))
from planted_schedulers import CORRECT, PLANTED, UNSOUND

from sim.testing import audit_scheduler, dipoles, flights, unsound_dipoles

EXAMPLES = 100
LONGEST_S = 60.0
SCHEDULERS = {one.__name__: one for one in (*PLANTED, *CORRECT)}


class Run(NamedTuple):
    """One run of Hypothesis: how long it took, and what was blamed, None if nothing."""

    name: str
    seconds: float
    blamed: str | None


def run(name: str, number: int, phases: tuple[Phase, ...] = tuple(Phase), examples: int = EXAMPLES) -> Run:
    """What a user would run, from the seed ``number``."""
    make, seen = SCHEDULERS[name], []
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
    def keeps_the_limits(flight):
        report = audit_scheduler(make, flight)
        seen[:] = report.violations
        assert report.ok

    began = time.monotonic()
    try:
        keeps_the_limits()
    except AssertionError:
        return Run(name, time.monotonic() - began, str(seen[0]))
    return Run(name, time.monotonic() - began, None)


def row(name: str, runs: list[Run]) -> tuple[str, bool]:
    """A row of the table, and whether it is as it must be."""
    found = [one for one in runs if one.blamed is not None]
    longest_s = max(one.seconds for one in runs)
    as_wanted = len(found) == (0 if SCHEDULERS[name] in CORRECT else len(runs)) and longest_s < LONGEST_S
    shown = min((one.blamed for one in found), key=len, default="")
    what = SCHEDULERS[name].__doc__.splitlines()[0]
    text = f"{what:62} {len(found)} of {len(runs)}  {longest_s:5.1f} s  {shown}"
    return text + ("" if as_wanted else "  <-- WRONG"), as_wanted


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="classes of planted_schedulers.py; default: all"
    )
    parser.add_argument("--runs", type=int, default=4, help="seeds of each (4)")
    parser.add_argument("--workers", type=int, default=1, help="runs at a time (1)")
    asked = parser.parse_args()
    unknown = sorted(set(asked.names) - SCHEDULERS.keys())
    if unknown:
        parser.error(f"no scheduler {', '.join(unknown)} in planted_schedulers.py")
    names = asked.names or list(SCHEDULERS)
    seeds = range(1, asked.runs + 1)
    wanted = [(name, number) for name in names for number in seeds]
    print(f"{'what is wrong with it':62} blamed in, longest run, and the shortest that is said of it")
    right = True
    with ProcessPoolExecutor(asked.workers) as pool:
        done = pool.map(run, *zip(*wanted, strict=True))
        for name, runs in groupby(done, key=lambda one: one.name):
            text, as_wanted = row(name, list(runs))
            right = right and as_wanted
            print(text, flush=True)
    print(
        "OK"
        if right
        else f"FAIL: a fault missed, a correct one blamed, or a run of {LONGEST_S:.0f} s or more"
    )
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
