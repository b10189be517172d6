"""The errors by tick of what a scenario's modes and law control, and when it has settled."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from fsw.core.laws.interface import MAX_SPIN_RADPS
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import axis1_errors, errors, law_attitude, law_vector
from sim.report.figures.mean import Mean
from sim.scenario.controlled import Controlled
from sim.scenario.schema import Scenario
from sim.scenario.telecommands import SendSpin, first_tick
from sim.statistics.settling import Settling
from sim.value_types import Array, Json


def spin_reference_radps(scenario: Scenario, t_s: Array) -> Array:
    """The spin about axis 1 that is asked for, rad/s, at times t, (n,).

    That of ``control.spin_radps``, and of each TC_SPIN of the scenario within the range from its tick on.
    """
    hz = scenario.time.tick_hz
    tick = np.rint(t_s * hz)
    reference = np.full(len(t_s), scenario.control.spin_radps)
    for telecommand in _spins(scenario):
        reference[tick >= first_tick(telecommand, hz)] = telecommand.spin_radps
    return reference


def _spins(scenario: Scenario) -> Iterator[SendSpin]:
    """Those that the flight software follows, in their order."""
    for telecommand in sorted(scenario.telecommand, key=lambda telecommand: telecommand.at_s):
        if isinstance(telecommand, SendSpin) and abs(telecommand.spin_radps) <= MAX_SPIN_RADPS:
            yield telecommand


def error_vectors(what: str, truth: Histories, scenario: Scenario) -> Array:
    """The error of what is controlled, (n, 3) or (n, 1), deg or deg/s, in the axes of the laws.

    ``attitude``: the rotation vector from nominal; ``axis``: that from axis 1 to the vertical;
    ``rate``: relative to the orbital frame, less the spin reference; ``spin``: its component about axis 1.
    """
    axes = scenario.body.law_axes
    if what == "attitude":
        return np.degrees(errors(law_attitude(truth["q_body_from_orbit"], axes)))
    if what == "axis":
        return np.degrees(axis1_errors(law_attitude(truth["q_body_from_orbit"], axes)))
    reference_radps = np.zeros((len(truth["t_s"]), 3))
    reference_radps[:, 0] = spin_reference_radps(scenario, truth["t_s"])
    rate: Array = np.degrees(law_vector(truth["omega_body_orbit_radps"], axes) - reference_radps)
    return rate[:, :1] if what == "spin" else rate


@dataclass(slots=True)
class ControlledError:
    """The error of what is controlled over the last orbit, and the tick at which it has settled."""

    of: Controlled
    scenario: Scenario
    settling: Settling
    last_orbit: Mean = field(default_factory=Mean)

    def take(self, truth: Histories, recent: slice) -> Array:
        """The next block, of which ``recent`` is in the last orbit; returns the errors' magnitudes."""
        error: Array = np.linalg.norm(error_vectors(self.of.what, truth, self.scenario), axis=1)
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
