"""The flight software as a process of its own that is killed or stopped by signals, in the middle of pulses.

While it runs, the plant waits for its answers; while it does not, the plant keeps ticking. Signals come at
random moments of the wall clock within a tick.
"""

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random
from subprocess import Popen
from tempfile import TemporaryDirectory

from fsw.bus.hub import Hub
from fsw.bus.link import LoopLink
from fsw.wire.frame import Frame
from fsw.wire.messages import FswBoot, intact
from sim.errors import HarnessError
from sim.fault_rig.record import FaultFlightRecord
from sim.faults.faulty_plant import FaultyPlant
from sim.flight.fsw_answers import has_answer
from sim.flight.sil import start_node
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario
from sim.scenario.written import write_flight_table

ALONE_S = 0.01
"""Duration of a tick without an answer."""
ANSWER_S = 5.0
BOOT_S = 60.0
WITHIN_TICK_S = 0.003
"""Longest delay of a signal after SYNC; a step takes about a third of it."""
CYCLE_TICKS = 103
PATIENCE_TICKS = 40 * CYCLE_TICKS
"""In which a pulse begins, if the process fires at all."""
MOST_STOPPED_TICKS = 8


@dataclass(frozen=True, slots=True)
class Strike:
    """The time of a signal: ``ticks`` after the start of the next pulse, ``delay_s`` after the SYNC there."""

    ticks: int
    delay_s: float


class ProcessRig:
    """One flight with a real process.

    Args:
        scenario: of the flight.
        seed: of the plant.
        stop: SIGSTOP and SIGCONT in place of SIGKILL.
    """

    def __init__(self, scenario: Scenario, seed: int, stop: bool = False) -> None:
        self._scenario = scenario
        self._epoch_us = scenario.epoch_unix_s * 1_000_000
        self._stop = stop
        self._stopped_until = -1
        self._present = True
        self.plant = FaultyPlant(plant_config(scenario, seed))
        self.record = FaultFlightRecord(scenario.time.tick_hz)

    def fly(self, strikes: list[Strike]) -> FaultFlightRecord:
        """Fly until all signals were sent, and the last process has fired; or until one does not fire."""
        with self._bus():
            self._await_boot()
            for strike in strikes:
                if not self._until_pulse():
                    return self.record
                for _ in range(strike.ticks):
                    self._tick()
                self._tick(strike)
            if self._until_pulse():
                for _ in range(CYCLE_TICKS):
                    self._tick()
        return self.record

    @contextmanager
    def _bus(self) -> Iterator[None]:
        hub = Hub()
        hub.start()
        scratch = TemporaryDirectory()
        self._table = str(write_flight_table(Path(scratch.name), self._scenario))
        self._link = LoopLink(hub.port, may_host=False)
        self._spec = f"loop:{hub.port}"
        self._process = self._start()
        try:
            yield
        finally:
            self._process.kill()
            self._process.wait()
            self._link.close()
            hub.close()
            scratch.cleanup()

    def _start(self) -> Popen[bytes]:
        words = ("--table", self._table, "--bus", self._spec, "--parent", str(os.getpid()))
        return start_node("fsw", *words)

    def _await_boot(self) -> None:
        deadline = time.monotonic() + BOOT_S
        while time.monotonic() < deadline:
            frame = self._link.receive(1.0)
            if frame is not None and frame.can_id == FswBoot.ID and intact(frame):
                self.record.boots.append(0)
                return
        raise HarnessError("the flight software's process does not boot")

    def _until_pulse(self) -> bool:
        """Tick until a pulse begins; the next tick is its second. False, and noted: none does."""
        before = True
        for _ in range(PATIENCE_TICKS):
            self._tick()
            now = any(self.record.coil_drives[-1].current_a)
            if now and not before:
                return True
            before = now
        self.record.unfired_s = PATIENCE_TICKS / self.record.tick_hz
        return False

    def _tick(self, strike: Strike | None = None) -> None:
        plant, record = self.plant, self.record
        tick = plant.tick
        frames = plant.begin_tick()
        record.note_sent(tick, self._epoch_us, plant.sent)
        self._link.send(frames)
        if strike is not None:
            self._strike(strike, tick)
        elif 0 <= self._stopped_until <= tick:
            self._process.send_signal(signal.SIGCONT)
            self._stopped_until = -1
        answers = self._answers(tick)
        record.note_answer(tick, answers)
        record.boots += [tick for frame in answers if frame.can_id == FswBoot.ID and intact(frame)]
        for frame in answers:
            plant.receive(frame)
        record.modes.append(None)
        record.error_deg.append(None)
        record.lit.append(plant.truth().lit > 0.0)
        plant.end_tick()
        record.coil_drives.append(plant.coil_drive)

    def _strike(self, strike: Strike, tick: int) -> None:
        time.sleep(strike.delay_s)
        self._present = False
        if self._stop:
            self._process.send_signal(signal.SIGSTOP)
            self._stopped_until = tick + 1 + strike.ticks % MOST_STOPPED_TICKS
            return
        self._process.kill()
        self._process.wait()
        self._process = self._start()

    def _answers(self, tick: int) -> list[Frame]:
        """All frames until the answer to this tick is complete, or the time is over."""
        deadline = time.monotonic() + (ANSWER_S if self._present else ALONE_S)
        answers: list[Frame] = []
        while (frame := self._link.receive(max(0.0, deadline - time.monotonic()))) is not None:
            answers.append(frame)
            if has_answer([frame], tick):
                self._present = True
                return answers
        self._present = False
        return answers


def random_strikes(count: int, rng: Random) -> list[Strike]:
    """Random signals: half of them within the pulse, half anywhere in the cycle."""

    def ticks() -> int:
        return rng.randrange(3 if rng.random() < 0.5 else CYCLE_TICKS - 3)

    return [Strike(ticks(), rng.uniform(0.0, WITHIN_TICK_S)) for _ in range(count)]
