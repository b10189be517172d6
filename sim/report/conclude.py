"""Conclude a run: audit, replay, summary and report; only then is the run complete."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fsw.core.state import FlightState
from fsw.table.config import flight_config
from sim.audit.check import limits_beside
from sim.audit.findings import AuditReport
from sim.errors import HarnessError
from sim.faults.section import forge_answers
from sim.record import binding, run_dir
from sim.record.candump import LogEntry, More, read_log, whole_entries
from sim.record.destination import check_folder
from sim.record.estimates import Estimates
from sim.record.log_index import check_against_index
from sim.record.truth import GrowingTruth, Histories, RowsMissingError, TruthReader
from sim.replay.log_replay import ReplayResult, replay
from sim.report.charts.lines import Lines
from sim.report.figures.histories import HistoryBlocks, TruthBlocks
from sim.report.figures.performance import Performance
from sim.report.flight_audit import audit_flight
from sim.report.observed import observed_estimates
from sim.report.page import write_report
from sim.report.summary import BusTally, summarise
from sim.report.verdict import Verdict, failures
from sim.scenario.law_named import with_law_named
from sim.scenario.schema import Scenario, flight_table
from sim.value_types import Json

Watch = Callable[[int], None]
Draw = Callable[[Scenario, Lines, AuditReport], None]


def conclude(
    path: Path,
    watch: Watch = lambda tick: None,
    law: str | None = None,
    draw: Draw | None = None,
) -> Json:
    """Write summary.json and report.html of a run, complete or not; bind a whole one and mark it complete.

    The log is replayed through the flight software: that gives its estimates at full precision, and checks
    each time that the replay is exact. Of a user's flight software the estimates are those on the bus.

    Args:
        path: the run directory.
        watch: called with each tick that was replayed.
        law: the user law that the run flew, named again; None: none is executed.
        draw: called with what the charts show, once the report is written.

    Raises:
        HarnessError: the directory is not a run or cannot be written, or one of its files is damaged; or it
            flew a user law which is not named, or whose source has changed.
        LawError: that law fails.
    """
    scenario, _ = with_law_named(run_dir.read_scenario(path), law)
    check_folder(path, run_dir.RESULTS)
    with TruthReader(path / run_dir.TRUTH) as truth:
        _check_rows(path, truth.complete)
        own = "flight_software" in run_dir.read_run(path)
        replayed = (_observe if own else _replay)(path, scenario, truth, watch)
    return _write_results(path, scenario, replayed, draw)


def conclude_flight(path: Path, more: More, watch: Watch = lambda tick: None, law: str | None = None) -> Json:
    """The same for a run that is being flown: the replay follows the flight.

    If a stranger has made the flight software's count of ticks differ from the plant's, the replay cannot
    follow the histories by it: then the run is concluded once it is over.

    Args:
        path: the run directory.
        more: waits; whether the flight goes on.
        watch: called with each tick that was replayed.
        law: as for ``conclude``.

    Raises:
        HarnessError: the run cannot be concluded, or the flight was cut short.
    """
    scenario, _ = with_law_named(run_dir.read_scenario(path), law)
    ticks = run_dir.read_run(path)["ticks"]
    while not run_dir.bus_log(path).exists() and more():
        pass
    growing = GrowingTruth(path / run_dir.TRUTH, ticks)
    try:
        replayed = _replay(path, scenario, growing, watch, more)
    except RowsMissingError:
        while more():
            pass
        return conclude(path, watch, law)
    with TruthReader(path / run_dir.TRUTH) as truth:
        if truth.complete != ticks:
            raise HarnessError(f"{path / run_dir.TRUTH}: {truth.complete} whole rows, not {ticks}")
    _check_rows(path, ticks)
    check_folder(path, run_dir.RESULTS)
    return _write_results(path, scenario, replayed)


@dataclass(frozen=True, slots=True)
class _Replayed:
    """What one pass over log and histories has gathered; ``result`` None: nothing can be replayed."""

    result: ReplayResult | None
    performance: Performance
    lines: Lines


def _replay(
    path: Path, scenario: Scenario, truth: TruthBlocks, watch: Watch, more: More | None = None
) -> _Replayed:
    performance = Performance(scenario, truth.complete)
    lines = Lines(truth.complete, scenario)

    def take_block(histories: Histories, estimates: Estimates) -> None:
        performance.take(histories, estimates)
        lines.take(histories, estimates)

    blocks = HistoryBlocks(truth, take_block)

    def on_tick(state: FlightState) -> None:
        blocks.take(state)
        watch(state.tick)

    config, forged = flight_config(flight_table(scenario)), forge_answers(scenario.fault)
    result = replay(run_dir.bus_log(path), config, on_tick, forged, more)
    while more is not None and more():  # a replay that differs ends before the flight
        pass
    blocks.finish()
    return _Replayed(result, performance, lines)


def _observe(path: Path, scenario: Scenario, truth: TruthReader, watch: Watch) -> _Replayed:
    """The same where the flight software is not this project's, which cannot be replayed."""
    performance = Performance(scenario, truth.complete, own_software=False)
    lines = Lines(truth.complete, scenario)
    first = 0
    entries, forged = whole_entries(run_dir.bus_log(path)), forge_answers(scenario.fault)
    for estimates in observed_estimates(entries, truth.complete, forged):
        histories = truth.rows(first, first + len(estimates.valid))
        performance.take(histories, estimates)
        lines.take(histories, estimates)
        first += len(estimates.valid)
        watch(first)
    return _Replayed(None, performance, lines)


