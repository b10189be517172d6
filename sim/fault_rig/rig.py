"""Plant, boards and flight software in one process, and faults between them. The plant always ticks on."""

import time
from functools import cache

from fsw.core.config import FlightConfig
from fsw.core.gate.sync_watch import near
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.frame import Frame
from fsw.wire.messages import Sync, TickDone, intact
from sim.fault_rig.record import Record
from sim.faults.fault import Condition, Fault
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario, flight_table, load, parse_settings

MOST_KEPT = 4096
"""Frames that wait for a stopped process; a socket's buffer holds no more."""


@cache
def prepared(name: str, settings: tuple[str, ...]) -> tuple[Scenario, FlightConfig]:
    """A scenario and its onboard table: costly, and the same for all flights of a row."""
    scenario = load(name, parse_settings(settings))
    return scenario, flight_config(flight_table(scenario))


class Rig:
    """One flight under fault.

    Args:
        scenario: what is flown.
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
        self.record = Record(scenario.time.tick_hz)

    def inject(self, fault: Fault, first: int, end: int | None) -> None:
        """Schedule a fault, for the next tick at the earliest."""
        self.plant.inject(ScheduledFault(fault, first, end))
        self.record.onset, self.record.end = first, end

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
        self._be(self._wanted(tick), tick)
        self.pace(tick, syncs)
        answers = self._answers(tick, frames)
        record.note_answer(tick, answers)
        for frame in answers:
            plant.receive(frame)
        record.note_state(tick, self._node.state if self._node is not None else None, plant.truth())
        plant.end_tick()
        record.coil_drives.append(plant.coil_drive)

    def pace(self, tick: int, syncs: list[Frame]) -> None:
        """True time until fsw answers: here ticks are the time."""

    def finish(self) -> Record:
        """The record, its counts complete."""
        if self._node is not None:
            self.record.rejected = self._node.state.gate.rejected
        return self.record

    def _wanted(self, tick: int) -> Condition:
        conditions = [fault.condition(tick) for fault in self.plant.active]
        for worst in (Condition.DEAD, Condition.STOPPED):
            if worst in conditions:
                return worst
        return Condition.RUNNING

    def _be(self, condition: Condition, tick: int) -> None:
        """Let the process become what it is to be."""
        if condition is Condition.DEAD:
            self._node = None
            self._backlog.clear()
        elif self._node is None:
            self._node = FlightNode(self._config)
            self.plant.receive(self._node.start())
            self.record.boots.append(tick)
        self._condition = condition

    def _answers(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """What fsw says to what it is sent; an exception that leaves it is its end, and is noted."""
        node, record = self._node, self.record
        if node is None:
            return []
        self._backlog = (self._backlog + frames)[:MOST_KEPT]
        if self._condition is Condition.STOPPED:
            return []
        waiting, self._backlog = self._backlog, []
        for fault in self.plant.active:
            node.state = fault.upset(node.state)
        answers: list[Frame] = []
        began = time.perf_counter()
        try:
            for frame in waiting:
                before = node.state.tick
                answer = node.receive(frame)
                answers += answer
                if _asks(frame, before) and not _names(answer, Sync.decode(frame.data).tick):
                    record.unanswered.append(tick)
                if node.state.tick != before >= 0 and not near(before, node.state.tick):
                    record.restarts.append(tick)
                if node.ended and record.ended is None:
                    record.ended = tick
        except Exception as error:  # whatever comes out of a step is a finding, for the check "no exception"
            record.crash = f"tick {tick}: {type(error).__name__}: {error}"
            self._node = None
        record.worst_step_s = max(record.worst_step_s, time.perf_counter() - began)
        return answers


def _asks(frame: Frame, before: int) -> bool:
    """Whether a frame is a SYNC that moves time forward, and not so far that it must be doubted."""
    if frame.can_id != Sync.ID or not intact(frame):
        return False
    tick = Sync.decode(frame.data).tick
    return before < 0 or near(before, tick)


def _names(answer: tuple[Frame, ...], tick: int) -> bool:
    """Whether the answer ends with the TICK_DONE of that tick."""
    last = answer[-1] if answer else None
    return last is not None and last.can_id == TickDone.ID and TickDone.decode(last.data).tick == tick
