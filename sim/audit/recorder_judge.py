"""The pulses of a log by the clock of its recorder: what ticks that are held or rushed would hide.

A board sends the status of a tick in advance, as soon as the tick before has been answered, and the SYNC may
come late. So there are two bounds on every edge: a pulse was on when a status said so, by the stamp of that
status; and a board without a clock of its own keeps it on until the SYNC of its last tick. A limit that the
sure bound breaks is a violation. One that only the other breaks is a doubt: such a log is not OK.

Stamps are allowed ``TOLERANCE_US`` of jitter. A stamp that goes back is a step of the recorder's clock: what
lies between the two SYNCs counts as its ticks say, and the log as not judged in real time. A stamp that goes
far ahead of the ticks may be a tick that was held, or such a step too: in doubt it is no part of a back-off.
"""

from array import array
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile

from fsw.wire.messages import CoilStatus
from sim.audit.findings import AuditLimits, Violation, ViolationKind, seconds_text
from sim.audit.log_clock import MICRO, LogClock
from sim.audit.status_ticks import BoardStatus

TOLERANCE_US = 50_000
"""Of a recorder's stamps: the jitter that a limit may seem broken by."""
_PACE = 0.05
"""Part by which the median second of the stamps may differ from one."""
_AHEAD = MICRO
"""A SYNC that comes later than its ticks say by over a second is reported."""
_KEPT = 64
"""SYNCs that are kept: statuses come at most a few ticks after theirs."""


@dataclass(slots=True)
class _Pulse:
    """A coil that is on. Instants as ``LogClock`` counts them."""

    coil: int
    seq: int
    tick: int
    line: int
    begun: int  # no sooner: the SYNC before its first status
    shown: int  # no later: the stamp of its first status
    on_until: int  # on until then at least
    latest: int  # until then at most, on a board that counts ticks alone
    announced: int  # until then by a clock of the board's own
    remaining: int
    status_tick: int  # of its last status


