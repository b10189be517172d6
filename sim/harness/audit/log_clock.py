"""The time of a log: its tick rate, and what its timestamps are worth, read off its first seconds.

All instants are integers in units of 1 / (10^6 tick_hz) s. In them a tick is 10^6, a microsecond is
``tick_hz``, and nothing is ever rounded.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, islice, pairwise

from fsw.wire.messages import CoilStatus, Sync
from sim.harness.candump import LogEntry

MICRO = 1_000_000
_PEEK = 100_000
"""How many entries may be looked at before the rate must be settled."""


@dataclass(frozen=True, slots=True)
class LogClock:
    """How to turn ticks and timestamps of a log into instants.

    Attributes:
        units: ticks a second where ticks are known, else 1; an instant counts 1 / (10^6 units) s.
        period: of COIL_STATUS, in instants.
        epoch_s: unix time of tick 0; None if the log has no SYNC, or none that tells the tick rate.
        origin_us: timestamp that counts as t = 0.
        simulated: timestamps are epoch + tick / tick_hz, to the microsecond.
        contradictory: no tick rate fits the log's SYNCs.
    """

    units: int
    period: int
    epoch_s: int | None
    origin_us: int
    simulated: bool = False
    contradictory: bool = False

    def of_timestamp(self, timestamp_us: int) -> int:
        """The instant of a timestamp; one that is a tick's, rounded to microseconds, is that tick's."""
        instant = timestamp_us * self.units
        tick = (instant + MICRO // 2) // MICRO * MICRO
        if abs(instant - tick) < self.units:
            instant = tick
        return instant - self.origin_us * self.units

    def seconds(self, instant: int) -> Fraction:
        """The instant in seconds from t = 0."""
        return Fraction(instant, MICRO * self.units)


def read_clock(entries: Iterator[LogEntry], tick_hz: int | None) -> tuple[LogClock, Iterator[LogEntry]]:
    """The clock of a log, and the entries again from the first.

    Args:
        entries: SYNC and COIL_STATUS of the log, in its order; others are passed on.
        tick_hz: the rate that a scenario beside the log states. SYNC overrules it.
    """
    peeked: list[LogEntry] = []
    syncs: list[tuple[int, int]] = []
    first: LogEntry | None = None
    rates: list[int] | None = None
    for entry in islice(entries, _PEEK):
        peeked.append(entry)
        if entry.frame.can_id != Sync.ID or len(entry.frame.data) != Sync.LENGTH:
            continue
        first = first or entry
        if _note(syncs, Sync.decode(entry.frame.data)):
            rates = _rates(syncs)
            if rates is not None and len(rates) <= 1:
                break
    clock = _tick_clock(first, syncs[0], rates, tick_hz) if first is not None else None
    if clock is None:
        clock = _timestamp_clock(peeked, tick_hz, contradictory=rates == [])
    return clock, chain(peeked, entries)


def _note(syncs: list[tuple[int, int]], sync: Sync) -> bool:
    """Keep the SYNCs on both sides of each change of ``unix_time_s``; whether this is such a change."""
    this = (sync.tick, sync.unix_time_s)
    changed = bool(syncs) and syncs[-1][1] != this[1]
    if len(syncs) > 1 and not changed and syncs[-2][1] == this[1]:
        syncs[-1] = this
    else:
        syncs.append(this)
    return changed


def _rates(syncs: list[tuple[int, int]]) -> list[int] | None:
    """The tick rates that give unix_time_s - tick // tick_hz one value; None if it is too early to say."""
    (tick, unix), (last_tick, last_unix) = syncs[0], syncs[-1]
    ticks, seconds = last_tick - tick, last_unix - unix
    if ticks <= 0 or seconds <= 0:
        return []
    if seconds == 1 and tick > 0:
        return None
    lowest = max(1, ticks // (seconds + 1))
    highest = last_tick if seconds == 1 else (ticks - 1) // (seconds - 1)
    return [hz for hz in range(lowest, highest + 1) if len({u - t // hz for t, u in syncs}) == 1]


def _tick_clock(
    first: LogEntry, sync: tuple[int, int], rates: list[int] | None, tick_hz: int | None
) -> LogClock | None:
    hz = rates[0] if rates and (len(rates) == 1 or tick_hz not in rates) else tick_hz
    if hz is None:
        return None
    tick, unix = sync
    epoch_s = unix - tick // hz
    clock = LogClock(units=hz, period=MICRO, epoch_s=epoch_s, origin_us=epoch_s * MICRO)
    return replace(clock, simulated=clock.of_timestamp(first.timestamp_us) == tick * MICRO)


def _timestamp_clock(entries: list[LogEntry], tick_hz: int | None, contradictory: bool) -> LogClock:
    origin_us = entries[0].timestamp_us if entries else 0
    if tick_hz is not None:
        return LogClock(tick_hz, MICRO, None, origin_us, contradictory=contradictory)
    times = [entry.timestamp_us for entry in entries if entry.frame.can_id == CoilStatus.ID]
    spacings = Counter(later - sooner for sooner, later in pairwise(times) if later > sooner)
    period_us = max(spacings, key=lambda spacing: (spacings[spacing], -spacing), default=MICRO)
    hz = round(MICRO / period_us)
    if hz > 0 and abs(MICRO - period_us * hz) < hz:
        return LogClock(hz, MICRO, None, origin_us, contradictory=contradictory)
    return LogClock(1, period_us, None, origin_us, contradictory=contradictory)
