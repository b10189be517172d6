"""The entries of a log that are judged, and how the log ends."""

from collections.abc import Iterable, Iterator

from fsw.wire.messages import CoilBoot, CoilDipoleStatus, CoilStatus, PlantEnd, Sync, intact
from sim.record.candump import LogEntry, LogTruncatedError

JUDGED = frozenset((CoilStatus.ID, CoilDipoleStatus.ID, CoilBoot.ID, Sync.ID))


class WholeEntries:
    """The entries that are judged, up to where the log is truncated; afterwards, how the log ended."""

    def __init__(self, entries: Iterable[LogEntry]) -> None:
        self._entries = entries
        self.truncated_at: int | None = None
        self.ended = False
        """Whether its last frame is an intact PLANT_END that fits its last SYNC."""
        self.wrong_end: str | None = None
        """What is wrong with a PLANT_END that is its last frame."""

    def __iter__(self) -> Iterator[LogEntry]:
        last = sync = None
        try:
            for entry in self._entries:
                last = entry.frame
                if last.can_id == Sync.ID and intact(last):
                    sync = last
                if last.can_id in JUDGED:
                    yield entry
        except LogTruncatedError as error:
            self.truncated_at = error.line
            return
        if last is None or last.can_id != PlantEnd.ID:
            return
        if not intact(last):
            self.wrong_end = "its last frame is a PLANT_END with a wrong CRC or length"
        elif sync is not None and not _fits(PlantEnd.decode(last.data), Sync.decode(sync.data)):
            ticks, tick = PlantEnd.decode(last.data).ticks, Sync.decode(sync.data).tick
            self.wrong_end = f"its PLANT_END counts {ticks} ticks, its last SYNC is of tick {tick}"
        self.ended = self.wrong_end is None

    def notes(self) -> Iterator[str]:
        """How the log ended where it should not have, in a sentence."""
        if self.truncated_at is not None:
            yield f"truncated: line {self.truncated_at} is incomplete; the lines before it are judged"
        elif not self.ended:
            yield f"the log has no end mark{f': {self.wrong_end}' if self.wrong_end else ''}"


def _fits(end: PlantEnd, sync: Sync) -> bool:
    """Whether the number of ticks in PLANT_END, modulo 2^24, is that up to the last SYNC."""
    return (sync.tick + 1 - end.ticks) % (1 << 24) == 0
