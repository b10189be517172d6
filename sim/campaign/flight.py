"""A flight for campaigns: plant and flight software in one process, no file, judged as by ``torquer sil``.

The loop, the bus, the audit and the summary are those of ``torquer sil --bus virtual``; only what they are
given is kept in memory instead of files, and no more of it than they need.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fsw.input.schema import Nested
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, CoilBoot, CoilRefused, CoilStatus, PlantEnd, Sync
from sim.audit.auditor import AuditReport, audit
from sim.audit.limits import limits_in
from sim.flight.flight_loop import fly
from sim.flight.record_flight import ticks_of
from sim.flight.virtual import VirtualBus
from sim.plant.plant import Plant, TruthRow
from sim.record.candump import LogEntry
from sim.record.estimates import EstimateRecorder, Estimates
from sim.record.run_dir import Json
from sim.record.run_record import FlightRecord
from sim.record.truth import Histories
from sim.report.summary import BusTally, summarise
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario, flight_table, load
from sim.scenario.telecommands import uplink

Figures = dict[str, float]
Measure = Callable[[Scenario, Histories, Estimates], Figures]

_KEPT = frozenset({CoilStatus.ID, CoilBoot.ID, CoilRefused.ID, Sync.ID, PlantEnd.ID}) | {
    can_id for can_id, name in NAMES.items() if name.endswith("_EVENT")
}
"""What audit and tally look at."""

_COLUMNS = {"t_s": 1, "q_body_from_orbit": 4, "omega_body_orbit_radps": 3, "lit": 1, "m_body_am2": 3}


@dataclass(frozen=True, slots=True)
class Order:
    """A flight to be flown.

    Attributes:
        scenario: name or path.
        overrides: laid over the scenario, nested as in its file.
        seed: of the plant's random streams.
        orbits: None: as the scenario says.
        measure: further figures, of the scenario, truth and estimates; a function of a module.
    """

    scenario: str
    overrides: Nested = field(default_factory=dict)
    seed: int = 1
    orbits: float | None = None
    measure: Measure | None = None


@dataclass(frozen=True, slots=True)
class Flight:
    """What came of it: the keys of summary.json, and what ``measure`` gave."""

    order: Order
    summary: Json
    figures: Figures


@dataclass(frozen=True, slots=True)
class Record:
    """All that is kept of a flight: ``run`` is what ``run.json`` would say of it, as far as it is judged."""

    scenario: Scenario
    run: FlightRecord
    truth: Histories
    estimates: Estimates
    audit: AuditReport
    tally: BusTally


def fly_order(order: Order) -> Flight:
    """Fly, audit and summarise.

    Raises:
        TableError: the scenario or an override is not valid.
        HarnessError: the flight cannot be flown.
    """
    kept = record_order(order)
    summary = summarise(kept.scenario, kept.run, kept.truth, kept.estimates, kept.audit, kept.tally)
    figures = {} if order.measure is None else order.measure(kept.scenario, kept.truth, kept.estimates)
    return Flight(order, summary, figures)


def record_order(order: Order) -> Record:
    """Fly and audit; ``measure`` is left to others.

    Raises:
        TableError: the scenario or an override is not valid.
        HarnessError: the flight cannot be flown.
    """
    scenario = load(order.scenario, order.overrides)
    ticks = ticks_of(scenario, order.orbits)
    node = FlightNode(flight_config(flight_table(scenario)))
    log, truth = _Frames(), _Truth(ticks, node)
    plant = Plant(plant_config(scenario, order.seed))
    flown = fly(
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
        seed=order.seed, flown={"ticks": flown.ticks, "slips": flown.slips, "wall_s": flown.wall_s}
    )
    audited = audit(log.entries, limits_in(scenario.model_dump(mode="json"), scenario.name))
    return Record(scenario, run, truth.histories, truth.recorder.estimates(), audited, tally)


class _Frames:
    """The frames that are looked at afterwards, numbered as the lines of a log would be."""

    def __init__(self) -> None:
        self.entries: list[LogEntry] = []
        self._line = 0

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        for frame in frames:
            self._line += 1
            if frame.can_id in _KEPT:
                self.entries.append(LogEntry(self._line, timestamp_us, "virtual", frame))


class _Truth:
    """The histories that a summary needs, and with each row what the flight software knows by then."""

    def __init__(self, ticks: int, node: FlightNode) -> None:
        self.histories: Histories = {
            name: np.zeros(ticks) if width == 1 else np.zeros((ticks, width))
            for name, width in _COLUMNS.items()
        }
        self.recorder = EstimateRecorder(ticks)
        self._node = node
        self._row = 0

    def append(self, row: TruthRow) -> None:
        for name, history in self.histories.items():
            history[self._row] = getattr(row, name)
        self.recorder.take(self._node.state)
        self._row += 1

    def flush(self) -> None:
        """Everything is there already."""
