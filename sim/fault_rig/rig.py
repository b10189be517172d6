"""Plant, boards and flight software in one process, and faults between them. The plant never stops."""

import time

from fsw.core.config import FlightConfig
from fsw.core.gate.sync_watch import near
from fsw.node import FlightNode
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, Sync, TickDone, intact
from sim.fault_rig.record import FaultFlightRecord
from sim.faults.fault import Condition, Fault
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
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
        self.plant = FaultyPlant(plant_config(scenario, seed))
        self.record = FaultFlightRecord(scenario.time.tick_hz)

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
