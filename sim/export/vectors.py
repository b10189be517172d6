"""A flight as golden vectors: what comes in and what goes out, tick by tick, for unit tests on a target.

JSON lines: the first line says of which flight they are, each other line is a tick, with its frames as
candump writes them. Binary, for what has no JSON: ``MAGIC``, then records of ``RECORD`` each: its kind, the
number of data bytes, the identifier with SocketCAN's flags, and eight bytes, those beyond the number 0. A
record of kind ``TICK`` ends each tick, its data the tick and the number of frames in and out.
"""

import json
import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from fsw.wire.candump_line import frame_text
from fsw.wire.frame import Frame
from fsw.wire.messages import SENDERS, PlantEnd, Sync, TickDone, intact
from sim.errors import HarnessError
from sim.export.source import LogPass, Source
from sim.record.candump import LogEntry
from sim.result_files import whole_file

FORMAT = "torquer-vectors/1"
MAGIC = b"torquer-vec/1\r\n\0"
RECORD = struct.Struct("<BBxxI8s")
IN, OUT, TICK = 0, 1, 2
BEFORE = -1
"""Tick of what came before the first SYNC: the boot of the flight software."""
_FROM_FSW = frozenset(can_id for can_id, sender in SENDERS.items() if sender == "FSW")


@dataclass(slots=True)
class TickVector:
    """A tick: the frames that the flight software receives up to its SYNC, and those of its answer."""

    tick: int
    incoming: list[Frame] = field(default_factory=list)
    outgoing: list[Frame] = field(default_factory=list)


def tick_vectors(entries: Iterable[LogEntry]) -> Iterator[TickVector]:
    """The ticks of a log, first what came before them; a repeated SYNC is none.

    Raises:
        HarnessError: ticks are answered late, so that what belongs to which is not known.
    """
    before, now = TickVector(BEFORE), TickVector(0)
    current = before
    for entry in entries:
        frame = entry.frame
        if frame.can_id in _FROM_FSW:
            _check_in_time(frame, current, entry)
            current.outgoing.append(frame)
        elif frame.can_id == Sync.ID and intact(frame):
            if Sync.decode(frame.data).tick != current.tick + 1:
                continue
            yield current
            now.tick = current.tick + 1
            now.incoming.append(frame)
            current, now = now, TickVector(0)
        elif frame.can_id != PlantEnd.ID:
            now.incoming.append(frame)
    yield current


def _check_in_time(frame: Frame, current: TickVector, entry: LogEntry) -> None:
    if frame.can_id != TickDone.ID or not intact(frame):
        return
    answered = TickDone.decode(frame.data).tick
    if answered != current.tick:
        raise HarnessError(
            f"line {entry.line}: tick {answered} is answered in tick {current.tick}: "
            "vectors are of a flight in lockstep"
        )


def write_vectors(source: Source, out: Path, force: bool) -> tuple[int, list[str]]:
    """Write the vectors of a run or of a log: the number of ticks, and notes.

    Args:
        source: the run or the log.
        out: ``.jsonl``, or ``.bin`` for the binary form.
        force: whether it may take the place of another file.

    Raises:
        HarnessError: the suffix is none of the two, the log is none of a flight in lockstep, or the file
            cannot be written.
    """
    writers = {".jsonl": _write_lines, ".bin": _write_binary}
    if out.suffix not in writers:
        raise HarnessError(f"--out {out}: its suffix must be .jsonl or .bin")
    entries = LogPass(source.log)
    with whole_file(out, force) as path:
        ticks = writers[out.suffix](path, tick_vectors(entries), source)
    return ticks, entries.notes


def _write_lines(path: Path, vectors: Iterator[TickVector], source: Source) -> int:
    ticks = 0
    about = {} if source.scenario is None or source.record is None else source.identity
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(json.dumps({"format": FORMAT, **about}) + "\n")
        for vector in vectors:
            texts = {"in": _texts(vector.incoming), "out": _texts(vector.outgoing)}
            file.write(json.dumps({"tick": vector.tick, **texts}) + "\n")
            ticks += vector.tick != BEFORE
    return ticks


def _write_binary(path: Path, vectors: Iterator[TickVector], source: Source) -> int:
    ticks = 0
    with path.open("wb") as file:
        file.write(MAGIC)
        for vector in vectors:
            frames = [(IN, frame) for frame in vector.incoming] + [(OUT, frame) for frame in vector.outgoing]
            for kind, frame in frames:
                file.write(RECORD.pack(kind, len(frame.data), frame.can_id, frame.data))
            counts = struct.pack("<iHH", vector.tick, len(vector.incoming), len(vector.outgoing))
            file.write(RECORD.pack(TICK, len(counts), 0, counts))
            ticks += vector.tick != BEFORE
    return ticks


def _texts(frames: list[Frame]) -> list[str]:
    return [frame_text(frame) for frame in frames]
