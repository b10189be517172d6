"""Plant, boards and flight software in one process, and faults between them. The plant never stops."""

import time
from fractions import Fraction

from fsw.core.config import FlightConfig
from fsw.core.gate.sync_watch import near
from fsw.node import FlightNode
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, Sync, TickDone, intact
from hil_stub.bench import DEADMAN_MS, Bench, CoilBoard
from hil_stub.coils.coil_driver import Pin
from sim.fault_rig.currents import CurrentPulse
from sim.fault_rig.record import FaultFlightRecord
from sim.faults.fault import Condition, Fault
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.plant.coil_drive import OFF, CoilDrive
from sim.plant.config import PlantConfig
from sim.plant.hardware.actuators import Actuator
from sim.plant.sensor_config import SunCellsConfig
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario

MOST_WAITING = 4096
"""Frames that wait for a stopped process; the size of a socket's buffer."""


class Rig:
    """One flight with faults.

    Args:
        scenario: of the flight.
        config: its onboard table.
        seed: of the plant's random streams.
    """

    def __init__(self, scenario: Scenario, config: FlightConfig, seed: int) -> None:
        self._config = config
        self._epoch_us = scenario.epoch_unix_s * 1_000_000
        self._node: FlightNode | None = None
        self._backlog: list[Frame] = []
        self._condition = Condition.DEAD
        flown = plant_config(scenario, seed)
        self.plant = FaultyPlant(flown)
        cells = flown.sun_sensor.cells if isinstance(flown.sun_sensor, SunCellsConfig) else ()
        normals_body = tuple([cell.normal_body for cell in cells])
        self.record = FaultFlightRecord(scenario.time.tick_hz, normals_body)

    def inject(self, fault: Fault, first: int, end: int | None) -> None:
        """Schedule a fault, for the next tick at the earliest."""
        self.plant.inject(ScheduledFault(fault, first, end))
        record = self.record
        if record.onset is None:
            record.onset, record.end = first, end
        else:
            record.onset = min(record.onset, first)
            record.end = None if end is None or record.end is None else max(record.end, end)

    def tick(self) -> None:
        """Fly one tick."""
        plant, record = self.plant, self.record
        tick = plant.tick
        *frames, sync = plant.begin_tick()
        syncs = [sync]
        for fault in plant.active:
            syncs = [frame for one in syncs for frame in fault.sync(tick, one)]
        frames += syncs
        record.note_sent(tick, self._epoch_us, plant.sent)
        self._set_condition(self._due_condition(tick), tick)
        self.pace(tick, syncs)
        answers = self._answers(tick, frames)
        record.note_answer(tick, answers)
        for frame in answers:
            plant.receive(frame)
        record.note_state(tick, self._node.state if self._node is not None else None, plant.truth())
        plant.end_tick()
        record.coil_drives.append(plant.coil_drive)

    def pace(self, tick: int, syncs: list[Frame]) -> None:
        """Let true time pass until fsw answers; in this rig time is counted in ticks."""

    def finish(self) -> FaultFlightRecord:
        """The record, its counts complete."""
        if self._node is not None:
            self.record.rejected = self._node.state.gate.rejected
        return self.record

    def _due_condition(self, tick: int) -> Condition:
        conditions = [fault.condition(tick) for fault in self.plant.active]
        for worst in (Condition.DEAD, Condition.STOPPED):
            if worst in conditions:
                return worst
        return Condition.RUNNING

    def _set_condition(self, condition: Condition, tick: int) -> None:
        """Bring the process into a condition."""
        if condition is Condition.DEAD:
            self._node = None
            self._backlog.clear()
        elif self._node is None:
            self._node = FlightNode(self._config)
            self.plant.receive(self._node.start())
            self.record.boots.append(tick)
        self._condition = condition

    def _answers(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """The answers of fsw to its frames; an exception ends it and is noted."""
        node, record = self._node, self.record
        if node is None:
            return []
        self._backlog = (self._backlog + frames)[:MOST_WAITING]
        if self._condition is Condition.STOPPED:
            return []
        waiting, self._backlog = self._backlog, []
        leap = self._config.leap_ticks
        for fault in self.plant.active:
            node.state = fault.upset(node.state)
        answers: list[Frame] = []
        began = time.perf_counter()
        try:
            for frame in waiting:
                before = node.state.tick
                answer = node.receive(frame)
                if _needs_answer(frame, before, leap) and not _answers_tick(
                    answer, Sync.decode(frame.data).tick
                ):
                    record.unanswered.append(tick)
                if node.state.tick != before >= 0 and not near(before, node.state.tick, leap):
                    record.restarts.append(tick)
                    record.requests_before.append(len(record.request_ticks) + _requests(answers))
                answers += answer
                if node.ended and record.ended is None:
                    record.ended = tick
        except Exception as error:  # any exception is a finding, for the check "no exception"
            record.crash = f"tick {tick}: {type(error).__name__}: {error}"
            self._node = None
        record.worst_step_s = max(record.worst_step_s, time.perf_counter() - began)
        return answers


def _requests(frames: list[Frame]) -> int:
    return sum(frame.can_id == CoilFire.ID for frame in frames)


def _needs_answer(frame: Frame, before: int, leap_ticks: int) -> bool:
    """Whether a frame is a SYNC that moves time forward by a plausible number of ticks."""
    if frame.can_id != Sync.ID or not intact(frame):
        return False
    tick = Sync.decode(frame.data).tick
    return before < 0 or near(before, tick, leap_ticks)


def _answers_tick(answer: tuple[Frame, ...], tick: int) -> bool:
    """Whether the answer ends with the TICK_DONE of that tick."""
    last = answer[-1] if answer else None
    return last is not None and last.can_id == TickDone.ID and TickDone.decode(last.data).tick == tick


# --- The rig with a coil board on a bench: its clock keeps true time, from which ticks may deviate

REPEATED_EVERY_MS = 500


class BenchActuator(Actuator):
    """A coil driver on a bench in place of the plant's own, with nominal currents.

    Args:
        config: the plant's.
    """

    def __init__(self, config: PlantConfig) -> None:
        coils, limits = config.coils, config.limits
        low_a, middle_a, high_a = (dipole / coils.dipole_per_ampere_am2 for dipole in coils.levels_am2)
        self._level_a = (0.0, low_a, middle_a, high_a)
        self._period_ms = Fraction(1000, config.tick_hz)
        self._bench = Bench(lambda: CoilBoard(limits, (low_a, middle_a, high_a)), DEADMAN_MS, has_clock=True)
        self._outbox = self._bench.switch_on()
        self._pin: Pin | None = None
        self._drive = OFF
        self._on_ms = self.now_ms = 0
        self.pulses: list[CurrentPulse] = []
        """Completed pulses, over true time."""

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """The frames of the bench since the last tick; it enters ticks and reads its current by itself."""
        sent, self._outbox = self._outbox, []
        return sent

    def receive(self, frame: Frame) -> None:
        """Take a frame of the bus at this instant."""
        if frame.can_id == TickDone.ID:
            self._drive = self._over_the_tick()
        self._outbox += self._bench.receive(frame, self.now_ms)
        self._note(self.now_ms)

    def wait(self, milliseconds: int) -> None:
        """Let true time pass, and note when the timer switches the pin off."""
        end_ms = self.now_ms + milliseconds
        while self.now_ms < end_ms:
            due_ms = self._bench.due_ms()
            self.now_ms = end_ms if due_ms is None else min(end_ms, max(due_ms, self.now_ms + 1))
            self._bench.watch(self.now_ms)
            self._note(self.now_ms)

    def drive(self) -> CoilDrive:
        """The currents over the tick that fsw has answered."""
        drive, self._drive = self._drive, OFF
        return drive

    def _over_the_tick(self) -> CoilDrive:
        pin = self._bench.pin
        if pin is None:
            return OFF
        current_a = self._level_a[abs(pin.level)] * (1 if pin.level > 0 else -1)
        x, y, z = (current_a if coil == pin.coil else 0.0 for coil in range(3))
        left_ms = self._period_ms if pin.until_ms is None else pin.until_ms - self.now_ms
        return CoilDrive((x, y, z), float(min(Fraction(1), left_ms / self._period_ms)))

    def _note(self, at_ms: int) -> None:
        pin = self._bench.pin
        if pin == self._pin:
            return
        if self._pin is not None:
            self.pulses.append(
                CurrentPulse(self._pin.coil, Fraction(self._on_ms, 1000), Fraction(at_ms, 1000))
            )
        self._pin, self._on_ms = pin, at_ms


class ClockRig(Rig):
    """A flight in which a fault determines the duration of each tick."""

    def __init__(self, scenario: Scenario, config: FlightConfig, seed: int) -> None:
        super().__init__(scenario, config, seed)
        config_of_plant = plant_config(scenario, seed)
        self._actuator = BenchActuator(config_of_plant)
        self._period_ms = 1000 // config_of_plant.tick_hz
        self.plant = FaultyPlant(config_of_plant, actuator=self._actuator)
        self.record.pulses_by_time = self._actuator.pulses

    def pace(self, tick: int, syncs: list[Frame]) -> None:
        """Hand SYNC to the board, and let time pass until fsw answers; repeat SYNC if the fault does."""
        board = self._actuator
        board.wait(self._period_ms if not self.plant.active else 0)
        for sync in syncs:
            board.receive(sync)
        for fault in self.plant.active:
            held_ms = fault.held_ms(tick)
            while held_ms > 0:
                board.wait(min(held_ms, REPEATED_EVERY_MS))
                held_ms -= REPEATED_EVERY_MS
                if fault.repeats_sync:
                    board.receive(syncs[0])
