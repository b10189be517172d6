"""How the plant waits for the flight software: for its boot and for the answer to a tick, with deadlines."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, SENDERS, FswBoot, PlantBoot, TickDone, intact
from sim.errors import FlightError
from sim.signals import EndedBySignal

BOOT_REQUEST_S = 0.25
"""Between two requests. One that comes soon after a boot has no answer: the next one must not take long."""
ANSWER_TIMEOUT_S = 20.0
REPEAT_SYNC_S = 2.0
"""In lockstep: silence after which SYNC is repeated; flight software that rejected the first accepts that."""
LATE_TIMEOUT_S = 5.0
"""In real time, after the last tick: silence after which the plant stops waiting for late answers."""

MOST_WAITING = 1024
"""Most frames taken before a tick, so that a babbling node cannot stop the plant."""

Overhear = Callable[[int, list[Frame], list[Frame], bool], object]
"""Called in each tick with the frames before its SYNC, those after it, and whether SYNC was repeated."""


MOST_UNHEARD = 64


class CounterpartError(FlightError):
    """The flight software is silent for too long, or another plant sends on the bus.

    Args:
        message: the sentence.
        tick: that has no answer; None: it is the boot that was awaited.
        unheard: what came instead, each frame once, at most ``MOST_UNHEARD``.
    """

    def __init__(self, message: str, tick: int | None = None, unheard: Sequence[Frame] = ()) -> None:
        super().__init__(message)
        self.tick = tick
        self.unheard = tuple(list(dict.fromkeys(unheard))[:MOST_UNHEARD])


@dataclass(frozen=True, slots=True)
class Patience:
    """How long to wait for the flight software [s].

    ``boot_s``: for its boot. ``answer_s``: in lockstep, for the answer to a tick. ``silence_s``: in real
    time, for any answer.
    """

    boot_s: float = inf
    answer_s: float = field(default_factory=lambda: ANSWER_TIMEOUT_S)
    silence_s: float = inf


def await_boot(
    bus: Bus, boot_s: float, overhear: Overhear | None, waiting: Callable[[float], None] | None
) -> Frame:
    """Wait for FSW_BOOT; PLANT_BOOT asks flight software that booted earlier to repeat it.

    Raises:
        CounterpartError: it did not come, or another plant sends. A signal's exception has it as its cause.
    """
    unheard: dict[Frame, None] = {}
    why = f"the flight software has not booted within {boot_s:.0f} s"
    began = time.monotonic()
    try:
        while (waited_s := time.monotonic() - began) < boot_s:
            if waiting is not None:
                waiting(waited_s)
            bus.send([PlantBoot(reason=0, version=1, table_crc=0).encode()])
            boot = _boot_until(bus, min(time.monotonic() + BOOT_REQUEST_S, began + boot_s), overhear, unheard)
            if boot is not None:
                return boot
    except EndedBySignal as error:
        # compiled code drops what stands after "from"
        error.__cause__ = CounterpartError(why, unheard=tuple(unheard))
        raise
    raise CounterpartError(why, unheard=tuple(unheard))


def _boot_until(
    bus: Bus, deadline: float, overhear: Overhear | None, unheard: dict[Frame, None]
) -> Frame | None:
    """The boot, if it comes before a deadline; what comes instead is noted."""
    while (remaining_s := deadline - time.monotonic()) > 0.0:
        frame = bus.receive(remaining_s)
        if frame is None:
            continue
        if not intact(frame):
            _note_unheard(unheard, frame)
        elif frame.can_id == FswBoot.ID:
            return frame
        elif SENDERS[frame.can_id] == "PLANT":
            if overhear is not None:
                overhear(0, [frame], [], False)
            raise CounterpartError(f"another plant sent {NAMES[frame.can_id]} before the flight began")
        else:
            _note_unheard(unheard, frame)
    return None


def _note_unheard(unheard: dict[Frame, None], frame: Frame) -> None:
    """Note a frame once, and no more of them than are shown, whatever a babbling node sends."""
    if len(unheard) < MOST_UNHEARD:
        unheard[frame] = None


def waiting_frames(bus: Bus) -> list[Frame]:
    """Frames received since the last tick; in the log, as for the flight software, they precede this tick."""
    frames: list[Frame] = []
    while len(frames) < MOST_WAITING and (frame := bus.receive(0.0)) is not None:
        frames.append(frame)
    return frames


def frames_until(bus: Bus, deadline: float, tick: int | None = None) -> list[Frame]:
    """All frames up to a deadline of the monotonic clock; those already received if it has passed.

    If ``tick`` is given, none after its TICK_DONE.
    """
    frames: list[Frame] = []
    _take_until(bus, deadline, tick, frames)
    return frames


def _take_until(bus: Bus, deadline: float, tick: int | None, frames: list[Frame]) -> None:
    """Append them as they come, so that they are there even if a signal ends the wait."""
    late = 0
    while late < MOST_WAITING:
        left_s = max(0.0, deadline - time.monotonic())
        frame = bus.receive(left_s)
        if frame is None:
            break
        frames.append(frame)
        if tick is not None and _is_answer(frame, tick):
            break
        if left_s == 0.0:
            late += 1


def lockstep_answers(bus: Bus, tick: int, sync: Frame, answer_s: float) -> list[Frame]:
    """All frames up to the TICK_DONE of ``tick``, among them each repeated SYNC.

    Frames of other nodes do not extend the deadline.

    Raises:
        CounterpartError: it did not come. A signal's exception has it as its cause.
    """
    answers: list[Frame] = []
    why = f"no answer from the flight software to tick {tick} within {answer_s:.0f} s"
    deadline = time.monotonic() + answer_s
    try:
        while True:
            _take_until(bus, min(deadline, time.monotonic() + REPEAT_SYNC_S), tick, answers)
            if answers and _is_answer(answers[-1], tick):
                return answers
            if time.monotonic() >= deadline:
                break
            bus.send([sync])
            answers.append(sync)
    except EndedBySignal as error:
        error.__cause__ = _unanswered(why, tick, sync, answers)
        raise
    raise _unanswered(why, tick, sync, answers)


def _unanswered(why: str, tick: int, sync: Frame, answers: list[Frame]) -> CounterpartError:
    return CounterpartError(why, tick, [frame for frame in answers if frame is not sync])


def late_answers(bus: Bus, tick: int) -> list[Frame]:
    """The late frames of flight software that has fallen behind, up to the TICK_DONE of ``tick``.

    Ends when no tick is answered for ``LATE_TIMEOUT_S``, whatever other nodes send.
    """
    answers: list[Frame] = []
    left_s, last_s = LATE_TIMEOUT_S, time.monotonic()
    while left_s > 0.0 and not has_answer(answers[-1:], tick) and (frame := bus.receive(left_s)) is not None:
        answers.append(frame)
        now = time.monotonic()
        if frame.can_id == TickDone.ID:
            last_s = now
        left_s = LATE_TIMEOUT_S - (now - last_s)
    return answers


class Silence:
    """In real time: the time for which the flight software has answered no tick.

    Time in which this process itself was stopped does not count.
    """

    def __init__(self, most_s: float, period_s: float, began: float) -> None:
        self._most_s = most_s
        self._longest_s = period_s + 1.0
        self._before = began
        self._silent_s = 0.0
        self._last_tick = -1

    def end(self, frames: list[Frame], tick: int) -> None:
        """Note the end of a tick, and the frames received in it.

        Raises:
            CounterpartError: too long without an answer, and over more than one tick.
        """
        now = time.monotonic()
        self._silent_s += min(now - self._before, self._longest_s)
        self._before = now
        if any(frame.can_id == TickDone.ID for frame in frames):
            self._silent_s, self._last_tick = 0.0, tick
        elif self._silent_s > self._most_s and tick > self._last_tick + 1:
            raise CounterpartError(
                f"no answer from the flight software since tick {max(self._last_tick, 0)} "
                f"for {self._most_s:.0f} s"
            )


def has_answer(frames: list[Frame], tick: int) -> bool:
    """Whether the TICK_DONE of ``tick`` is among the frames."""
    return any([_is_answer(frame, tick) for frame in frames])


def _is_answer(frame: Frame, tick: int) -> bool:
    return (
        frame.can_id == TickDone.ID
        and len(frame.data) == TickDone.LENGTH
        and TickDone.decode(frame.data).tick == tick
    )
