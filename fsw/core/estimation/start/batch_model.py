"""A batch of samples as arrays: what a motion should have shown, and the motions from which to search.

A motion has 18 + 3 + c numbers: attitude, rate, residual dipole, torque and the error of the inertia move the
satellite; bias of the field and excess of each of c cells show in the samples.
"""

from math import cos, hypot, pi, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import Vec3, add, cross, dot, norm, scale, unit
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.start.batch import BatchSample
from fsw.core.estimation.start.motions import Disturbed, Leg, flown, in_body, turned_by
from fsw.core.estimation.start.triad import triad
from fsw.core.orbit.earth import MU_M3PS2

TURNS, RATES_DEGPS = 12, (0.0, 0.15, -0.15, 0.3, -0.3, 0.6, -0.6, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0)
"""Starts: turns about the field, by each of these rates about it."""
LEAST_SINE = 0.1
"""Of the angle between field and Sun."""
MOVING = 18
"""Numbers that move the satellite: attitude, rate, dipole, torque, inertia."""
TURN_T = 5e-7
"""What turn and scale of the magnetometer do to the field, beside its bias."""
VARYING = 0.3
"""Part of bias and excess that does not stay the same over a batch."""
LEAST_SIGMAS = {"dipole": 1e-8, "torque": 1e-13, "inertia": 1e-9}
"""Of what is not in doubt, A m^2, N m and kg m^2."""


class Motions(NamedTuple):
    """Attitudes (n, 4), and rate, dipole, torque, inertia, bias and excess, (n, 15 + 3 + c), of motions."""

    q: Matrix
    numbers: Matrix

    def changed(self, step: Matrix) -> "Motions":
        """With a step of 18 + 3 + c numbers by each, the attitude's being a turn."""
        return Motions(turned_by(self.q, step[:, 0:3]), self.numbers + step[:, 3:])

    def chosen(self, rows: list[int]) -> "Motions":
        """Some of them."""
        return Motions(self.q[rows], self.numbers[rows])


class BatchProblem(NamedTuple):
    """A batch as arrays: legs between m samples, field and currents measured, (m, 3 + c).

    ``weights`` (m, 3 + c): one over each standard deviation, 0 where there is no sample; ``prior``
    (18 + 3 + c): standard deviations, infinite of attitude and rate; ``differences`` (18): for derivatives.
    """

    legs: tuple[Leg, ...]
    samples: tuple[BatchSample, ...]
    measured: Matrix
    weights: Matrix
    prior: Matrix
    differences: Matrix
    normals: Matrix
    config: MekfConfig


def problem_of(samples: tuple[BatchSample, ...], config: MekfConfig, cells: CellSet) -> BatchProblem:
    """The samples, and what is known beforehand, as arrays."""
    legs = tuple(_leg(samples[number], samples[number + 1]) for number in range(len(samples) - 1))
    currents = np.array([sample.currents for sample in samples])
    lit = np.array([sample.lit for sample in samples])
    parts = config.layout
    bias_t = hypot(_sigmas(config, parts.mag_bias, 3)[0], TURN_T)
    noise_t = hypot(sqrt(float(config.field_noise[0, 0])), VARYING * bias_t)
    noise = hypot(cells.sigma, VARYING * cells.excess_sigma)
    of_cells = np.where((currents >= 0.0) & (lit > 0.0)[:, None], 1.0 / noise, 0.0)
    weights = np.hstack((np.full((len(samples), 3), 1.0 / noise_t), of_cells))
    moving = (
        *np.maximum(_sigmas(config, parts.dipole, 3), LEAST_SIGMAS["dipole"]).tolist(),
        *np.maximum(_sigmas(config, parts.torque, 3), LEAST_SIGMAS["torque"]).tolist(),
        *np.maximum(_sigmas(config, parts.inertia, 6), LEAST_SIGMAS["inertia"]).tolist(),
    )
    shown = (bias_t,) * 3 + (cells.excess_sigma,) * currents.shape[1]
    prior = np.array((np.inf,) * 6 + moving + shown)
    differences = np.concatenate(((1e-3,) * 3, (1e-5,) * 3, 0.1 * np.array(moving)))
    measured = np.hstack((np.array([sample.field_t for sample in samples]), currents))
    return BatchProblem(
        legs, samples, measured, weights, prior, differences, np.array(cells.normals_body), config
    )


def _sigmas(config: MekfConfig, place: slice | None, size: int) -> Matrix:
    """Standard deviations of a parameter beforehand, by component; zero if it is not carried."""
    return np.zeros(size) if place is None else np.sqrt(config.initial_covariance.diagonal()[place])


def _leg(before: BatchSample, after: BatchSample) -> Leg:
    middle = scale(0.5, add(before.r_eci_m, after.r_eci_m))
    b = np.array(scale(0.5, add(before.b_eci_t, after.b_eci_t)))
    gravity = 3.0 * MU_M3PS2 / norm(middle) ** 3
    return Leg(after.since_s, np.array(unit(middle)), b, gravity, np.array(after.m_body_am2))


def starts(problem: BatchProblem) -> Motions:
    """Attitudes about the first field, and rates that take it to the second, with any about the field."""
    first, second = problem.samples[0], problem.samples[1]
    field = unit(first.field_t)
    attitudes, rates = [], []
    for attitude in _attitudes(first):
        still = unit(tuple(in_body(np.array([attitude]), np.array(second.b_eci_t))[0].tolist()))
        turning = scale(1.0 / second.since_s, _rotation(still, unit(second.field_t)))
        for rate in RATES_DEGPS:
            attitudes.append(attitude)
            rates.append(add(turning, scale(radians(rate), field)))
    rest = np.zeros((len(rates), problem.prior.size - 6))
    return Motions(np.array(attitudes), np.hstack((np.array(rates), rest)))


def _attitudes(first: BatchSample) -> list[Quaternion]:
    """By TRIAD with the Sun of three lit cells; without them at turns about the field."""
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
    """The rotation vector of the axes by which a direction that stands still goes from one to the other."""
    axis, cosine = cross(after, before), dot(before, after)
    sine = norm(axis)
    return scale(float(np.arctan2(sine, cosine)) / sine, axis) if sine > 0.0 else axis


def motion(problem: BatchProblem, motions: Motions) -> tuple[Matrix, Matrix, Matrix]:
    """Attitudes (m, n, 4) and rates (m, n, 3) at the samples, and what is seen there, (m, n, 3 + c)."""
    q, numbers, rotor = motions.q, motions.numbers, problem.config.rotor
    omega, disturbed = numbers[:, 0:3], Disturbed(numbers[:, 3:6], numbers[:, 6:9], numbers[:, 9:15])
    attitudes, rates = [q], [omega]
    for leg in problem.legs:
        q, omega = flown(q, omega, leg, disturbed, rotor)
        attitudes.append(q)
        rates.append(omega)
    seen = [_expected(at, sample, problem) for at, sample in zip(attitudes, problem.samples, strict=True)]
    return np.array(attitudes), np.array(rates), np.array(seen)


def _expected(q: Matrix, sample: BatchSample, problem: BatchProblem) -> Matrix:
    """Field and currents at one sample, (n, 3 + c)."""
    sun = in_body(q, np.array(sample.s_eci)).dot(problem.normals.T)
    earth = in_body(q, np.array(scale(-1.0 / norm(sample.r_eci_m), sample.r_eci_m))).dot(problem.normals.T)
    light = np.maximum(0.0, sun) + sample.earth * (0.5 + 0.5 * earth) ** 2
    return np.hstack((in_body(q, np.array(sample.b_eci_t)), light))
