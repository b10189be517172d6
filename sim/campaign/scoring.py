"""What a campaign keeps of the histories of a run: its pointing indices, and its error over time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.campaign.definition.campaign import StatisticsSection
from sim.campaign.flight import RecordedFlight
from sim.report.figures.attitude_arrays import axis1_errors, errors
from sim.report.figures.estimate_error import knowledge_errors
from sim.scenario.schema import flight_table, orbit_period_s
from sim.statistics.indices import index_histories, profile

Array = NDArray[np.float64]

POINTS_AN_ORBIT = 60
MOST_POINTS = 600


@dataclass(frozen=True, slots=True)
class RunScore:
    """Figures by column; profiles of the indices and the RMS error by stretch of the run, in degrees."""

    figures: dict[str, float]
    profiles: dict[str, Array]
    error_deg: Array


def score(record: RecordedFlight, statistics: StatisticsSection) -> RunScore:
    """The score of a flight; a scenario that points axis 1 alone is judged by that."""
    scenario = record.scenario
    ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    q = record.truth["q_body_from_orbit"]
    error = axis1_errors(q) if flight_table(scenario).modes.axis_only else errors(q)
    knowledge = knowledge_errors(record.truth, record.estimates)
    counted = slice(-max(1, round(statistics.last_orbits * ticks_per_orbit)), None)
    window = max(1, round(statistics.window_s * scenario.time.tick_hz))
    histories = index_histories(np.degrees(error[counted]), np.degrees(knowledge[counted]), window)
    figures = {}
    for name, values in histories.items():
        figures[f"{name}_deg_rms"] = float(np.sqrt(np.mean(values**2)))
        figures[f"{name}_deg_max"] = float(values.max())
    profiles = {name: profile(values) for name, values in histories.items()}
    points = min(len(error), MOST_POINTS, max(2, round(POINTS_AN_ORBIT * len(error) / ticks_per_orbit)))
    return RunScore(figures, profiles, _stretches(np.degrees(np.linalg.norm(error, axis=1)), points))


def _stretches(values: Array, count: int) -> Array:
    """The root mean square of each of ``count`` stretches."""
    starts = np.linspace(0, len(values), count, endpoint=False).astype(int)
    lengths = np.diff(np.append(starts, len(values)))
    result: Array = np.sqrt(np.add.reduceat(values**2, starts) / lengths)
    return result
