"""report.html of a run: one self-contained page, the same for the same inputs."""

from math import degrees
from pathlib import Path
from typing import Any

from fsw.core.estimation.parameters import COMPONENTS
from fsw.wire.messages import Component
from sim.audit.auditor import AuditReport
from sim.drawing.page_parts import Table
from sim.drawing.pages import page
from sim.record import run_dir
from sim.record.run_record import RunRecord
from sim.record.whole_file import replace_text
from sim.report import headline, tables
from sim.report.charts.lines import Lines
from sim.report.event_words import event_table
from sim.scenario.schema import Scenario
from sim.value_types import Json

# --- The table of the report that shows what the filter estimates besides attitude and rate


UNITS = {
    "mag_bias_t": ("nT", 1e9),
    "torque_body_nm": ("N m", 1.0),
    "dipole_body_am2": ("A m²", 1.0),
    "coil_error": ("%", 100.0),
    "inertia_error_kgm2": ("kg m²", 1.0),
    "mag_turn_rad": ("°", degrees(1.0)),
    "mag_scale": ("%", 100.0),
    "sun_turn_rad": ("°", degrees(1.0)),
    "delay_s": ("s", 1.0),
    "cell_excess": ("%", 100.0),
    "cell_gain": ("%", 100.0),
    "earth_light": ("%", 100.0),
}
"""The unit in which the page shows a parameter, and how many of these are one of SI."""


def parameter_table(summary: Json) -> Table:
    """Estimates, bounds and truth in readable units, a row per component, named as on the bus."""
    figures = summary.get("parameters", {})
    rows = []
    for component, (name, offset) in zip(Component, COMPONENTS, strict=True):
        if name in figures:
            unit, factor = UNITS[name]
            columns = [figures[name].get(key) for key in ("bound", "value", "sigma", "truth")]
            cells = ["–" if column is None else f"{factor * column[offset]:.4g}" for column in columns]
            rows.append((component.name.lower(), unit, *cells))
    return Table(("", "unit", "bound", "estimate at the end", "sigma", "truth"), rows)


# --- The page

SCRIPTS = ("script/attitude.js", "script/track.js", "script/events.js")


def write_report(
    path: Path,
    scenario: Scenario,
    summary: dict[str, Any],
    lines: Lines,
    audit: AuditReport,
) -> None:
    """Write the report of a run, complete or not; ``run.json`` is read where it lies beside the report.

    Raises:
        HarnessError: that ``run.json`` is damaged.
    """
    from sim.report.charts.page_data import page_data  # noqa: PLC0415 as the sections
    from sim.report.charts.sections import sections  # noqa: PLC0415 matplotlib loads when something is drawn

    run = run_dir.read_run(path.parent) if (path.parent / run_dir.RUN).is_file() else None
    events = event_table(summary, scenario)
    charts = sections(scenario, lines, audit)
    html = page(
        "sim.report",
        "report.html",
        data=page_data(scenario, summary, lines, audit, charts),
        scripts=SCRIPTS,
        name=scenario.name,
        about=scenario.summary,
        facts=_facts(summary, run),
        headline=headline.headline(summary),
        badges=headline.badges(summary, run, audit),
        tiles=headline.tiles(summary),
        diagnosis=headline.diagnosis_table(summary),
        requirements=headline.requirement_table(summary),
        violations=tables.violations(audit),
        violations_left_out=max(0, len(audit.violations) - tables.VIOLATIONS_SHOWN),
        notes=audit.notes,
        key_figures=tables.key_figures(summary),
        coils=tables.coil_table(summary, audit),
        longest_pulse=tables.longest_pulse(summary, audit),
        charts=charts,
        moves=lines.ticks > 0,
        parameters=parameter_table(summary),
        events=events,
        event_count=summary.get("event_count", len(events.rows)),
        events_open=len(events.rows) <= tables.EVENTS_OPEN,
        scenario=tables.scenario_in_words(scenario),
        scenario_toml=tables.scenario_toml(scenario),
        versions=tables.versions(run),
    )
    replace_text(path, html)


def _facts(summary: dict[str, Any], run: RunRecord | None) -> list[str]:
    facts = [f"seed {summary['seed']}"]
    if run:
        facts.append(f"bus {run['bus']}, {run['pace']}")
    facts.append(f"{summary['ticks']} ticks, {summary['sim_seconds']:.0f} s")
    if run:
        facts.append(f"torquer {run['torquer_version']}")
    return facts
