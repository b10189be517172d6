"""The loop of a flight: the plant exchanges its ticks with the flight software over a bus and records them.

In lockstep the plant waits for the TICK_DONE that names its tick. In real time it keeps to absolute
deadlines; an answer that is not there by then counts as a slip and is not waited for.
"""

import gc
import time
from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Protocol

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from sim.flight.fsw_answers import (
    Overhear,
    Patience,
    Silence,
    await_boot,
    frames_until,
    has_answer,
    late_answers,
    lockstep_answers,
    waiting_frames,
)
from sim.plant.plant import Plant
from sim.plant.truth_row import TruthRow
from sim.record.inbox_order import has_from_ground, split_at_sync
from sim.record.pace import LOCKSTEP, Pace

ProgressCallback = Callable[[int], None]
"""Called every ``WATCH_TICKS`` ticks with the current tick."""


@dataclass(frozen=True, slots=True)
class FlightOutcome:
    """The outcome of a completed flight."""

    ticks: int
    slips: int
    wall_s: float


class FrameLog(Protocol):
    """A sink for the frames of a flight."""

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Append frames that share one time stamp."""


class TruthLog(Protocol):
    """A sink for the plant's truth."""

    def append(self, row: TruthRow) -> None:
        """Add the row of the next tick."""

    def flush(self) -> None:
        """No row follows."""


def fly(
    plant: Plant,
    bus: Bus,
    log: FrameLog,
    truth: TruthLog,
    ticks: int,
    epoch_unix_s: int,
    tick_hz: int,
    pace: Pace = LOCKSTEP,
    watch: ProgressCallback | None = None,
    uplink: Callable[[int], list[Frame]] | None = None,
    patience: Patience | None = None,
    overhear: Overhear | None = None,
    waiting: Callable[[float], None] | None = None,
) -> FlightOutcome:
    """Fly ``ticks`` ticks; in each, telecommands go before the frames of the boards.

    Args:
        plant: the plant.
        bus: the plant's end of the bus.
        log: sink of every frame.
        truth: sink of the plant's truth.
        ticks: how many.
        epoch_unix_s: time of tick 0.
        tick_hz: ticks a second.
        pace: lockstep or real time.
        watch: called with the tick every ``WATCH_TICKS`` ticks.
        uplink: the telecommands of a tick.
        patience: how long to wait for the flight software; None: the default.
        overhear: called in each tick with the frames of other nodes; None: there are none.
        waiting: called at each request until the flight software boots, with the time waited [s].

    Raises:
        CounterpartError: the flight software is silent, or another plant sends.
        FlightError: the disk is full.
        BusError: the bus failed.
    """
    patience = patience or Patience()
    boot = await_boot(bus, patience.boot_s, overhear, waiting)
    epoch_us = timestamp_us = epoch_unix_s * 1_000_000
    log.write(epoch_us, [boot])
    gc.freeze()  # so that collections during the flight do not scan what was loaded before
    began = time.monotonic()
    answers: list[Frame] = []
    period_s = 1.0 / (tick_hz * (pace.factor or inf))
    silence = Silence(patience.silence_s, period_s, began)
    for tick in range(ticks):
        timestamp_us = epoch_us + tick * 1_000_000 // tick_hz
        sent = plant.begin_tick() if uplink is None else uplink(tick) + plant.begin_tick()
        late, before, sync = answers, waiting_frames(bus), sent[-1]
        bus.send(sent)
        if pace.factor is None:
            answers = lockstep_answers(bus, tick, sync, patience.answer_s)
        else:
            answers = frames_until(bus, began + (tick + 1) * period_s)
            plant.slips += not has_answer(answers, tick)
            silence.end(before + answers, tick)
        if overhear is not None:
            from_others = [frame for frame in answers if frame is not sync]
            overhear(tick, before, from_others, len(from_others) < len(answers))
        if has_from_ground(answers):
            received, answers = split_at_sync(late + before + sent, answers, tick)
            before += received
        for frame in before:
            plant.receive(frame)
        for frame in answers:
            plant.receive(frame)
        log.write(timestamp_us, before + sent + answers)
        truth.append(plant.truth())
        plant.end_tick()
        if watch is not None and tick % WATCH_TICKS == 0:
            watch(tick)
    if not has_answer(answers, ticks - 1):
        log.write(timestamp_us, late_answers(bus, ticks - 1))
    end = plant.end()
    bus.send([end])
    log.write(epoch_us + ticks * 1_000_000 // tick_hz, [end])
    truth.flush()
    return FlightOutcome(ticks, plant.slips, time.monotonic() - began)


WATCH_TICKS = 64
