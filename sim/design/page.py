"""design.html: the gains, how stable they are, and how far gains and inertia may be off."""

from sim.design.analysis import Analysis, PictureMaps
from sim.design.pictures import gain_figure, robustness_figure
from sim.design.render import as_text
from sim.design.theory.linear import Gains
from sim.drawing.canvas import style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Tile, sections_page
from sim.scenario.schema import Scenario


def design_page(analysis: Analysis, scenario: Scenario, maps: PictureMaps) -> str:
    """The page of an analysis."""
    with style():
        charts = (
            chart(
                "gains",
                gain_figure(analysis, maps, Gains(scenario.control.k_w, scenario.control.k_a)),
                "Degree of stability over the gains, blue is stable; the red line is where stability ends.",
            ),
            chart(
                "robustness",
                robustness_figure(analysis, maps.inertia),
                "Degree of stability of the same gains on a body whose inertia is off.",
            ),
        )
    body = analysis.body
    header = PageHeader(
        "Gains of the PD law",
        body.name,
        (f"{body.altitude_km:.0f} km", f"inclination {body.inclination_deg:.1f}°", "by Floquet theory"),
        [("good", "✓ stable") if analysis.stabilised else ("bad", "✗ not stable")],
        _tiles(analysis),
    )
    sections = [
        PageSection("pictures", "Where the gains are stable", charts=charts),
        PageSection("figures", "All figures", text=as_text(analysis, scenario)),
    ]
    return sections_page(header, sections)


def _tiles(analysis: Analysis) -> list[Tile]:
    gains, orbits = analysis.chosen.gains, analysis.settling_orbits
    return [
        Tile("k_w", f"{float(gains.k_w):.4g}", "N m s/T²"),
        Tile("k_a", f"{float(gains.k_a):.4g}", "N m/T²"),
        Tile("Degree of stability", f"{analysis.chosen.degree:+.3f}", "1/rad, negative is stable"),
        Tile("Settling", "never" if orbits is None else f"{orbits:.2f}", "orbits to 5 %"),
    ]
