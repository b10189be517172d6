"""Compare the laws on six satellites, and write docs/comparison.md with a picture of each.

The flights are those of ``torquer compare BODY``. A run that was stopped goes on where it was. Exit code 1
where the limits were broken.
"""

import argparse
import json
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from argument_types import count
from comparison_picture import draw
from jinja2 import Environment, StrictUndefined

from fsw.core.laws.entry import Aim
from sim.compare.case import Driver
from sim.compare.command import JSON as COMPARED
from sim.compare.command import CompareOptions, compare
from sim.compare.score import Score
from sim.compare.table import as_table, error_text, ranked
from sim.drawing.page_parts import Table
from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replace_text
from sim.scenario.controlled import Controlled
from sim.tuning.cost import BY_RATE

ROOT = Path(__file__).resolve().parent.parent
PAGE, TEMPLATE = ROOT / "docs" / "comparison.md", ROOT / "tools" / "comparison.md.j2"
SATELLITES = {
    "microsat": "50 kg, three unequal moments, magnetometer and Sun sensor",
    "cubesat3u": "a CubeSat of 3 units, long and slender",
    "posat1": "50 kg with a gravity gradient boom, that holds an axis to the vertical and tumbles at first",
    "pitch-wheel": "a wheel of constant speed along the pitch axis, the horizon for a sensor",
    "microsat-wheel": "the 50 kg satellite with a wheel that is driven",
    "spinner": "spins about its axis 1. All are judged by that rate, which laws that only turn the axis or "
    "damp nutation do not hold",
}
Record = dict[str, Any]


class Compared(NamedTuple):
    """A satellite whose laws have flown.

    Attributes:
        name: of the scenario.
        what: the satellite, in words.
        by: what the laws are judged by.
        flown_s: length of a flight, s.
        scores: best first, each aim for itself.
    """

    name: str
    what: str
    by: Controlled
    flown_s: float
    scores: Sequence[Score]

    @property
    def picture(self) -> str:
        """Its file, beside the page."""
        return f"comparison-{self.name}.svg"

    def best(self, driver: Driver) -> Score | None:
        """The law with the least error over the last orbit among those that control what is judged."""
        return min(self._judged(driver), key=lambda score: score.error_rms or 0.0, default=None)

    def thriftiest(self, driver: Driver) -> Score | None:
        """Of those that settled, the one that took least of the coils."""
        settled = [score for score in self._judged(driver) if score.settle_orbits is not None]
        return min(settled, key=lambda score: score.dipole_squared_a2m4s or 0.0, default=None)

    def _judged(self, driver: Driver) -> list[Score]:
        strays = BY_RATE if self.by.unit == "deg" else frozenset()
        return [
            score
            for score in self.scores
            if score.driver is driver and score.error_rms is not None and score.aim not in strays
        ]


def fly(name: str, workers: int) -> Record:
    """Compare the laws on a satellite, with the gains that ship: what the command writes."""
    with TemporaryDirectory() as folder:
        compare(name, {}, CompareOptions(workers=workers), Path(folder))
        record: Record = json.loads(Path(folder, COMPARED).read_text())
        return record


def compared(name: str, record: Record) -> Compared:
    """What the command wrote as values, its scores ranked."""
    by = Controlled(**record["judged"])
    scores = [
        Score(**{**row, "aim": Aim(row["aim"]), "driver": Driver(row["driver"])}) for row in record["rows"]
    ]
    return Compared(name, SATELLITES[name], by, record["sim_seconds"], ranked(scores, by))


def winner(score: Score | None, by: Controlled) -> str:
    """A law and its error, for the first table."""
    if score is None:
        return "none"
    return f"`{score.law}` {error_text(score.error_rms or 0.0, by.unit)} {by.unit}"


def markdown(table: Table) -> str:
    """A table of the page."""
    rows = [table.head, ["---"] * len(table.head), *table.rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def page(satellites: Sequence[Compared]) -> str:
    """The page: the template ``comparison.md.j2`` with the figures."""
    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        satellites=satellites,
        tables={satellite.name: as_table(satellite.scores, satellite.by) for satellite in satellites},
        drivers=list(Driver),
        winner=winner,
        markdown=markdown,
        version=version("torquer"),
    )


def main(words: Sequence[str] | None = None) -> int:
    """Fly, write the page; 1 where limits were broken."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its pictures lie beside it")
    arguments = parser.parse_args(words)
    try:
        check_file(arguments.out)
        satellites = [compared(name, fly(name, arguments.workers)) for name in SATELLITES]
    except HarnessError as error:
        print(f"comparison: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        print("comparison: interrupted; flights that are done are not flown again", file=sys.stderr)
        return 130
    for satellite in satellites:
        draw(satellite.scores, satellite.by, arguments.out.with_name(satellite.picture))
    replace_text(arguments.out, page(satellites))
    print(arguments.out)
    return int(any(score.limits_ok is False for satellite in satellites for score in satellite.scores))


if __name__ == "__main__":
    sys.exit(main())
