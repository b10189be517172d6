"""The controller's estimates at every tick, gathered while a log is replayed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsw.core.state import FlightState

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Estimates:
    """Histories by tick: NaN where nothing was known.

    ``covariance`` is that of attitude and rate error, (n, 6, 6), body axes; ``mode`` the mode's number.
    """

    q_body_from_orbit: Array
    omega_body_orbit_radps: Array
    omega_body_radps: Array
    covariance: Array
    valid: NDArray[np.bool_]
    mode: NDArray[np.int64]


class EstimateRecorder:
    """Takes flight states tick by tick."""

    def __init__(self, ticks: int) -> None:
        self._estimates = Estimates(
            q_body_from_orbit=np.full((ticks, 4), np.nan),
            omega_body_orbit_radps=np.full((ticks, 3), np.nan),
            omega_body_radps=np.full((ticks, 3), np.nan),
            covariance=np.full((ticks, 6, 6), np.nan),
            valid=np.zeros(ticks, dtype=bool),
            mode=np.zeros(ticks, dtype=int),
        )

    def take(self, state: FlightState) -> None:
        """Keep what the state says of its tick; ticks beyond the histories are passed over."""
        tick, into = state.tick, self._estimates
        if tick >= len(into.valid):
            return
        into.mode[tick] = state.modes.mode
        into.valid[tick] = state.attitude.valid
        known = state.estimator.estimate
        if known is None and not state.attitude.valid:
            return
        into.q_body_from_orbit[tick] = state.attitude.q_body_from_orbit
        into.omega_body_orbit_radps[tick] = state.attitude.omega_body_orbit_radps
        if known is not None:
            into.omega_body_radps[tick] = known.omega_body_radps
            into.covariance[tick] = known.covariance[0:6, 0:6]

    def estimates(self) -> Estimates:
        """The histories."""
        return self._estimates
