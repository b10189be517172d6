"""Fly what ``torquer size`` judges, and write docs/sizing.md: how far its figures agree with flights.

Exit code 1 where the median of a satellite's flights is not within a factor of two of its figure, where a
satellite drawn at random flies at more than three times its figure or less than a third without a warning,
and where a cubesat as ``torquer new`` writes it flies otherwise without a warning before and a reason after.
"""

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from importlib.metadata import version
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from argument_types import count
from jinja2 import Environment, StrictUndefined

from fsw.input.schema import Nested, TableError
from sim.campaign.claim import Study
from sim.campaign.flight import FlightResult, Order, fly_order
from sim.campaign.runner import run
from sim.campaign.study_cache import with_cache
from sim.errors import HarnessError
from sim.new_scenario.command import write_new
from sim.new_scenario.satellite import NewSatellite
from sim.progress import progress
from sim.record.destination import check_file
from sim.record.whole_file import replace_text
from sim.scenario.schema import Scenario, load
from sim.sizing.command import SURE_DEG, doubt_of, points, why_not
from sim.sizing.expectation import Expectation, expect
from sim.sizing.gravity import gravity_on

ROOT = Path(__file__).resolve().parent.parent
PAGE, TEMPLATE = ROOT / "docs" / "sizing.md", ROOT / "tools" / "sizing.md.j2"
ORBITS, FIRST = 10.0, 101
DRIVEN: dict[str, Any] = {"continuous": True}
FACTOR = 2.0
"""Within it of the figure is the median of flights whose floor is at most ``SURE_DEG``."""
FAR = 3.0
"""Off by no more is that of a satellite drawn at random, or ``size`` has a doubt."""


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
    def times(self) -> float:
        """How many times what is expected that is."""
        return self.median_deg / self.expected.pointing_deg

    @property
    def is_doubted(self) -> bool:
        """Whether ``size`` says that flights may have several times the figure."""
        return bool(doubt_of(self.expected))

    @property
    def is_sure(self) -> bool:
        """Whether the figure is said to hold: its floor is a small angle, and the load can be borne."""
        return self.expected.floor_deg <= SURE_DEG and self.expected.load <= 1.0


CUBESATS = (
    NewSatellite("one-u", None, 500.0, 97.4, 1.3, (0.1, 0.1, 0.1135)),
    NewSatellite(
        "one-u-low", None, 400.0, 51.6, 1.2, (0.1, 0.1, 0.1135), **DRIVEN, dipole_am2=0.1, cells=True
    ),
    NewSatellite(
        "one-half-u", None, 550.0, 97.6, inertia_kgm2=(0.0052, 0.0052, 0.0022), axes=("z", "x", "y")
    ),
    NewSatellite("two-u", None, 600.0, 97.8, 2.4, (0.1, 0.1, 0.227), cells=True),
    NewSatellite("three-u-z", None, 550.0, 97.6, inertia_kgm2=(0.04, 0.04, 0.008)),
    NewSatellite("three-u-y", None, 420.0, 51.6, inertia_kgm2=(0.038, 0.008, 0.039), axes=("y", "x", "z")),
    NewSatellite("three-u-x", None, 700.0, 98.2, inertia_kgm2=(0.008, 0.04, 0.041), **DRIVEN, dipole_am2=0.2),
    NewSatellite("three-u", None, 500.0, 97.4, 4.5, (0.1, 0.1, 0.34), **DRIVEN, dipole_am2=0.24, cells=True),
    NewSatellite("six-u", None, 520.0, 97.5, 9.0, (0.1, 0.2263, 0.366), **DRIVEN, dipole_am2=0.5),
    NewSatellite("six-u-flat", None, 450.0, 97.2, inertia_kgm2=(0.08, 0.05, 0.03)),
    NewSatellite("twelve-u", None, 600.0, 97.8, 20.0, (0.2263, 0.2263, 0.34)),
    NewSatellite("twelve-u-flat", None, 700.0, 65.0, inertia_kgm2=(0.2, 0.15, 0.1), axes=("z", "y", "x")),
)
"""As people have them: 1U to 12U, each axis the long one, Sun sensor or cells, pulsed or continuous."""


DRAWN = range(301, 313)
"""Seeds of satellites with drag and sunlight, by which no part of the figure was chosen."""
FACES = ((0.183, 0.0226), (0.113, 0.0366), (0.05, 0.0828))
"""Of a 6U: distance from the middle, m, and area, m^2, of the faces across axes 1, 2 and 3."""


def drawn(seed: int) -> Nested:
    """Orbit, hour and mass centre of a 6U with plates, drawn at random: keys over ``cubesat6u``."""
    draw = Random(seed)
    off_m = [draw.uniform(-0.02, 0.02) for _ in FACES]
    plates = []
    for axis, (distance_m, area_m2) in enumerate(FACES):
        for sign in (1.0, -1.0):
            normal, centre_m = [0.0, 0.0, 0.0], [-part for part in off_m]
            normal[axis] = sign
            centre_m[axis] += sign * distance_m
            plates.append({"area_m2": area_m2, "normal": normal, "centre_m": centre_m, "diffuse": 0.3})
    return {
        "time": {"epoch_utc": f"2025-{draw.randint(1, 12):02d}-15T{draw.randint(0, 23):02d}:00:00Z"},
        "orbit": {
            "altitude_km": draw.uniform(480.0, 700.0),
            "inclination_deg": draw.choice((51.6, 65.0, 97.6)),
            "raan_deg": draw.uniform(0.0, 360.0),
        },
        "body": {"plates": plates},
        "disturbance": {"drag": {"density_scale": draw.choice((0.5, 1.0, 2.0))}},
        "flight": {"uncertainty": {"torque_nm": 3e-7}},
    }


