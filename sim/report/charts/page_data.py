"""What the script of the report draws: charts against time, attitude, track, events."""

from collections.abc import Sequence

import numpy as np

from sim.audit.auditor import AuditReport
from sim.drawing.coastline import coastlines
from sim.drawing.time_chart import packed, time_data
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.charts.ground_track import below_deg
from sim.report.charts.lines import Lines
from sim.report.charts.sections import ChartSection
from sim.report.event_words import in_words
from sim.scenario.schema import Scenario
from sim.value_types import Array, Json

LEAST_SIDE = 0.3
"""Shortest side of the body as it is drawn, relative to its longest."""


def page_data(
    scenario: Scenario, summary: Json, lines: Lines, audit: AuditReport, sections: Sequence[ChartSection]
) -> Json | None:
    """The data of a flight; None for one without a tick."""
    if lines.ticks == 0:
        return None
    flight = DrawnFlight.of(scenario, lines, audit)
    events = [in_words(one) for one in summary.get("events", [])]
    return {
        "time": time_data(flight.time, flight.t_s, flight.start_unix_s),
        "charts": {chart.name: chart.data for section in sections for chart in section.charts if chart.data},
        "events": [{"t_s": one.t_s, "severity": one.severity} for one in events],
        "motion": _motion(scenario, flight),
    }


def _motion(scenario: Scenario, flight: DrawnFlight) -> Json:
    motion = flight.lines.motion
    longitude, latitude = below_deg(flight)
    return {
        "orbit_s": flight.orbit_s,
        "t_s": packed(motion.places / flight.tick_hz),
        "q": packed(motion.samples("q_body_from_orbit").ravel()),
        "b_t": packed(motion.samples("b_body_t").ravel()),
        "sun": packed(motion.samples("sun_body").ravel()),
        "lit": packed(motion.samples("lit").ravel()),
        "longitude": packed(longitude),
        "latitude": packed(latitude),
        "sides": sides(np.array(scenario.body.inertia)).tolist(),
        "land": [outline.ravel().tolist() for outline in coastlines()],
    }


def sides(inertia_kgm2: Array) -> Array:
    """The sides of a cuboid of uniform density with these moments of inertia, the longest 1, (3,).

    J_1 = m (a_2^2 + a_3^2) / 12 and so on, thus a_1^2 ~ J_2 + J_3 - J_1; none is drawn very short.
    """
    moments = np.diag(inertia_kgm2)
    squares = np.maximum(moments.sum() - 2.0 * moments, 0.0)
    result: Array = np.maximum(np.sqrt(squares / squares.max()), LEAST_SIDE).round(3)
    return result
