"""One flight: the plant's ticks exchanged with the flight software over a bus, recorded as they happen.

In lockstep the plant waits for the TICK_DONE that names its tick. In real time it keeps to absolute
deadlines; an answer that is not there by then is a counted slip, never a wait.
"""

import gc
import hashlib
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

from fsw.io.bus import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import FswBoot, PlantBoot, TickDone, intact
from sim.harness.candump import format_line, format_time
from sim.harness.errors import HarnessError
from sim.harness.heard import heard_before_sync
from sim.harness.log_index import LogIndex
from sim.harness.telecommands import Uplink
from sim.plant.plant import Plant, TruthRow

BOOT_REQUEST_S = 1.0
ANSWER_TIMEOUT_S = 20.0
REPEAT_SYNC_S = 2.0
"""In lockstep: silence after which SYNC is sent again; a flight software that doubts it believes it then."""
LATE_TIMEOUT_S = 5.0
"""After the last tick in real time: silence for so long, and no late answer is waited for any more."""

Watch = Callable[[int], None]
"""Called now and then with the tick that is under way."""


class FlightError(HarnessError):
    """The flight ended before its time."""

    exit_code = 1


@dataclass(frozen=True, slots=True)
class Pace:
    """``factor`` None: lockstep, as fast as it goes; else real time times the factor."""

    factor: float | None = None


LOCKSTEP = Pace()


@dataclass(frozen=True, slots=True)
class Flown:
    """What became of a flight."""

    ticks: int
    slips: int
    wall_s: float


class FrameLog(Protocol):
    """Takes the frames of a flight."""

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Append frames that all bear one time."""


class TruthLog(Protocol):
    """Takes the plant's truth."""

    def append(self, row: TruthRow) -> None:
        """Add the row of the next tick."""

    def flush(self) -> None:
        """No row follows."""


