"""Which tick a COIL_STATUS belongs to: it carries no tick number, only its place among the SYNCs shows it."""

from typing import NamedTuple

from fsw.wire.messages import CoilStatus


class BoardStatus(NamedTuple):
    """A COIL_STATUS as logged.

    Attributes:
        line: its line in the log.
        timestamp_us: its timestamp.
        status: its content; None if its CRC or length is wrong.
        booted: the board has started since its last status.
    """

    line: int
    timestamp_us: int
    status: CoilStatus | None
    booted: bool


class StatusTicks:
    """Assigns statuses to ticks.

    There is one status a tick, and it comes before the tick's SYNC. In real time it may come after it, and a
    recorder may lose frames. So the last of several statuses at once belong to the last ticks, one each, as
    far as those have none yet; and a single one after an empty tick belongs to that tick if its counter shows
    that it is the board's next. Where a piece of the log is missing, those before it belong to its first
    ticks.
    """

    def __init__(self) -> None:
        self._waiting: list[BoardStatus] = []
        self._empty = 0
        self._counter: int | None = None
        self._silent = 0
        self._reported_us = 0

    @property
    def silent(self) -> int:
        """Number of ticks so far that have no status."""
        return self._silent + self._empty

    @property
    def waiting(self) -> bool:
        """Whether statuses wait for their SYNC."""
        return bool(self._waiting)

    def add(self, status: BoardStatus) -> None:
        """The next status of the log."""
        self._waiting.append(status)

    def close(self, tick: int, step: int, timestamp_us: int = 0) -> list[tuple[int, list[BoardStatus]]]:
        """At SYNC of ``tick``, ``step`` ticks after the last one: ticks in order, each with its statuses.

        ``timestamp_us``: of this SYNC.
        """
        waiting, self._waiting = self._waiting, []
        step += self._empty
        self._empty = 0
        if not waiting:
            self._empty = step
            return []
        if step == 2 and len(waiting) == 1 and self._is_next(waiting[0]):
            self._empty = 1
            tick, step = tick - 1, 1
        before = self._before_gap(waiting, timestamp_us) if step > 2 and len(waiting) < step else 0
        self._reported_us = timestamp_us
        last = waiting[-1].status
        self._counter = None if last is None else last.counter
        if step == 1:
            return [(tick, waiting)]
        by_tick: dict[int, list[BoardStatus]] = {
            tick - step + 1 + place: [status] for place, status in enumerate(waiting[:before])
        }
        for age, status in enumerate(reversed(waiting[before:])):
            by_tick.setdefault(max(tick - age, tick - step + 1), []).insert(0, status)
        self._silent += step - len(by_tick)
        return sorted(by_tick.items())

    def _before_gap(self, waiting: list[BoardStatus], timestamp_us: int) -> int:
        """How many statuses follow the last one, by counter and by time, ahead of a gap in the log."""
        counter, middle_us = self._counter, (self._reported_us + timestamp_us) // 2
        number = 0
        for _, status_us, status, _ in waiting:
            if counter is None or status is None or status.counter != (counter + 1) % 16:
                break
            if status_us >= middle_us:
                break
            number, counter = number + 1, status.counter
        return number

    def _is_next(self, board: BoardStatus) -> bool:
        if self._counter is None or board.status is None:
            return False
        return board.status.counter == (self._counter + 1) % 16
