"""The samples of a bus log, tick by tick, as arrays."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilStatus, MagField, SunVector, Sync, intact
from sim.errors import HarnessError
from sim.record.candump import LogTruncatedError, read_log

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Samples:
    """What the boards sent, a row a tick; NaN where nothing valid came.

    Attributes:
        tick: numbers of the ticks, which rise by one.
        unix_s: their time, UTC.
        field_nt: readings of the magnetometer, its channels, (n, 3).
        sun: readings of the Sun sensor, (n, 3).
        coil: output that was driven over the tick that ended, 0 to 2.
        level: its level, -3 to 3; 0 where none was driven, or nothing was reported.
        reported: whether the coil driver has reported.
    """

    tick: Numbers
    unix_s: Array
    field_nt: Array
    sun: Array
    coil: Numbers
    level: Numbers
    reported: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.tick)

    def free(self, within: int) -> NDArray[np.bool_]:
        """Ticks with a field sample, and no coil driven within so many ticks, as was reported."""
        driven = (self.level != 0) | ~self.reported
        near = np.convolve(driven, np.ones(2 * within + 1), mode="same") > 0.0
        return ~near & whole(self.field_nt)


def in_time(samples: Samples, delay_ticks: float) -> Samples:
    """The samples with the field, which shows the satellite as it was so many ticks before, at its own time.

    Between two samples it is linear.
    """
    late, part = int(delay_ticks), delay_ticks - int(delay_ticks)
    newer = _ahead(samples.field_nt, late)
    field_nt = newer if part == 0.0 else (1.0 - part) * newer + part * _ahead(samples.field_nt, late + 1)
    return replace(samples, field_nt=field_nt)


def _ahead(rows: Array, ticks: int) -> Array:
    """The rows of so many ticks later; NaN beyond the last."""
    if not ticks:
        return rows
    return np.vstack([rows[ticks:], np.full((min(ticks, len(rows)), rows.shape[1]), np.nan)])


def whole(rows: Array) -> NDArray[np.bool_]:
    """Which rows lack no number."""
    return np.asarray(np.isfinite(rows).all(axis=1), bool)


def read_samples(log: Path, tick_hz: int) -> Samples:
    """The samples of a candump log, as far as it goes.

    A board may be a tick ahead of the SYNC that names it, as on a bench: of what comes between two SYNCs the
    last sample of each board belongs to the later one.

    Raises:
        LogError: the file is no candump log.
        HarnessError: it holds no ticks.
    """
    rows: dict[int, list[float]] = {}
    first_unix_s, pending = 0.0, _nothing()
    try:
        for entry in read_log(log):
            frame = entry.frame
            if frame.can_id == Sync.ID and intact(frame):
                sync = Sync.decode(frame.data)
                if not rows:
                    first_unix_s = float(sync.unix_time_s) - sync.tick / tick_hz % 1.0
                rows.setdefault(sync.tick, pending)
                pending = _nothing()
            else:
                _take(frame, pending)
    except LogTruncatedError:
        pass  # what was read is whole
    if not rows:
        raise HarnessError(f"{log}: no SYNC in it: not the log of a flight")
    return _filled(rows, first_unix_s, tick_hz)


def _nothing() -> list[float]:
    return [np.nan] * 6 + [0.0, 0.0, 0.0]


def _take(frame: Frame, row: list[float]) -> None:
    if frame.can_id not in (MagField.ID, SunVector.ID, CoilStatus.ID) or not intact(frame):
        return
    if frame.can_id == MagField.ID:
        field = MagField.decode(frame.data)
        row[0:3] = (field.b_x, field.b_y, field.b_z) if field.valid else [np.nan] * 3
    elif frame.can_id == SunVector.ID:
        sun = SunVector.decode(frame.data)
        row[3:6] = (sun.s_x, sun.s_y, sun.s_z) if sun.valid else [np.nan] * 3
    else:
        status = CoilStatus.decode(frame.data)
        row[6:9] = (status.coil, status.level, 1.0)


def _filled(rows: dict[int, list[float]], first_unix_s: float, tick_hz: int) -> Samples:
    """With empty rows for the ticks that are missing."""
    ticks = np.arange(min(rows), max(rows) + 1)
    table = np.array([rows.get(tick, _nothing()) for tick in ticks.tolist()])
    return Samples(
        tick=ticks,
        unix_s=first_unix_s + (ticks - ticks[0]) / tick_hz,
        field_nt=table[:, 0:3],
        sun=table[:, 3:6],
        coil=table[:, 6].astype(np.int64),
        level=table[:, 7].astype(np.int64),
        reported=table[:, 8] > 0.0,
    )