def _write_results(path: Path, scenario: Scenario, replayed: _Replayed, draw: Draw | None = None) -> Json:
    """Audit, summary and page; the run is then marked complete, if it is."""
    run, log = run_dir.read_run(path), run_dir.bus_log(path)
    tally = BusTally(scenario.epoch_unix_s * 1_000_000)
    limits = limits_beside(log)
    assert limits is not None
    report = audit_flight(_tally_entries(read_log(log), tally), limits, scenario, expect_end=True)
    summary = summarise(scenario, run, replayed.performance, report, tally)
    if replayed.result is not None:
        summary["replay"] = _replay_json(replayed.result)
    failed_checks = failures(
        run,
        summary["ticks"],
        report,
        replayed.result,
        check_against_index(log),
        summary["requirements"],
    )
    noted = {
        "code": run.get("code"),
        "algebra": run.get("algebra"),
        "second_senders": run.get("second_senders"),
        "failures": failed_checks,
    }
    summary |= {key: found for key, found in noted.items() if found}
    flight_is_bound = run_dir.BUS_LOG in binding.digests(run)
    if flight_is_bound:
        binding.release(path, run_dir.SUMMARY)
    run_dir.write_json(path / run_dir.SUMMARY, summary)
    write_report(path / run_dir.REPORT, scenario, summary, replayed.lines, report)
    if flight_is_bound:
        binding.bind(path, run_dir.TRUTH, run_dir.SUMMARY)
    if Verdict.COMPLETE not in failed_checks:
        run_dir.update(path, complete=True)
    if draw is not None:
        draw(scenario, replayed.lines, report)
    return summary


def _check_rows(path: Path, rows: int) -> None:
    """A flight that came to its end has as many rows as ticks.

    Raises:
        HarnessError: it has not.
    """
    flight = run_dir.read_run(path).get("flown")
    if flight is not None and rows != flight["ticks"]:
        raise HarnessError(
            f"{path / run_dir.TRUTH}: {rows} whole rows, but {flight['ticks']} ticks were flown"
        )


def _tally_entries(entries: Iterator[LogEntry], tally: BusTally) -> Iterator[LogEntry]:
    for entry in entries:
        tally.take(entry)
        yield entry


def _replay_json(replay_result: ReplayResult) -> Json:
    return {
        "bit_exact": replay_result.bit_exact,
        "command_exact": replay_result.command_exact,
        "ticks": replay_result.ticks,
    }
