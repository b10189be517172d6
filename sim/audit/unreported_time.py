"""Stretches of a log in which the board reports nothing: whether a whole pulse may have gone unreported.

The status after such a stretch has the ``seq`` of the last request that the board accepted. Where it is that
of the status before, and no coil was on then, nothing was accepted in between and nothing was driven. Where
it is another, that request was driven: its first status shows a level, or a pulse has gone unreported, in a
stretch however short.
"""

from collections.abc import Iterator

from fsw.wire.messages import CoilStatus
from sim.audit.findings import AuditLimits, seconds_text
from sim.audit.log_clock import LogClock

_ROUNDED_MS = 20
"""Of ``lockout_ms``, which is in steps of 10 ms."""


class UnreportedTime:
    """Adds up stretches without a status that are as long as the longest pulse and a tick.

    Ticks that SYNC skips have no status by the contract: they count as time without a report, but a stretch
    is doubted only for the ticks whose SYNC is in the log.
    """

    def __init__(self, clock: LogClock, limits: AuditLimits) -> None:
        self._clock = clock
        self._least = limits.pulse_us * clock.units + clock.period
        self._last: int | None = None
        self._seq: int | None = None
        self._backoff = limits.backoff_us * clock.units
        self._lockouts: dict[int, int] = {}
        self._accepts_from: int | None = None
        self._is_first = True
        self._under_way = False
        self._syncs = self._stretches = 0
        self._first: int | None = None
        self.total = 0
        """In instants."""
        self.doubt = ""
        """Why a pulse may have gone unreported, for the first that may have, a clause."""

    def begin(self, instant: int) -> None:
        """The first tick of a log, or of another run in it, ends at ``instant``."""
        self._last, self._seq = instant - self._clock.period, None
        self._lockouts.clear()
        self._accepts_from = None
        self._is_first, self._under_way = True, False
        self._syncs = 0

    def sync(self) -> None:
        """A tick without a status has its SYNC in the log."""
        self._syncs += 1

    def boot(self, instant: int) -> None:
        """The board has started: it has accepted nothing, and before the first boot of a log it was off."""
        if not self._is_first:
            self._close(instant - self._clock.period, None, "the board boots after it")
        self._last, self._seq, self._is_first, self._under_way = instant, 0, False, False
        self._syncs = 0
        self._lockouts.clear()
        self._accepts_from = instant + self._backoff

    def take(self, instant: int, statuses: list[CoilStatus]) -> None:
        """The statuses of the tick that ends at ``instant``."""
        if not statuses:
            return
        until = instant - self._clock.period
        self._close(until, statuses[0].seq)
        for status in statuses:
            self._compare(until, status)
            self._seq = status.seq
            self._lockouts[status.coil] = status.lockout_ms
            if status.seq or status.level:
                self._accepts_from = None
        self._last, self._is_first = instant, False
        self._under_way = any(status.level and status.remaining_ms for status in statuses)
        self._syncs = 0

    def finish(self, instant: int) -> None:
        """The log, or a run in it, ends at ``instant``."""
        self._close(instant, None)

    def notes(self) -> Iterator[str]:
        """How long the board reported nothing, and from when on for the first time, in a sentence."""
        if self._first is None:
            return
        total, least, first = (
            seconds_text(self._clock.seconds(instant)) for instant in (self.total, self._least, self._first)
        )
        stretches = "a stretch" if self._stretches == 1 else f"{self._stretches} stretches"
        yield f"unreported: {total} s, in {stretches} of at least {least} s, the first from t={first} s"

    def _close(self, until: int, seq: int | None, why: str = "no status before or after it") -> None:
        if self._last is None or until - self._last < self._least:
            return
        self._stretches += 1
        self.total += until - self._last
        if self._first is None:
            self._first = max(self._last, 0)
        accepts_from = self._accepts_from
        if not seq and accepts_from is not None and until > accepts_from:
            seq, why = None, "the first request since the boot may have had the seq 0, which none has too"
        synced = self._clock.epoch_s is None or self._syncs * self._clock.period >= self._least
        if synced and not self.doubt and (seq is None or seq != self._seq or self._under_way):
            self.doubt = self._doubt(self._last, until, seq, why)

    def _compare(self, until: int, status: CoilStatus) -> None:
        """Whether a status is the first of a request, and shows none of its pulse."""
        if self.doubt or self._last is None or self._seq is None or status.level:
            return
        if status.seq == self._seq and not self._first_is_lost(until, status):
            return
        if self._clock.epoch_s is None or self._syncs * self._clock.period >= until - self._last:
            at = seconds_text(self._clock.seconds(until + self._clock.period))
            self.doubt = (
                f"a pulse may have gone unreported before t={at} s: "
                f"seq is {self._seq} before and {status.seq} then, with no coil on"
            )

    def _first_is_lost(self, until: int, status: CoilStatus) -> bool:
        """Whether the first request since a boot has the ``seq`` 0, as before it: its back-off shows it."""
        if self._accepts_from is None or until < self._accepts_from:
            return False
        before = min(self._lockouts.values(), default=status.lockout_ms)
        return status.lockout_ms > before + _ROUNDED_MS

    def _doubt(self, begun: int, until: int, seq: int | None, why: str) -> str:
        seconds = self._clock.seconds
        if self._under_way:
            why = "a coil was on when it began"
        elif seq is not None and self._seq is not None:
            why = f"seq is {self._seq} before and {seq} after it"
        return (
            f"a pulse may have gone unreported in the {seconds_text(seconds(until - begun))} s "
            f"from t={seconds_text(seconds(max(begun, 0)))} s: {why}"
        )
