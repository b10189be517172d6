"""Quantities by tick, derived from a flight's histories or from a block of them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fsw.core.laws.plan.law_axes import LawAxes
from fsw.core.state import FlightState
from sim.record.estimates import EstimateRecorder, Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import angle_rad, axis1_angle_rad, law_attitude, normal_in_body
from sim.report.figures.estimate_error import estimate_error
from sim.report.figures.performance import BLOCK_TICKS
from sim.value_types import Array

DARK = 0.5
"""A smaller visible fraction of the Sun counts as eclipse."""


@dataclass(frozen=True, slots=True)
class FlightHistories:
    """The histories of at least one tick: the plant's, and the controller's of the same ticks."""

    truth: Histories
    estimates: Estimates
    axes: LawAxes | None = None
    """Those that the laws count by; None: the body axes."""

    @property
    def ticks(self) -> int:
        """The number of ticks."""
        return len(self.truth["t_s"])

    @property
    def dark(self) -> NDArray[np.bool_]:
        """Whether it is eclipse."""
        return self.truth["lit"] < DARK

    @property
    def pointing_deg(self) -> Array:
        """The angle between the nominal and the true attitude."""
        return np.degrees(angle_rad(law_attitude(self.truth["q_body_from_orbit"], self.axes)))

    @property
    def axis1_deg(self) -> Array:
        """The angle of axis 1, that looks up, from the local vertical."""
        return np.degrees(axis1_angle_rad(law_attitude(self.truth["q_body_from_orbit"], self.axes)))

    @property
    def attitude_error_deg(self) -> Array:
        """The angle between the estimated and the true attitude; NaN before the first estimate."""
        return np.degrees(angle_rad(estimate_error(self.truth, self.estimates)))

    @property
    def rate_error_degps(self) -> Array:
        """The magnitude of the error of the inertial rate; NaN where unknown."""
        omega = self.estimates.omega_body_radps[: self.ticks]
        relative = self.estimates.omega_body_orbit_radps[: self.ticks]
        orbit_rate = np.linalg.norm(omega - relative, axis=1)
        orbital = orbit_rate[:, None] * normal_in_body(self.truth["q_body_from_orbit"])
        error: Array = np.linalg.norm(self.truth["omega_body_orbit_radps"] + orbital - omega, axis=1)
        return np.degrees(error)

    def sigma3_deg(self, first: int) -> Array:
        """3 sqrt(tr P) of three error states, from ``first`` on: three times the error the filter expects."""
        variances = [self.estimates.covariance[: self.ticks, i, i] for i in range(first, first + 3)]
        result: Array = np.degrees(3.0 * np.sqrt(np.sum(variances, axis=0)))
        return result


# --- Joins what a replay estimates with the plant's histories, in blocks of ticks, as the replay goes on

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
