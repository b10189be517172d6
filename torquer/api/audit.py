"""``torquer.check``: the audit of the actuator limits."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from fsw.input.schema import TableError
from sim.audit import check as audit_check
from sim.audit.findings import AuditReport
from sim.progress import shown
from sim.record.signature import PublicKey, public_key
from torquer.api.arguments import optional_path, path_text
from torquer.api.errors import one_sentence
from torquer.api.printed import PrintedResult


@dataclass(frozen=True)
class Audit(PrintedResult):
    """The audit of a log; ``print`` shows what the command prints.

    Attributes:
        report: pulses, violations and notes.
    """

    report: AuditReport

    @property
    def ok(self) -> bool:
        """The limits were kept over a complete, unaltered log that belongs to its run."""
        return not self.report.exit_code

    @property
    def violations(self) -> tuple[str, ...]:
        """The limits that were broken, a sentence each."""
        return tuple(map(str, self.report.violations))

    def __str__(self) -> str:
        return audit_check.render(self.report)


@one_sentence
def check(
    run_or_log: str | PathLike[str],
    *,
    backoff: str | None = None,
    clock: str = "both",
    channel: str | None = None,
    verify: str | PathLike[str] | None = None,
    progress: bool = False,
) -> Audit:
    """Audit the actuator limits in a run or in any candump log, as ``torquer check`` does.

    Args:
        run_or_log: a run directory, or a log.
        backoff: ``"shared"`` or ``"per_coil"``: the limits of a bare log.
        clock: ``"both"``, ticks and timestamps; ``"ticks"``: of a simulation whose ticks are not real time.
        channel: the one to read, of a log that has several.
        verify: public Ed25519 key in PEM; the run must be signed by its private half.
        progress: show on stderr how much of a large file has been read.

    Raises:
        InputError: there is no such log, or a file beside it cannot be used.
    """
    if backoff not in (None, "shared", "per_coil"):
        raise TableError(
            f"check: backoff = {backoff!r:.80} is not allowed: allowed is 'shared' or 'per_coil'"
        )
    if clock not in ("both", "ticks"):
        raise TableError(f"check: clock = {clock!r:.80} is not allowed: allowed is 'both' or 'ticks'")
    path = Path(path_text(run_or_log, "run_or_log"))
    with shown(progress):
        return Audit(audit_check.check(path, backoff, optional_key(verify), clock == "ticks", channel))


def optional_key(verify: str | PathLike[str] | None) -> PublicKey | None:
    """The public key in a file, if one is given.

    Raises:
        HarnessError: the file has none, or the package cryptography is missing.
    """
    path = optional_path(verify, "verify")
    return None if path is None else public_key(path)