OTHERS = tuple((str(seed), "cubesat6u", drawn(seed)) for seed in DRAWN)


class Cubesat(NamedTuple):
    """One as ``torquer new`` writes it: what was said before, and what its flights were."""

    name: str
    driver: str
    expected_deg: float | None
    """None: none to rely on."""
    warnings: tuple[str, ...]
    flown_deg: tuple[float, ...]
    causes: tuple[tuple[str, ...], ...]
    """By flight: why it had not settled; empty where it had."""

    @property
    def median_deg(self) -> float:
        """Of the flights."""
        return median(self.flown_deg)

    @property
    def as_said(self) -> bool:
        """Within a factor of two, or warned of before and, where it has not settled, explained after."""
        if self.expected_deg is not None:
            times = self.median_deg / self.expected_deg
            if 1.0 / FACTOR <= times <= FACTOR:
                return True
        return bool(self.warnings) and ("unknown",) not in self.causes


def fly_cubesats(seeds: int, workers: int) -> list[Cubesat]:
    """All cubesats, with the seeds from 101 on.

    Raises:
        HarnessError: a flight cannot be flown.
    """
    with TemporaryDirectory() as folder:
        written = [write_new(one, Path(folder, f"{one.name}.toml")) for one in CUBESATS]
        studies = [
            Study(
                one.scenario.name,
                tuple(
                    partial(fly_order, Order(str(one.file), {}, FIRST + place, ORBITS))
                    for place in range(seeds)
                ),
                lambda flights: [],
                has_flights=True,
            )
            for one in written
        ]
        with progress("flying cubesats", seeds * len(studies)) as watch:
            flown = run(with_cache(studies), workers, watch, lambda study: None)
    return [
        _cubesat(one.scenario, one.warnings, study.results) for one, study in zip(written, flown, strict=True)
    ]


def _cubesat(scenario: Scenario, warnings: tuple[str, ...], flights: Sequence[FlightResult]) -> Cubesat:
    expected = expect(scenario)
    relied_on = points(expected, gravity_on(scenario))
    doubt = "" if relied_on else f"pointing none to rely on: {why_not(expected, gravity_on(scenario))}"
    return Cubesat(
        scenario.name,
        scenario.coils.driver,
        expected.pointing_deg if relied_on else None,
        (*warnings, doubt) if doubt else warnings,
        tuple(map(pointing_deg, flights)),
        tuple(tuple(reason["cause"] for reason in one.summary["diagnosis"]["reasons"]) for one in flights),
    )


def fly(satellites: Sequence[tuple[str, str, Nested]], seeds: int, workers: int) -> list[Row]:
    """All these satellites, with the seeds from 1 on.

    Raises:
        HarnessError: a flight cannot be flown.
    """
    scenarios = [(what, name, load(name, keys)) for what, name, keys in satellites]
    studies = [
        Study(
            name,
            tuple(partial(fly_order, order) for order in orders_of(name, keys, seeds)),
            lambda flights: [],
            has_flights=True,
        )
        for _, name, keys in satellites
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


def page(rows: Sequence[Row], others: Sequence[Row], cubesats: Sequence[Cubesat]) -> str:
    """The page: the template ``sizing.md.j2`` with the figures; ``others`` were drawn at random."""
    template = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    sure = [flown / row.expected.pointing_deg for row in rows if row.is_sure for flown in row.flown_deg]
    return template.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        rows=rows,
        others=others,
        cubesats=cubesats,
        sure=sure,
        sure_deg=SURE_DEG,
        orbits=ORBITS,
        factor=FACTOR,
        version=version("torquer"),
    )


def faults(rows: Sequence[Row], others: Sequence[Row], cubesats: Sequence[Cubesat]) -> list[str]:
    """The satellites whose flights are not as near to their figure as they should be, nor as was said."""
    far = [row for row in rows if row.is_sure and not 1.0 / FACTOR <= row.times <= FACTOR]
    far += [row for row in others if not row.is_doubted and not 1.0 / FAR <= row.times <= FAR]
    unsaid = [
        f"{one.name}: flown {one.median_deg:.2f} deg, expected {one.expected_deg}, not as was said"
        for one in cubesats
        if not one.as_said
    ]
    return unsaid + [
        f"{row.scenario}, {row.what or 'as shipped'}: flown {row.median_deg:.2f} deg, "
        f"expected {row.expected.pointing_deg:.2f}"
        for row in far
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
        rows = fly(SATELLITES, arguments.seeds, arguments.workers)
        others = fly(OTHERS, arguments.seeds, arguments.workers)
        cubesats = fly_cubesats(arguments.seeds, arguments.workers)
    except (HarnessError, TableError) as error:
        print(f"sizing: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("sizing: interrupted; flights that are done are not flown again", file=sys.stderr)
        return 130
    replace_text(arguments.out, page(rows, others, cubesats))
    found = faults(rows, others, cubesats)
    print("\n".join([*found, str(arguments.out)]))
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
