"""The picture of a comparison: a line for each law, a mark for each driver of its coils."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from sim.compare.case import Driver
from sim.compare.score import Score
from sim.drawing.canvas import AXES_COLOURS, MUTED, style
from sim.record.whole_file import replacing
from sim.scenario.controlled import Controlled

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
