"""Orbit elements from the ground: stored one by one, put into use all at once."""

from dataclasses import dataclass, replace
from typing import Any, final

from fsw.wire.messages import Element


@final
@dataclass(frozen=True, slots=True)
class Elements:
    """Mean elements as in a two-line element set, in its units, by the names of ``Element``.

    The epoch is in days since 1970-01-01 UTC, whole days and the fraction of a day separately; ``bstar`` is
    in 1 per Earth radius, ``motion_revpday`` is Kozai's mean motion in revolutions per day.
    """

    epoch_day: float = 0.0
    epoch_fraction: float = 0.0
    inclination_deg: float = 0.0
    raan_deg: float = 0.0
    eccentricity: float = 0.0
    perigee_deg: float = 0.0
    anomaly_deg: float = 0.0
    motion_revpday: float = 0.0
    bstar: float = 0.0


RANGES: dict[Element, tuple[float, float]] = {
    Element.EPOCH_DAY: (0.0, 100_000.0),
    Element.EPOCH_FRACTION: (0.0, 1.0),
    Element.INCLINATION_DEG: (0.0, 180.0),
    Element.RAAN_DEG: (0.0, 360.0),
    Element.ECCENTRICITY: (0.0, 0.9999999),
    Element.PERIGEE_DEG: (0.0, 360.0),
    Element.ANOMALY_DEG: (0.0, 360.0),
    Element.MOTION_REVPDAY: (6.4, 20.0),
    Element.BSTAR: (-1.0, 1.0),
}
"""Range of each element alone; whether together they are an orbit is judged when they are loaded."""


@final
@dataclass(frozen=True, slots=True)
class Upload:
    """Elements received so far, and which: bit n for element n."""

    values: Elements = Elements()
    received: int = 0

    @property
    def complete(self) -> bool:
        """Whether every element has been received."""
        return self.received == (1 << len(Element)) - 1

    def with_element(self, element: Element, value: float) -> "Upload":
        """The upload with one more element, or one replaced."""
        changed: dict[str, Any] = {element.name.lower(): value}
        return Upload(replace(self.values, **changed), self.received | 1 << element)
