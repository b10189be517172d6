"""A flight recorded in memory: the digest of its frames, those that are judged, and its histories."""

import hashlib
from array import array
from collections.abc import Sequence
from typing import Final, final

import numpy as np

from fsw.node import FlightNode
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, CoilDipole, CoilFire, CoilRefused, PlantEnd
from sim.audit.whole_entries import JUDGED
from sim.plant.truth_row import TruthRow
from sim.record.candump import LogEntry
from sim.record.estimates import EstimateRecorder
from sim.record.truth import COLUMNS, Histories

COMMANDS: Final = frozenset({CoilFire.ID, CoilDipole.ID})


@final
class FrameDigest:
    """Digests of frames in their order.

    Two flights with the same digest of all frames are equal to the last bit: each TICK_DONE has the CRC of
    the flight state. Each frame is sealed by a CRC of its own that includes its identifier, so that the data
    suffice.
    """

    def __init__(self) -> None:
        self._all, self._commands = hashlib.sha256(), hashlib.sha256()

    def take(self, frames: Sequence[Frame]) -> None:
        """Add the frames of a tick."""
        self._all.update(b"".join([frame.data for frame in frames]))
        for frame in frames:
            if frame.can_id in COMMANDS:
                self._commands.update(frame.data)

    @property
    def frames(self) -> str:
        """Of all frames, in hex."""
        return self._all.hexdigest()

    @property
    def commands(self) -> str:
        """Of the commands, in hex."""
        return self._commands.hexdigest()


_JUDGED: Final = (
    JUDGED
    | {CoilRefused.ID, PlantEnd.ID}
    | {can_id for can_id, name in NAMES.items() if name.endswith("_EVENT")}
)
"""Identifiers of the frames that audit and tally evaluate."""

_WIDTHS: Final = {name: width for name, width, *_ in COLUMNS if name != "r_eci_m"}
"""Of the histories that summaries and measures need: the first numbers of a row."""


@final
class FramesInMemory:
    """The frames that are evaluated after the flight, numbered like the lines of a log."""

    def __init__(self) -> None:
        self.entries: list[LogEntry] = []
        self.digest = FrameDigest()
        self._line = 0

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Add the frames of a tick."""
        self.digest.take(frames)
        for frame in frames:
            self._line += 1
            if frame.can_id in _JUDGED:
                self.entries.append(LogEntry(self._line, timestamp_us, "virtual", frame))


@final
class HistoriesInMemory:
    """The histories that summaries and measures need, and with each row the estimate on board."""

    def __init__(self, ticks: int, node: FlightNode) -> None:
        self._rows = array("d")
        self._width = sum(_WIDTHS.values())
        self.recorder = EstimateRecorder(ticks)
        self._node = node

    def append(self, row: TruthRow) -> None:
        """Add the row of a tick, and the estimate of the node in it."""
        self._rows.fromlist(row.numbers()[: self._width])
        self.recorder.take(self._node.state)

    def histories(self) -> Histories:
        """By name; each a copy of its columns."""
        rows = np.frombuffer(self._rows).reshape(-1, self._width)
        columns = np.split(rows, np.cumsum([*_WIDTHS.values()])[:-1], axis=1)
        return {
            name: np.ascontiguousarray(column[:, 0] if width == 1 else column)
            for (name, width), column in zip(_WIDTHS.items(), columns, strict=True)
        }

    def flush(self) -> None:
        """Nothing is buffered."""
