"""Flights for campaigns: plant and flight software in one process, no files, judged as by ``torquer sil``.

The loop, the bus, the audit and the summary are those of ``torquer sil --bus virtual``; only their
input is in memory instead of files, and only as much as they need.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from fsw.input.schema import Nested
from fsw.node import FlightNode
from fsw.table.config import flight_config
from sim.audit.auditor import AuditReport
from sim.audit.limits import limits_in
from sim.campaign.in_memory import FrameDigest, FramesInMemory, HistoriesInMemory
from sim.faults.section import make_plant
from sim.flight.flight_loop import fly
from sim.flight.record_flight import MOST_IN_MEMORY, ticks_of
from sim.flight.virtual_bus import VirtualBus
from sim.record.candump import read_log
from sim.record.estimates import Estimates
from sim.record.run_record import FlightRecord
from sim.record.truth import Histories
from sim.report.figures.performance import perform
from sim.report.flight_audit import audit_flight
from sim.report.summary import BusTally, summarise
from sim.scenario.assemble import effects_of, plant_config
from sim.scenario.schema import Scenario, flight_table, load
from sim.scenario.telecommands import uplink
from sim.value_types import Json


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
    log, truth = FramesInMemory(), HistoriesInMemory(ticks, node)
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
