"""What a campaign keeps of the histories of a run: its pointing indices, and its error over time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.campaign.definition.campaign import StatisticsSection
from sim.campaign.flight import RecordedFlight
from sim.report.figures.attitude_arrays import angle_rad, axis1_angle_rad, relative
from sim.report.figures.estimate_error import estimate_error
from sim.scenario.schema import flight_table, orbit_period_s
from sim.statistics.indices import index_histories, profile

Array = NDArray[np.float64]

POINTS_AN_ORBIT = 60
MOST_POINTS = 600
NO_ESTIMATE_RAD = np.pi
"""Counts as the error of a filter that has no estimate."""


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
    knowledge = rotation_vectors(estimate_error(record.truth, record.estimates))
    knowledge[~np.isfinite(knowledge).all(axis=1)] = (NO_ESTIMATE_RAD, 0.0, 0.0)
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


def rotation_vectors(turn: Array) -> Array:
    """Angle times axis of quaternions whose scalar part is at least 0, (n, 3), rad."""
    angle, vector = angle_rad(turn), turn[:, 1:]
    size = np.linalg.norm(vector, axis=1)
    factor = np.divide(angle, size, out=np.full_like(angle, 2.0), where=size > 0.0)
    result: Array = factor[:, None] * vector
    return result


def errors(q: Array) -> Array:
    """The turn from nominal to each attitude, (n, 3), rad, body axes."""
    return rotation_vectors(relative(np.tile((1.0, 0.0, 0.0, 0.0), (len(q), 1)), q))


def axis1_errors(q: Array) -> Array:
    """The turn from body axis 1 to the vertical, (n, 3), rad, body axes; 0 about axis 1."""
    q0, q1, q2, q3 = q.T
    across = np.stack((np.zeros_like(q0), -2.0 * (q1 * q3 + q0 * q2), 2.0 * (q1 * q2 - q0 * q3)), axis=1)
    size = np.linalg.norm(across, axis=1)
    factor = np.divide(axis1_angle_rad(q), size, out=np.zeros_like(size), where=size > 0.0)
    result: Array = factor[:, None] * across
    return result


def _stretches(values: Array, count: int) -> Array:
    """The root mean square of each of ``count`` stretches."""
    starts = np.linspace(0, len(values), count, endpoint=False).astype(int)
    lengths = np.diff(np.append(starts, len(values)))
    result: Array = np.sqrt(np.add.reduceat(values**2, starts) / lengths)
    return result
