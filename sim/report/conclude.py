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
from sim.record.estimates import EstimateRecorder
from sim.record.log_index import check_against_index
from sim.record.run_dir import Json
from sim.record.truth import read_truth
from sim.replay.log_replay import ReplayResult, replay
from sim.report.page import write_report
from sim.report.summary import BusTally, summarise
from sim.report.verdict import Verdict, failures
from sim.scenario.schema import flight_table

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
    truth = read_truth(path / run_dir.TRUTH)
    flight = run.get("flown")
    if flight is not None and len(truth["t_s"]) != flight["ticks"]:
        raise HarnessError(
            f"{path / run_dir.TRUTH}: {len(truth['t_s'])} whole rows, but {flight['ticks']} ticks were flown"
        )
    recorder = EstimateRecorder(len(truth["t_s"]))

    def on_tick(state: FlightState) -> None:
        recorder.take(state)
        watch(state.tick)

    config, forged = flight_config(flight_table(scenario)), forge_answers(scenario.fault)
    replay_result = replay(log, config, on_tick, forged)
    tally = BusTally(scenario.epoch_unix_s * 1_000_000)
    limits = limits_beside(log)
    assert limits is not None
    report = audit(_tally_entries(read_log(log), tally), limits, expect_end=True)
    if break_frames(scenario.fault):
        report = without_broken_frames(report)
    summary = summarise(scenario, run, truth, recorder.estimates(), report, tally)
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
    write_report(path / run_dir.REPORT, scenario, summary, truth, recorder.estimates(), report)
    if flight_is_bound:
        binding.bind(path, run_dir.TRUTH, run_dir.SUMMARY)
    if Verdict.COMPLETE not in failed_checks:
        run_dir.update(path, complete=True)
    return summary


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