class BusLog:
    """bus.log and its index, written a whole tick at a time: a kill leaves whole ticks.

    Raises:
        FlightError: the disk takes no more. What was written is kept, up to its last whole tick.
    """

    def __init__(self, path: Path, channel: str) -> None:
        self._path = path
        self._channel = channel
        self._size = 0
        self._sha256 = hashlib.sha256()
        try:
            self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
            self._index = LogIndex(path)
        except OSError as error:
            raise FlightError(f"{path}: cannot be written: {error.strerror}") from None

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Append frames that all bear one time."""
        stamp = format_time(timestamp_us)
        channel = self._channel
        text = "".join([format_line(stamp, channel, frame) for frame in frames]).encode("ascii")
        rest = text
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
            self._index.add(text, len(frames))
        except OSError as error:
            if rest:
                os.ftruncate(self._descriptor, self._size)
            raise FlightError(
                f"{self._path}: cannot be written at {stamp}: {error.strerror}; "
                "what was flown until then is kept"
            ) from None
        self._size += len(text)
        self._sha256.update(text)

    @property
    def sha256(self) -> str:
        """Of all that was written, in hex."""
        return self._sha256.hexdigest()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._descriptor)
        try:
            self._index.close(ended=error is None)
        except OSError as fault:
            if error is None:
                raise FlightError(f"{self._path}: its index cannot be written: {fault.strerror}") from None


def fly(
    plant: Plant,
    bus: Bus,
    log: FrameLog,
    truth: TruthLog,
    ticks: int,
    epoch_unix_s: int,
    tick_hz: int,
    pace: Pace = LOCKSTEP,
    watch: Watch = lambda tick: None,
    uplink: Uplink = lambda tick: [],
) -> Flown:
    """Fly ``ticks`` ticks; what the ground sends in a tick goes before what the boards say.

    Raises:
        FlightError: the flight software gives no answer (lockstep).
        BusError: the bus failed.
    """
    boot = _await_boot(bus)
    epoch_us = timestamp_us = epoch_unix_s * 1_000_000
    log.write(epoch_us, [boot])
    gc.freeze()  # what was loaded before the flight need not be searched for garbage during it
    began = time.monotonic()
    answers: list[Frame] = []
    for tick in range(ticks):
        timestamp_us = epoch_us + tick * 1_000_000 // tick_hz
        sent = uplink(tick) + plant.begin_tick()
        known = answers + (before := _waiting(bus)) + sent
        bus.send(sent)
        if pace.factor is None:
            answers = _lockstep_answers(bus, tick, sent[-1])
        else:
            answers = _answers_until(bus, began + (tick + 1) / (tick_hz * pace.factor))
            plant.slips += not answered(answers, tick)
        heard, answers = heard_before_sync(known, answers, tick)
        before += heard
        for frame in before + answers:
            plant.receive(frame)
        log.write(timestamp_us, before + sent + answers)
        truth.append(plant.truth())
        plant.end_tick()
        if tick % WATCH_TICKS == 0:
            watch(tick)
    if not answered(answers, ticks - 1):
        log.write(timestamp_us, _late_answers(bus, ticks - 1))
    end = plant.end()
    bus.send([end])
    log.write(epoch_us + ticks * 1_000_000 // tick_hz, [end])
    truth.flush()
    return Flown(ticks, plant.slips, time.monotonic() - began)


WATCH_TICKS = 64
MOST_WAITING = 1024
"""Frames of strangers taken before a tick: one that babbles without end does not stop the plant."""


def _await_boot(bus: Bus) -> Frame:
    """FSW_BOOT. A flight software that started first and was not heard is asked to repeat it."""
    while True:
        bus.send([PlantBoot(reason=0, version=1, table_crc=0).encode()])
        deadline = time.monotonic() + BOOT_REQUEST_S
        while (remaining_s := deadline - time.monotonic()) > 0.0:
            frame = bus.receive(remaining_s)
            if frame is not None and frame.can_id == FswBoot.ID and intact(frame):
                return frame


def _waiting(bus: Bus) -> list[Frame]:
    """What strangers have sent since: the flight software has it before this tick, so the log has too."""
    frames: list[Frame] = []
    while len(frames) < MOST_WAITING and (frame := bus.receive(0.0)) is not None:
        frames.append(frame)
    return frames


def _lockstep_answers(bus: Bus, tick: int, sync: Frame) -> list[Frame]:
    """All frames up to the TICK_DONE that names ``tick``, with SYNC where it had to be sent again."""
    answers: list[Frame] = []
    timeout_s = min(REPEAT_SYNC_S, ANSWER_TIMEOUT_S)
    silent_s = 0.0
    while True:
        frame = bus.receive(timeout_s)
        if frame is None:
            silent_s += timeout_s
            if silent_s >= ANSWER_TIMEOUT_S:
                raise FlightError(
                    f"no answer from the flight software to tick {tick} within {ANSWER_TIMEOUT_S:.0f} s"
                )
            bus.send([sync])
            frame = sync
        else:
            silent_s = 0.0
        answers.append(frame)
        if _names(frame, tick):
            return answers


def _answers_until(bus: Bus, deadline: float) -> list[Frame]:
    """All frames up to a deadline of the monotonic clock, and what is there already if that has passed."""
    answers: list[Frame] = []
    while (frame := bus.receive(max(0.0, deadline - time.monotonic()))) is not None:
        answers.append(frame)
    return answers


def _late_answers(bus: Bus, tick: int) -> list[Frame]:
    """What a flight software that has fallen behind still says, up to the TICK_DONE that names ``tick``."""
    answers: list[Frame] = []
    while not answered(answers[-1:], tick) and (frame := bus.receive(LATE_TIMEOUT_S)) is not None:
        answers.append(frame)
    return answers


def answered(frames: list[Frame], tick: int) -> bool:
    """Whether the TICK_DONE that names ``tick`` is among the frames."""
    return any(_names(frame, tick) for frame in frames)


def _names(frame: Frame, tick: int) -> bool:
    return (
        frame.can_id == TickDone.ID
        and len(frame.data) == TickDone.LENGTH
        and TickDone.decode(frame.data).tick == tick
    )
