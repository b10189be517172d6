"""Training of the neural units that choose the gains of a PD law: flights of many weights side by side.

The cost of the weights is the mean of ln(RMS angle) over the orbits of flights from random attitudes, each
under a constant torque and a residual dipole of its own, of which the law does not know. They are as strong
as they can be in some flights, and next to nothing in others: units that had seen strong ones alone do not
come to rest where there are none. Differential evolution lowers the cost (Storn, Price 1997). Flights on
which the weights are judged must be others.

Source: Ovchinnikov, Roldugin 2019, section 3.4, after Das, Sinha, Misra 2012; the units as in
``fsw/core/laws/pd_neural.py``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import log, pi
from typing import cast

import numpy as np
from scipy.optimize import Bounds, differential_evolution

from fsw.core.laws.pd_neural import RANGE, SMALL
from sim.design.theory import side_by_side
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains, dipole_field
from sim.design.theory.side_by_side import angle_deg, in_body, quaternion_rate
from sim.value_types import Array

STEP_S = 30.0
"""Of law and integration."""
PD_GAINS, MOST_AM2 = Gains(6.2694e6, 1614.9), 5.0
"""Best gains of the PD law by Floquet theory for the 50 kg satellite, and what each of its coils gives."""
TORQUE_NM, DIPOLE_AM2 = 1e-7, 3e-3
"""Standard deviation of each component of what disturbs a flight at most."""
LEAST_PART = 0.01
"""Of that: a flight has a part of it between this and 1, all their logarithms being as likely."""
LEAST_DEG, MOST_DEG = 15.0, 120.0
"""Between which angles a flight begins, at rest in the orbital frame."""
LEVEL, SLOPE, LAGS_ORBITS = 1.0, 0.6, (0.01, 1.0)
"""Bounds of the search: of s at ``MIDDLE``, of c1 and c2, and of the lag."""
MIDDLE = 3.0
"""Of what a unit sees: an error of 11 deg."""
POPULATION = 8
"""Of the search: members a number."""


@dataclass(frozen=True, slots=True)
class Trials:
    """Flights: q_body_from_orbit at the start, (k, 4); torque, N m, and dipole, A m^2, body axes, (k, 3)."""

    q: Array
    torque_nm: Array
    dipole_am2: Array


def trials(count: int, seed: int) -> Trials:
    """So many at random."""
    random = np.random.default_rng(seed)
    axes = random.standard_normal((count, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    half = 0.5 * np.radians(random.uniform(LEAST_DEG, MOST_DEG, count))
    q = np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * axes], axis=1)
    torque, dipole = random.standard_normal((2, count, 3))
    part = np.exp(random.uniform(log(LEAST_PART), 0.0, count))[:, None]
    return Trials(q, TORQUE_NM * part * torque, DIPOLE_AM2 * part * dipole)


def orbit_rms_deg(
    body: Body, gains: Gains, weights: Array, flown: Trials, most_am2: float, orbits: int = 5
) -> Array:
    """RMS angle in each orbit, (members, flights, orbits), deg.

    Args:
        body: the satellite, its wheel left out.
        gains: k_w and k_a on which the units work.
        weights: w0, w1, w2, a0, a1, a2, lag_orbits of each member, (members, 7).
        flown: the flights.
        most_am2: of each coil.
        orbits: length.
    """
    members, flights = len(weights), len(flown.q)
    each = np.repeat(weights, flights, axis=0)
    loop = _Flights(
        body, gains, each, *(np.tile(part, (members, 1)) for part in (flown.torque_nm, flown.dipole_am2))
    )
    q = np.tile(flown.q, (members, 1))
    x = np.concatenate([q, body.rate_radps * in_body(q, np.array([0.0, 0.0, 1.0]))], axis=1)
    steps = round(2.0 * pi / body.rate_radps / STEP_S)
    t_s = np.linspace(0.0, STEP_S * orbits * steps, 2 * orbits * steps + 1)
    fields_t = body.field_t * dipole_field(body.rate_radps * t_s, body)
    lags, squares = None, np.zeros((len(q), orbits))
    for step in range(orbits * steps):
        lags, m = loop.dipole(x, fields_t[2 * step], lags)
        rates = partial(loop.rates, m_am2=np.clip(m, -most_am2, most_am2))
        squares[:, step // steps] += angle_deg(x) ** 2 / steps
        x = side_by_side.step(rates, x, fields_t[2 * step : 2 * step + 3], STEP_S)
    rms: Array = np.sqrt(squares).reshape(members, flights, orbits)
    return rms


def cost(rms_deg: Array) -> Array:
    """Of each member: the mean of ln(RMS angle) over flights and orbits."""
    found: Array = np.log(rms_deg).mean(axis=(1, 2))
    return found


def train(
    body: Body,
    gains: Gains,
    flown: Trials,
    most_am2: float,
    seed: int,
    generations: int,
    report: Callable[[int, float], None] = lambda generation, lowest: None,
) -> tuple[Array, float]:
    """The weights with the least cost that the search found, (7,), and that; never worse than none at all.

    Args:
        body: as of ``orbit_rms_deg``, as are the next three.
        gains: k_w and k_a.
        flown: the flights.
        most_am2: of each coil.
        seed: of the search.
        generations: how long to search.
        report: is called with the number of each generation and the lowest cost so far.
    """
    most, (shortest, longest) = np.array([LEVEL, SLOPE, SLOPE] * 2 + [1.0]), np.log(LAGS_ORBITS)

    def weights_of(numbers: Array) -> Array:
        """Of numbers between -1 and 1, (7, members)."""
        weights = most * numbers.T
        weights[:, 0] -= MIDDLE * (weights[:, 1] + weights[:, 2])
        weights[:, 3] -= MIDDLE * (weights[:, 4] + weights[:, 5])
        weights[:, 6] = np.exp(0.5 * (shortest + longest + weights[:, 6] * (longest - shortest)))
        return weights

    def costs(numbers: Array) -> Array:
        members = weights_of(numbers.reshape(7, -1))
        return cost(orbit_rms_deg(body, gains, members, flown, most_am2))

    numbers = iter(range(1, generations + 2))
    found = differential_evolution(
        cast("Callable[..., float]", costs),  # scipy's types know no search of many members at once
        Bounds(-np.ones(7), np.ones(7)),
        x0=np.zeros(7),
        maxiter=generations,
        popsize=POPULATION,
        tol=0.0,
        rng=seed,
        polish=False,
        vectorized=True,
        updating="deferred",
        callback=lambda intermediate_result: report(next(numbers), float(intermediate_result.fun)),
    )
    return weights_of(np.asarray(found.x, dtype=np.float64)[:, None])[0], float(found.fun)


@dataclass(frozen=True, slots=True)
class _Flights:
    """The controlled motion of many flights at once: x = (q_body_from_orbit, omega absolute)."""

    body: Body
    gains: Gains
    weights: Array
    torque_nm: Array
    dipole_am2: Array

    def dipole(self, x: Array, b_orbit_t: Array, lags: Array | None) -> tuple[Array, Array]:
        """The units' v1 and v2, (2, 2, n), and the dipole, before it is limited."""
        q, w0 = x[:, :4], self.body.rate_radps
        omega = self.relative(x)
        error = np.where(q[:, :1] >= 0.0, 4.0, -4.0) * q[:, 1:]
        by_error = np.log(1.0 + np.linalg.norm(error, axis=1) / SMALL)
        by_rate = np.log(1.0 + np.linalg.norm(omega, axis=1) / (SMALL * w0))
        weights = self.weights.T
        s = weights[[0, 3]] + weights[[1, 4]] * by_error + weights[[2, 5]] * by_rate
        v1, v2 = (s, s) if lags is None else lags
        part = STEP_S / (2.0 * pi / w0 * weights[6] + STEP_S)
        v1 = v1 + part * (s - v1)
        v2 = v2 + part * (v1 - v2)
        k_w, k_a = np.array([[self.gains.k_w], [self.gains.k_a]]) * RANGE ** np.tanh(v2)
        wanted = k_w[:, None] * omega + k_a[:, None] * error
        return np.stack([v1, v2]), np.cross(wanted, in_body(q, b_orbit_t))

    def relative(self, x: Array) -> Array:
        """Rate relative to the orbital frame, body axes."""
        normal = in_body(x[:, :4], np.array([0.0, 0.0, self.body.rate_radps]))
        relative: Array = x[:, 4:] - normal
        return relative

    def rates(self, x: Array, b_orbit_t: Array, m_am2: Array) -> Array:
        """dx/dt."""
        q, omega, inertia = x[:, :4], x[:, 4:], np.asarray(self.body.inertia_kgm2)
        e1, relative = in_body(q, np.array([1.0, 0.0, 0.0])), self.relative(x)
        torque = self.torque_nm + np.cross(m_am2 + self.dipole_am2, in_body(q, b_orbit_t))
        torque += 3.0 * self.body.rate_radps**2 * np.cross(e1, e1 @ inertia)
        torque -= np.cross(omega, omega @ inertia)
        return np.concatenate([quaternion_rate(q, relative), torque @ np.linalg.inv(inertia)], axis=1)
