"""What the script of the report draws: charts against time, attitude, track, events."""

from collections.abc import Sequence

import numpy as np

from sim.audit.auditor import AuditReport
from sim.drawing.coastline import coastlines
from sim.drawing.cuboid import sides
from sim.drawing.time_chart import packed, time_data
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.charts.ground_track import below_deg
from sim.report.charts.lines import Lines
from sim.report.charts.sections import ChartSection
from sim.report.event_words import in_words
from sim.scenario.schema import Scenario
from sim.value_types import Json


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
    continuous = scenario.coils.driver == "continuous"  # pulses are shown by their levels
    return {
        "orbit_s": flight.orbit_s,
        "t_s": packed(motion.places / flight.tick_hz),
        "q": packed(motion.samples("q_body_from_orbit").ravel()),
        "b_t": packed(motion.samples("b_body_t").ravel()),
        "m_am2": packed(motion.samples("m_body_am2").ravel() if continuous else np.zeros(0)),
        "levels_am2": list(scenario.coils.levels_am2),
        "sun": packed(motion.samples("sun_body").ravel()),
        "lit": packed(motion.samples("lit").ravel()),
        "longitude": packed(longitude),
        "latitude": packed(latitude),
        "sides": sides(np.array(scenario.body.inertia)).tolist(),
        "land": [outline.ravel().tolist() for outline in coastlines()],
    }
