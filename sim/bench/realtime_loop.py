"""Paces a bench in real time, and measures how well everybody keeps to it."""

import gc
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, SENDERS, CoilStatus, MagField, PlantEnd, SunVector, TickDone, intact
from sim.bench.bus_load import frame_bits
from sim.bench.times import Times
from sim.bench.world import World
from sim.flight.flight import FrameLog
from sim.flight.second_senders import ALONE, SecondSender, SenderWatch

SAMPLES = {CoilStatus.ID: "coil", MagField.ID: "magnetometer", SunVector.ID: "sun"}
"""What each board sends exactly once a tick."""
LEAD = 0.3
"""Part of a tick before its end at which the world goes on without the coil board's word."""
MOST_A_TICK = 2000
"""Frames taken in a tick: one that babbles without end does not stop the bench."""
START_S = 0.2


@dataclass
class Measured:
    """What was measured, tick by tick.

    Args:
        ticks: SYNCs sent.
        jitter: how late each SYNC was.
        latency: from SYNC to the TICK_DONE that answers it, where it came before the next SYNC.
        slips: ticks without that.
        bits: on the bus, in all and in the busiest tick.
        busiest_bits: in the busiest tick.
        samples: of each board, ticks in which exactly one came.
        seen: messages by name.
        second_senders: who else sends in the place of plant or flight software.
    """

    ticks: int = 0
    jitter: Times = field(default_factory=Times)
    latency: Times = field(default_factory=Times)
    slips: int = 0
    bits: int = 0
    busiest_bits: int = 0
    samples: Counter[str] = field(default_factory=Counter)
    seen: Counter[str] = field(default_factory=Counter)
    second_senders: list[SecondSender] = field(default_factory=list)


class Conductor:
    """One run in real time, on absolute deadlines: nobody who is late is waited for.

    Args:
        bus: the plant's end of it.
        world: what is shown, and SYNC.
        log: takes every frame, each under its tick's time.
        epoch_unix_s: time of tick 0.
        tick_hz: ticks a second.
        watch: called in each tick.
    """

    def __init__(
        self,
        bus: Bus,
        world: World,
        log: FrameLog,
        epoch_unix_s: int,
        tick_hz: int,
        watch: Callable[[int], None] = lambda tick: None,
    ) -> None:
        self._bus = bus
        self._world = world
        self._log = log
        self._epoch_us = epoch_unix_s * 1_000_000
        self._tick_hz = tick_hz
        self._watch = watch
        self._heard: list[Frame] = []
        self._sent: list[Frame] = []
        self._senders = SenderWatch(lockstep=False, own=ALONE)
        self._answered = 0  # how many of them came up to TICK_DONE
        self.measured = Measured()

    def run(self, ticks: int, booted: Sequence[Frame] = ()) -> Measured:
        """``ticks`` ticks, and PLANT_END.

        Args:
            ticks: how many.
            booted: what was heard since FSW_BOOT, with it: all that the flight software hears before tick 0.

        Raises:
            BusError: the bus failed.
        """
        period_s = 1.0 / self._tick_hz
        gc.freeze()
        start_s = time.monotonic() + START_S
        self._heard += booted
        self._listen(-1, start_s, start_s)
        for tick in range(ticks):
            due_s = start_s + tick * period_s
            sent = self._world.frames()
            self._bus.send(sent)
            sent_s = time.monotonic()
            self.measured.jitter.add(sent_s - due_s)
            self._settle(tick, sent)
            self._listen(tick, due_s + period_s, sent_s)
        end = PlantEnd(ticks).encode()
        self._bus.send([end])
        self._settle(ticks, [end])
        return self.measured

    def _settle(self, tick: int, sent: list[Frame]) -> None:
        """What the tick before has left to do, once the SYNC of this one is sent: that is not late for it."""
        if tick:
            self._tally()
            self._senders.take(tick - 1, [], self._heard)
            self.measured.second_senders = self._senders.found
            self._watch(tick - 1)
        self._keep(tick, sent)
        self._sent = sent

    def _listen(self, tick: int, until_s: float, sent_s: float) -> None:
        """Until the next SYNC is due: answers are timed, and the world goes on when the board has spoken."""
        waits = tick >= 0
        early_s = until_s - LEAD / self._tick_hz
        while len(self._heard) < MOST_A_TICK:
            now_s = time.monotonic()
            if waits and now_s >= early_s:
                self._world.advance()
                waits = False
            if now_s >= until_s:
                break
            frame = self._bus.receive((early_s if waits else until_s) - now_s)
            if frame is None:
                continue
            self._heard.append(frame)
            if frame.can_id == TickDone.ID and TickDone.decode(frame.data).tick == tick:
                self.measured.latency.add(time.monotonic() - sent_s)
                self._answered = len(self._heard)
            elif self._world.hear(frame) and waits:
                self._world.advance()
                waits = False
        else:  # a babbler: what it still says waits in the bus
            time.sleep(max(0.0, until_s - time.monotonic()))
        if waits:
            self._world.advance()

    def _tally(self) -> None:
        measured, heard = self.measured, self._heard
        measured.ticks += 1
        measured.slips += not self._answered
        bits = sum(map(frame_bits, self._sent + heard))
        measured.bits += bits
        measured.busiest_bits = max(measured.busiest_bits, bits)
        count = Counter(frame.can_id for frame in heard if intact(frame))
        for can_id, number in count.items():
            measured.seen[NAMES[can_id]] += number
            if number == 1 and can_id in SAMPLES:
                measured.samples[SAMPLES[can_id]] += 1

    def _keep(self, tick: int, sent: list[Frame]) -> None:
        """Log what was heard since the last SYNC, then what is sent; an answer bears its tick's time."""
        heard, answered = self._heard, self._answered
        self._heard, self._answered = [], 0
        now_us = self._time_us(tick)
        if answered:
            self._log.write(self._time_us(tick - 1), heard[:answered])
            heard = heard[answered:]
        self._log.write(now_us, heard + sent)

    def _time_us(self, tick: int) -> int:
        return self._epoch_us + tick * 1_000_000 // self._tick_hz


def is_boot(frame: Frame, node: str) -> bool:
    """Whether it is the boot message of a node."""
    return NAMES.get(frame.can_id) == f"{node}_BOOT" and SENDERS[frame.can_id] == node and intact(frame)
