"""report.html of a run."""

from pathlib import Path
from typing import Any

from sim.harness.audit import AuditReport
from sim.harness.estimates import Estimates
from sim.harness.scenario import Scenario
from sim.harness.truth import Histories


def write_report(
    path: Path,
    scenario: Scenario,
    summary: dict[str, Any],
    truth: Histories,
    estimates: Estimates,
    audit: AuditReport,
) -> None:
    """Write the report."""
    path.write_text(f"<title>{scenario.name}</title>", encoding="utf-8")
