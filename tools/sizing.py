"""Fly what ``torquer size`` judges, and write docs/sizing.md: how far its figures agree with flights.

Exit code 1 where the median of a satellite's flights is not within a factor of two of its figure.
"""

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import NamedTuple

from argument_types import count
from jinja2 import Environment, StrictUndefined

from fsw.input.schema import Nested, TableError
from sim.campaign.claim import Study
from sim.campaign.flight import FlightResult, Order, fly_order
from sim.campaign.runner import run
from sim.campaign.study_cache import with_cache
from sim.errors import HarnessError
from sim.progress import progress
from sim.record.destination import check_file
from sim.record.whole_file import replace_text
from sim.scenario.schema import load
from sim.sizing.command import SURE_DEG
from sim.sizing.expectation import Expectation, expect

ROOT = Path(__file__).resolve().parent.parent
PAGE, TEMPLATE = ROOT / "docs" / "sizing.md", ROOT / "tools" / "sizing.md.j2"
ORBITS = 10.0
FACTOR = 2.0
"""Within it of the figure is the median of flights whose floor is at most ``SURE_DEG``."""


def of(torque_nm: float = 0.0, dipole_am2: float = 0.0, bound: float = 0.0) -> Nested:
    """A disturbance, the same about each axis, and where it exceeds that of the scenario its bound."""
    if torque_nm:
        disturbance, key = {"torque_nm": [torque_nm] * 3}, "torque_nm"
    else:
        disturbance, key = {"residual_dipole_am2": [dipole_am2] * 3}, "residual_dipole_am2"
    return {"disturbance": disturbance} | ({"flight": {"uncertainty": {key: bound}}} if bound else {})


def levels(*levels_am2: float) -> Nested:
    """Coils of other levels."""
    return {"coils": {"levels_am2": list(levels_am2)}}


SATELLITES: tuple[tuple[str, str, Nested], ...] = (
    ("", "microsat", {}),
    ("", "realsat", {}),
    ("", "cubesat3u", {}),
    ("", "cubesat6u", {}),
    ("levels 0.1, 0.4, 1.6", "microsat", levels(0.1, 0.4, 1.6)),
    ("levels 2, 8, 30", "microsat", levels(2.0, 8.0, 30.0)),
    ("levels 0.001, 0.004, 0.016", "cubesat3u", levels(0.001, 0.004, 0.016)),
    ("levels 0.012, 0.05, 0.2", "cubesat3u", levels(0.012, 0.05, 0.2)),
    ("residual dipole 0.01 per axis, bound 0.05", "microsat", of(dipole_am2=0.01, bound=0.05)),
    ("residual dipole 0.05 per axis, bound 0.1", "microsat", of(dipole_am2=0.05, bound=0.1)),
    ("torque 2.4e-9 per axis", "cubesat3u", of(torque_nm=2.4e-9)),
    ("torque 6e-9 per axis", "cubesat3u", of(torque_nm=6e-9)),
    ("torque 3.6e-7 per axis, bound 1e-6", "microsat", of(torque_nm=3.6e-7, bound=1e-6)),
    ("torque 7.3e-7 per axis, bound 1.5e-6", "microsat", of(torque_nm=7.3e-7, bound=1.5e-6)),
    ("torque 2e-8 per axis", "cubesat3u", of(torque_nm=2e-8)),
)
"""What differs from the scenario, in SI units; the scenario; the keys that do it."""


class Row(NamedTuple):
    """A satellite: what is expected of it, and the errors of its flights over the last orbit, deg RMS."""

    what: str
    scenario: str
    law: str
    expected: Expectation
    flown_deg: tuple[float, ...]

    @property
    def median_deg(self) -> float:
        """Of the flights."""
        return median(self.flown_deg)

    @property
    def is_sure(self) -> bool:
        """Whether the figure is said to hold: its floor is a small angle, and the load can be borne."""
        return self.expected.floor_deg <= SURE_DEG and self.expected.load <= 1.0


def fly(seeds: int, workers: int) -> list[Row]:
    """All satellites, with the seeds from 1 on.

    Raises:
        HarnessError: a flight cannot be flown.
    """
    scenarios = [(what, name, load(name, keys)) for what, name, keys in SATELLITES]
    studies = [
        Study(
            name,
            tuple(partial(fly_order, order) for order in orders_of(name, keys, seeds)),
            lambda flights: [],
            has_flights=True,
        )
        for _, name, keys in SATELLITES
    ]
    with progress("flying", seeds * len(studies)) as watch:
        flown = run(with_cache(studies), workers, watch, lambda study: None)
    return [
        Row(what, name, scenario.control.law, expect(scenario), tuple(map(pointing_deg, study.results)))
        for (what, name, scenario), study in zip(scenarios, flown, strict=True)
    ]


def orders_of(scenario: str, keys: Nested, seeds: int) -> list[Order]:
    """The flights of a satellite."""
    return [Order(scenario, keys, seed, ORBITS) for seed in range(1, 1 + seeds)]


def pointing_deg(flight: FlightResult) -> float:
    """RMS pointing error over the last orbit."""
    pointing: Mapping[str, float] = flight.summary["pointing_deg"]
    return pointing["rms_last_orbit"]


def page(rows: Sequence[Row]) -> str:
    """The page: the template ``sizing.md.j2`` with the figures."""
    template = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    sure = [flown / row.expected.pointing_deg for row in rows if row.is_sure for flown in row.flown_deg]
    return template.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        rows=rows, sure=sure, sure_deg=SURE_DEG, orbits=ORBITS, factor=FACTOR, version=version("torquer")
    )


def faults(rows: Sequence[Row]) -> list[str]:
    """The satellites whose flights are not as near to their figure as they should be."""
    return [
        f"{row.scenario}, {row.what or 'as shipped'}: flown {row.median_deg:.2f} deg, "
        f"expected {row.expected.pointing_deg:.2f}"
        for row in rows
        if row.is_sure and not 1.0 / FACTOR <= row.median_deg / row.expected.pointing_deg <= FACTOR
    ]


def main(words: Sequence[str] | None = None) -> int:
    """Fly, write the page; 1 where a flight is far from its figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=count, default=3, help="flights of each satellite")
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--out", type=Path, default=PAGE)
    arguments = parser.parse_args(words)
    try:
        check_file(arguments.out)
        rows = fly(arguments.seeds, arguments.workers)
    except (HarnessError, TableError) as error:
        print(f"sizing: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("sizing: interrupted; flights that are done are not flown again", file=sys.stderr)
        return 130
    replace_text(arguments.out, page(rows))
    print("\n".join([*faults(rows), str(arguments.out)]))
    return int(bool(faults(rows)))


if __name__ == "__main__":
    sys.exit(main())
