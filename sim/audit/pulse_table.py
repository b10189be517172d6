"""The pulses of a log, twenty bytes each: a month has tens of thousands."""

from array import array
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import overload

from sim.audit.findings import DrivenPulse


class PulseTable(Sequence[DrivenPulse]):
    """Pulses in the order in which they were added.

    Args:
        unit_s: the unit in which edges are counted.
    """

    def __init__(self, unit_s: Fraction) -> None:
        self._unit_s = unit_s
        self._coils, self._levels = array("b"), array("b")
        self._starts, self._ends = array("q"), array("q")

    def add(self, coil: int, level: int, start: int, end: int) -> None:
        """One more, from ``start`` to ``end`` in units."""
        self._coils.append(coil)
        self._levels.append(level)
        self._starts.append(start)
        self._ends.append(end)

    def by_start(self) -> "PulseTable":
        """The same in order of start."""
        ordered = PulseTable(self._unit_s)
        for place in sorted(range(len(self)), key=self._starts.__getitem__):
            ordered.add(self._coils[place], self._levels[place], self._starts[place], self._ends[place])
        return ordered

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]  # it grows

    def __len__(self) -> int:
        return len(self._starts)

    def __iter__(self) -> Iterator[DrivenPulse]:
        return map(self._pulse, range(len(self)))

    @overload
    def __getitem__(self, index: int) -> DrivenPulse: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[DrivenPulse, ...]: ...
    def __getitem__(self, index: int | slice) -> DrivenPulse | tuple[DrivenPulse, ...]:
        if isinstance(index, slice):
            return tuple(map(self._pulse, range(*index.indices(len(self)))))
        return self._pulse(index)

    def _pulse(self, place: int) -> DrivenPulse:
        start_s, end_s = self._starts[place] * self._unit_s, self._ends[place] * self._unit_s
        return DrivenPulse(self._coils[place], self._levels[place], start_s, end_s)
