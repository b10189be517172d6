"""report.html of a run: one self-contained page without scripts, the same for the same inputs."""

from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

from sim.audit.auditor import AuditReport
from sim.record import run_dir
from sim.record.estimates import Estimates
from sim.record.run_record import RunRecord
from sim.record.truth import Histories
from sim.report import tables
from sim.scenario.schema import Scenario


def write_report(
    path: Path,
    scenario: Scenario,
    summary: dict[str, Any],
    truth: Histories,
    estimates: Estimates,
    audit: AuditReport,
) -> None:
    """Write the report of a run, complete or not; ``run.json`` is read where it lies beside the report.

    Raises:
        HarnessError: that ``run.json`` is damaged.
    """
    from sim.report.sections import charts  # noqa: PLC0415 matplotlib loads when something is drawn

    run = run_dir.read_run(path.parent) if (path.parent / run_dir.RUN).is_file() else None
    sections = [
        tables.section(
            "figures", "Key figures", tables.violations(audit) + tables.key_figures(summary, audit)
        ),
        *charts(scenario, truth, estimates, audit, tables.events(summary)),
        tables.section("flown", "What was flown", tables.what_was_flown(scenario)),
    ]
    path.write_text(_page(_header(scenario, summary, run, audit), sections, run), encoding="utf-8")


def _page(header: str, sections: list[str], run: RunRecord | None) -> str:
    css = resources.files("sim.drawing").joinpath("report.css").read_text(encoding="utf-8")
    title = header[header.index("<h1>") + 4 : header.index("</h1>")]
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{title}: flight report</title>\n<style>\n{css}</style>\n</head>\n<body>\n<main>\n"
        f"{header}\n{chr(10).join(sections)}\n<footer>{tables.versions(run)}</footer>\n</main>\n</body>\n</html>\n"
    )


def _header(scenario: Scenario, summary: dict[str, Any], run: RunRecord | None, audit: AuditReport) -> str:
    facts = [f"seed {summary['seed']}"]
    if run:
        facts.append(f"bus {run['bus']}, {run['pace']}")
    facts.append(f"{summary['ticks']} ticks, {summary['sim_seconds']:.0f} s")
    if run:
        facts.append(f"torquer {run['torquer_version']}")
    return (
        f'<header><p class="over">Flight report</p><h1>{escape(scenario.name)}</h1>'
        f'<p>{escape(scenario.summary)}</p><p class="meta">{escape(" · ".join(facts))}</p>'
        f"{tables.badges(summary, run, audit)}{tables.tiles(summary)}</header>"
    )
