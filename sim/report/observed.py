"""The estimates that a user's flight software gives on the bus, by tick, from the log of its flight.

What it does not send is not there: attitude and rate NaN, mode ``NO_MODE``.
"""

from collections.abc import Iterable, Iterator
from math import nan, sqrt

import numpy as np

from fsw.wire.messages import Mode, NavAttitude, NavQuality, NavRate, Sync, TickDone, intact
from sim.record.candump import LogEntry
from sim.record.estimates import Estimates
from sim.report.figures.performance import BLOCK_TICKS

NO_MODE = -1
"""In place of a mode that was not sent."""
_MODES = frozenset(Mode)


def observed_estimates(entries: Iterable[LogEntry], ticks: int, forged: bool = False) -> Iterator[Estimates]:
    """The estimates of a flight in blocks of ``BLOCK_TICKS``, the last one shorter.

    Each holds for the tick in whose answer it came; NAV_QUALITY holds until the next one.

    Args:
        entries: the log of the flight.
        ticks: to give; those that the log does not hold have no estimate.
        forged: a fault of the scenario sends under identifiers of the flight software, before SYNC: what
            comes between two answers is not its own.
    """
    block, first, last = _block(ticks, 0), 0, -1
    quality: NavQuality | None = None
    answering = False
    for entry in entries:
        frame = entry.frame
        if frame.can_id == Sync.ID and intact(frame):
            tick = Sync.decode(frame.data).tick
            if tick != last + 1 or tick >= ticks:  # repeated, or forged
                continue
            last, answering = tick, True
            if last >= first + BLOCK_TICKS:
                yield block
                first += BLOCK_TICKS
                block = _block(ticks, first)
            _hold(block, last - first, quality)
        elif frame.can_id == TickDone.ID and len(frame.data) == TickDone.LENGTH:
            answering &= TickDone.decode(frame.data).tick != last
        elif last >= 0 and (answering or not forged) and frame.can_id in _TAKEN and intact(frame):
            if frame.can_id == NavQuality.ID:
                quality = NavQuality.decode(frame.data)
                _hold(block, last - first, quality)
            elif frame.can_id == NavAttitude.ID:
                attitude = NavAttitude.decode(frame.data)
                x, y, z = attitude.q_x, attitude.q_y, attitude.q_z
                scalar = sqrt(max(0.0, 1.0 - x * x - y * y - z * z))
                block.q_body_from_orbit[last - first] = (scalar, x, y, z) if attitude.valid else nan
                block.valid[last - first] = bool(attitude.valid)
            else:
                rate = NavRate.decode(frame.data)
                block.omega_body_orbit_radps[last - first] = rate.w_x, rate.w_y, rate.w_z
    while first < ticks:
        yield block
        first += BLOCK_TICKS
        block = _block(ticks, first)


_TAKEN = frozenset((NavAttitude.ID, NavRate.ID, NavQuality.ID))


def _hold(block: Estimates, row: int, quality: NavQuality | None) -> None:
    """Put mode and 3 sigma of all axes into the rest of the block."""
    if quality is None:
        return
    block.mode[row:] = quality.mode if quality.mode in _MODES else NO_MODE
    sigmas = np.repeat((quality.sigma3_attitude / 3.0, quality.sigma3_rate / 3.0), 3)
    block.covariance[row:] = np.diag(sigmas**2)


def _block(ticks: int, first: int) -> Estimates:
    rows = max(0, min(BLOCK_TICKS, ticks - first))
    return Estimates(
        q_body_from_orbit=np.full((rows, 4), nan),
        omega_body_orbit_radps=np.full((rows, 3), nan),
        omega_body_radps=np.full((rows, 3), nan),
        covariance=np.full((rows, 6, 6), nan),
        valid=np.zeros(rows, dtype=bool),
        mode=np.full(rows, NO_MODE),
    )
