"""The motion behind a batch of samples, by least squares from many starts.

Unknown are attitude and rate at the first sample, and with their priors residual dipole, torque, inertia, the
bias of the field and the excess of each cell, taken as constant over the batch. Starts are all turns about
the first field, with rates that the field's own motion leaves open; the best of them are improved by the
method of Levenberg and Marquardt. The motion is found if no other one, that ends by ``APART`` or more away,
comes within ``LEAD`` nats of it.

Source: Marquardt 1963; batch estimators as in Crassidis and Junkins 2012, section 1.6.
"""

from typing import Any

import numpy as np

from fsw.core.algebra.vector import Vec3
from fsw.core.estimation import mekf
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.start.batch import BatchSample
from fsw.core.estimation.start.batch_model import MOVING, BatchProblem, Motions, motion, problem_of, starts

IMPROVED, STEPS = 14, 12
MOST_TURN_RAD, MOST_RATE_RADPS = 0.5, 0.005
LEAD = 8.0
APART = 0.9848
"""Cosine of half the angle, 20 deg."""
MOST_MISFIT = 3.0
"""Chi square of a found motion over its numbers, at most."""
INFLATION = 2.0
"""Of the standard deviations that are found: the equations are not linear, nor is the noise white."""


def fitted(samples: tuple[BatchSample, ...], config: MekfConfig) -> Estimate | None:
    """The estimate at the last sample; None where the samples leave more than one motion, or none fits.

    Args:
        samples: oldest first.
        config: the filter.
    """
    if config.cells is None:
        return None
    problem = problem_of(samples, config, config.cells)
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # of a motion that is absurd the cost is no number
            return _found(problem)
    except np.linalg.LinAlgError:  # the equations of damaged samples
        return None


def _found(problem: BatchProblem) -> Estimate | None:
    begun = starts(problem)
    seen = motion(problem, begun)[2]
    best = _order(_cost(problem, begun, seen))[:IMPROVED]
    improved, costs = _improved(problem, begun.chosen(best))
    ends = motion(problem, improved)[0][-1]
    order = _order(costs)
    first = order[0]
    others = [one for one in order[1:] if abs(ends[one].dot(ends[first])) < APART]
    alone = all(costs[one] - costs[first] > LEAD for one in others)
    fits = 2.0 * costs[first] <= MOST_MISFIT * np.count_nonzero(problem.weights)
    return _estimate(problem, improved.chosen(order[:1])) if alone and fits else None


def _order(costs: Matrix) -> list[int]:
    """The numbers of the motions, the cheapest first."""
    order: list[int] = np.argsort(costs, kind="stable").tolist()
    return order


def _cost(problem: BatchProblem, motions: Motions, seen: Matrix) -> Matrix:
    """Half of chi square of each motion, (n)."""
    left = _residuals(problem, motions, seen)
    known = motions.numbers[:, 3:] / problem.prior[6:]
    half: Matrix = 0.5 * ((left * left).sum(axis=(0, 2)) + (known * known).sum(axis=1))
    return half


def _residuals(problem: BatchProblem, motions: Motions, seen: Matrix) -> Matrix:
    """What is left of the samples, in their standard deviations, (m, n, 3 + c)."""
    shown = motions.numbers[:, MOVING - 3 :]
    left: Matrix = (seen + shown - problem.measured[:, None, :]) * problem.weights[:, None, :]
    return left


def _improved(problem: BatchProblem, motions: Motions) -> tuple[Motions, Matrix]:
    """The motions after ``STEPS`` of Levenberg and Marquardt, and their costs."""
    damping = np.full(len(motions.q), 1e-2)
    normal, gradient, costs = _equations(problem, motions)
    for _ in range(STEPS):
        diagonal = np.einsum("nii->ni", normal)
        damped = normal + (damping[:, None] * diagonal)[:, :, None] * np.eye(normal.shape[1])
        tried = motions.changed(_limited(_solved(damped, -gradient)))
        equations = _equations(problem, tried)
        better = equations[2] < costs
        motions = Motions(
            np.where(better[:, None], tried.q, motions.q),
            np.where(better[:, None], tried.numbers, motions.numbers),
        )
        normal = np.where(better[:, None, None], equations[0], normal)
        gradient = np.where(better[:, None], equations[1], gradient)
        costs = np.where(better, equations[2], costs)
        damping = np.where(better, 0.2 * damping, 10.0 * damping)
    return motions, costs


def _limited(steps: Matrix) -> Matrix:
    """Steps of at most ``MOST_TURN_RAD`` and ``MOST_RATE_RADPS``: the equations hold near by only."""
    turn, rate = (np.sqrt((steps[:, rows] ** 2).sum(axis=1)) for rows in (slice(0, 3), slice(3, 6)))
    most = np.maximum(np.maximum(turn / MOST_TURN_RAD, rate / MOST_RATE_RADPS), 1.0)
    limited: Matrix = steps / most[:, None]
    return limited


