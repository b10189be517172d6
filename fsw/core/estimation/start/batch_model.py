"""A batch of samples as arrays: what a motion should have shown, and the motions from which to search.

A motion has k = 18 + 3 + 2 c + 1 numbers: attitude, rate, residual dipole, torque and the error of the
inertia move the satellite; bias of the field, excess and gain of each of c cells and light of the Earth show
in the samples. What a cell is wrong by has the same parts as in the filter, which goes on with them.
"""

from dataclasses import dataclass
from math import cos, hypot, pi, radians, sin, sqrt
from typing import final

import numpy as np

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import Vec3, add, cross, dot, norm, scale, unit
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.start.batch_sample import BatchSample
from fsw.core.estimation.start.motions import Disturbed, Leg, all_in_body, in_body, turned_by
from fsw.core.estimation.start.triad import triad
from fsw.core.orbit.earth import MU_M3PS2

TURNS, RATES_DEGPS = 12, (0.0, 0.15, -0.15, 0.3, -0.3, 0.6, -0.6, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0)
"""Starts: this many rotations about the field, each with each of these rates about it."""
LEAST_SINE = 0.1
"""Of the angle between field and Sun."""
MOVING = 18
"""Numbers that move the satellite: attitude, rate, dipole, torque, inertia."""
TURN_T = 5e-7
"""What misalignment and scale error of the magnetometer do to the field, besides its bias."""
VARYING = 0.3
"""Fraction of bias and excess that varies over a batch."""
LEAST_SIGMAS = {"dipole": 1e-8, "torque": 1e-13, "inertia": 1e-9, "cells": 1e-6}
"""For what the table takes as certain, A m^2, N m, kg m^2, and parts of full sunlight."""


@final
@dataclass(frozen=True, slots=True)
class Motions:
    """Attitudes (n, 4), and rate, dipole, torque, inertia, bias, excess, gains and light, (n, k - 3)."""

    q: Matrix
    numbers: Matrix

    def changed(self, step: Matrix) -> "Motions":
        """The motions after a step of k numbers each, that of the attitude being a rotation."""
        return Motions(turned_by(self.q, step[:, 0:3]), self.numbers + step[:, 3:])

    def chosen(self, rows: list[int]) -> "Motions":
        """Some of them."""
        return Motions(self.q[rows], self.numbers[rows])


@final
@dataclass(frozen=True, slots=True)
class BatchModel:
    """What the table says of a batch: standard deviations of a field component, T, and of a current.

    ``excess_varying``: standard deviation of what the excess of a cell has in one tick beyond its mean.
    ``prior`` (k): standard deviations, infinite for attitude and rate; ``differences`` (18): steps for
    derivatives; ``normals`` (c, 3): of the cells, body axes; ``albedo``: of the table.
    """

    field_sigma_t: float
    current_sigma: float
    excess_varying: float
    prior: Matrix
    differences: Matrix
    normals: Matrix
    albedo: float
    config: MekfConfig


@final
@dataclass(frozen=True, slots=True)
class Shown:
    """What motions should show in a sample.

    ``values`` (n, 3 + c): field and currents, with bias and errors of the cells; ``direct`` (n, c): light of
    the Sun; ``of_earth`` (n, c): light of an Earth that reflects all that falls on it.
    """

    values: Matrix
    direct: Matrix
    of_earth: Matrix


def model_of(config: MekfConfig, cells: CellSet) -> BatchModel:
    """The model by the bounds of the table."""
    parts = config.layout
    bias_t = hypot(_sigmas(config, parts.mag_bias, 3)[0], TURN_T)
    moving = (
        *np.maximum(_sigmas(config, parts.dipole, 3), LEAST_SIGMAS["dipole"]).tolist(),
        *np.maximum(_sigmas(config, parts.torque, 3), LEAST_SIGMAS["torque"]).tolist(),
        *np.maximum(_sigmas(config, parts.inertia, 6), LEAST_SIGMAS["inertia"]).tolist(),
    )
    count, varying = len(cells.normals_body), VARYING * cells.model_sigma
    of_cells = (cells.excess_sigma,) * count + (cells.gain_sigma,) * count + (cells.light_sigma,)
    shown = (bias_t,) * 3 + tuple([max(sigma, LEAST_SIGMAS["cells"]) for sigma in of_cells])
    return BatchModel(
        field_sigma_t=hypot(sqrt(float(config.field_noise[0, 0])), VARYING * bias_t),
        current_sigma=hypot(cells.sigma, varying),
        excess_varying=varying,
        prior=np.array((np.inf,) * 6 + moving + shown),
        differences=np.array((1e-3,) * 3 + (1e-5,) * 3 + tuple([0.1 * sigma for sigma in moving])),
        normals=np.array(cells.normals_body),
        albedo=cells.albedo,
        config=config,
    )


def _sigmas(config: MekfConfig, place: slice | None, size: int) -> Matrix:
    """Prior standard deviations of a parameter, by component; zero if it is not carried."""
    return np.zeros(size) if place is None else np.sqrt(config.initial_covariance.diagonal()[place])


def measured(sample: BatchSample, model: BatchModel) -> tuple[Matrix, Matrix]:
    """Field and currents, and one over the standard deviation of each, 0 where there is none, (3 + c)."""
    weight = 1.0 / model.current_sigma if sample.lit else 0.0
    of_cells = tuple([weight if current >= 0.0 else 0.0 for current in sample.currents])
    weights = (1.0 / model.field_sigma_t,) * 3 + of_cells
    return np.array(sample.field_t + sample.currents), np.array(weights)


