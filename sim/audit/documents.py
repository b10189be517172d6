"""The result of an audit for programs: values of JSON, and verdicts as tests of JUnit."""

from sim.audit.findings import AuditReport, Violation, ViolationKind
from sim.junit import JunitCase
from sim.value_types import Json

OF_PULSES = frozenset(
    (
        ViolationKind.PULSE,
        ViolationKind.ANNOUNCED,
        ViolationKind.GAP,
        ViolationKind.BOOT,
        ViolationKind.TWO_COILS,
    )
)
"""The rules of a pulsed driver."""


def as_json(report: AuditReport) -> Json:
    """Limits, figures, violations and notes."""
    limits = report.limits
    return {
        "ok": report.exit_code == 0,
        "limits": {
            "pulse_s": limits.pulse_us / 1e6,
            "backoff_s": limits.backoff_us / 1e6,
            "backoff": "shared" if limits.shared else "per_coil",
            "max_level": limits.max_level,
            "driver": "continuous" if limits.is_continuous else "pulsed",
        },
        "statuses": report.statuses,
        "dipole_statuses": report.dipoles.statuses if report.dipoles else 0,
        "unreported_s": report.unreported_s,
        "span_s": report.span_s,
        "pulses": {"total": len(report.pulses), "per_coil": report.pulses_per_coil},
        "max_pulse_s": report.max_pulse_s,
        "min_gap_s": {"per_coil": report.min_gap_per_coil_s, "any": report.min_gap_any_s},
        "duty": {"per_coil": report.duty_per_coil, "total": report.duty_total},
        "complete": report.complete,
        "genuine": report.genuine,
        "violations": [_violation(one) for one in report.violations],
        "mismatches": list(report.mismatches),
        "notes": list(report.notes),
    }


def suites(report: AuditReport) -> dict[str, list[JunitCase]]:
    """A test for each rule that can be broken, and for each condition that a log must meet to be judged."""
    rules = [_rule(kind, report) for kind in ViolationKind]
    log = {
        "something to judge": f"the log has no {report.missing}" if report.missing else "",
        "reported throughout": report.doubt,
        "complete": "" if report.complete else "the log is incomplete",
        "as its index says": "" if report.genuine else "its index contradicts it",
        "files of one run": "; ".join(report.mismatches),
    }
    return {
        "limits": rules,
        "log": [
            *(JunitCase("check.log", name, failure=why) for name, why in log.items()),
            JunitCase("check.log", "real time", skipped=report.not_real_time),
        ],
    }


def _rule(kind: ViolationKind, report: AuditReport) -> JunitCase:
    broken = [violation for violation in report.violations if violation.kind is kind]
    others = f"; and {len(broken) - 1} more" if len(broken) > 1 else ""
    return JunitCase(
        "check.limits",
        kind.value,
        failure=f"{broken[0]}{others}" if broken else "",
        skipped=_skipped(kind, report),
    )


def _skipped(kind: ViolationKind, report: AuditReport) -> str:
    if report.missing:
        return "nothing to judge"
    return "no limit of a continuous driver" if report.limits.is_continuous and kind in OF_PULSES else ""


def _violation(one: Violation) -> Json:
    return {
        "kind": one.kind.value,
        "time_s": one.time_s,
        "tick": one.tick,
        "coil": one.coil,
        "line": one.line,
        "sentence": one.sentence,
    }
