"""The columns of recorded telemetry: each name says quantity, axis and unit."""

import re
from collections.abc import Sequence
from typing import NamedTuple

from fsw.input.near import did_you_mean

TIME = "utc_unix_s"
AXES = "xyz"


class VectorColumns(NamedTuple):
    """A vector quantity: the first word of its columns, and factors by the unit in their names."""

    name: str
    factors: dict[str, float]

    def columns(self, unit: str) -> tuple[str, ...]:
        """The names of its three columns."""
        return tuple(f"{self.name}_{axis}_{unit}" for axis in AXES)


FIELD = VectorColumns("mag", {"nt": 1.0, "ut": 1e3, "mg": 100.0, "t": 1e9})
"""In nT; ``mg`` is milligauss."""
GYRO = VectorColumns("gyro", {"degps": 1.0, "radps": 57.29577951308232})
"""In deg/s."""
CELL = re.compile(r"sun_cell_(?P<cell>\w+)_(?P<unit>raw|ma|a)")
"""The current of a Sun cell, in any unit: its full scale is in the same."""
TEMPERATURE = "temperature_degc"


class Places(NamedTuple):
    """Where in a row each quantity stands, with the factor to its unit; None where it is absent."""

    time: int
    field: tuple[int, int, int]
    field_factor: float
    gyro: tuple[int, int, int] | None
    gyro_factor: float
    cells: dict[str, int]
    temperature: int | None
    unused: tuple[str, ...]


def places(head: Sequence[str]) -> Places:
    """Where each quantity stands under these column names.

    Raises:
        ValueError: a clause that names the column that is missing, or twice there.
    """
    at: dict[str, int] = {}
    for place, name in enumerate(head):
        if name in at:
            raise ValueError(f"there are two columns {name!r}")
        at[name] = place
    if TIME not in at:
        named = ", ".join(head)
        raise ValueError(f"there is no column {TIME!r}{did_you_mean(TIME, at)}; line 1 names {named!r:.60}")
    field, field_factor = _vector(FIELD, at)
    if field is None:
        raise ValueError(_missing(FIELD, at))
    gyro, gyro_factor = _vector(GYRO, at)
    cells = _cells(at)
    used = {at[TIME], *field, *(gyro or ()), *cells.values(), at.get(TEMPERATURE, -1)}
    unused = tuple(name for name in head if at[name] not in used)
    return Places(at[TIME], field, field_factor, gyro, gyro_factor, cells, at.get(TEMPERATURE), unused)


def _cells(at: dict[str, int]) -> dict[str, int]:
    """Where the current of each cell stands."""
    cells: dict[str, int] = {}
    for name, place in at.items():
        if found := CELL.fullmatch(name):
            if found["cell"] in cells:
                raise ValueError(f"there are two columns of cell {found['cell']!r}, {name!r} is one of them")
            cells[found["cell"]] = place
    return cells


def _vector(quantity: VectorColumns, at: dict[str, int]) -> tuple[tuple[int, int, int] | None, float]:
    """Its three columns in one of its units, and the factor of that unit."""
    for unit, factor in quantity.factors.items():
        present = [name for name in quantity.columns(unit) if name in at]
        if len(present) == len(AXES):
            x, y, z = (at[name] for name in present)
            return (x, y, z), factor
        if present:
            raise ValueError(_missing(quantity, at, unit))
    return None, 1.0


def _missing(quantity: VectorColumns, at: dict[str, int], unit: str = "") -> str:
    names = quantity.columns(unit or next(iter(quantity.factors)))
    absent = next(name for name in names if name not in at)
    units = ", ".join(quantity.factors)
    return f"there is no column {absent!r}{did_you_mean(absent, at)}; units of it are {units}"