def _solved(normal: Matrix, right: Matrix) -> Matrix:
    """Solutions of symmetric equations, each scaled by its diagonal: their numbers have many units."""
    size = np.sqrt(np.einsum("nii->ni", normal))
    scaled = normal / (size[:, :, None] * size[:, None, :])
    solution: Matrix = np.linalg.solve(scaled, (right / size)[:, :, None])[:, :, 0] / size
    return solution


def _equations(problem: BatchProblem, motions: Motions) -> tuple[Matrix, Matrix, Matrix]:
    """Normal matrix (n, k, k), gradient (n, k) and cost (n) of each motion, k = 18 + 3 + c."""
    count, own = len(motions.q), problem.prior.size - MOVING
    seen = motion(problem, _varied(problem, motions))[2]
    here, there = seen[:, :count], np.split(seen[:, count:], MOVING, axis=1)
    columns = [(one - here) / step for one, step in zip(there, problem.differences, strict=True)]
    moving = np.stack(columns, axis=-1) * problem.weights[:, None, :, None]
    constant = np.broadcast_to(problem.weights[:, None, :, None] * np.eye(own), (*moving.shape[:3], own))
    slopes = np.concatenate((moving, constant), axis=-1)
    normal = np.einsum("mnri,mnrj->nij", slopes, slopes, optimize=True)
    gradient = np.einsum("mnri,mnr->ni", slopes, _residuals(problem, motions, here), optimize=True)
    precision = problem.prior**-2.0
    gradient[:, 6:] += motions.numbers[:, 3:] * precision[6:]
    return normal + np.diag(precision), gradient, _cost(problem, motions, here)


def _varied(problem: BatchProblem, motions: Motions) -> Motions:
    """The motions, and behind them 18 times as many, each with one of the differences."""
    shape = (len(motions.q), 3 + motions.numbers.shape[1])
    varied = [motions]
    for index, difference in enumerate(problem.differences):
        step = np.zeros(shape)
        step[:, index] = difference
        varied.append(motions.changed(step))
    return Motions(*(np.concatenate([one[part] for one in varied]) for part in (0, 1)))


def _estimate(problem: BatchProblem, found: Motions) -> Estimate:
    """The estimate at the last sample, with what the fit has found of the parameters and left of all."""
    config, (normal, _, _) = problem.config, _equations(problem, found)
    size = np.sqrt(normal[0].diagonal())
    left = INFLATION**2 * np.linalg.inv(normal[0] / np.outer(size, size)) / np.outer(size, size)
    attitudes, rates, _ = motion(problem, _varied(problem, found))
    q, rate, numbers = attitudes[-1, 0], rates[-1, 0], found.numbers[0]
    flow = np.eye(len(left))
    moved = np.hstack((2.0 * _difference(q, attitudes[-1, 1:]), rates[-1, 1:] - rate))
    flow[0:6, 0:MOVING] = moved.T / problem.differences
    left = flow.dot(left).dot(flow.T)
    begun = mekf.start(_four(q), _three(rate), config)
    covariance, parameters = config.initial_covariance.copy(), begun.parameters
    parts, places = config.layout, list(range(6))
    kept = list(range(6))
    for name, place, first in (
        ("dipole_body_am2", parts.dipole, 6),
        ("torque_body_nm", parts.torque, 9),
        ("inertia_error_kgm2", parts.inertia, 12),
        ("mag_bias_t", parts.mag_bias, MOVING),
    ):
        if place is not None:
            own = range(first, first + place.stop - place.start)
            kept, places = [*kept, *own], [*places, *range(place.start, place.stop)]
            value: dict[str, Any] = {name: tuple(numbers[[number - 3 for number in own]].tolist())}
            parameters = parameters._replace(**value)
    covariance[np.ix_(places, places)] = left[np.ix_(kept, kept)]
    if parts.sun_turn is not None:
        covariance[0:3, 0:3] += config.initial_covariance[parts.sun_turn, parts.sun_turn]
    return begun._replace(parameters=parameters, covariance=0.5 * (covariance + covariance.T))


def _difference(q: Matrix, others: Matrix) -> Matrix:
    """The vector part of q^-1 (x) q_other by rows, of near attitudes."""
    scalar, vector = others[:, :1], others[:, 1:]
    product: Matrix = q[0] * vector - scalar * q[1:] - np.cross(q[1:], vector)
    return product


def _three(v: Matrix) -> Vec3:
    x, y, z = v.tolist()
    return (x, y, z)


def _four(q: Matrix) -> tuple[float, float, float, float]:
    a, b, c, d = q.tolist()
    return (a, b, c, d)
