"""Flights for campaigns: plant and flight software in one process, no files, judged as by ``torquer sil``.

The loop, the bus, the audit and the summary are those of ``torquer sil --bus virtual``; only their
input is in memory instead of files, and only as much as they need.
"""

import hashlib
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fsw.input.schema import Nested
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, CoilDipole, CoilFire, CoilRefused, PlantEnd
from sim.audit.auditor import AuditReport
from sim.audit.limits import limits_in
from sim.audit.whole_entries import JUDGED
from sim.faults.section import make_plant
from sim.flight.flight_loop import fly
from sim.flight.record_flight import MOST_IN_MEMORY, ticks_of
from sim.flight.virtual_bus import VirtualBus
from sim.plant.truth_row import TruthRow
from sim.record.candump import LogEntry, read_log
from sim.record.estimates import EstimateRecorder, Estimates
from sim.record.run_record import FlightRecord
from sim.record.truth import COLUMNS, Histories
from sim.report.figures.performance import perform
from sim.report.flight_audit import audit_flight
from sim.report.summary import BusTally, summarise
from sim.scenario.assemble import effects_of, plant_config
from sim.scenario.schema import Scenario, flight_table, load
from sim.scenario.telecommands import uplink
from sim.value_types import Json

# --- SHA-256 of the frames of a flight: of all, and of the commands to the coils alone

COMMANDS = frozenset({CoilFire.ID, CoilDipole.ID})


class FrameDigest:
    """Digests of frames in their order.

    Two flights with the same digest of all frames are equal to the last bit: each TICK_DONE has the CRC of
    the flight state. Each frame is sealed by a CRC of its own that includes its identifier, so that the data
    suffice.
    """

    def __init__(self) -> None:
        self._all, self._commands = hashlib.sha256(), hashlib.sha256()

    def take(self, frames: Sequence[Frame]) -> None:
        """Add the frames of a tick."""
        self._all.update(b"".join([frame.data for frame in frames]))
        for frame in frames:
            if frame.can_id in COMMANDS:
                self._commands.update(frame.data)

    @property
    def frames(self) -> str:
        """Of all frames, in hex."""
        return self._all.hexdigest()

    @property
    def commands(self) -> str:
        """Of the commands, in hex."""
        return self._commands.hexdigest()


def digest_of(log: Path) -> FrameDigest:
    """The digest of a bus log.

    Raises:
        HarnessError: it cannot be read.
    """
    digest = FrameDigest()
    for entry in read_log(log):
        digest.take((entry.frame,))
    return digest


# --- The flight

Figures = dict[str, float]
Measure = Callable[[Scenario, Histories, Estimates], Figures]

_JUDGED = (
    JUDGED
    | {CoilRefused.ID, PlantEnd.ID}
    | {can_id for can_id, name in NAMES.items() if name.endswith("_EVENT")}
)
"""Identifiers of the frames that audit and tally evaluate."""

_WIDTHS = {name: width for name, width, *_ in COLUMNS if name != "r_eci_m"}
"""Of the histories that summaries and measures need: the first numbers of a row."""


@dataclass(frozen=True, slots=True)
class Order:
    """A flight to be run.

    Attributes:
        scenario: name or path, or the scenario.
        overrides: laid over the scenario, nested as in its file.
        seed: of the plant's random streams.
        orbits: None: as the scenario says.
        measure: further figures, of the scenario, truth and estimates; a function of a module.
        name: what it is called; empty: by scenario, seed and overrides.
    """

    scenario: str | Scenario
    overrides: Nested = field(default_factory=dict)
    seed: int = 1
    orbits: float | None = None
    measure: Measure | None = None
    name: str = ""


@dataclass(frozen=True, slots=True)
class FlightResult:
    """The result of a flight: the keys of summary.json, and the figures of ``measure``."""

    order: Order
    summary: Json
    figures: Figures


