"""Requirements of a campaign: limits on figures of a run."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf

from fsw.input.near import did_you_mean
from fsw.input.schema import Nested, TableError
from sim.campaign.definition.columns import NUMBERS
from sim.campaign.definition.words import FIGURE_WORDS, POINTING

SHORT = {"pointing_deg": "pointing_deg_rms_last_orbit"}
"""Short names of figures."""
_SIDES = {"at_least", "at_most"}


@dataclass(frozen=True, slots=True)
class FigureRequirement:
    """A figure of a run that must lie between two limits."""

    figure: str
    at_least: float = -inf
    at_most: float = inf

    def met_by(self, value: object) -> bool:
        """Whether a run meets it; one without the figure does not."""
        return isinstance(value, int | float) and self.at_least <= value <= self.at_most

    def as_value(self) -> object:
        """The limits as in a campaign file."""
        if self.at_least == -inf:
            return self.at_most
        return {key: getattr(self, key) for key in sorted(_SIDES) if abs(getattr(self, key)) < inf}

    def __str__(self) -> str:
        if self.at_least == -inf:
            return f"{self.figure} <= {self.at_most:g}"
        if self.at_most == inf:
            return f"{self.figure} >= {self.at_least:g}"
        return f"{self.at_least:g} <= {self.figure} <= {self.at_most:g}"


def requirements_in(values: Nested, source: str) -> tuple[FigureRequirement, ...]:
    """The requirements in ``[requirement]``: a number as the upper limit, or a table of at_least and at_most.

    Raises:
        TableError: there is no such figure, a figure has two entries or no limit, or a limit is not a number.
    """
    names: dict[str, str] = {}
    found: list[FigureRequirement] = []
    for name, limit in _flat(values):
        requirement = _requirement(name, limit, source)
        earlier = names.setdefault(requirement.figure, name)
        if len(names) == len(found):
            both = f"{requirement.figure} has two entries, requirement.{earlier} and requirement.{name}"
            raise TableError(f"{source}: {both}: write one")
        found.append(requirement)
    return tuple(found)


def _one_of_each_kind() -> str:
    """A figure of each kind, for whoever has named none."""
    first: dict[str, str] = {}
    for name, words in FIGURE_WORDS.items():
        first.setdefault(words.kind, name)
    first |= {POINTING: next(iter(SHORT))}
    return ", ".join(f"of the {kind} {name}" for kind, name in first.items())


def _flat(values: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, object]]:
    """Limits by figure, its dots as underscores."""
    for key, value in values.items():
        if isinstance(value, dict) and value and not value.keys() <= _SIDES:
            yield from _flat(value, f"{prefix}{key}_")
        else:
            yield f"{prefix}{key}", value


def _requirement(name: str, limit: object, source: str) -> FigureRequirement:
    limits: Nested = limit if isinstance(limit, dict) else {"at_most": limit}
    if not limits:
        raise TableError(f"{source}: requirement.{name} has no limit: give a number, at_least or at_most")
    figure = SHORT.get(name, name)
    if figure not in NUMBERS:
        hint = did_you_mean(figure, [*SHORT, *NUMBERS]) or f": {_one_of_each_kind()}"
        raise TableError(f"{source}: requirement.{name} is no figure of a run{hint}")
    for side, value in limits.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not -inf < value < inf:
            where = f"requirement.{name}" + (f".{side}" if isinstance(limit, dict) else "")
            raise TableError(f"{source}: {where} = {value!r} is not allowed: allowed is a number")
    return FigureRequirement(figure, **{side: float(value) for side, value in limits.items()})