def leg(before: BatchSample, after: BatchSample) -> Leg:
    """What acts between two samples."""
    middle = scale(0.5, add(before.r_eci_m, after.r_eci_m))
    b = np.array(scale(0.5, add(before.b_eci_t, after.b_eci_t)))
    gravity = 3.0 * MU_M3PS2 / norm(middle) ** 3
    return Leg(after.since_s, np.array(unit(middle)), b, gravity, np.array(after.m_body_am2))


def starts(samples: tuple[BatchSample, ...], model: BatchModel) -> Motions:
    """Attitudes about the first field, and rates that carry it to the second, plus each about the field."""
    first, second = samples[0], samples[1]
    field = unit(first.field_t)
    attitudes, rates = [], []
    for attitude in _attitudes(first):
        still = unit(tuple(in_body(np.array([attitude]), np.array(second.b_eci_t))[0].tolist()))
        turning = scale(1.0 / second.since_s, _rotation(still, unit(second.field_t)))
        for rate in RATES_DEGPS:
            attitudes.append(attitude)
            rates.append(add(turning, scale(radians(rate), field)))
    rest = np.zeros((len(rates), model.prior.size - 6))
    return Motions(np.array(attitudes), np.hstack((np.array(rates), rest)))


def _attitudes(first: BatchSample) -> list[Quaternion]:
    """By TRIAD with the Sun from three lit cells; without them at ``TURNS`` rotations about the field."""
    if first.coarse is not None:
        return [triad(first.field_t, first.coarse, first.b_eci_t, first.s_eci)]
    field = unit(first.field_t)
    least = min(range(3), key=lambda axis: abs(field[axis]))
    x, y, z = (1.0 if axis == least else 0.0 for axis in range(3))
    across = unit(cross(field, (x, y, z)))
    aside = cross(field, across)
    apart = norm(cross(unit(first.b_eci_t), first.s_eci)) > LEAST_SINE
    turns = [2.0 * pi * number / TURNS for number in range(TURNS)]
    towards = [add(scale(cos(turn), across), scale(sin(turn), aside)) for turn in turns]
    far = first.s_eci if apart else first.r_eci_m
    return [triad(field, direction, first.b_eci_t, far) for direction in towards]


def _rotation(before: Vec3, after: Vec3) -> Vec3:
    """The rotation vector of the axes that takes a fixed direction's components from one to the other."""
    axis, cosine = cross(after, before), dot(before, after)
    sine = norm(axis)
    return scale(float(np.arctan2(sine, cosine)) / sine, axis) if sine > 0.0 else axis


def varied(motions: Motions, model: BatchModel) -> Motions:
    """The motions, followed by 18 times as many, each with one number changed by its difference."""
    steps = np.zeros((1 + MOVING, *(len(motions.q), 3 + motions.numbers.shape[1])))
    steps[range(1, 1 + MOVING), :, range(MOVING)] = model.differences[:, None]
    times = (1 + MOVING, 1)
    again = Motions(np.tile(motions.q, times), np.tile(motions.numbers, times))
    return again.changed(steps.reshape(len(again.q), -1))


def disturbances(motions: Motions) -> Disturbed:
    """What disturbs them."""
    numbers = motions.numbers
    return Disturbed(numbers[:, 3:6], numbers[:, 6:9], numbers[:, 9:15])


def expected(motions: Motions, sample: BatchSample, model: BatchModel) -> Shown:
    """Field and currents at one sample.

    Args:
        motions: where they are.
        sample: what was modelled.
        model: what the table says.
    """
    down = scale(-1.0 / norm(sample.r_eci_m), sample.r_eci_m)
    b, s, e = all_in_body(motions.q, np.array((sample.b_eci_t, sample.s_eci, down)))
    direct, view = np.maximum(0.0, model.normals.dot(s)).T, (0.5 + 0.5 * model.normals.dot(e)).T
    of_earth = (sample.earth / model.albedo if sample.earth else 0.0) * view * view
    bias, excess, gain, light = parts_shown(motions.numbers, len(model.normals))
    currents = (1.0 + gain) * direct + (model.albedo + light) * of_earth + excess
    return Shown(np.hstack((b.T + bias, currents)), direct, of_earth)


def parts_shown(numbers: Matrix, cells: int) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Bias (n, 3), excess (n, c), gain (n, c) and light (n, 1) among the numbers of motions, (n, k - 3)."""
    first = MOVING - 3
    after_bias, after_excess = first + 3, first + 3 + cells
    return (
        numbers[:, first:after_bias],
        numbers[:, after_bias:after_excess],
        numbers[:, after_excess:-1],
        numbers[:, -1:],
    )


def constant_slopes(shown: Shown, count: int) -> Matrix:
    """Derivatives of the values of the first n motions by bias, excess, gains, light: (n, 3 + c, 4 + 2 c)."""
    cells = shown.direct.shape[1]
    slopes = np.zeros((count, 3 + cells, 4 + 2 * cells))
    places = np.arange(3 + cells)
    slopes[:, places, places] = 1.0
    slopes[:, places[3:], places[3:] + cells] = shown.direct[:count]
    slopes[:, 3:, -1] = shown.of_earth[:count]
    return slopes
