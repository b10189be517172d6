"""The equations of motions and samples, and what follows from them: a step that improves, an estimate.

Numbers of a motion: attitude, rate, residual dipole, torque, inertia, bias of the field, excess and gain of
each of c cells, light of the Earth, k = 18 + 3 + 2 c + 1. With z the samples, h(x) what the motion x should
show, H its derivative, R and P the covariances of samples and priors,

    N = H^T R^-1 H + P^-1,  g = H^T R^-1 (h(x) - z) + P^-1 x,

and the least-squares step is N dx = -g. H is by differences where the motion, which is known only by its
equation, depends on the number.

What the cells are wrong by makes the attitude wrong, and is still there after the start. So the filter begins
with what the samples tell of it, and with the covariance of it and the attitude: if it took them for
independent, the next tick would count the same errors once more, as if they were new ones.
"""

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from fsw.core.algebra.quaternion import from_small_rotation, multiply, normalise
from fsw.core.algebra.vector import Vec3, add, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.dynamics.error_dynamics import free_acceleration, with_age_along
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.start.batch_model import (
    MOVING,
    BatchModel,
    Motions,
    Shown,
    constant_slopes,
    measured,
)
from fsw.core.estimation.start.batch_sample import BatchSample
from fsw.core.estimation.start.motions import turned_by

MOST_TURN_RAD, MOST_RATE_RADPS = 0.5, 0.005
INFLATION = 2.0
"""Factor on the standard deviations found: the equations are not linear, nor is the noise white."""


@final
@dataclass(frozen=True, slots=True)
class Equations:
    """By motion: N, (n, k, k), g, (n, k), half of chi square, and how many numbers were measured, (n)."""

    normal: Matrix
    gradient: Matrix
    costs: Matrix
    measured: Matrix


def at_priors(motions: Motions, model: BatchModel, going: int) -> Equations:
    """The equations of the priors alone; N and g are empty where no motion is varied.

    Args:
        motions: n of them.
        model: what the table says.
        going: how many go through the samples: n, or 19 n with the varied ones.
    """
    count = len(motions.q)
    size = model.prior.size if going > count else 0
    precision = model.prior**-2.0
    own = motions.numbers[:, 3:]
    gradient = np.hstack((np.zeros((count, 6)), own * precision[6:]))[:, :size]
    known = own / model.prior[6:]
    costs = 0.5 * (known * known).sum(axis=1)
    normal = np.tile(np.diag(precision[:size]), (count, 1, 1))
    return Equations(normal, gradient, costs, np.zeros(count))


def add_sample(
    equations: Equations, motions: Motions, seen: Shown, sample: BatchSample, model: BatchModel
) -> Equations:
    """The equations with one more sample.

    Args:
        equations: before.
        motions: n of them.
        seen: what they should show, followed by what the varied ones should, n or 19 n.
        sample: what was measured.
        model: what the table says.
    """
    count = len(motions.q)
    values, weights = measured(sample, model)
    here = seen.values[:count]
    left = (here - values) * weights
    costs = equations.costs + 0.5 * (left * left).sum(axis=1)
    numbers = equations.measured + np.count_nonzero(weights)
    if len(seen.values) == count:
        return Equations(equations.normal, equations.gradient, costs, numbers)
    there = seen.values[count:].reshape(MOVING, count, -1)
    moving = ((there - here) / model.differences[:, None, None]).transpose(1, 2, 0) * weights[:, None]
    constant = constant_slopes(seen, count) * weights[:, None]
    slopes = np.concatenate((moving, constant), axis=2)
    across = slopes.transpose(0, 2, 1)
    normal = equations.normal + across @ slopes
    gradient = equations.gradient + (across @ left[:, :, None])[:, :, 0]
    return Equations(normal, gradient, costs, numbers)


def improving_step(equations: Equations, damping: Matrix) -> Matrix:
    """The Levenberg-Marquardt step of the numbers, (n, k), limited in attitude and rate."""
    normal = equations.normal
    diagonal = np.einsum("nii->ni", normal)
    damped = normal + (damping[:, None] * diagonal)[:, :, None] * np.eye(normal.shape[1])
    return _limited(_solved(damped, -equations.gradient))


def _limited(steps: Matrix) -> Matrix:
    """Steps of at most ``MOST_TURN_RAD`` and ``MOST_RATE_RADPS``: the equations hold only nearby."""
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


