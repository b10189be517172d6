"""The samples of a bus log, tick by tick, as arrays."""

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilStatus, MagField, SunVector, Sync, intact
from sim.errors import HarnessError
from sim.record.candump import LogTruncatedError, read_log
from sim.value_types import Array, Numbers

SURE_GAP_S, LONGEST_GAP_S = 3600.0, 86400.0
"""Time without a SYNC that is believed whatever the time stamps say, since a recording of a flight without a
pace has stamps that are much closer; and that is believed at most, where they bear it out."""
COILS, REPORTED, UNREPORTED, DISPUTED = slice(6, 9), 1.0, 0.0, -1.0
"""Where a row has coil, level and what is known of them: reported, not reported, reported as two things."""


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
        reported: whether the coil driver has reported, and not two things at once.
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

    @property
    def tick_hz(self) -> int:
        """Ticks a second; 1 where there is one tick alone."""
        span_s = float(self.unix_s[-1] - self.unix_s[0])
        return round((len(self) - 1) / span_s) if span_s > 0.0 else 1

    def free(self, within: int) -> NDArray[np.bool_]:
        """Ticks with a field sample, and no coil driven within so many ticks, as was reported."""
        driven = (self.level != 0) | ~self.reported
        near = np.convolve(driven, np.ones(2 * within + 1))[within : within + len(driven)] > 0.0
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
        HarnessError: it holds no ticks, one that lies too far from the others, or a coil or level that no
            board has.
    """
    rows: dict[int, list[float]] = {}
    stamps_s: dict[int, float] = {}
    epoch_unix_s, pending = 0, _nothing()
    try:
        for entry in read_log(log):
            frame = entry.frame
            if frame.can_id == Sync.ID and intact(frame):
                sync = Sync.decode(frame.data)
                if not rows:
                    epoch_unix_s = sync.unix_time_s - sync.tick // tick_hz
                rows.setdefault(sync.tick, pending)
                stamps_s.setdefault(sync.tick, entry.timestamp_us / 1e6)
                pending = _nothing()
            else:
                try:
                    _take(frame, pending)
                except ValueError as error:
                    raise HarnessError(f"{log}: line {entry.line}: {error}") from None
    except LogTruncatedError:
        pass  # what was read is whole
    if not rows:
        raise HarnessError(f"{log}: no SYNC in it: not the log of a flight")
    _check_gaps(log, stamps_s, tick_hz)
    return _filled(rows, epoch_unix_s, tick_hz)


def _check_gaps(log: Path, stamps_s: dict[int, float], tick_hz: int) -> None:
    """Check that no tick lies so far from the one before that it must be wrong."""
    for before, tick in pairwise(sorted(stamps_s)):
        missing_s, passed_s = (tick - before) / tick_hz, abs(stamps_s[tick] - stamps_s[before])
        if missing_s > min(passed_s, LONGEST_GAP_S) + SURE_GAP_S:
            raise HarnessError(
                f"{log}: a SYNC names tick {tick}, {missing_s:.0f} s after tick {before}, from which it is "
                f"{passed_s:.0f} s by the time stamps: it cannot be right"
            )


def _nothing() -> list[float]:
    return [np.nan] * 6 + [0.0, 0.0, UNREPORTED]


def _take(frame: Frame, row: list[float]) -> None:
    """Put what a frame says into the row of its tick; ValueError: a coil or a level that no board has."""
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
        if status.coil > 2 or abs(status.level) > 3:
            raise ValueError(
                f"a COIL_STATUS of coil {status.coil} at level {status.level}: there are coils 0 to 2 and "
                "levels -3 to 3"
            )
        driven = [status.coil if status.level else 0.0, status.level, REPORTED]
        row[COILS] = driven if row[COILS] in (_nothing()[COILS], driven) else [0.0, 0.0, DISPUTED]


def _filled(rows: dict[int, list[float]], epoch_unix_s: int, tick_hz: int) -> Samples:
    """With empty rows for the ticks that are missing; the epoch is the time of tick 0."""
    ticks = np.arange(min(rows), max(rows) + 1)
    table = np.tile(_nothing(), (len(ticks), 1))
    table[np.array(list(rows)) - ticks[0]] = list(rows.values())
    return Samples(
        tick=ticks,
        unix_s=epoch_unix_s + ticks / tick_hz,
        field_nt=table[:, 0:3],
        sun=table[:, 3:6],
        coil=table[:, 6].astype(np.int64),
        level=table[:, 7].astype(np.int64),
        reported=table[:, 8] == REPORTED,
    )
