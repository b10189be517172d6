"""Runs a bench in real time, and measures how well every node keeps pace."""

import gc
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from math import ceil, log, log1p

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    NAMES,
    SENDERS,
    CoilStatus,
    MagField,
    PlantEnd,
    SunCells,
    SunVector,
    TickDone,
    intact,
)
from sim.bench.bus_load import frame_bits
from sim.bench.tick_source import TickSource
from sim.flight.flight_loop import FrameLog
from sim.flight.second_senders import ALONE, SecondSenderFrames, SenderWatch
from sim.scenario.telecommands import Uplink

# --- A histogram of times: however long a bench runs, it takes no more memory

LEAST_S = 1e-6
STEP = 0.01
"""Relative width of a class."""


class TimeHistogram:
    """Counts times above 0 in classes; quantiles are true to 1 %, rounded up, and the longest is exact."""

    def __init__(self, seconds: Iterable[float] = ()) -> None:
        self._counts: Counter[int] = Counter()
        self._number = 0
        self._longest_s = 0.0
        for time_s in seconds:
            self.add(time_s)

    def add(self, seconds: float) -> None:
        """Count one time."""
        self._counts[_class(seconds)] += 1
        self._number += 1
        self._longest_s = max(self._longest_s, seconds)

    def quantile(self, fraction: float) -> float:
        """The time that no more than a ``fraction`` of all stay below; infinite where none was counted."""
        passed = min(self._number - 1, int(fraction * self._number))
        for number in sorted(self._counts):
            passed -= self._counts[number]
            if passed < 0:
                return min(LEAST_S * (1.0 + STEP) ** number, self._longest_s)
        return float("inf")


def _class(seconds: float) -> int:
    """The class of a time: the k with LEAST_S (1 + STEP)^(k - 1) < t <= LEAST_S (1 + STEP)^k, at least 0."""
    return ceil(log(seconds / LEAST_S) / log1p(STEP)) if seconds > LEAST_S else 0


# --- The loop

SAMPLES = {CoilStatus.ID: "coil", MagField.ID: "magnetometer", SunVector.ID: "sun", SunCells.ID: "cells"}
"""The message that each board sends exactly once a tick."""
LEAD = 0.3
"""Fraction of a tick before its end at which the source advances without the coil board's status."""
MAX_FRAMES = 2000
"""Frames received in a tick: a babbling node does not stop the bench."""
MAX_LATE_FRAMES = 50
"""Of these, frames received after the next SYNC is due: they were on the bus before it."""
START_S = 0.2


@dataclass
class BenchMeasurements:
    """What was measured, tick by tick.

    Args:
        ticks: SYNCs sent.
        jitter: how late each SYNC was.
        latency: from SYNC to the TICK_DONE that answers it, where it came before the next SYNC.
        slips: ticks without that.
        bits: on the bus, in all.
        busiest_bits: in the busiest tick.
        samples: of each board, ticks in which exactly one came.
        messages: intact messages by name.
        second_senders: other nodes that send under identifiers of plant or flight software.
    """

    ticks: int = 0
    jitter: TimeHistogram = field(default_factory=TimeHistogram)
    latency: TimeHistogram = field(default_factory=TimeHistogram)
    slips: int = 0
    bits: int = 0
    busiest_bits: int = 0
    samples: Counter[str] = field(default_factory=Counter)
    messages: Counter[str] = field(default_factory=Counter)
    second_senders: list[SecondSenderFrames] = field(default_factory=list)


