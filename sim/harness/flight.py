"""One flight: the plant's ticks exchanged with the flight software over a bus, recorded as they happen.

In lockstep the plant waits for the TICK_DONE that names its tick. In real time it keeps to absolute
deadlines; an answer that is not there by then is a counted slip, never a wait.
"""

import gc
import hashlib
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, SENDERS, FswBoot, PlantBoot, TickDone, intact
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
Overhear = Callable[[int, list[Frame], list[Frame], bool], object]
"""Called in each tick with what came before its SYNC and after it, and whether SYNC was sent again."""


class FlightError(HarnessError):
    """The flight ended before its time."""

    exit_code = 1


class CounterpartError(FlightError):
    """The flight software has said nothing for too long, or another plant speaks in this one's place."""


@dataclass(frozen=True, slots=True)
class Patience:
    """How long the flight software is waited for [s].

    ``boot_s``: until it boots. ``answer_s``: in lockstep for the answer to a tick. ``silence_s``: in real
    time, where no answer is waited for, for any at all.
    """

    boot_s: float = inf
    answer_s: float = field(default_factory=lambda: ANSWER_TIMEOUT_S)
    silence_s: float = inf


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
    patience: Patience | None = None,
    overhear: Overhear = lambda tick, before, answers, again: None,
    waiting: Callable[[float], None] = lambda waited_s: None,
) -> Flown:
    """Fly ``ticks`` ticks; what the ground sends in a tick goes before what the boards say.

    Args:
        plant: to be flown.
        bus: its end.
        log: takes every frame.
        truth: takes the plant's truth.
        ticks: how many.
        epoch_unix_s: time of tick 0.
        tick_hz: ticks a second.
        pace: lockstep or real time.
        watch: told the tick, now and then.
        uplink: what the ground sends in a tick.
        patience: how long the flight software is waited for; None: the default.
        overhear: told what others have sent.
        waiting: told every second how long the flight software has been waited for until it boots [s].

    Raises:
        CounterpartError: the flight software is silent, or another plant speaks.
        FlightError: the disk takes no more.
        BusError: the bus failed.
    """
    patience = patience or Patience()
    boot = _await_boot(bus, patience.boot_s, overhear, waiting)
    epoch_us = timestamp_us = epoch_unix_s * 1_000_000
    log.write(epoch_us, [boot])
    gc.freeze()  # what was loaded before the flight need not be searched for garbage during it
    began = time.monotonic()
    answers: list[Frame] = []
    period_s = 1.0 / (tick_hz * (pace.factor or inf))
    silence = _Silence(patience.silence_s, period_s, began)
    for tick in range(ticks):
        timestamp_us = epoch_us + tick * 1_000_000 // tick_hz
        sent = uplink(tick) + plant.begin_tick()
        known = answers + (before := _waiting(bus)) + sent
        bus.send(sent)
        if pace.factor is None:
            answers = _lockstep_answers(bus, tick, sent[-1], patience.answer_s)
        else:
            answers = list(_heard_until(bus, began + (tick + 1) * period_s))
            plant.slips += not answered(answers, tick)
            silence.end(before + answers, tick)
        from_others = [frame for frame in answers if frame is not sent[-1]]
        overhear(tick, before, from_others, len(from_others) < len(answers))
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


def _await_boot(bus: Bus, boot_s: float, overhear: Overhear, waiting: Callable[[float], None]) -> Frame:
    """FSW_BOOT. A flight software that started first and was not heard is asked to repeat it."""
    began = time.monotonic()
    while (waited_s := time.monotonic() - began) < boot_s:
        waiting(waited_s)
        bus.send([PlantBoot(reason=0, version=1, table_crc=0).encode()])
        deadline = min(time.monotonic() + BOOT_REQUEST_S, began + boot_s)
        while (remaining_s := deadline - time.monotonic()) > 0.0:
            frame = bus.receive(remaining_s)
            if frame is None or not intact(frame):
                continue
            if frame.can_id == FswBoot.ID:
                return frame
            if SENDERS[frame.can_id] == "PLANT":
                overhear(0, [frame], [], False)
                raise CounterpartError(f"another plant sent {NAMES[frame.can_id]} before the flight began")
    raise CounterpartError(f"the flight software has not booted within {boot_s:.0f} s")


