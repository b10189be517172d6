"""The estimates of the flight software at every tick, recorded during a replay."""

from dataclasses import dataclass
from math import nan
from struct import Struct

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


_VECTORS = Struct("=10d")
"""Attitude, rate relative to the orbital frame and inertial rate of a tick."""


class EstimateRecorder:
    """Records flight states tick by tick, ``ticks`` of them from ``first`` on."""

    def __init__(self, ticks: int, first: int = 0) -> None:
        self.first = first
        self._vectors = np.full((ticks, 10), nan)
        self._packed = self._vectors.data
        self._covariance = np.full((ticks, 6, 6), nan)
        self._valid, self._mode = bytearray(ticks), bytearray(ticks)
        self._last: Estimate | None = None

    def take(self, state: FlightState) -> None:
        """Store the estimate of the state's tick; other ticks are ignored."""
        tick, ticks = state.tick - self.first, len(self._valid)
        if not 0 <= tick < ticks:
            return
        attitude, estimate = state.attitude, state.estimator.estimate
        self._mode[tick] = state.modes.mode
        self._valid[tick] = attitude.valid
        if estimate is None and not attitude.valid:
            return
        omega_body_radps = (nan, nan, nan) if estimate is None else estimate.omega_body_radps
        vectors = (*attitude.q_body_from_orbit, *attitude.omega_body_orbit_radps, *omega_body_radps)
        _VECTORS.pack_into(self._packed, tick * _VECTORS.size, *vectors)
        if estimate is not None:
            self._covariance[tick] = estimate.covariance[0:6, 0:6]
            self._last = estimate if tick + 1 < ticks else estimate.copy()  # it goes on after the last tick

    def estimates(self) -> Estimates:
        """The histories."""
        q_body_from_orbit, omega_body_orbit_radps, omega_body_radps = (
            np.ascontiguousarray(vector) for vector in np.split(self._vectors, (4, 7), axis=1)
        )
        return Estimates(
            q_body_from_orbit,
            omega_body_orbit_radps,
            omega_body_radps,
            self._covariance,
            np.frombuffer(self._valid, dtype=bool),
            np.frombuffer(self._mode, dtype=np.uint8).astype(int),
            None if self._last is None else self._last.copy(),
        )
