"""A picture of directions in characters of a terminal: each character has two by four dots (Braille)."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, radians, sin

from fsw.core.algebra.vector import Vec3

AZIMUTH_DEG, ELEVATION_DEG = -50.0, 25.0
"""From where the orbit axes are seen: turned about the radius, then tilted towards the viewer."""
_BRAILLE = 0x2800
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bit of a dot by its row and column in a character."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A character and the name of the arrow that it belongs to; empty: the outline."""

    text: str
    name: str


def project(vector: Vec3) -> tuple[float, float]:
    """Right and up on the picture, of a vector in orbit axes; the radius is up."""
    radius, along, normal = vector
    turn, tilt = radians(AZIMUTH_DEG), radians(ELEVATION_DEG)
    right = cos(turn) * along - sin(turn) * normal
    deep = sin(turn) * along + cos(turn) * normal
    return right, cos(tilt) * radius - sin(tilt) * deep


def picture(arrows: Mapping[str, Vec3], columns: int, rows: int) -> list[list[Cell]]:
    """Unit vectors from the middle of a circle, by rows from the top; each ends in a letter of its name.

    Args:
        arrows: by name, orbit axes; later ones are drawn over earlier ones.
        columns: of characters.
        rows: of characters.
    """
    bits = [[0] * columns for _ in range(rows)]
    names = [[""] * columns for _ in range(rows)]
    letters: dict[tuple[int, int], tuple[str, str]] = {}
    radius = max(1.0, min(columns * 2, rows * 4) / 2.0 - 4.0)

    def place(right: float, up: float) -> tuple[int, int]:
        return round(columns + right * radius), round(rows * 2 - up * radius)

    def dot(at: tuple[int, int], name: str) -> None:
        x, y = at
        if 0 <= x < columns * 2 and 0 <= y < rows * 4:
            bits[y // 4][x // 2] |= _DOTS[y % 4][x % 2]
            names[y // 4][x // 2] = name or names[y // 4][x // 2]

    for step in range(120):
        dot(place(cos(radians(3 * step)), sin(radians(3 * step))), "")
    for name, vector in arrows.items():
        right, up = project(vector)
        steps = max(2, round(radius))
        for step in range(steps + 1):
            dot(place(right * step / steps, up * step / steps), name)
        x, y = place(1.06 * right, 1.06 * up)
        letters[y // 4, x // 2] = (name[-1] if name.startswith("body") else name[0], name)
    return [
        [
            Cell(*letters[row, column])
            if (row, column) in letters
            else Cell(chr(_BRAILLE | bits[row][column]) if bits[row][column] else " ", names[row][column])
            for column in range(columns)
        ]
        for row in range(rows)
    ]


_BARS = " ▁▂▃▄▅▆▇█"


def sparkline(values: list[float | None], width: int) -> str:
    """The last values as bars between nothing and the largest of them; a gap where there is none."""
    shown = values[-width:]
    top = max((value for value in shown if value is not None), default=0.0) or 1.0
    return "".join(" " if value is None else _BARS[1 + round(7 * value / top)] for value in shown)
