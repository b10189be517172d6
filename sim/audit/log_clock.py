"""The clock of a log: its tick rate, and whether its timestamps are simulated time, from its first seconds.

All instants are integers in units of 1 / (10^6 tick_hz) s. In them a tick is 10^6, a microsecond is
``tick_hz``, and nothing is ever rounded.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, islice, pairwise

from fsw.wire.messages import CoilStatus, Sync
from sim.audit.findings import seconds_text
from sim.record.candump import LogEntry

MICRO = 1_000_000
_PEEK = 100_000
"""Entries that may be read before the rate must be decided."""
_MOST_HZ = 1000
"""Ticks a second: the fastest rate that is looked for; a scenario may state a faster one."""


@dataclass(frozen=True, slots=True)
class LogClock:
    """How to turn ticks and timestamps of a log into instants.

    Attributes:
        units: ticks a second where the rate is known, otherwise 1; an instant counts 1 / (10^6 units) s.
        period: of COIL_STATUS, in instants.
        epoch_s: unix time of tick 0; None if the log has no SYNC, or too few to show the tick rate.
        origin_us: timestamp that counts as t = 0.
        simulated: timestamps are epoch + tick / tick_hz, to the microsecond.
        contradictory: no tick rate fits the log's SYNCs.
    """

    units: int
    period: int
    epoch_s: int | None
    origin_us: int
    simulated: bool
    contradictory: bool

    def of_timestamp(self, timestamp_us: int) -> int:
        """The instant of a timestamp; that of a tick, rounded to microseconds, gives exactly that tick."""
        return _instant(timestamp_us, self.units) - self.origin_us * self.units

    def seconds(self, instant: int) -> Fraction:
        """The instant in seconds from t = 0."""
        return Fraction(instant, MICRO * self.units)


def clock_notes(clock: LogClock, stated_hz: int | None, ticks_alone: bool) -> Iterator[str]:
    """What a reader must know of a clock, a sentence each; ``stated_hz`` is the rate of a scenario."""
    if clock.epoch_s is None:
        period = seconds_text(clock.seconds(clock.period))
        yield f"no tick rate in the log: judged by timestamps, a COIL_STATUS every {period} s"
        return
    if not clock.simulated:
        how = "judged by ticks alone" if ticks_alone else "judged by ticks, and by them within 50 ms"
        yield f"timestamps are not simulated time: {how}"
    if stated_hz not in (None, clock.units):
        yield f"the log has {clock.units} ticks a second, its scenario says {stated_hz}"


def _instant(timestamp_us: int, units: int) -> int:
    instant = timestamp_us * units
    since = instant % MICRO
    if since < units:
        return instant - since
    if MICRO - since < units:
        return instant - since + MICRO
    return instant


def read_clock(entries: Iterator[LogEntry], tick_hz: int | None) -> tuple[LogClock, Iterator[LogEntry]]:
    """The clock of a log, and the entries again from the first.

    Args:
        entries: SYNC and COIL_STATUS of the log, in its order; others are passed on.
        tick_hz: the rate that a scenario beside the log states. SYNC overrules it.
    """
    peeked: list[LogEntry] = []
    syncs: list[LogEntry] = []
    seconds: dict[int, tuple[int, int]] = {}
    rates: list[int] | None = None
    for entry in islice(entries, _PEEK):
        peeked.append(entry)
        if entry.frame.can_id != Sync.ID or len(entry.frame.data) != Sync.LENGTH:
            continue
        syncs.append(entry)
        sync = Sync.decode(entry.frame.data)
        tick, unix = sync.tick, sync.unix_time_s
        is_new = unix not in seconds
        seconds[unix] = (tick if is_new else seconds[unix][0], tick)
        if len(seconds) > 1 and is_new:
            rates = _rates(seconds, rates, tick_hz)
            if rates is not None and len(rates) <= 1:
                break
    clock = _tick_clock(syncs, rates, tick_hz) if syncs else None
    if clock is None:
        clock = _timestamp_clock(peeked, tick_hz, contradictory=rates == [])
    return clock, chain(peeked, entries)


def _rates(
    seconds: dict[int, tuple[int, int]], before: list[int] | None, stated: int | None
) -> list[int] | None:
    """The tick rates that give unix_time_s - tick // tick_hz one value; None if it is too early to say.

    Args:
        seconds: first and last tick of each unix_time_s so far.
        before: the rates that have fitted until now; None if it was too early to say.
        stated: by a scenario.
    """
    (unix, (tick, _)), *_, (last_unix, (last_tick, _)) = seconds.items()
    if last_unix - unix == 1 and tick > 0:
        return None
    ends = [(tick, unix) for unix, ticks in seconds.items() for tick in ticks]
    tried = range(last_tick - tick, 0, -1) if before is None else before
    likely = list(tried[-_MOST_HZ:])  # any number of ticks may lie between two SYNCs
    if stated is not None and stated in tried and stated not in likely:
        likely.insert(0, stated)
    return [hz for hz in likely if len({unix - tick // hz for tick, unix in ends}) == 1]


def _tick_clock(syncs: list[LogEntry], rates: list[int] | None, tick_hz: int | None) -> LogClock | None:
    hz = tick_hz if not rates or tick_hz in rates else min(rates)
    if hz is None:
        return None
    first = Sync.decode(syncs[0].frame.data)
    epoch_s = first.unix_time_s - first.tick // hz
    agree = sum(
        _instant(entry.timestamp_us, hz) == (epoch_s * hz + Sync.decode(entry.frame.data).tick) * MICRO
        for entry in syncs
    )
    return LogClock(hz, MICRO, epoch_s, epoch_s * MICRO, 2 * agree >= len(syncs), contradictory=False)


def _timestamp_clock(entries: list[LogEntry], tick_hz: int | None, contradictory: bool) -> LogClock:
    origin_us = entries[0].timestamp_us if entries else 0
    if tick_hz is not None:
        return LogClock(tick_hz, MICRO, None, origin_us, simulated=False, contradictory=contradictory)
    times = [entry.timestamp_us for entry in entries if entry.frame.can_id == CoilStatus.ID]
    spacings = Counter(later - sooner for sooner, later in pairwise(times) if later > sooner)
    period_us = max(spacings, key=lambda spacing: (spacings[spacing], -spacing), default=MICRO)
    hz = round(MICRO / period_us)
    if abs(MICRO - period_us * hz) < hz:
        return LogClock(hz, MICRO, None, origin_us, simulated=False, contradictory=contradictory)
    return LogClock(1, period_us, None, origin_us, simulated=False, contradictory=contradictory)
