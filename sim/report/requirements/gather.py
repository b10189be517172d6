"""Gathers one index over the window of a requirement, block by block, in constant memory."""

import numpy as np
from numpy.typing import NDArray

from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.coil_effort import dipole_squared_a2m4s, driven_s
from sim.report.figures.controlled import controlled, error_vectors
from sim.report.figures.estimate_error import knowledge_errors
from sim.report.requirements.statistic import Statistic
from sim.scenario.requirements import RequirementSection
from sim.scenario.schema import Scenario, orbit_period_s
from sim.statistics.indices import magnitudes
from sim.statistics.settling import Settling, held_ticks
from sim.statistics.windows import Windows

Array = NDArray[np.float64]


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
        self.driven_s = 0.0
        self.dipole_squared_a2m4s = 0.0
        """Of a continuous driver, over the window."""
        self.statistic = Statistic(section.probability)
        self._scenario = scenario
        self._settling = Settling(held_ticks(scenario.time.tick_hz))
        self._windows = self._new_windows()

    @property
    def threshold(self) -> float:
        """Below which what is controlled has settled."""
        return self.section.settled_degps if self.what == "spin" else self.section.settled_deg

    @property
    def settled_at(self) -> int | None:
        """Tick at which what is controlled has settled; None: it has not."""
        return self._settling.tick

    @property
    def long_enough_to_settle(self) -> bool:
        """False where settling is asked for, and the flight is too short to show it."""
        asked = self.section.index == "settling" or self.section.window == "settled"
        return not asked or self.ticks >= self._settling.held_ticks

    @property
    def window_from(self) -> int:
        """The first tick of the window."""
        if self.section.window == "settled":
            return self._settling.since
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
        first, rows = self._settling.taken, len(truth["t_s"])
        error = error_vectors(self.what, truth, self._scenario)
        broken = self._settling.take(magnitudes(error) < self.threshold)
        if broken and self.section.window == "settled":
            self.statistic = Statistic(self.section.probability)
            self._windows = self._new_windows()
        since = max(0, self.window_from - first)
        if since < rows:
            self._take(truth, estimates, error, slice(since, rows))

    def value(self) -> float | None:
        """The statistic of the index over the window, once all blocks are taken; None where it is empty."""
        if self.section.index in ("mpe", "rpe"):
            self._take_means(self._windows.rest())
            self._windows = self._new_windows()
        return self.statistic.value

    def _new_windows(self) -> Windows:
        return Windows(max(1, round(self.section.average_s * self._scenario.time.tick_hz)))

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
            self._take_means(self._windows.take(error[rows]))
            return
        if index == "ake":
            error = np.degrees(knowledge_errors(truth, estimates))
        elif index == "rate":
            error = error_vectors("rate", truth, self._scenario)
        values = magnitudes(error[rows])
        self.statistic.take(values[truth["lit"][rows] > 0.5] if self.section.sunlit else values)

    def _take_means(self, found: tuple[Array, Array]) -> None:
        """What is limited of MPE and RPE of further windows."""
        mean, relative = found
        self.statistic.take(mean if self.section.index == "mpe" else relative)


def _pointed(scenario: Scenario) -> str:
    """What a requirement refers to where it does not say so."""
    what = controlled(scenario).what
    return "attitude" if what == "rate" else what
