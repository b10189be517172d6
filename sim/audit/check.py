"""``torquer check``: audit the actuator limits in a run directory or in any candump log."""

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from fsw.input.toml_text import load_toml
from fsw.wire.messages import CoilBoot, FswBoot, MagBoot, PlantBoot, SunBoot, WheelBoot, intact
from sim.audit.auditor import audit
from sim.audit.findings import AuditLimits, AuditReport, seconds_text
from sim.audit.limits import is_shared, limits_in
from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.binding import compare
from sim.record.candump import LogEntry, read_log
from sim.record.log_index import LogStanding, check_against_index
from sim.record.signature import PublicKey

SCENARIO_NAME = "scenario.toml"
CONTRACT_VERSION = 1
"""Version of the bus contract that is judged here; each node reports its own in its boot message."""
_BOOTS = {boot.ID: boot for boot in (PlantBoot, FswBoot, CoilBoot, MagBoot, SunBoot, WheelBoot)}
_SHOWN = 50
"""Violations that are printed one by one; the log of a board out of control may hold thousands."""


def check(
    path: Path,
    backoff: str | None,
    key: PublicKey | None = None,
    ticks_alone: bool = False,
    channel: str | None = None,
) -> AuditReport:
    """Audit a log by the limits of the scenario beside it, and compare the files beside it with its run.json.

    A scenario that is not the run's does not define the limits: the default ones apply instead.

    Args:
        path: a run directory, or a log.
        backoff: ``"shared"`` or ``"per_coil"``, overrules the scenario; without either it is shared.
        key: the run must be signed by its private half.
        ticks_alone: ticks are not real time, and the timestamps of a recorder are not judged.
        channel: the one to read, of a log that has several.

    Raises:
        HarnessError: there is no such log, it is not a candump log or an altered one, or a file beside it
            cannot be used.
    """
    folder = os.path.isdir(path)  # unlike Path's, never an error, whatever the name
    log = run_dir.bus_log(path) if folder else path
    if not os.path.isfile(log):
        raise HarnessError(f"{path}: no {run_dir.BUS_LOG} in it" if folder else f"{path}: no such file")
    binding = compare(log.parent, log, key)
    mismatched = SCENARIO_NAME in binding.mismatches
    stated = AuditLimits() if mismatched else limits_beside(log)
    limits = stated or AuditLimits()
    if backoff is not None:
        limits = replace(limits, shared=is_shared(backoff, "--backoff"))
    versions = _Versions(log, channel)
    with binding.beside_errors():
        report = audit(versions.entries(), limits, stated is not None, ticks_alone)
        foreign = versions.check()
    voucher = check_against_index(log)
    usual = f"judged by the usual limits: {SCENARIO_NAME} is not the run's" if mismatched else ""
    notes = (voucher.sentence, binding.note, usual, foreign)
    return replace(
        report,
        notes=(*report.notes, *(note for note in notes if note)),
        complete=report.complete and voucher.standing is not LogStanding.OPEN,
        genuine=voucher.standing is not LogStanding.BROKEN,
        mismatches=tuple(binding.mismatches.values()),
    )


class _Versions:
    """The versions of the bus contract that the boot messages of a log name, gathered while it is read."""

    def __init__(self, log: Path, channel: str | None) -> None:
        self._log = log
        self._channel = channel
        self._booted: set[int] = set()  # identifiers of boot messages of this version
        self._foreign: dict[int, tuple[int, int]] = {}  # first line and version of the others, by identifier
        self._count = 0

    def entries(self) -> Iterator[LogEntry]:
        """The entries of the log."""
        for entry in read_log(self._log, channel=self._channel):
            can_id = entry.frame.can_id
            if can_id in _BOOTS and intact(entry.frame):
                version = _BOOTS[can_id].decode(entry.frame.data).version
                if version == CONTRACT_VERSION:
                    self._booted.add(can_id)
                else:
                    self._count += 1
                    self._foreign.setdefault(can_id, (entry.line, version))
            yield entry

    def check(self) -> str:
        """A note on boot messages of another version, if there are any; one that is astray proves nothing.

        Raises:
            HarnessError: no node, or not the coil driver, has booted with this version.
        """
        if not self._foreign:
            return ""
        line, version = min(self._foreign.values())
        if CoilBoot.ID in self._foreign and CoilBoot.ID not in self._booted:
            line, version = self._foreign[CoilBoot.ID]
        elif self._booted:
            many = f"{self._count} boot messages are" if self._count > 1 else "a boot message is"
            return f"{many} of another version of the bus contract, first line {line}, of version {version}"
        raise HarnessError(
            f"{self._log}: line {line} is of version {version} of the bus contract, "
            f"and only version {CONTRACT_VERSION} can be read"
        )


