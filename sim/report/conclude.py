"""Conclude a run: audit, replay, summary and report; only then is the run complete."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from fsw.core.state import FlightState
from fsw.table.config import flight_config
from sim.audit.auditor import AuditReport, ViolationKind, audit
from sim.audit.check import limits_beside
from sim.errors import HarnessError
from sim.faults.section import break_frames, forge_answers
from sim.record import binding, run_dir
from sim.record.candump import LogEntry, read_log
from sim.record.destination import check_folder
from sim.record.estimates import Estimates
from sim.record.log_index import check_against_index
from sim.record.run_dir import Json
from sim.record.run_record import RunRecord
from sim.record.truth import Histories, TruthReader
from sim.replay.log_replay import ReplayResult, replay
from sim.report.figures.performance import Performance
from sim.report.history_blocks import HistoryBlocks, TakeBlock
from sim.report.lines import Lines
from sim.report.page import write_report
from sim.report.summary import BusTally, summarise
from sim.report.verdict import Verdict, failures
from sim.scenario.schema import Scenario, flight_table

Watch = Callable[[int], None]


def conclude(path: Path, watch: Watch = lambda tick: None) -> Json:
    """Write summary.json and report.html of a run, complete or not; bind and mark complete a whole one.

    The log is replayed through the flight software: that gives its estimates at full precision, and shows
    each time that the replay is exact.

    Raises:
        HarnessError: the directory is no run or cannot be written, or one of its files is damaged.
    """
    run, scenario = run_dir.read_run(path), run_dir.read_scenario(path)
    check_folder(path, run_dir.RESULTS)
    log = path / run_dir.BUS_LOG
    with TruthReader(path / run_dir.TRUTH) as truth:
        _check_rows(path / run_dir.TRUTH, truth.complete, run)
        performance = Performance(scenario, truth.complete)
        lines = Lines(truth.complete, scenario.time.tick_hz)
        replay_result = _replay(log, scenario, truth, (performance.take, lines.take), watch)
    tally = BusTally(scenario.epoch_unix_s * 1_000_000)
    limits = limits_beside(log)
    assert limits is not None
    report = audit(_tally_entries(read_log(log), tally), limits, expect_end=True)
    if break_frames(scenario.fault):
        report = without_broken_frames(report)
    summary = summarise(scenario, run, performance, report, tally)
    summary["replay"] = _replay_json(replay_result)
    senders = run.get("second_senders")
    failed_checks = failures(run, summary["ticks"], report, replay_result, check_against_index(log))
    summary |= {
        key: found for key, found in (("second_senders", senders), ("failures", failed_checks)) if found
    }
    flight_is_bound = run_dir.BUS_LOG in binding.digests(run)
    if flight_is_bound:
        binding.release(path, run_dir.SUMMARY)
    run_dir.write_json(path / run_dir.SUMMARY, summary)
    write_report(path / run_dir.REPORT, scenario, summary, lines, report)
    if flight_is_bound:
        binding.bind(path, run_dir.TRUTH, run_dir.SUMMARY)
    if Verdict.COMPLETE not in failed_checks:
        run_dir.update(path, complete=True)
    return summary


def _check_rows(path: Path, rows: int, run: RunRecord) -> None:
    """A flight that came to its end has as many rows as ticks.

    Raises:
        HarnessError: it has not.
    """
    flight = run.get("flown")
    if flight is not None and rows != flight["ticks"]:
        raise HarnessError(f"{path}: {rows} whole rows, but {flight['ticks']} ticks were flown")


def _replay(
    log: Path, scenario: Scenario, truth: TruthReader, takers: tuple[TakeBlock, ...], watch: Watch
) -> ReplayResult:
    """Replay, and hand over truth and estimates block by block."""

    def take_block(histories: Histories, estimates: Estimates) -> None:
        for take in takers:
            take(histories, estimates)

    blocks = HistoryBlocks(truth, take_block)

    def on_tick(state: FlightState) -> None:
        blocks.take(state)
        watch(state.tick)

    config, forged = flight_config(flight_table(scenario)), forge_answers(scenario.fault)
    result = replay(log, config, on_tick, forged)
    blocks.finish()
    return result


def _tally_entries(entries: Iterator[LogEntry], tally: BusTally) -> Iterator[LogEntry]:
    for entry in entries:
        tally.take(entry)
        yield entry


def without_broken_frames(report: AuditReport) -> AuditReport:
    """The report without broken frames, where the scenario injects them: they say nothing about the board."""
    others = tuple(violation for violation in report.violations if violation.kind is not ViolationKind.FRAME)
    return replace(report, violations=others)


def _replay_json(replay_result: ReplayResult) -> Json:
    return {
        "bit_exact": replay_result.bit_exact,
        "command_exact": replay_result.command_exact,
        "ticks": replay_result.ticks,
    }