def _waiting(bus: Bus) -> list[Frame]:
    """What strangers have sent since: the flight software has it before this tick, so the log has too."""
    frames: list[Frame] = []
    while len(frames) < MOST_WAITING and (frame := bus.receive(0.0)) is not None:
        frames.append(frame)
    return frames


def _heard_until(bus: Bus, deadline: float) -> Iterator[Frame]:
    """All frames up to a deadline of the monotonic clock, and what is there already if that has passed."""
    late = 0
    while late < MOST_WAITING:
        left_s = max(0.0, deadline - time.monotonic())
        frame = bus.receive(left_s)
        if frame is None:
            return
        yield frame
        late += left_s == 0.0


def _lockstep_answers(bus: Bus, tick: int, sync: Frame, answer_s: float) -> list[Frame]:
    """All frames up to the TICK_DONE that names ``tick``, with SYNC where it had to be sent again.

    What others say does not stretch the time for it.
    """
    answers: list[Frame] = []
    deadline = time.monotonic() + answer_s
    while True:
        for frame in _heard_until(bus, min(deadline, time.monotonic() + REPEAT_SYNC_S)):
            answers.append(frame)
            if _names(frame, tick):
                return answers
        if time.monotonic() >= deadline:
            raise CounterpartError(
                f"no answer from the flight software to tick {tick} within {answer_s:.0f} s"
            )
        bus.send([sync])
        answers.append(sync)


def _late_answers(bus: Bus, tick: int) -> list[Frame]:
    """What a flight software that has fallen behind still says, up to the TICK_DONE that names ``tick``.

    It is over when no tick is answered for ``LATE_TIMEOUT_S``, whatever others say.
    """
    answers: list[Frame] = []
    left_s, answered_s = LATE_TIMEOUT_S, time.monotonic()
    while left_s > 0.0 and not answered(answers[-1:], tick) and (frame := bus.receive(left_s)) is not None:
        answers.append(frame)
        now = time.monotonic()
        if frame.can_id == TickDone.ID:
            answered_s = now
        left_s = LATE_TIMEOUT_S - (now - answered_s)
    return answers


class _Silence:
    """In real time: how long the flight software has answered no tick.

    Time for which this process was stopped itself does not count.
    """

    def __init__(self, most_s: float, period_s: float, began: float) -> None:
        self._most_s = most_s
        self._longest_s = period_s + 1.0
        self._before = began
        self._silent_s = 0.0
        self._answered = -1

    def end(self, heard: list[Frame], tick: int) -> None:
        """A tick has ended, with what was heard in it.

        Raises:
            CounterpartError: too long without an answer, and over more than one tick.
        """
        now = time.monotonic()
        self._silent_s += min(now - self._before, self._longest_s)
        self._before = now
        if any(frame.can_id == TickDone.ID for frame in heard):
            self._silent_s, self._answered = 0.0, tick
        elif self._silent_s > self._most_s and tick > self._answered + 1:
            raise CounterpartError(
                f"no answer from the flight software since tick {max(self._answered, 0)} "
                f"for {self._most_s:.0f} s"
            )


def answered(frames: list[Frame], tick: int) -> bool:
    """Whether the TICK_DONE that names ``tick`` is among the frames."""
    return any(_names(frame, tick) for frame in frames)


def _names(frame: Frame, tick: int) -> bool:
    return (
        frame.can_id == TickDone.ID
        and len(frame.data) == TickDone.LENGTH
        and TickDone.decode(frame.data).tick == tick
    )
