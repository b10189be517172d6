"""Whether attitudes and rates that a flight software calls valid are near the truth, and if not, why.

A mistake is named where the truth, altered as the mistake alters it, is what was called valid, within
``EXPLAINS_DEG`` or the bound of a rate in 95 % of the ticks, and neither the truth nor another mistake is.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.fault_table.wrong_estimates import WRONG_DEG
from sim.record import run_dir
from sim.record.candump import whole_entries
from sim.record.estimates import Estimates
from sim.record.truth import Histories, TruthReader
from sim.report.figures.attitude_arrays import angle_rad, normal_in_body, relative, rotated
from sim.report.figures.estimate_error import estimate_error
from sim.report.observed import observed_estimates
from sim.scenario.schema import Scenario, orbit_period_s
from sim.value_types import Array

EXPLAINS_DEG = 5.0
MOST, LEAST_TICKS = 0.95, 60
PART_OF_ORBIT, PART_OF_RATE = 0.5, 0.1
"""A rate is wrong by more than this part of the orbital rate and this part of itself: less is coarse, as of
one by differences, and that of the orbit, which a rate against inertial space has too much, is more."""


class WrongAttitude(NamedTuple):
    """The longest time for which attitudes were called valid and were wrong.

    Attributes:
        longest_s: on end; a tick without an attitude ends nothing.
        worst_deg: the largest error of all that were called valid.
        limit_deg: the error from which on one is wrong.
        mistake: what explains them, in words; empty: nothing that has a name.
    """

    longest_s: float
    worst_deg: float
    limit_deg: float = WRONG_DEG
    mistake: str = ""


class WrongRate(NamedTuple):
    """The longest time for which rates beside a valid attitude were wrong.

    Attributes:
        longest_s: on end.
        worst_degps: the largest error.
        mistake: what explains them, in words; empty: nothing that has a name.
    """

    longest_s: float
    worst_degps: float
    mistake: str = ""


def wrong_attitude(path: Path, tick_hz: int, limit_deg: float, forged: bool = False) -> WrongAttitude:
    """Of the attitudes that the log of a run holds, against its histories; ``forged`` as for the answers."""
    longest = wrong = 0
    worst_deg = 0.0
    claimed, true = [], []
    for rows, estimates in _beside_truth(path, forged):
        valid = estimates.valid
        error_deg = np.degrees(angle_rad(estimate_error(rows, estimates)))[valid]
        claimed.append(estimates.q_body_from_orbit[valid])
        true.append(rows["q_body_from_orbit"][valid])
        for one in error_deg.tolist():
            wrong = wrong + 1 if one > limit_deg else 0
            longest, worst_deg = max(longest, wrong), max(worst_deg, one)
    mistake = _attitude_mistake(np.concatenate(claimed), np.concatenate(true)) if longest else ""
    return WrongAttitude(longest / tick_hz, worst_deg, limit_deg, mistake)


def wrong_rate(path: Path, scenario: Scenario, forged: bool = False) -> WrongRate | None:
    """Of NAV_RATE beside a valid attitude, against the rate relative to the orbital frame; None: none came.

    Args:
        path: the run directory.
        scenario: that was flown.
        forged: as for the answers.
    """
    claimed, true, attitude = [], [], []
    for rows, estimates in _beside_truth(path, forged):
        known = estimates.valid & ~np.isnan(estimates.omega_body_orbit_radps).any(axis=1)
        claimed.append(estimates.omega_body_orbit_radps[known])
        true.append(rows["omega_body_orbit_radps"][known])
        attitude.append(rows["q_body_from_orbit"][known])
    omega, omega_true, q = np.concatenate(claimed), np.concatenate(true), np.concatenate(attitude)
    if not len(omega):
        return None
    orbital_radps = 2.0 * np.pi / orbit_period_s(scenario)
    bound = PART_OF_ORBIT * orbital_radps + PART_OF_RATE * np.linalg.norm(omega_true, axis=1)
    error = np.linalg.norm(omega - omega_true, axis=1)
    longest = wrong = 0
    for one in (error > bound).tolist():
        wrong = wrong + 1 if one else 0
        longest = max(longest, wrong)
    q_orbit_from_body = q * np.array((1.0, -1.0, -1.0, -1.0))
    ways = {
        "its sign is wrong": -omega_true,
        "it is the rate against inertial space, with the orbit's": omega_true
        + orbital_radps * normal_in_body(q),
        "it is in the axes of the orbital frame": rotated(q_orbit_from_body, omega_true),
        "it is in deg/s": np.degrees(omega_true),
    }
    misses = {words: np.linalg.norm(omega - way, axis=1) > bound for words, way in ways.items()}
    mistake = _only(misses, error > bound) if longest else ""
    return WrongRate(longest / scenario.time.tick_hz, float(np.degrees(error.max())), mistake)


def _beside_truth(path: Path, forged: bool) -> Iterator[tuple[Histories, Estimates]]:
    """Blocks of the histories with the estimates of the same ticks."""
    first = 0
    with TruthReader(path / run_dir.TRUTH) as truth:
        entries = whole_entries(run_dir.bus_log(path))
        for estimates in observed_estimates(entries, truth.complete, forged):
            yield truth.rows(first, first + len(estimates.valid)), estimates
            first += len(estimates.valid)


def _attitude_mistake(claimed: Array, true: Array) -> str:
    """The mistake that makes the claimed attitudes of the true ones; a claimed scalar part has no sign."""
    first, last = true[:, (3, 0, 1, 2)], true[:, (1, 2, 3, 0)]
    ways = {
        "it is the conjugate, the turn from body to orbit": (true * np.array((1.0, -1.0, -1.0, -1.0)),),
        "its vector is not turned where the scalar part is negative": (_without_sign(true),),
        "the scalar part is taken for the first component of the vector": (first, _without_sign(first)),
        "the scalar part is taken for the last component of the vector": (last, _without_sign(last)),
    }
    misses = {words: np.all([_is_far(claimed, one) for one in way], axis=0) for words, way in ways.items()}
    return _only(misses, _is_far(claimed, true))


def _without_sign(q: Array) -> Array:
    return np.hstack((np.abs(q[:, :1]), q[:, 1:]))


def _is_far(claimed: Array, way: Array) -> Array:
    result: Array = angle_rad(relative(claimed, way)) > np.radians(EXPLAINS_DEG)
    return result


def _only(misses: Mapping[str, Array], truth_misses: Array) -> str:
    """The mistake that explains most ticks, where the truth does not, and no other mistake does."""
    if len(truth_misses) < LEAST_TICKS or np.mean(truth_misses) <= 1.0 - MOST:
        return ""
    explains = [words for words, far in misses.items() if np.mean(far) <= 1.0 - MOST]
    return explains[0] if len(explains) == 1 else ""
