"""report.html of a run: one self-contained page, the same for the same inputs."""

from math import degrees
from pathlib import Path
from typing import Any

from fsw.core.estimation.parameters import COMPONENTS
from fsw.wire.messages import Component, Mode
from sim.audit.auditor import AuditReport
from sim.drawing.page_parts import Table, Tile
from sim.drawing.pages import page
from sim.flight.second_senders import describe_senders
from sim.record import run_dir
from sim.record.run_record import RunRecord
from sim.record.whole_file import replace_text
from sim.report import tables
from sim.report.charts.lines import Lines
from sim.report.event_words import event_table
from sim.report.requirements.judge import Outcome
from sim.report.summary import last_orbit
from sim.report.tables import has, value
from sim.scenario.schema import Scenario
from sim.value_types import Json

# --- What the report says first: whether the requirements are met and why not, badges, the few main figures

Badge = tuple[str, str]
"""A class of style, and the words."""

_TICK, _CROSS = "✓ ", "✗ "
_ESTIMATE = ("Attitude estimate", ("estimate_deg", "rms_sunlit"), "{:.3f}°", "RMS in sunlight")
_COILS = (
    ("Duty", ("duty", "total"), "{:.2%}", "all coils, whole flight"),
    ("Pulses", ("pulses", "total"), "{:d}", "of all coils"),
)


def headline(summary: Json) -> Badge:
    """Whether the flight meets its requirements, in a sentence."""
    found = summary["requirements"]
    failed = [one for one in found if one["verdict"] == Outcome.FAILED]
    unjudged = [one for one in found if one["verdict"] == Outcome.NOT_JUDGED]
    if not found:
        return "note", "Not judged: the scenario has no requirements."
    if failed:
        several = f"{len(failed)} of {len(found)} requirements missed"
        return "bad", f"{several if len(failed) > 1 else 'Requirement missed'}: {failed[0]['text']}."
    if unjudged:
        return "note", f"Not judged: {unjudged[0]['text']}."
    return "good", f"Requirements met: all {len(found)}." if len(found) > 1 else f"Met: {found[0]['text']}."


def requirement_table(summary: Json) -> Table:
    """A row per requirement, with the causes of one that is missed."""
    rows = [
        (
            one["verdict"],
            one["text"],
            "; ".join(reason["text"] for reason in one["reasons"]).replace("m^2", "m²"),
        )
        for one in summary["requirements"]
    ]
    return Table(("verdict", "requirement", "why"), rows)


def diagnosis_table(summary: Json) -> Table:
    """What limits the pointing, if anything does, and a row for each thing that may; none of an older run."""
    found = summary.get("diagnosis", {"findings": {}, "reasons": []})
    rows = [("why not settled", reason["text"]) for reason in found["reasons"]]
    rows += found["findings"].items()
    return Table(("", "what the flight shows"), [(name, text.replace("m^2", "m²")) for name, text in rows])


def badges(summary: Json, run: RunRecord | None, audit: AuditReport) -> list[Badge]:
    """The verdicts: requirements, limits, refusals, replay, mode, isolation, completeness.

    A good one is green only in a flight that meets its requirements, all of which were judged.
    """
    kind, words = headline(summary)
    sign = {"good": _TICK, "bad": _CROSS, "note": "! "}[kind]
    shown = [_limits_badge(audit)]
    refused = summary["pulses"]["refused"]
    shown.append(("note", f"! {refused} refused") if refused else ("good", f"{_TICK}no refusals"))
    shown.append(_replay_badge(summary.get("replay")))
    mode = summary.get("mode_final")
    if mode is not None:
        shown.append(("good" if mode == Mode.POINT.name else "note", f"mode {mode}"))
    if summary["isolated"]:
        shown.append(("note", f"! isolated: {', '.join(summary['isolated'])}"))
    if not whole(run, audit):
        planned = f" of {run['ticks']}" if run else ""
        shown.append(("bad", f"{_CROSS}incomplete: {summary['ticks']}{planned} ticks"))
    if summary.get("second_senders"):
        shown.append(("bad", f"{_CROSS}{describe_senders(summary['second_senders'])}"))
    if kind != "good":
        shown = [
            ("plain", text.removeprefix(_TICK)) if good == "good" else (good, text) for good, text in shown
        ]
    return [(kind, sign + words.partition(":")[0].lower()), *shown]


def whole(run: RunRecord | None, audit: AuditReport) -> bool:
    """The flight ran to its end, and its log is whole."""
    return audit.complete and (run is None or "flown" in run)


def tiles(summary: Json) -> list[Tile]:
    """The few figures that are looked at first; of the attitude, what is controlled."""
    rows = [*_controlled(summary), _ESTIMATE, *_COILS]
    return [
        Tile(name, value(summary, keys, pattern), note)
        for name, keys, pattern, note in rows
        if has(summary, keys)
    ]


def _controlled(summary: Json) -> list[tuple[str, tuple[str, ...], str, str]]:
    if "controlled" not in summary:
        return []
    found, note = summary["controlled"], f"RMS, {last_orbit(summary).removeprefix('the ')}"
    axis1 = ("Axis 1 from vertical", ("axis1_deg", "rms_last_orbit"), "{:.2f}°", note)
    settling = (
        "Settled",
        ("controlled", "settle_orbits"),
        "{:.2f}",
        f"orbits to {found['words']} under {found['threshold']:g} {found['unit']}",
    )
    first = {
        "attitude": [("Pointing", ("pointing_deg", "rms_last_orbit"), "{:.2f}°", note), axis1],
        "axis": [axis1],
        "rate": [("Rate", ("controlled", "rms_last_orbit"), "{:.4f} °/s", note)],
    }
    spin = ("Spin", ("spin_radps", "mean_last_orbit"), "{:.5f}", "rad/s, mean")
    return [*first[found["what"]], spin, settling]


def _limits_badge(audit: AuditReport) -> Badge:
    if audit.ok:
        return "good", f"{_TICK}limits kept"
    if not audit.violations:
        return "note", "! limits not judged: no coil status"
    return "bad", f"{_CROSS}limits broken: {len(audit.violations)}"


def _replay_badge(replay: Json | None) -> Badge:
    if replay is None:
        return "note", "not replayed"
    if replay["bit_exact"]:
        return "good", f"{_TICK}replay bit-exact"
    if replay["command_exact"]:
        return "note", "! replay command-exact only"
    return "bad", f"{_CROSS}replay differs"


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
        headline=headline(summary),
        badges=badges(summary, run, audit),
        tiles=tiles(summary),
        diagnosis=diagnosis_table(summary),
        requirements=requirement_table(summary),
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
