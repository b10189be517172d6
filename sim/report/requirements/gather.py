"""Gathers one index over the window of a requirement, block by block, in constant memory."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.coil_effort import dipole_squared_a2m4s, driven_s
from sim.report.figures.controlled import controlled, error_vectors, held_from
from sim.report.figures.estimate_error import knowledge_errors
from sim.report.requirements.statistic import Statistic
from sim.scenario.requirements import RequirementSection
from sim.scenario.schema import Scenario, orbit_period_s
from sim.statistics.indices import magnitudes, mean_and_relative

Array = NDArray[np.float64]

HELD_S = 600.0
"""Time for which an error must have stayed under its threshold, to the end of the flight, to have settled."""


class Gathered:
    """The values of an index over its window.

    Args:
        section: the requirement.
        scenario: of the flight.
        ticks: of the whole flight.
    """

    def __init__(self, section: RequirementSection, scenario: Scenario, ticks: int) -> None:
        self.section = section
        self.what = section.what or _pointed(scenario)
        self.ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
        self.ticks = ticks
        self.judged = ticks + 1 > section.by_orbit * self.ticks_per_orbit
        """Whether the flight is long enough, to within a tick."""
        self.settled_at = 0
        """Tick from which the error of what is controlled stays under its threshold."""
        self.driven_s = 0.0
        self.dipole_squared_a2m4s = 0.0
        """Of a continuous driver, over the window."""
        self.statistic = Statistic(section.probability)
        self._scenario = scenario
        self._taken = 0
        self._held_ticks = ceil(HELD_S * scenario.time.tick_hz)
        self._average = max(1, round(section.average_s * scenario.time.tick_hz))
        self._recent = np.empty((0, 3))  # errors of the last averaging time
        self._waiting = 0  # how many of them are in no average yet

    @property
    def threshold(self) -> float:
        """Below which what is controlled has settled."""
        return self.section.settled_degps if self.what == "spin" else self.section.settled_deg

    @property
    def settled(self) -> bool:
        """Whether it has settled: at the end of the flight it has held for ``HELD_S``."""
        return self._taken - self.settled_at >= self._held_ticks

    @property
    def long_enough_to_settle(self) -> bool:
        """False where settling is asked for, and the flight is too short to show it."""
        asked = self.section.index == "settling" or self.section.window == "settled"
        return not asked or self.ticks >= self._held_ticks

    @property
    def window_from(self) -> int:
        """The first tick of the window."""
        if self.section.window == "settled":
            return self.settled_at
        return max(0, self.ticks - round(self.section.last_orbits * self.ticks_per_orbit))

    @property
    def flown_orbits(self) -> float:
        """The length of the flight."""
        return self.ticks / self.ticks_per_orbit

    @property
    def window_orbits(self) -> float:
        """The length of the window."""
        return (self.ticks - self.window_from) / self.ticks_per_orbit

    def take(self, truth: Histories, estimates: Estimates) -> None:
        """The next block."""
        first, rows = self._taken, len(truth["t_s"])
        self._taken += rows
        error = error_vectors(self.what, truth, self._scenario.control.spin_radps)
        row = held_from(magnitudes(error), self.threshold)
        if row:
            self.settled_at = first + row
            if self.section.window == "settled":
                self.statistic = Statistic(self.section.probability)
                self._recent, self._waiting = np.empty((0, 3)), 0
        since = max(0, self.window_from - first)
        if since < rows:
            self._take(truth, estimates, error, slice(since, rows))

    def value(self) -> float | None:
        """The statistic of the index over the window, once all blocks are taken; None where it is empty."""
        if self._waiting:
            self._take_means(self._recent, self._waiting)
            self._waiting = 0
        return self.statistic.value

    def _take(self, truth: Histories, estimates: Estimates, error: Array, rows: slice) -> None:
        index = self.section.index
        if index in ("duty", "energy"):
            if self._scenario.coils.driver != "continuous":
                return
            dipole_am2 = truth["m_body_am2"][rows]
            self.driven_s += driven_s(self._scenario, dipole_am2)
            self.dipole_squared_a2m4s += dipole_squared_a2m4s(self._scenario, dipole_am2)
            return
        if index == "settling":
            return
        if index in ("mpe", "rpe"):
            self._average_over(error[rows])
            return
        if index == "ake":
            error = np.degrees(knowledge_errors(truth, estimates))
        elif index == "rate":
            error = error_vectors("rate", truth, self._scenario.control.spin_radps)
        values = magnitudes(error[rows])
        self.statistic.take(values[truth["lit"][rows] > 0.5] if self.section.sunlit else values)

    def _average_over(self, error: Array) -> None:
        """Count the means over whole averaging times; the rest waits for the next block."""
        rows = np.concatenate((self._recent.reshape(-1, error.shape[1]), error))
        waiting = self._waiting + len(error)
        self._waiting = waiting % self._average
        first, end = len(rows) - waiting, len(rows) - self._waiting
        if end > first:
            self._take_means(rows[first:end], end - first)
        self._recent = rows[-self._average :]

    def _take_means(self, error: Array, fresh: int) -> None:
        """The means of these errors; of the deviations from them, those of the last ``fresh`` errors.

        The last averaging time ends with the window and overlaps the one before, so that every tick counts,
        and each mean is over the same time.
        """
        mean, relative = mean_and_relative(error, self._average)
        self.statistic.take(mean if self.section.index == "mpe" else relative[-fresh:])


def _pointed(scenario: Scenario) -> str:
    """What a requirement refers to where it does not say so."""
    what = controlled(scenario).what
    return "attitude" if what == "rate" else what
