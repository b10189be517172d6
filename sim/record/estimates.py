"""The estimates of the flight software at every tick, recorded during a replay."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fsw.core.estimation.mekf import Estimate
from fsw.core.state import FlightState
from sim.value_types import Array


@dataclass(frozen=True, slots=True)
class Estimates:
    """Histories by tick: NaN where there was no estimate.

    ``covariance`` is that of attitude and rate error, (n, 6, 6), body axes; ``mode`` the mode's number;
    ``last`` the last estimate of the filter, whole.
    """

    q_body_from_orbit: Array
    omega_body_orbit_radps: Array
    omega_body_radps: Array
    covariance: Array
    valid: NDArray[np.bool_]
    mode: NDArray[np.int64]
    last: Estimate | None = None

    def part(self, rows: slice) -> "Estimates":
        """The estimates of some ticks; ``last`` stays."""
        return Estimates(
            self.q_body_from_orbit[rows],
            self.omega_body_orbit_radps[rows],
            self.omega_body_radps[rows],
            self.covariance[rows],
            self.valid[rows],
            self.mode[rows],
            self.last,
        )


class EstimateRecorder:
    """Records flight states tick by tick, ``ticks`` of them from ``first`` on."""

    def __init__(self, ticks: int, first: int = 0) -> None:
        self.first = first
        self._estimates = Estimates(
            q_body_from_orbit=np.full((ticks, 4), np.nan),
            omega_body_orbit_radps=np.full((ticks, 3), np.nan),
            omega_body_radps=np.full((ticks, 3), np.nan),
            covariance=np.full((ticks, 6, 6), np.nan),
            valid=np.zeros(ticks, dtype=bool),
            mode=np.zeros(ticks, dtype=int),
        )
        self._last: Estimate | None = None

    def take(self, state: FlightState) -> None:
        """Store the estimate of the state's tick; other ticks are ignored."""
        tick, into = state.tick - self.first, self._estimates
        if not 0 <= tick < len(into.valid):
            return
        into.mode[tick] = state.modes.mode
        into.valid[tick] = state.attitude.valid
        estimate = state.estimator.estimate
        if estimate is None and not state.attitude.valid:
            return
        into.q_body_from_orbit[tick] = state.attitude.q_body_from_orbit
        into.omega_body_orbit_radps[tick] = state.attitude.omega_body_orbit_radps
        if estimate is not None:
            into.omega_body_radps[tick] = estimate.omega_body_radps
            into.covariance[tick] = estimate.covariance[0:6, 0:6]
            self._last = estimate.copy()

    def estimates(self) -> Estimates:
        """The histories."""
        return replace(self._estimates, last=self._last)