@dataclass(frozen=True, slots=True)
class RecordedFlight:
    """The record of a flight: ``run`` has the keys of ``run.json`` that a summary needs."""

    scenario: Scenario
    run: FlightRecord
    truth: Histories
    estimates: Estimates
    audit: AuditReport
    tally: BusTally
    digest: FrameDigest = field(default_factory=FrameDigest)

    def summary(self) -> Json:
        """The keys of summary.json."""
        performance = perform(self.scenario, self.truth, self.estimates)
        return summarise(self.scenario, self.run, performance, self.audit, self.tally)


def fly_order(order: Order) -> FlightResult:
    """Fly, audit and summarise.

    Raises:
        TableError: the scenario or an override is not valid.
        HarnessError: the flight cannot be flown.
    """
    record = record_order(order)
    figures = {} if order.measure is None else order.measure(record.scenario, record.truth, record.estimates)
    return FlightResult(order, record.summary(), figures)


def record_order(order: Order) -> RecordedFlight:
    """Fly and audit; ``measure`` is not called.

    Raises:
        TableError: the scenario or an override is not valid.
        HarnessError: the flight cannot be flown.
    """
    scenario = load(order.scenario, order.overrides)
    return record_scenario(scenario, order.seed, order.orbits)


def record_scenario(scenario: Scenario, seed: int, orbits: float | None = None) -> RecordedFlight:
    """Fly a scenario and audit; ``orbits`` None: as it says.

    Raises:
        TableError: no plant or flight software can have these numbers.
        HarnessError: the flight cannot be flown.
    """
    ticks = ticks_of(scenario, orbits, MOST_IN_MEMORY)
    node = FlightNode(flight_config(flight_table(scenario)))
    log, truth = _Frames(), _Truth(ticks, node)
    plant = make_plant(plant_config(scenario, seed), scenario.fault, effects_of(scenario))
    outcome = fly(
        plant,
        VirtualBus(node),
        log,
        truth,
        ticks,
        scenario.epoch_unix_s,
        scenario.time.tick_hz,
        uplink=uplink(scenario.telecommand, scenario.time.tick_hz),
    )
    tally = BusTally(scenario.epoch_unix_s * 1_000_000)
    for entry in log.entries:
        tally.take(entry)
    run = FlightRecord(
        seed=seed, flown={"ticks": outcome.ticks, "slips": outcome.slips, "wall_s": outcome.wall_s}
    )
    report = audit_flight(log.entries, limits_in(scenario.model_dump(mode="json"), scenario.name), scenario)
    estimates = truth.recorder.estimates()
    return RecordedFlight(scenario, run, truth.histories(), estimates, report, tally, log.digest)


class _Frames:
    """The frames that are evaluated after the flight, numbered like the lines of a log."""

    def __init__(self) -> None:
        self.entries: list[LogEntry] = []
        self.digest = FrameDigest()
        self._line = 0

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        self.digest.take(frames)
        for frame in frames:
            self._line += 1
            if frame.can_id in _JUDGED:
                self.entries.append(LogEntry(self._line, timestamp_us, "virtual", frame))


class _Truth:
    """The histories that summaries and measures need, and with each row the estimate on board."""

    def __init__(self, ticks: int, node: FlightNode) -> None:
        self._rows = array("d")
        self._width = sum(_WIDTHS.values())
        self.recorder = EstimateRecorder(ticks)
        self._node = node

    def append(self, row: TruthRow) -> None:
        self._rows.fromlist(row.numbers()[: self._width])
        self.recorder.take(self._node.state)

    def histories(self) -> Histories:
        """By name; each a copy of its columns."""
        rows = np.frombuffer(self._rows).reshape(-1, self._width)
        columns = np.split(rows, np.cumsum([*_WIDTHS.values()])[:-1], axis=1)
        return {
            name: np.ascontiguousarray(column[:, 0] if width == 1 else column)
            for (name, width), column in zip(_WIDTHS.items(), columns, strict=True)
        }

    def flush(self) -> None:
        """Nothing is buffered."""
