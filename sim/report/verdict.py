"""Whether a run failed, and why: limits, replay, second senders on its bus, completeness, requirements."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

from sim.audit.findings import AuditReport, Violation
from sim.flight.second_senders import describe_senders
from sim.record import run_dir
from sim.record.log_index import IndexCheck
from sim.record.run_record import RunRecord
from sim.replay.log_replay import ReplayResult
from sim.report.requirements.judge import Outcome
from sim.value_types import Json


class Verdict(StrEnum):
    """What a run is judged by, in the order in which it is reported."""

    LIMITS = "limits"
    REPLAY = "replay"
    SECOND_SENDERS = "second_senders"
    COMPLETE = "complete"
    REQUIREMENTS = "requirements"


def failures(
    run: RunRecord,
    ticks: int,
    audit_report: AuditReport,
    replay_result: ReplayResult | None,
    voucher: IndexCheck,
    requirements: Sequence[Json] = (),
) -> dict[str, str]:
    """What fails, each as a clause of a sentence; empty where nothing fails.

    Args:
        run: content of run.json.
        ticks: number of ticks of the flight.
        audit_report: the audit of the whole log.
        replay_result: the result of the replay; None where there is none.
        voucher: the check of the log against its index.
        requirements: of the scenario, as in summary.json.
    """
    senders = run.get("second_senders")
    clauses = {
        Verdict.LIMITS: _limits(audit_report.missing, audit_report.violations),
        Verdict.REPLAY: _replay(replay_result, run.get("platform") == run_dir.fingerprint()),
        Verdict.SECOND_SENDERS: describe_senders(senders) if senders else "",
        Verdict.COMPLETE: _incomplete(run, ticks, audit_report.complete, voucher),
        Verdict.REQUIREMENTS: _missed([one for one in requirements if one["verdict"] == Outcome.FAILED]),
    }
    return {verdict.value: clause for verdict, clause in clauses.items() if clause}


def flight_failed(clauses: Mapping[str, str]) -> str:
    """All that failed, in one sentence."""
    return f"the flight failed: {'; '.join(clauses.values())}"


def _limits(missing: str, violations: Sequence[Violation]) -> str:
    if violations:
        times = "once" if len(violations) == 1 else f"{len(violations)} times"
        return f"the limits are broken {times}, first at {violations[0]}"
    return f"the limits cannot be judged: the log has no {missing}" if missing else ""


def _replay(replay_result: ReplayResult | None, same_platform: bool) -> str:
    if (
        replay_result is None
        or replay_result.bit_exact
        or (replay_result.command_exact and not same_platform)
    ):
        return ""
    return f"the replay is not exact: {replay_result.first_bit_difference}"


def _missed(failed: Sequence[Json]) -> str:
    if not failed:
        return ""
    others = f", and {len(failed) - 1} more" if len(failed) > 1 else ""
    reason = f" ({failed[0]['reasons'][0]['text']})" if failed[0]["reasons"] else ""
    return f"a requirement is missed: {failed[0]['text']}{reason}{others}"


def _incomplete(run: RunRecord, ticks: int, ended: bool, voucher: IndexCheck) -> str:
    if "flown" in run and ended:
        return "" if voucher.holds else voucher.sentence
    why = f": {run['ended']}" if "ended" in run else ""
    return f"the run is not complete, {ticks} of {run['ticks']} ticks were flown{why}"
