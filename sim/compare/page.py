"""compare.html: the laws side by side, by their table and over time."""

from collections.abc import Sequence

from sim.compare.case import Driver
from sim.compare.picture import axis_label, colour_of, laws_of, with_unit
from sim.compare.score import WINDOW_ORBITS, Result, Score
from sim.compare.table import as_table, error_text
from sim.drawing.canvas import style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Table, Tile, sections_page
from sim.drawing.time_chart import Level, Panel, Series, TimeChart, draw, time_data
from sim.report.figures.controlled import Controlled
from sim.scenario.schema import Scenario
from sim.statistics.settling import HELD_S
from sim.tuning.kept import KeptGains, gains_text

PANEL_IN = 2.8
_MEANING = (
    "Judged by the {what}. Settled: under {threshold} from then on to the end, for {held:g} s at least. RMS, "
    "max and rate over {window}; ∫ m² is the energy lost in the coils but for a factor. Best first, each aim "
    "of laws for itself."
)


_FOUND = (
    "The best gains that torquer design --laws has found in {flights} flights a law, {orbits:g} orbits each, "
    "of the rigid body in the direct dipole's field with nothing unknown. Cost: share of the flight until "
    "the error stays under 5°, and log2(1 + RMS / 5°) of the last orbit; a law that does not point is judged "
    "by its rate."
)


def compare_page(
    scenario: Scenario,
    facts: Sequence[str],
    scores: Sequence[Score],
    results: Sequence[Result],
    window: str,
    by: Controlled,
    kept: KeptGains | None = None,
) -> str:
    """The page of a comparison whose figures are over ``window``; without a flight it has no chart.

    With gains ``kept`` for the body it tells those of each law, and what they cost on the rigid body.
    """
    flights = [result for result in results if result.history is not None]
    meaning = _MEANING.format(
        what=by.words, threshold=with_unit(by.threshold, by), held=HELD_S, window=window
    )
    sections = [PageSection("scores", "The laws", meaning, (as_table(scores, by),), text=_failures(scores))]
    time = None
    if flights and flights[0].history is not None:
        first = flights[0].history
        time = time_data(first.time, first.t_s, scenario.epoch_unix_s)
        with style():
            drawn = draw(first.time, TimeChart(first.t_s, _panels(flights, by)))
            words = f"RMS of {WINDOW_ORBITS:g} orbits about each time. Grey bands are eclipses."
            charts = (chart("error", drawn.picture, words, drawn.data),)
        sections.append(PageSection("error", "The error over time", charts=charts))
    if kept is not None:
        words = _FOUND.format(flights=kept.flights, orbits=kept.orbits)
        sections.append(PageSection("gains", "The gains", words, (_gains_table(kept, scores),)))
    header = PageHeader(
        "Comparison of control laws", scenario.name, facts, _badges(scores), _tiles(scores, window, by)
    )
    return sections_page(header, sections, time)


def _gains_table(kept: KeptGains, scores: Sequence[Score]) -> Table:
    rows = []
    for score in scores:
        row = kept.rows.get(score.driver.value, {}).get(score.law)
        if row is not None:
            settled = row.get("settle_orbits")
            rows.append(
                [
                    score.law,
                    score.driver.value,
                    "never" if settled is None else f"{settled:.2f}",
                    f"{row['rms']:.3g}",
                    f"{row['cost']:.3f}",
                    f"{row['cost_before']:.3f}",
                    gains_text(row["control"]),
                ]
            )
    return Table(["law", "driver", "settled [orbits]", "RMS", "cost", "of the scenario's", "gains"], rows)


def _panels(flights: Sequence[Result], by: Controlled) -> list[Panel]:
    laws = laws_of(flights)
    panels = []
    for driver in Driver:
        series = [
            Series(score.law, history.error, colour_of(laws.index(score.law)))
            for score, history in flights
            if score.driver is driver and history is not None
        ]
        if series:
            settled = (Level(by.threshold, with_unit(by.threshold, by)),)
            title = f"{driver.value.capitalize()} coil driver"
            panels.append(Panel(title, axis_label(by), PANEL_IN, series, 3.5, settled))
    return panels


def _badges(scores: Sequence[Score]) -> list[tuple[str, str]]:
    broken = [score for score in scores if score.limits_ok is False]
    grounded = [score for score in scores if score.failure]
    badges = [("bad", f"✗ limits broken by {len(broken)}") if broken else ("good", "✓ limits kept")]
    if grounded:
        badges.append(("note", f"! {len(grounded)} did not fly"))
    return badges


def _tiles(scores: Sequence[Score], window: str, by: Controlled) -> list[Tile]:
    """The best of each driver."""
    tiles = []
    for driver in Driver:
        flown = [score for score in scores if score.driver is driver and score.error_rms is not None]
        if flown:
            best = min(flown, key=lambda score: score.error_rms or 0.0)
            rms = error_text(best.error_rms or 0.0, by.unit) + ("°" if by.unit == "deg" else f" {by.unit}")
            note = f"{rms} RMS, {window.removeprefix('the ')}"
            tiles.append(Tile(f"Best, {driver.value}", best.law, note))
    return tiles


def _failures(scores: Sequence[Score]) -> str:
    return "\n".join(f"{score.law}, {score.driver}: {score.failure}" for score in scores if score.failure)
