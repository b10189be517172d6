"""The bus log in the formats of Vector's tools, written by python-can."""

from pathlib import Path

import can

from fsw.bus.can_message import message_of
from sim.console import counted
from sim.export.source import LogPass, Source
from sim.progress import Watch

MOST_CHANNELS = 2**16 - 1


def write_blf(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a binary log, its time stamps to the microsecond."""
    return _write(can.BLFWriter(path), source, watch)


def write_asc(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a text log; its time stamps count from the first frame, the date being in its head."""
    return _write(can.ASCWriter(path), source, watch)


def _write(writer: can.BLFWriter | can.ASCWriter, source: Source, watch: Watch) -> list[str]:
    """Both formats count time from the first frame: what is stamped earlier gets its time, and a note."""
    log = LogPass(source.log)
    first_us: int | None = None
    early = 0
    with writer:
        for entry in log:
            first_us = entry.timestamp_us if first_us is None else first_us
            early += entry.timestamp_us < first_us
            stamp_us = max(entry.timestamp_us, first_us)
            writer.on_message_received(message_of(entry.frame, stamp_us / 1e6, _channel(entry.channel)))
            watch(stamp_us - first_us)
    if early:
        log.notes.append(f"{counted(early, 'frame')} stamped earlier than the first, now with its time")
    return log.notes


def _channel(name: str) -> str | None:
    """The name of a bus, if it ends with a number that the formats hold, or with none."""
    number = can.util.channel2int(name)
    return name if number is None or number < MOST_CHANNELS else None
