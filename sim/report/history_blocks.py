"""Joins what a replay estimates with the plant's histories, in blocks of ticks, as the replay goes on."""

from collections.abc import Callable
from typing import Protocol

from fsw.core.state import FlightState
from sim.record.estimates import EstimateRecorder, Estimates
from sim.record.truth import Histories
from sim.report.figures.performance import BLOCK_TICKS

TakeBlock = Callable[[Histories, Estimates], None]


class TruthBlocks(Protocol):
    """Histories that can be read block by block.

    Attributes:
        complete: number of rows that can be read.
    """

    complete: int

    def rows(self, first: int, past: int) -> Histories:
        """Some rows of every dataset, by name."""


class HistoryBlocks:
    """Hands over each block once the replay is a whole block past it.

    Until then a replay may still find that frames arrived in another order, and give a tick another estimate.

    Args:
        truth: the plant's histories.
        take: what is called with each block, in order.
    """

    def __init__(self, truth: TruthBlocks, take: TakeBlock) -> None:
        self._truth = truth
        self._take = take
        self._now = EstimateRecorder(self._length(0), 0)
        self._next = EstimateRecorder(self._length(BLOCK_TICKS), BLOCK_TICKS)

    def take(self, state: FlightState) -> None:
        """The state after a tick; ticks beyond the histories are ignored."""
        while self._next.first + BLOCK_TICKS <= state.tick and self._length(self._now.first):
            self._hand_over()
        self._now.take(state)
        self._next.take(state)

    def finish(self) -> None:
        """Hand over what is left; ticks that were not replayed have no estimate."""
        while self._length(self._now.first):
            self._hand_over()

    def _hand_over(self) -> None:
        first = self._now.first
        estimates = self._now.estimates()
        self._take(self._truth.rows(first, first + self._length(first)), estimates)
        after = self._next.first + BLOCK_TICKS
        self._now, self._next = self._next, EstimateRecorder(self._length(after), after)

    def _length(self, first: int) -> int:
        """Ticks of the block that begins with this one; 0 beyond the histories."""
        return max(0, min(BLOCK_TICKS, self._truth.complete - first))
