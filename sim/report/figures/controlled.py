"""The quantity that a scenario's modes and law control, its errors by tick, and when it has settled."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from fsw.table.own_law import declared
from fsw.table.sections import ControlTable
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import axis1_errors, errors
from sim.report.figures.mean import Mean
from sim.scenario.schema import Scenario, flight_table
from sim.statistics.settling import Settling

Array = NDArray[np.float64]
Json = dict[str, Any]

SETTLED_DEG = 5.0


class Controlled(NamedTuple):
    """What is controlled: its name in requirements, in words, and the error below which it has settled."""

    what: str
    words: str
    unit: str
    threshold: float


def controlled(scenario: Scenario) -> Controlled:
    """Body axis 1 or the whole attitude, as the modes judge; the rate under a law that does not point."""
    table = flight_table(scenario)
    modes = table.modes
    if modes.axis_only:
        return Controlled("axis", "axis 1", "deg", SETTLED_DEG)
    if _aim(table.control) in (Aim.THREE_AXIS, Aim.AXIS):
        return Controlled("attitude", "whole attitude", "deg", SETTLED_DEG)
    return Controlled("rate", "rate", "deg/s", modes.slow_degps)


def _aim(control: ControlTable) -> Aim:
    """Of the law that flies; one whose source is withheld is taken to point."""
    if control.own:
        return Aim.THREE_AXIS if control.law_withheld else declared(control).aim
    return LAWS[control.law].aim


def error_vectors(what: str, truth: Histories, spin_radps: float) -> Array:
    """The error of what is controlled, (n, 3) or (n, 1), deg or deg/s, body axes.

    ``attitude``: the rotation vector from nominal; ``axis``: that from body axis 1 to the vertical;
    ``rate``: relative to the orbital frame, less the spin reference; ``spin``: its component about axis 1.
    """
    if what == "attitude":
        return np.degrees(errors(truth["q_body_from_orbit"]))
    if what == "axis":
        return np.degrees(axis1_errors(truth["q_body_from_orbit"]))
    rate: Array = np.degrees(truth["omega_body_orbit_radps"] - np.array([spin_radps, 0.0, 0.0]))
    return rate[:, :1] if what == "spin" else rate


@dataclass(slots=True)
class ControlledError:
    """The error of what is controlled over the last orbit, and the tick at which it has settled."""

    of: Controlled
    spin_radps: float
    settling: Settling
    last_orbit: Mean = field(default_factory=Mean)

    def take(self, truth: Histories, recent: slice) -> Array:
        """The next block, of which ``recent`` is in the last orbit; returns the errors' magnitudes."""
        error: Array = np.linalg.norm(error_vectors(self.of.what, truth, self.spin_radps), axis=1)
        self.last_orbit.take(error[recent])
        self.settling.take(error < self.of.threshold)
        return error

    def figures(self, ticks_per_orbit: float) -> Json:
        """For summary.json; no ``settle_orbits`` unless it has settled."""
        figures = {
            **self.of._asdict(),
            "rms_last_orbit": self.last_orbit.rms,
            "max_last_orbit": self.last_orbit.most,
        }
        if (settled := self.settling.tick) is not None:
            figures["settle_orbits"] = settled / ticks_per_orbit
        return figures
