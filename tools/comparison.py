"""Compare the laws on six satellites, and write docs/comparison.md with a picture of each.

The flights are those of ``torquer compare BODY``. A run that was stopped goes on where it was. Exit code 1
where the limits were broken.
"""

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from argument_types import count
from jinja2 import Environment, StrictUndefined
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fsw.core.laws.entry import Aim
from sim.compare.case import Driver
from sim.compare.command import JSON as COMPARED
from sim.compare.command import CompareOptions, compare
from sim.compare.score import Score
from sim.compare.table import as_table, error_text, ranked
from sim.drawing.canvas import AXES_COLOURS, MUTED, style
from sim.drawing.page_parts import Table
from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replace_text, replacing
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


# --- The picture of a comparison: a line for each law, a mark for each driver of its coils

MARKS = {Driver.PULSED: ("o", AXES_COLOURS[0], 0.16), Driver.CONTINUOUS: ("D", AXES_COLOURS[1], -0.16)}
"""Of a driver: shape, colour, and place above the middle of the line."""
LINE_IN, HEAD_IN = 0.17, 0.85


def draw(scores: Sequence[Score], by: Controlled, path: Path) -> None:
    """Error, time to settle and effort of each law, in the order of the scores, best above; as SVG.

    A mark is hollow where the law never settled.
    """
    laws = list(dict.fromkeys(score.law for score in scores if not score.failure))
    columns: tuple[tuple[str, Callable[[Score], float | None], str], ...] = (
        (f"error RMS, last orbit [{by.unit}]", lambda score: score.error_rms, "log"),
        ("settled after [orbits]", lambda score: score.settle_orbits, "linear"),
        ("∫ m² [A² m⁴ s]", lambda score: score.dipole_squared_a2m4s, "log"),
    )
    with style():
        figure = Figure(figsize=(8.2, HEAD_IN + LINE_IN * len(laws)), layout="constrained")
        panels = figure.subplots(1, len(columns), sharey=True, width_ratios=(2.0, 1.2, 1.2), squeeze=False)[0]
        for panel, (label, pick, scale) in zip(panels, columns, strict=True):
            for score, value in picked(scores, pick):
                shape, colour, above = MARKS[score.driver]
                filled = "none" if score.settle_orbits is None else colour
                panel.plot(
                    value, laws.index(score.law) - above, shape, markersize=4.2, markeredgewidth=0.9,
                    markerfacecolor=filled, markeredgecolor=colour,
                )  # fmt: skip
            panel.set_xscale(scale)
            panel.set_xlabel(label)
        panels[0].axvline(by.threshold, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
        panels[0].set_yticks(range(len(laws)), laws, fontsize=7.0)
        panels[0].set_ylim(len(laws) - 0.4, -0.6)
        panels[1].set_xlim(left=0.0)
        figure.legend(handles=list(_legend()), loc="outside upper left", ncols=3)
        with replacing(path) as file:
            figure.savefig(file, format="svg", metadata={"Date": None})


def picked(scores: Sequence[Score], pick: Callable[[Score], float | None]) -> Iterator[tuple[Score, float]]:
    """The scores that have that figure, with it."""
    for score in scores:
        value = pick(score)
        if value is not None:
            yield score, value


def _legend() -> Iterator[Line2D]:
    for driver, (shape, colour, _) in MARKS.items():
        yield Line2D([], [], marker=shape, color=colour, linestyle="", markersize=4.2, label=driver.value)
    yield Line2D([], [], marker="o", color=MUTED, markerfacecolor="none", linestyle="", markersize=4.2,
                 label="hollow: never settled")  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
