"""Requirements of a scenario: what a flight of it must achieve, and the orbit by which it is judged.

``[[requirement]]`` limits an index. APE, MPE, RPE and AKE are those of ECSS-E-ST-60-10C; their equations are
in ``sim.statistics.indices``.
"""

import re
from difflib import get_close_matches
from typing import Annotated, Literal, NamedTuple, Self

from pydantic import Field, Strict, model_validator

from fsw.input.schema import Positive, Section, TableError, validated
from sim.scenario.names import Name


class Unit(NamedTuple):
    """The unit of a limit: its symbol, and the key that gives a limit in it."""

    symbol: str
    key: str


DEG, DEGPS = Unit("deg", "at_most_deg"), Unit("deg/s", "at_most_degps")
ORBITS, PERCENT, JOULE = (
    Unit("orbits", "at_most_orbits"),
    Unit("%", "at_most_percent"),
    Unit("J", "at_most_j"),
)
UNITS = (DEG, DEGPS, ORBITS, PERCENT, JOULE)


class IndexRow(NamedTuple):
    """An index: its name in words, what it can be of, its unit, and whether its time can be chosen.

    The choice is by ``window``, ``sunlit`` and ``probability``; duty and energy count over the last orbits,
    and settling over the whole flight.
    """

    words: str
    of: tuple[str, ...]
    unit: Unit
    chosen: bool = True


POINTED = ("attitude", "axis")
INDICES: dict[str, IndexRow] = {
    "ape": IndexRow("APE", (*POINTED, "spin"), DEG),
    "mpe": IndexRow("MPE", (*POINTED, "spin"), DEG),
    "rpe": IndexRow("RPE", (*POINTED, "spin"), DEG),
    "ake": IndexRow("AKE", (), DEG),
    "rate": IndexRow("rate", (), DEGPS),
    "settling": IndexRow("settling", (*POINTED, "spin"), ORBITS, chosen=False),
    "duty": IndexRow("duty", (), PERCENT, chosen=False),
    "energy": IndexRow("energy", (), JOULE, chosen=False),
}
OF = {"attitude": "whole attitude", "axis": "axis 1", "spin": "spin rate"}
"""What an index is of, in words."""


def in_words(index: str, what: str | None, name: str | None = None) -> str:
    """An index and what it is of, after the name of the requirement if it has one.

    ``what`` does not matter where the index has no choice of it.
    """
    row = INDICES[index]
    words = f"{row.words} of {OF[what]}" if row.of and what else row.words
    return words if name is None else f"{name}: {words}"


