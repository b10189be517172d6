"""How the plant waits for the flight software: for its boot, for the answer to a tick, and not for ever."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import inf

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, SENDERS, FswBoot, PlantBoot, TickDone, intact
from sim.errors import FlightError

BOOT_REQUEST_S = 1.0
ANSWER_TIMEOUT_S = 20.0
REPEAT_SYNC_S = 2.0
"""In lockstep: silence after which SYNC is sent again; a flight software that doubts it believes it then."""
LATE_TIMEOUT_S = 5.0
"""After the last tick in real time: silence for so long, and no late answer is waited for any more."""

MOST_WAITING = 1024
"""Frames of strangers taken before a tick: one that babbles without end does not stop the plant."""

Overhear = Callable[[int, list[Frame], list[Frame], bool], object]
"""Called in each tick with what came before its SYNC and after it, and whether SYNC was sent again."""


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


def await_boot(bus: Bus, boot_s: float, overhear: Overhear, waiting: Callable[[float], None]) -> Frame:
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


def waiting_frames(bus: Bus) -> list[Frame]:
    """What strangers have sent since: the flight software has it before this tick, so the log has too."""
    frames: list[Frame] = []
    while len(frames) < MOST_WAITING and (frame := bus.receive(0.0)) is not None:
        frames.append(frame)
    return frames


def heard_until(bus: Bus, deadline: float) -> Iterator[Frame]:
    """All frames up to a deadline of the monotonic clock, and what is there already if that has passed."""
    late = 0
    while late < MOST_WAITING:
        left_s = max(0.0, deadline - time.monotonic())
        frame = bus.receive(left_s)
        if frame is None:
            return
        yield frame
        late += left_s == 0.0


def lockstep_answers(bus: Bus, tick: int, sync: Frame, answer_s: float) -> list[Frame]:
    """All frames up to the TICK_DONE that names ``tick``, with SYNC where it had to be sent again.

    What others say does not stretch the time for it.
    """
    answers: list[Frame] = []
    deadline = time.monotonic() + answer_s
    while True:
        for frame in heard_until(bus, min(deadline, time.monotonic() + REPEAT_SYNC_S)):
            answers.append(frame)
            if _names(frame, tick):
                return answers
        if time.monotonic() >= deadline:
            raise CounterpartError(
                f"no answer from the flight software to tick {tick} within {answer_s:.0f} s"
            )
        bus.send([sync])
        answers.append(sync)


def late_answers(bus: Bus, tick: int) -> list[Frame]:
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


class Silence:
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
