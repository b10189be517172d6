"""Whether a run failed, and why: by its limits, its replay, who else spoke on its bus, its completeness."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

from sim.audit.findings import AuditReport, Violation
from sim.flight.second_senders import said
from sim.record import run_dir
from sim.record.log_index import Voucher
from sim.record.run_record import RunRecord
from sim.replay.log_replay import ReplayResult


class Verdict(StrEnum):
    """What a run is judged by, in the order in which it is told."""

    LIMITS = "limits"
    REPLAY = "replay"
    SECOND_SENDERS = "second_senders"
    COMPLETE = "complete"


def failures(
    run: RunRecord,
    ticks: int,
    audited: AuditReport,
    shown: ReplayResult,
    voucher: Voucher,
) -> dict[str, str]:
    """What fails, each in a clause for people; empty where all is well.

    Args:
        run: content of run.json.
        ticks: how many have been flown.
        audited: what the audit of the whole log has found.
        shown: what the replay showed.
        voucher: what the index says of the log.
    """
    senders = run.get("second_senders")
    found = {
        Verdict.LIMITS: _limits(audited.statuses, audited.violations),
        Verdict.REPLAY: _replay(shown, run.get("platform") == run_dir.fingerprint()),
        Verdict.SECOND_SENDERS: said(senders) if senders else "",
        Verdict.COMPLETE: _incomplete(run, ticks, audited.complete, voucher),
    }
    return {verdict.value: clause for verdict, clause in found.items() if clause}


def flight_failed(found: Mapping[str, str]) -> str:
    """All that failed, in one sentence."""
    return f"the flight failed: {'; '.join(found.values())}"


def _limits(judged: int, violations: Sequence[Violation]) -> str:
    if violations:
        times = "once" if len(violations) == 1 else f"{len(violations)} times"
        return f"the limits are broken {times}, first at {violations[0]}"
    return "" if judged else "nothing tells whether the limits were kept: the log has no COIL_STATUS"


def _replay(shown: ReplayResult, same_platform: bool) -> str:
    if shown.bit_exact or (shown.command_exact and not same_platform):
        return ""
    return f"the replay is not exact: {shown.first_bit_difference}"


def _incomplete(run: RunRecord, ticks: int, ended: bool, voucher: Voucher) -> str:
    if "flown" in run and ended:
        return "" if voucher.holds else voucher.sentence
    why = f": {run['ended']}" if "ended" in run else ""
    return f"the run is not complete, {ticks} of {run['ticks']} ticks were flown{why}"