def limits_beside(log: Path) -> AuditLimits | None:
    """The limits in the ``scenario.toml`` of the log's folder; None without one.

    Raises:
        HarnessError: it cannot be read, or one of its limits makes no sense.
    """
    scenario = log.parent / SCENARIO_NAME
    if not scenario.is_file():
        return None
    try:
        tables = load_toml(scenario)
    except OSError as error:
        raise HarnessError(f"{scenario}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise HarnessError(f"{scenario}: cannot be read: {error}") from None
    return limits_in(tables, str(scenario))


def render(report: AuditReport) -> str:
    """The result as text: the limits, each violation with time and coil, the notes and the verdict."""
    lines = [_limits(report.limits)]
    if not report.missing:
        lines.append(_figures(report))
    lines += [f"VIOLATION {violation}" for violation in report.violations[:_SHOWN]]
    if len(report.violations) > _SHOWN:
        lines.append(f"... and {len(report.violations) - _SHOWN} more")
    lines += [f"note: {note}" for note in report.notes]
    lines += [f"MISMATCH {sentence}" for sentence in report.mismatches]
    lines.append(_verdict(report))
    return "\n".join(lines)


def _limits(limits: AuditLimits) -> str:
    if limits.on_fraction is not None:
        return (
            "limits: continuous driver, each coil within +- full scale, "
            f"driven for {limits.on_fraction:g} of a tick; none on pulses"
        )
    pulse_s, backoff_s = (seconds_text(us / 1_000_000) for us in (limits.pulse_us, limits.backoff_us))
    return (
        f"limits: pulse <= {pulse_s} s, "
        f"back-off >= {backoff_s} s {'shared' if limits.shared else 'per coil'}, "
        f"level -{limits.max_level}..{limits.max_level}, one coil at a time"
    )


def _figures(report: AuditReport) -> str:
    if report.dipoles is not None:
        duties = ", ".join(f"{100 * duty:.2f}" for duty in report.duty_per_coil)
        return (
            f"driven in {report.dipoles.any_driven} of {report.dipoles.statuses} ticks, "
            f"duty {100 * report.duty_total:.2f} % of {seconds_text(report.span_s)} s "
            f"(coil 0, 1, 2: {duties} %)"
        )
    text = f"{len(report.pulses)} pulses (coil 0, 1, 2: {', '.join(map(str, report.pulses_per_coil))})"
    if report.max_pulse_s is not None:
        text += f", longest {seconds_text(report.max_pulse_s)} s"
    if report.min_gap_any_s is not None:
        text += f", shortest gap {seconds_text(report.min_gap_any_s)} s"
    return text + f", duty {100 * report.duty_total:.2f} % of {seconds_text(report.span_s)} s"


def _verdict(report: AuditReport) -> str:
    if report.missing:
        return "FAIL: nothing to judge"
    if report.violations:
        count = len(report.violations)
        return f"FAIL: {count} violation{'' if count == 1 else 's'} of the limits"
    faults = {
        "as far as the log goes, but its index contradicts it": not report.genuine,
        "as far as the log goes, but the files are not shown to be its run's own": bool(report.mismatches),
        "as far as the log goes, but it is incomplete": not report.complete,
        f"as far as the board reports, but {report.doubt}": bool(report.doubt),
    }
    for fault, applies in faults.items():
        if applies:
            return f"FAIL: limits kept {fault}"
    if report.not_real_time:
        why = report.not_real_time
        return f"limits kept by ticks; real time not judged: {why} (--clock ticks: by ticks alone)"
    return "OK: continuous driver within full scale" if report.limits.is_continuous else "OK: limits kept"
