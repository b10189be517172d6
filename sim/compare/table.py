"""The table of a comparison as text, CSV and JSON; none depends on how long the flights took."""

import csv
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, fields
from functools import partial
from importlib.metadata import version
from io import StringIO
from math import inf
from typing import Any

from fsw.core.laws.entry import Aim
from sim.compare.score import Score
from sim.drawing.page_parts import Table
from sim.scenario.controlled import Controlled
from sim.tuning.cost import BY_RATE

SCHEMA_VERSION = 2
ITS_UNIT = "its"
"""In place of a unit: that of what the laws are judged by."""

_ABSENT = "-"
_COLUMNS: tuple[tuple[str, str, str, Callable[[Any], str]], ...] = (
    ("law", "law", "", str),
    ("driver", "driver", "", str),
    ("tuned", "gains", "", lambda tuned: "best" if tuned else "scenario"),
    ("settle_orbits", "settle", "orbits", "{:.2f}".format),
    ("error_rms", "RMS", ITS_UNIT, str),
    ("error_max", "max", ITS_UNIT, str),
    ("rate_rms_degps", "rate RMS", "deg/s", "{:.4f}".format),
    ("dipole_squared_a2m4s", "∫ m²", "A² m⁴ s", "{:.4g}".format),
    ("pulses", "pulses", "", str),
    ("duty", "duty", "%", lambda duty: f"{100.0 * duty:.2f}"),
    ("mode_final", "mode", "", str),
    ("limits_ok", "limits", "", lambda ok: "kept" if ok else "BROKEN"),
)
"""Field of a score, heading, unit, format."""
_LEFT = frozenset({"law", "driver", "tuned", "mode_final", "limits_ok"})


def ranked(scores: Iterable[Score], by: Controlled) -> list[Score]:
    """Best first, over the last orbit: by what is judged, or by the rate if the law is not meant to point.

    Aim after aim, what did not fly last.
    """
    aims = list(Aim)

    def place(score: Score) -> tuple[int, float, str, str]:
        stray = score.aim in BY_RATE and by.unit == "deg"
        figure = score.rate_rms_degps if stray else score.error_rms
        return aims.index(score.aim), inf if figure is None else figure, score.law, score.driver

    return sorted(scores, key=place)


def as_text(scores: Sequence[Score], by: Controlled) -> str:
    """The table as text; below it why a law did not fly."""
    columns = _columns(by)
    rows = [[heading for _, heading, _, _ in columns], [unit for _, _, unit, _ in columns]]
    rows += [[_cell(getattr(score, name), write) for name, _, _, write in columns] for score in scores]
    widths = [max(len(row[column]) for row in rows) for column in range(len(_COLUMNS))]
    lines = []
    for row in rows:
        cells = [
            text.ljust(width) if name in _LEFT else text.rjust(width)
            for text, width, (name, *_) in zip(row, widths, _COLUMNS, strict=True)
        ]
        lines.append("  ".join(cells).rstrip())
    lines += [f"{score.law}, {score.driver}: {score.failure}" for score in scores if score.failure]
    return "\n".join(lines)


def as_table(scores: Sequence[Score], by: Controlled) -> Table:
    """The table of a page."""
    columns = _columns(by)
    head = [f"{heading} [{unit}]" if unit else heading for _, heading, unit, _ in columns]
    rows = [[_cell(getattr(score, name), write) for name, _, _, write in columns] for score in scores]
    return Table(head, rows)


def error_text(error: float, unit: str) -> str:
    """An error: angles to a hundredth of a degree, rates to 0.0001 deg/s, smaller ones to two digits."""
    digits = 2 if unit == "deg" else 4
    return f"{error:.{digits}f}" if error == 0.0 or error >= 10.0**-digits else f"{error:.2g}"


def _columns(by: Controlled) -> list[tuple[str, str, str, Callable[[Any], str]]]:
    """With the unit of what is judged in its columns."""
    return [
        (name, heading, by.unit, partial(error_text, unit=by.unit))
        if unit == ITS_UNIT
        else (name, heading, unit, write)
        for name, heading, unit, write in _COLUMNS
    ]


def as_csv(scores: Sequence[Score]) -> str:
    """A line a score under the names of its fields; empty where there is nothing."""
    into = StringIO()
    writer = csv.DictWriter(into, [field.name for field in fields(Score)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(score) for score in scores)
    return into.getvalue()


def as_json(scores: Sequence[Score], description: dict[str, Any]) -> dict[str, Any]:
    """All scores, and the description of the comparison."""
    return {
        "schema_version": SCHEMA_VERSION,
        "torquer_version": version("torquer"),
        **description,
        "rows": [asdict(score) for score in scores],
    }


def _cell(value: object, write: Callable[[Any], str]) -> str:
    return _ABSENT if value is None else write(value)
