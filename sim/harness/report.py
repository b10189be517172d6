"""report.html of a run: one self-contained page without scripts, the same for the same inputs."""

from collections.abc import Callable
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from sim.harness import report_tables as tables
from sim.harness import run_dir
from sim.harness.audit import AuditReport
from sim.harness.estimates import Estimates
from sim.harness.scenario import Scenario
from sim.harness.truth import Histories

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sim.harness.report_flown import Flown


class Chart(NamedTuple):
    """A chart and the words under it."""

    draw: Callable[["Flown"], "Figure"]
    caption: str


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
    run = run_dir.read_run(path.parent) if (path.parent / run_dir.RUN).is_file() else {}
    sections = [
        _section("figures", "Key figures", tables.violations(audit) + tables.key_figures(summary, audit)),
        *_charts(scenario, truth, estimates, audit, tables.events(summary)),
        _section("flown", "What was flown", tables.what_was_flown(scenario)),
    ]
    path.write_text(_page(_header(scenario, summary, run, audit), sections, run), encoding="utf-8")


def _page(header: str, sections: list[str], run: dict[str, Any]) -> str:
    css = resources.files("sim.harness").joinpath("report.css").read_text(encoding="utf-8")
    title = header[header.index("<h1>") + 4 : header.index("</h1>")]
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{title}: flight report</title>\n<style>\n{css}</style>\n</head>\n<body>\n<main>\n"
        f"{header}\n{chr(10).join(sections)}\n<footer>{tables.versions(run)}</footer>\n</main>\n</body>\n</html>\n"
    )


def _header(scenario: Scenario, summary: dict[str, Any], run: dict[str, Any], audit: AuditReport) -> str:
    facts = [f"seed {summary['seed']}"]
    if "bus" in run:
        facts.append(f"bus {run['bus']}, {run['pace']}")
    facts.append(f"{summary['ticks']} ticks, {summary['sim_seconds']:.0f} s")
    if "torquer_version" in run:
        facts.append(f"torquer {run['torquer_version']}")
    return (
        f'<header><p class="over">Flight report</p><h1>{escape(scenario.name)}</h1>'
        f'<p>{escape(scenario.summary)}</p><p class="meta">{escape(" · ".join(facts))}</p>'
        f"{tables.badges(summary, run, audit)}{tables.tiles(summary)}</header>"
    )


def _section(anchor: str, title: str, content: str) -> str:
    return f'<section id="{anchor}"><h2>{title}</h2>{content}</section>'


def _charts(
    scenario: Scenario, truth: Histories, estimates: Estimates, audit: AuditReport, events: str
) -> list[str]:
    """All sections with charts; matplotlib is imported here, for only who draws should wait for it."""
    from sim.harness import report_charts as charts
    from sim.harness import report_coils as coils
    from sim.harness.report_canvas import style, svg
    from sim.harness.report_flown import Flown

    if len(truth["t_s"]) == 0:
        return [
            _section("attitude", "Flight", "<p>No tick was flown: there is nothing to draw.</p>" + events)
        ]
    flown = Flown.of(scenario, truth, estimates, audit)

    def drawn(anchor: str, title: str, *shown: Chart, after: str = "") -> str:
        parts = []
        for chart in shown:
            name = chart.draw.__name__
            graphic = svg(chart.draw(flown), name)
            parts.append(
                f'<figure id="{name}"><div class="scroll" tabindex="0" role="img" '
                f'aria-label="{escape(chart.caption)}">{graphic}</div>'
                f"<figcaption>{escape(chart.caption)}</figcaption></figure>"
            )
        return _section(anchor, title, "".join(parts) + after)

    with style():
        return [
            drawn(
                "attitude",
                "Attitude",
                Chart(charts.pointing, _POINTING),
                Chart(charts.modes, "The controller's modes."),
                Chart(charts.rates, _RATES),
                after=events,
            ),
            drawn("knowledge", "Estimate", Chart(charts.estimate, _ESTIMATE))
            if flown.has_estimates
            else _section("knowledge", "Estimate", f"<p>{_NO_ESTIMATE[scenario.knowledge]}</p>"),
            drawn(
                "coils",
                "Coils against their limits",
                Chart(coils.raster, _RASTER),
                Chart(coils.zoom, _zoom_caption(audit)),
                Chart(
                    coils.duty,
                    "Fraction of the orbit before each time, or of the flight so far, with a coil driven.",
                ),
                Chart(
                    coils.gaps_and_levels, "Gaps from the end of a pulse to the next start; levels by coil."
                ),
            ),
            drawn(
                "environment",
                "Field, dipole and torques",
                Chart(charts.field_and_dipole, "Plant's truth; coil c drives along body axis c + 1."),
                Chart(
                    charts.torques,
                    "Magnitudes, plant's truth. Coils act in pulses: theirs is the running mean.",
                ),
            ),
        ]


def _zoom_caption(audit: AuditReport) -> str:
    limits = audit.limits
    whom = "all coils" if limits.shared else "that coil"
    return (
        f"Length of each pulse, at most {limits.pulse_us / 1e6:g} s. Orange: back-off of {limits.backoff_us / 1e6:g} s "
        f"from the end of a pulse, in which no pulse of {whom} may start."
    )


_POINTING = (
    "True angle from the nominal attitude, and of body axis 1 from the local vertical. Bands in this and all other "
    "charts are eclipses. A long history is drawn as the span between its least and largest values."
)
_RATES = (
    "True rate of the body relative to the orbital frame: components, and magnitude on a logarithmic scale."
)
_ESTIMATE = (
    "True error of the estimate, magnitude of three axes, and three times the standard deviation that the filter "
    "states for it, 3 √tr P: the error should stay under it."
)
_RASTER = (
    "A lane for each coil; bars go up or down with the polarity and reach as far as the level. "
    "A bar is drawn wider than its pulse lasts."
)
_NO_ESTIMATE = {
    "perfect": "Flown with perfect knowledge: the controller was told the plant's attitude and rate.",
    "filter": "The filter gave no estimate in this flight.",
}