class RequirementSection(Section):
    """The upper limit of an index, to be met by the orbit ``by_orbit``; a shorter flight is not judged.

    ``id`` is the name by which verdicts call it, each only once in a scenario. ``what``: the whole
    attitude, axis 1, which looks up, relative to the vertical, or the spin about it; by default what the
    scenario's modes point. ``window``: the last ``last_orbits`` orbits of the flight, or all from settling
    on, when the error of ``what`` stays below ``settled_deg`` (``settled_degps`` for a spin rate); then it
    must have settled by that orbit. ``sunlit``: only the ticks in sunlight. The limit is on the root mean
    square over the window or, with ``probability``, holds for that fraction of the time: 1 is always.
    ``average_s`` is the time over which MPE takes the mean and RPE the deviation from it.
    """

    id: Name | None = None
    index: Literal[tuple(INDICES)]  # type: ignore[valid-type]  # the names are those of the table
    what: Literal["attitude", "axis", "spin"] | None = None
    at_most_deg: Positive | None = None
    at_most_degps: Positive | None = None
    at_most_orbits: Positive | None = None
    at_most_percent: Positive | None = None
    at_most_j: Positive | None = None
    by_orbit: float = Field(gt=0.0, le=100000.0)
    window: Literal["last_orbits", "settled"] = "last_orbits"
    last_orbits: Positive = 1.0
    sunlit: bool = False
    probability: float | None = Field(default=None, gt=0.0, le=1.0)
    settled_deg: Positive = 5.0
    settled_degps: Positive = 0.06
    average_s: float = Field(default=600.0, gt=0.0, le=100000.0)

    @model_validator(mode="after")
    def _fits_its_index(self) -> Self:
        row = INDICES[self.index]
        if self.what is not None and self.what not in row.of:
            allowed = f"it is of {' or '.join(row.of)}" if row.of else "it is of no choice"
            raise ValueError(f"{self.index} takes no what = '{self.what}': {allowed}")
        given = [unit.key for unit in UNITS if getattr(self, unit.key) is not None]
        if given != [self.unit.key]:
            raise ValueError(
                f"{self.index} is limited by {self.unit.key}, not by {', '.join(given) or 'nothing'}"
            )
        if not row.chosen and (self.window != "last_orbits" or self.sunlit or self.probability is not None):
            raise ValueError(f"{self.index} takes neither window nor sunlit nor probability")
        if self.sunlit and self.index in ("mpe", "rpe"):
            raise ValueError(f"{self.index} takes no sunlit: its mean is over time without a break")
        if self.window == "last_orbits" and self.last_orbits > self.by_orbit:
            raise ValueError(
                f"last_orbits = {self.last_orbits:g} is longer than the flight by_orbit = {self.by_orbit:g}"
            )
        if self.at_most_orbits is not None and self.at_most_orbits > self.by_orbit:
            raise ValueError(
                f"at_most_orbits = {self.at_most_orbits:g} is after by_orbit = {self.by_orbit:g}"
            )
        return self

    @property
    def unit(self) -> Unit:
        """Of the limit."""
        unit = INDICES[self.index].unit
        return DEGPS if self.what == "spin" and unit is DEG else unit

    @property
    def limit(self) -> float:
        """In its unit."""
        limit: float = getattr(self, self.unit.key)
        return limit


Requirements = Annotated[tuple[RequirementSection, ...], Strict(False)]


def check_ids(requirements: Requirements) -> None:
    """Check that no two requirements have the same name.

    Raises:
        ValueError: two have.
    """
    first: dict[str, int] = {}
    for number, one in enumerate(requirements):
        if one.id is None:
            continue
        if one.id in first:
            raise ValueError(
                f"requirement.{number}.id = '{one.id}' is that of requirement.{first[one.id]} too"
            )
        first[one.id] = number


_EXPECTATION = re.compile(r"\s*(\w+)(?:\.(\w+))?\s*<=?\s*([-+.\w]+?)\s*(deg/s|deg|orbits|%|J)?\s*")
_FORM = "write INDEX<VALUE or INDEX.WHAT<VALUE, for instance 'ape<2' or 'ape.axis<2'"


def expectation(text: str, orbits: float) -> RequirementSection:
    """A requirement from a text such as ``ape<2``, on a flight of ``orbits`` orbits.

    It is judged at the end of the flight, over its last orbit; a shorter flight is not judged.

    Raises:
        TableError: one sentence on what is wrong.
    """
    match = _EXPECTATION.fullmatch(text)
    if match is None:
        raise TableError(f"--expect {text[:80]!r}: {_FORM}")
    index, what, number, symbol = match.groups()
    index = index.lower()
    if index not in INDICES:
        near = get_close_matches(index, INDICES, 1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise TableError(f"--expect {text[:80]!r}: there is no index '{index}': {hint}{', '.join(INDICES)}")
    try:
        value = float(number)
    except ValueError:
        raise TableError(f"--expect {text[:80]!r}: '{number}' is not a number: {_FORM}") from None
    unit = DEGPS if what == "spin" and INDICES[index].unit is DEG else INDICES[index].unit
    if symbol is not None and symbol != unit.symbol:
        raise TableError(f"--expect {text[:80]!r}: the unit of {index} is {unit.symbol}, not {symbol}")
    least = value if unit is ORBITS else 1.0
    values = {"index": index, unit.key: value, "by_orbit": max(orbits, least), "last_orbits": 1.0}
    if what is not None:
        values["what"] = what
    return validated(RequirementSection, values, f"--expect {text[:80]!r}")
