"""How honest the filter of a flight is, and how well the satellite points: what a population is judged by."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from fsw.wire.messages import Mode
from sim.campaign.flight import Figures
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import angle_rad, law_attitude
from sim.report.figures.estimate_error import converged_tick, estimate_error, nees, within_3sigma
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.statistics.settling import settled_tick, spans
from sim.value_types import Array

POINTED_DEG = 10.0
LAST_ORBITS = 3.0
WRONG_DEG = (5.0, 10.0)


def consistency_figures(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """What differs from the onboard table, how honest the filter is, and how well the satellite points.

    ``inside_1``, ``_2``, ``_3``: fraction of the ticks after convergence, attitude valid, with the error
    about that body axis inside 3 sigma; ``estimate_deg``: RMS of the error in them; ``nees``: mean over all
    ticks after convergence. The same with ``point_`` before the name: from the first tick in POINT on,
    whatever modes follow. ``wrong_5deg_s`` and ``wrong_10deg_s``: longest time of the whole flight valid with
    a larger error. ``pointing_deg``: RMS over the last orbits; ``pointed_orbits``: when it has settled
    under 10 deg, for the last orbit at least, infinite if never; ``in_point``: 1 if the flight ends in POINT.
    """
    tick_hz, ticks = scenario.time.tick_hz, len(truth["t_s"])
    orbit_ticks = orbit_period_s(scenario) * tick_hz
    pointing_deg = np.degrees(angle_rad(law_attitude(truth["q_body_from_orbit"], scenario.body.law_axes)))
    error_deg = np.degrees(angle_rad(estimate_error(truth, estimates)))
    valid = estimates.valid[:ticks]
    in_point = estimates.mode[:ticks] == Mode.POINT
    starts = {"": converged_tick(error_deg, tick_hz), "point_": _first(in_point)}
    inside, consistency = within_3sigma(truth, estimates), nees(truth, estimates)
    pointed = settled_tick(pointing_deg < POINTED_DEG, tick_hz, orbit_period_s(scenario))
    return {
        **_differences(scenario),
        **{
            f"{prefix}{name}": value
            for prefix, first in starts.items()
            for name, value in _consistency(error_deg, valid, inside, consistency, first).items()
        },
        **{f"wrong_{most:g}deg_s": _longest(valid & (error_deg > most)) / tick_hz for most in WRONG_DEG},
        "pointing_deg": _rms(pointing_deg[-round(LAST_ORBITS * orbit_ticks) :]),
        "pointed_orbits": inf if pointed is None else pointed / orbit_ticks,
        "in_point": float(in_point[-1]),
    }


def _differences(scenario: Scenario) -> Figures:
    """Dipole, largest error of a moment of inertia, and the misalignments of both sensors together."""
    nominal, true = np.array(flight_table(scenario).body.inertia), np.array(scenario.body.inertia)
    sensors = scenario.sensors
    turns_deg = (sensors.magnetometer.misalignment_deg, sensors.sun.misalignment_deg)
    return {
        "dipole_am2": float(np.linalg.norm(scenario.disturbance.residual_dipole_am2)),
        "inertia_percent": 100.0 * float(np.abs(np.diagonal(true) / np.diagonal(nominal) - 1.0).max()),
        "misalignment_deg": float(sum(np.linalg.norm(turn) for turn in turns_deg)),
    }


def _consistency(
    error_deg: Array,
    valid: NDArray[np.bool_],
    inside: NDArray[np.bool_],
    consistency: Array,
    first: int | None,
) -> Figures:
    """The figures from tick ``first`` on; a flight that never gets there is not honest."""
    if first is None or not valid[first:].any():
        return {"inside_1": 0.0, "inside_2": 0.0, "inside_3": 0.0, "estimate_deg": inf, "nees": inf}
    counted, known = valid[first:], np.isfinite(consistency[first:])
    parts = inside[first:][counted].mean(axis=0)
    return {
        **{f"inside_{axis}": float(part) for axis, part in enumerate(parts, start=1)},
        "estimate_deg": _rms(error_deg[first:][counted]),
        "nees": float(consistency[first:][known].mean()) if known.any() else inf,
    }


def _first(holds: NDArray[np.bool_]) -> int | None:
    return int(holds.argmax()) if holds.any() else None


def _longest(holds: NDArray[np.bool_]) -> int:
    return max((past - first for first, past in spans(holds)), default=0)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