class RecorderJudge:
    """Judges pulses and back-off by the stamps of SYNC and COIL_STATUS."""

    def __init__(self, clock: LogClock, limits: AuditLimits) -> None:
        self._clock = clock
        self._limits = limits
        tolerance = TOLERANCE_US * clock.units
        self._tolerance = tolerance
        self._longest = limits.pulse_us * clock.units
        self._most = self._longest + tolerance
        self._least = limits.backoff_us * clock.units - tolerance
        self._syncs: list[tuple[int, int]] = []
        self._first_us: int | None = None
        self._shift = 0  # added to stamps: steps so far
        self._second: tuple[int, int] | None = None
        self._seconds = array("q")
        self._steps = 0
        self._step = ""
        self._ahead: list[tuple[int, int, int]] = []  # tick, instant, by how much
        self._pulses: dict[int, _Pulse] = {}
        self._ended: dict[int, tuple[int, int]] = {}  # no sooner and no later
        self._booted: int | None = None
        self.violations: list[Violation] = []
        self.doubt = ""
        """Why a limit may have been broken by the recorder's clock, for the first, a clause."""

    def sync(self, tick: int, timestamp_us: int) -> None:
        """The first SYNC of a tick."""
        stamp = self._stamp(timestamp_us)
        if self._syncs:
            last_tick, last = self._syncs[-1]
            ahead = stamp - last - (tick - last_tick) * MICRO
            if ahead > _AHEAD * self._clock.units:
                self._ahead.append((tick, stamp, ahead))
            if stamp < last - self._tolerance:
                if not self._step:
                    back = seconds_text(self._clock.seconds(last - stamp))
                    self._step = f"the recorder's clock goes back by {back} s at tick {tick}"
                self._steps += 1
                forward = last + (tick - last_tick) * MICRO
                self._shift += forward - stamp
                stamp = forward
                self._second = None
        self._syncs.append((tick, stamp))
        del self._syncs[:-_KEPT]
        if self._second is None:
            self._second = tick, stamp
        elif (ticks := tick - self._second[0]) >= self._clock.units:
            self._seconds.append((stamp - self._second[1]) // ticks)
            self._second = tick, stamp

    def boot(self, timestamp_us: int) -> None:
        """The board has started."""
        self._booted = self._stamp(timestamp_us)

    def interrupt(self) -> None:
        """The log, or a run in it, ends."""
        for pulse in list(self._pulses.values()):
            self._stop(pulse)
        self._ended.clear()
        self._syncs.clear()
        self._second = self._booted = None

    def observe(self, tick: int, boards: list[BoardStatus]) -> None:
        """All statuses of one tick."""
        driven = [(b, b.status) for b in boards if b.status is not None and b.status.level]
        if all(board.status is None for board in boards):
            return
        shown = {(status.coil, status.seq) for _, status in driven}
        for pulse in list(self._pulses.values()):
            if (pulse.coil, pulse.seq) not in shown:
                self._stop(pulse)
        for board, status in driven:
            stamp = min(self._stamp(board.timestamp_us), self._at(tick))
            under_way = self._pulses.get(status.coil)
            if under_way is not None and under_way.seq == status.seq:
                self._go_on(under_way, status, tick, stamp)
                continue
            if under_way is not None:
                self._stop(under_way)
            self._start(board.line, status, tick, stamp)

    def unjudged(self) -> str:
        """Why the log is not judged in real time, a clause; empty: it is."""
        if self._other_pace():
            median = sorted(self._seconds)[len(self._seconds) // 2] / MICRO
            if not median:
                return "its timestamps are all equal"
            return f"its timestamps run at {1 / median:.4g} times the pace of its ticks"
        return f"{self._step}{_more(self._steps)}" if self._step else ""

    def notes(self) -> Iterator[str]:
        """What a reader must know of the stamps, a sentence each."""
        if self._ahead and not self._other_pace():
            tick, _, ahead = self._ahead[0]
            by = seconds_text(self._clock.seconds(ahead))
            yield (
                f"the recorder's clock goes on by {by} s more than its ticks at tick {tick}"
                f"{_more(len(self._ahead))}: ticks that were held, or a step of that clock"
            )

    def found(self) -> list[Violation]:
        """The violations; none where the stamps run at another pace than the ticks."""
        return [] if self._other_pace() else self.violations

    def doubted(self) -> str:
        """``doubt``; none where the stamps run at another pace than the ticks."""
        return "" if self._other_pace() else self.doubt

    def _other_pace(self) -> bool:
        if not self._seconds:
            return False
        median = sorted(self._seconds)[len(self._seconds) // 2]
        return abs(median - MICRO) > _PACE * MICRO

    def _stamp(self, timestamp_us: int) -> int:
        if self._first_us is None:
            self._first_us = timestamp_us
        return (timestamp_us - self._first_us) * self._clock.units + self._shift

    def _at(self, tick: int) -> int:
        """The instant of a tick's SYNC; one that is not in the log lies between its neighbours."""
        syncs = self._syncs
        place = bisect_left(syncs, (tick,))
        if place == len(syncs):
            return syncs[-1][1] + (tick - syncs[-1][0]) * MICRO
        after, later = syncs[place]
        if after == tick or place == 0:
            return later - (after - tick) * MICRO
        before, sooner = syncs[place - 1]
        return sooner + (later - sooner) * (tick - before) // (after - before)

    def _start(self, line: int, status: CoilStatus, tick: int, stamp: int) -> None:
        begun = self._at(tick - 1)
        shown = max(stamp, begun)
        self._judge_start(status.coil, line, tick, begun, shown)
        remaining = self._units(status.remaining_ms)
        self._pulses[status.coil] = _Pulse(
            status.coil,
            status.seq,
            tick - 1,
            line,
            begun,
            shown,
            shown,
            self._at(tick),
            shown + MICRO + remaining,
            remaining,
            tick,
        )

    def _go_on(self, pulse: _Pulse, status: CoilStatus, tick: int, stamp: int) -> None:
        now, remaining = self._at(tick), self._units(status.remaining_ms)
        if remaining:
            pulse.on_until = max(pulse.on_until, stamp)
            pulse.latest = max(pulse.latest, now)
        elif pulse.remaining:
            by_ticks = pulse.remaining - (tick - pulse.status_tick) * MICRO
            before = self._at(pulse.status_tick)
            if by_ticks > self._units(1):  # ended by a clock of the board's own
                pulse.latest = min(pulse.latest, max(pulse.on_until, pulse.announced))
            elif now - before > (tick - pulse.status_tick) * MICRO + self._tolerance:
                pulse.latest = max(pulse.latest, now)
            else:
                pulse.latest = max(pulse.latest, before + pulse.remaining)
        pulse.remaining, pulse.status_tick = remaining, tick

    def _stop(self, pulse: _Pulse) -> None:
        del self._pulses[pulse.coil]
        self._ended[pulse.coil] = min(pulse.latest, max(pulse.on_until, pulse.announced)), pulse.latest
        limit = seconds_text(self._clock.seconds(self._longest))
        if pulse.on_until - pulse.shown > self._most:
            length = seconds_text(self._clock.seconds(pulse.on_until - pulse.shown))
            sentence = f"by the recorder's clock the pulse of {length} s exceeds {limit} s"
            self._add(ViolationKind.PULSE, pulse.tick, pulse.coil, pulse.line, sentence)
        elif pulse.latest - pulse.begun > self._most:
            length = seconds_text(self._clock.seconds(pulse.latest - pulse.begun))
            self._doubt(f"the pulse of coil {pulse.coil} at tick {pulse.tick} may have lasted {length} s")

    def _judge_start(self, coil: int, line: int, tick: int, begun: int, shown: int) -> None:
        ends = [end for other, end in self._ended.items() if self._limits.shared or other == coil]
        booted = [] if self._booted is None else [(self._booted, self._booted)]
        for kind, since, event in (
            (ViolationKind.GAP, ends, "the end of the pulse before"),
            (ViolationKind.BOOT, booted, "the boot of the board"),
        ):
            most = min((shown - sooner for sooner, _ in since), default=self._least)
            least = min((begun - later - self._ahead_since(later) for _, later in since), default=self._least)
            if least >= self._least:
                continue
            sure = most < self._least
            gap = seconds_text(self._clock.seconds(max(0, most if sure else least)))
            if sure:
                limit = seconds_text(self._clock.seconds(self._least + self._tolerance))
                sentence = (
                    f"by the recorder's clock the pulse starts {gap} s after {event}, sooner than {limit} s"
                )
                self._add(kind, tick - 1, coil, line, sentence)
            else:
                self._doubt(f"the pulse of coil {coil} at tick {tick - 1} may start {gap} s after {event}")

    def _ahead_since(self, instant: int) -> int:
        """By how much the stamps have gone ahead of the ticks since then."""
        since = takewhile(lambda one: one[1] > instant, reversed(self._ahead))
        return sum(ahead for _, _, ahead in since)

    def _units(self, milliseconds: int) -> int:
        return milliseconds * 1000 * self._clock.units

    def _doubt(self, clause: str) -> None:
        self.doubt = self.doubt or f"by the recorder's clock {clause}"

    def _add(self, kind: ViolationKind, tick: int, coil: int, line: int, sentence: str) -> None:
        seconds = self._clock.seconds(tick * MICRO)
        self.violations.append(Violation(kind, seconds, tick, coil, line, sentence))


def _more(count: int) -> str:
    return {0: "", 1: "", 2: ", and once more"}.get(count, f", and {count - 1} times more")
