"""The error of the estimate by tick, against the plant's truth and against what the filter states."""

import numpy as np

from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import normal_in_body, relative, rotation_vectors
from sim.statistics.settling import spans
from sim.value_types import Array, Flags

CONVERGED_DEG = 2.0
CONVERGED_FOR_S = 600.0
NO_ESTIMATE_RAD = np.pi
"""Counts as the knowledge error of a filter that has no estimate."""


def estimate_error(truth: Histories, estimates: Estimates) -> Array:
    """The rotation from the estimated to the true attitude at each tick, (n, 4); NaN before the first."""
    ticks = len(truth["t_s"])
    return relative(estimates.q_body_from_orbit[:ticks], truth["q_body_from_orbit"])


def knowledge_errors(truth: Histories, estimates: Estimates) -> Array:
    """Rotation vectors from the estimated to the true attitude, (n, 3), rad, body axes."""
    knowledge = rotation_vectors(estimate_error(truth, estimates))
    knowledge[~np.isfinite(knowledge).all(axis=1)] = (NO_ESTIMATE_RAD, 0.0, 0.0)
    return knowledge


def converged_tick(error_deg: Array, tick_hz: int) -> int | None:
    """The first tick of ten minutes with a small error of the estimate; NaN, no estimate, is not small."""
    length = round(CONVERGED_FOR_S * tick_hz)
    return next((first for first, past in spans(error_deg < CONVERGED_DEG) if past - first >= length), None)


def within_3sigma(truth: Histories, estimates: Estimates) -> Flags:
    """Whether each axis of the attitude error is inside the filter's own 3 sigma, by tick, (n, 3), body axes.

    False where the error or its covariance is unknown.
    """
    ticks = len(truth["t_s"])
    error_rad = 2.0 * estimate_error(truth, estimates)[:, 1:]
    variance = np.diagonal(estimates.covariance[:ticks, :3, :3], axis1=1, axis2=2)
    result: Flags = np.abs(error_rad) < 3.0 * np.sqrt(variance)
    return result


def nees(truth: Histories, estimates: Estimates) -> Array:
    """Normalised estimation error squared of attitude and rate at each tick, e' P^-1 e.

    NaN where the estimate is unknown, and where P is singular as far as its numbers go: then rounding alone
    would decide.
    """
    ticks = len(truth["t_s"])
    turn = estimate_error(truth, estimates)
    orbit_rate = np.linalg.norm(
        estimates.omega_body_radps[:ticks] - estimates.omega_body_orbit_radps[:ticks], axis=1
    )
    omega_true = truth["omega_body_orbit_radps"] + orbit_rate[:, None] * normal_in_body(
        truth["q_body_from_orbit"]
    )
    error = np.hstack((2.0 * turn[:, 1:], omega_true - estimates.omega_body_radps[:ticks]))
    defined = np.isfinite(error).all(axis=1)
    result = np.full(ticks, np.nan)
    if defined.any():
        solved = _solved(estimates.covariance[:ticks][defined], error[defined])
        squared = np.sum(error[defined] * solved, axis=1)
        result[defined] = np.where(squared >= 0.0, squared, np.nan)
    return result


def _solved(covariance: Array, error: Array) -> Array:
    """P^-1 e of each row; NaN where P is singular."""
    try:
        whole = np.asarray(np.linalg.solve(covariance, error[:, :, None])[:, :, 0], np.float64)
    except np.linalg.LinAlgError:
        regular: Flags = np.asarray(np.isfinite(covariance).all(axis=(1, 2)))
        regular[regular] = np.linalg.matrix_rank(covariance[regular], hermitian=True) == error.shape[1]
        whole = np.full(error.shape, np.nan)
        whole[regular] = np.linalg.solve(covariance[regular], error[regular][:, :, None])[:, :, 0]
    return whole