class RealtimeLoop:
    """One run in real time, on absolute deadlines: no late node is waited for.

    Args:
        bus: the plant's end of it.
        source: of the frames of each tick.
        log: of all frames, each under its tick's time.
        epoch_unix_s: time of tick 0.
        tick_hz: ticks a second.
        watch: called in each tick.
        uplink: the telecommands of a tick.
    """

    def __init__(
        self,
        bus: Bus,
        source: TickSource,
        log: FrameLog,
        epoch_unix_s: int,
        tick_hz: int,
        watch: Callable[[int], None] = lambda tick: None,
        uplink: Uplink = lambda tick: [],
    ) -> None:
        self._bus = bus
        self._source = source
        self._log = log
        self._epoch_us = epoch_unix_s * 1_000_000
        self._tick_hz = tick_hz
        self._watch = watch
        self._uplink = uplink
        self._received: list[Frame] = []
        self._sent: list[Frame] = []
        self._senders = SenderWatch(lockstep=False, own=ALONE)
        self._answered = 0  # how many of the received frames came up to TICK_DONE
        self.measured = BenchMeasurements()

    def run(self, ticks: int, boot_frames: Sequence[Frame] = ()) -> BenchMeasurements:
        """``ticks`` ticks, and PLANT_END.

        Args:
            ticks: how many.
            boot_frames: the frames from FSW_BOOT on: all that the flight software receives before tick 0.

        Raises:
            BusError: the bus failed.
        """
        period_s = 1.0 / self._tick_hz
        gc.freeze()
        start_s = time.monotonic() + START_S
        self._received += boot_frames
        self._listen(-1, start_s, start_s)
        sent_s = start_s
        for tick in range(ticks):
            due_s = start_s + tick * period_s
            sent = self._uplink(tick) + self._source.frames()
            self._take_waiting(tick - 1, sent_s)
            self._bus.send(sent)
            sent_s = time.monotonic()
            self.measured.jitter.add(sent_s - due_s)
            self._settle(tick, sent)
            self._listen(tick, due_s + period_s, sent_s)
        end = PlantEnd(ticks).encode()
        self._take_waiting(ticks - 1, sent_s)
        self._bus.send([end])
        self._settle(ticks, [end])
        return self.measured

    def _settle(self, tick: int, sent: list[Frame]) -> None:
        """Finish the tick before, after the SYNC of this one is sent, so that this does not delay it."""
        if tick:
            self._tally()
            self._senders.take(tick - 1, [], self._received)
            self.measured.second_senders = self._senders.found
            self._watch(tick - 1)
        self._write_log(tick, sent)
        self._sent = sent

    def _listen(self, tick: int, until_s: float, sent_s: float) -> None:
        """Receive until the next SYNC is due: time the answer, advance on the coil board's status."""
        waits = tick >= 0
        early_s = until_s - LEAD / self._tick_hz
        while len(self._received) < MAX_FRAMES:
            now_s = time.monotonic()
            if waits and now_s >= early_s:
                self._source.advance()
                waits = False
            if now_s >= until_s:
                break
            frame = self._bus.receive((early_s if waits else until_s) - now_s)
            if frame is not None and self._take(frame, tick, sent_s) and waits:
                self._source.advance()
                waits = False
        else:  # a babbling node: the rest of its frames waits on the bus
            time.sleep(max(0.0, until_s - time.monotonic()))
        if waits:
            self._source.advance()

    def _take(self, frame: Frame, tick: int, sent_s: float) -> bool:
        """Take a frame of this tick: whether it is the coil board's status."""
        self._received.append(frame)
        if _answers(frame, tick):
            self.measured.latency.add(time.monotonic() - sent_s)
            self._answered = len(self._received)
            return False
        return self._source.receive(frame)

    def _take_waiting(self, tick: int, sent_s: float) -> None:
        """Take what came while this process was held up: it was on the bus before the SYNC that is sent next.

        In a log that has it behind that SYNC, it would be of the next tick.
        """
        for _ in range(MAX_LATE_FRAMES):
            frame = self._bus.receive(0.0)
            if frame is None:
                return
            self._take(frame, tick, sent_s)

    def _tally(self) -> None:
        measured, received = self.measured, self._received
        measured.ticks += 1
        measured.slips += not self._answered
        bits = sum(map(frame_bits, self._sent + received))
        measured.bits += bits
        measured.busiest_bits = max(measured.busiest_bits, bits)
        count = Counter(frame.can_id for frame in received if intact(frame))
        for can_id, number in count.items():
            measured.messages[NAMES[can_id]] += number
            if number == 1 and can_id in SAMPLES:
                measured.samples[SAMPLES[can_id]] += 1

    def _write_log(self, tick: int, sent: list[Frame]) -> None:
        """Log the frames since the last SYNC, then those sent; an answer is logged under its tick's time."""
        received, answered = self._received, self._answered
        self._received, self._answered = [], 0
        now_us = self._time_us(tick)
        if answered:
            self._log.write(self._time_us(tick - 1), received[:answered])
            received = received[answered:]
        self._log.write(now_us, received + sent)

    def _time_us(self, tick: int) -> int:
        return self._epoch_us + tick * 1_000_000 // self._tick_hz


def _answers(frame: Frame, tick: int) -> bool:
    """Whether it is the answer of the flight software to the SYNC of a tick; a broken frame is none."""
    return frame.can_id == TickDone.ID and intact(frame) and TickDone.decode(frame.data).tick == tick


def is_boot(frame: Frame, node: str) -> bool:
    """Whether it is the boot message of a node."""
    return NAMES.get(frame.can_id) == f"{node}_BOOT" and SENDERS[frame.can_id] == node and intact(frame)