def estimate_of(
    found: Motions, equations: Equations, q: Matrix, omega: Matrix, model: BatchModel
) -> tuple[Estimate | None, float]:
    """The estimate at the point a motion has reached, None if it is unsound; and half of chi square there.

    Samples that came after the motion was found change it by one more step.

    Args:
        found: the motion.
        equations: of it.
        q: its attitude, followed by those with one of its numbers varied, (19, 4).
        omega: rates, (19, 3).
        model: what the table says.
    """
    normal, gradient = equations.normal[0], equations.gradient[0]
    step = _solved(equations.normal, -equations.gradient)[0]
    size = np.sqrt(normal.diagonal())
    left = INFLATION**2 * np.linalg.inv(normal / np.outer(size, size)) / np.outer(size, size)
    flow = np.eye(len(left))
    moved = np.hstack((2.0 * _difference(q[0], q[1:]), omega[1:] - omega[0]))
    flow[0:6, 0:MOVING] = moved.T / model.differences
    change = flow.dot(step)
    attitude = turned_by(q[:1], change[None, 0:3])[0]
    estimate = mekf.start(_four(attitude), _three(omega[0] + change[3:6]), model.config)
    _set_parameters(estimate, found.numbers[0] + step[3:], flow.dot(left).dot(flow.T), model)
    _add_age(estimate, model.config)
    cost = float(equations.costs[0] + 0.5 * gradient.dot(step))
    return (estimate if mekf.healthy(estimate) else None), cost


def _set_parameters(estimate: Estimate, numbers: Matrix, left: Matrix, model: BatchModel) -> None:
    """Set the parameters to those that were found, and the covariance to what is left of all."""
    config = model.config
    covariance, parameters = config.initial_covariance.copy(), estimate.parameters
    places, kept = list(range(6)), list(range(6))
    for name, place, own in _found(model):
        if place is not None:
            after = list(getattr(parameters, name))
            after[: len(own)] = numbers[[number - 3 for number in own]].tolist()
            value: dict[str, Any] = {name: tuple(after)}
            parameters = replace(parameters, **value)
            kept, places = [*kept, *own], [*places, *range(place.start, place.start + len(own))]
    covariance[np.ix_(places, places)] = left[np.ix_(kept, kept)]
    if (turn := config.layout.sun_turn) is not None:
        covariance[0:3, 0:3] += config.initial_covariance[turn, turn]
    if (excess := config.layout.cells) is not None:
        now = range(excess.start, excess.start + len(model.normals))
        covariance[now, now] += model.excess_varying**2
    estimate.parameters, estimate.covariance = parameters, 0.5 * (covariance + covariance.T)


def _add_age(estimate: Estimate, config: MekfConfig) -> None:
    """Set the estimate ahead by the age of the samples, which the equations leave out, and as uncertain.

    Both ages are taken as their mean: what that is wrong by is an error along the motion, of which no sample
    tells (``with_age_along``).
    """
    q, omega, parameters = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    delay = config.layout.delay
    if delay is None:
        return
    of_field, of_sun = parameters.delay_s
    age_s, acceleration = 0.5 * (of_field + of_sun), free_acceleration(omega, parameters, config.rotor)
    estimate.q_body_from_eci = normalise(multiply(q, from_small_rotation(scale(age_s, omega))))
    estimate.omega_body_radps = add(omega, scale(age_s, acceleration))
    estimate.covariance = with_age_along((omega, acceleration), estimate.covariance, delay)


def _found(model: BatchModel) -> tuple[tuple[str, slice | None, range], ...]:
    """Names and places of the parameters that are found, and the numbers of a motion that they are."""
    parts, cells = model.config.layout, len(model.normals)
    excess = MOVING + 3
    gain, light = excess + cells, excess + 2 * cells
    return (
        ("dipole_body_am2", parts.dipole, range(6, 9)),
        ("torque_body_nm", parts.torque, range(9, 12)),
        ("inertia_error_kgm2", parts.inertia, range(12, MOVING)),
        ("mag_bias_t", parts.mag_bias, range(MOVING, excess)),
        ("cell_excess", parts.cells, range(excess, gain)),
        ("cell_gain", parts.cell_gain, range(gain, light)),
        ("earth_light", parts.earth_light, range(light, light + 1)),
    )


def _difference(q: Matrix, others: Matrix) -> Matrix:
    """The vector part of q^-1 (x) q_other by rows, of nearby attitudes."""
    scalar, vector = others[:, :1], others[:, 1:]
    product: Matrix = q[0] * vector - scalar * q[1:] - np.cross(q[1:], vector)
    return product


def _three(v: Matrix) -> Vec3:
    x, y, z = v.tolist()
    return (x, y, z)


def _four(q: Matrix) -> tuple[float, float, float, float]:
    a, b, c, d = q.tolist()
    return (a, b, c, d)
