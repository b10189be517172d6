"""A run that was flown before, read to be drawn."""

from collections.abc import Callable
from pathlib import Path

from fsw.table.config import flight_config
from sim.audit.check import limits_beside
from sim.audit.findings import AuditLimits
from sim.faults.section import forge_answers
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.estimates import EstimateRecorder
from sim.record.truth import TruthReader
from sim.replay.log_replay import replay
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.charts.lines import Lines
from sim.report.figures.performance import BLOCK_TICKS
from sim.report.flight_audit import audit_flight
from sim.report.history_blocks import HistoryBlocks
from sim.scenario.schema import Scenario, flight_table

Watch = Callable[[int], None]


def flight_as_flown(path: Path, scenario: Scenario) -> DrawnFlight:
    """What the plant's histories and the log tell: nothing that the flight software has estimated.

    Raises:
        HarnessError: log or histories are missing or damaged.
    """
    with TruthReader(path / run_dir.TRUTH) as truth:
        lines = Lines(truth.complete, scenario)
        for first in range(0, truth.complete, BLOCK_TICKS):
            past = min(first + BLOCK_TICKS, truth.complete)
            lines.take(truth.rows(first, past), EstimateRecorder(past - first).estimates())
    return _drawn(path, scenario, lines)


def flight_as_estimated(path: Path, scenario: Scenario, watch: Watch = lambda tick: None) -> DrawnFlight:
    """The same with the estimates of the flight software, by a replay of the log.

    Args:
        path: the run directory.
        scenario: of the run, with a law of its own that may be executed.
        watch: called with each tick that was replayed.

    Raises:
        HarnessError: log or histories are missing or damaged.
    """
    with TruthReader(path / run_dir.TRUTH) as truth:
        lines = Lines(truth.complete, scenario)
        blocks = HistoryBlocks(truth, lines.take)
        config, forged = flight_config(flight_table(scenario)), forge_answers(scenario.fault)
        replay(run_dir.bus_log(path), config, blocks.take, forged)
        blocks.finish()
    return _drawn(path, scenario, lines)


def _drawn(path: Path, scenario: Scenario, lines: Lines) -> DrawnFlight:
    log = run_dir.bus_log(path)
    limits = limits_beside(log) or AuditLimits()
    return DrawnFlight.of(scenario, lines, audit_flight(read_log(log), limits, scenario))
