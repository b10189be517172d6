"""The bus log in the formats of Vector's tools, written by python-can."""

from pathlib import Path

import can

from fsw.bus.can_message import message_of
from sim.export.source import LogPass, Source
from sim.progress import Watch


def write_blf(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a binary log, its time stamps to the microsecond."""
    return _write(can.BLFWriter(path), source, watch)


def write_asc(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a text log; its time stamps count from the first frame, the date being in its head."""
    return _write(can.ASCWriter(path), source, watch)


def _write(writer: can.BLFWriter | can.ASCWriter, source: Source, watch: Watch) -> list[str]:
    log = LogPass(source.log)
    first_us: int | None = None
    with writer:
        for entry in log:
            if first_us is None:
                first_us = entry.timestamp_us
            writer.on_message_received(message_of(entry.frame, entry.timestamp_us / 1e6, entry.channel))
            watch(entry.timestamp_us - first_us)
    return log.notes
