"""Gains for the least settling time from the worst of many starts, with coils of limited dipole.

Inertial pointing by m = -b x (k_w omega + k_a E), E = 4 qv, each coil limited to its dipole, on a circular
orbit in the direct dipole's field. From each start the attitude has settled once its error stays under an
angle. The cost of (k_w, k_a) is the longest of these times; it has no derivative, and a simplex lowers it.
Without the limit of the dipole the gains would grow without bound.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Bruni, Celani 2017. Theirs is a search by a global
method over uncertain starts; here a local one over starts that are given.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from sim.design.inertial_gains import inertial_field, near_gains
from sim.design.theory import side_by_side
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains
from sim.design.theory.side_by_side import angle_deg, in_body, quaternion_rate
from sim.value_types import Array

STEP_S = 40.0
"""Of the integration."""
SETTLED_DEG = 5.0
"""Error below which a flight has settled."""
ROUNDS = 24
"""Costs that the search computes, if not told otherwise."""


@dataclass(frozen=True, slots=True)
class Starts:
    """Where flights begin: q_body_from_target, (k, 4), and absolute rates in body axes, (k, 3), rad/s."""

    q: Array
    omega_radps: Array


def spread_starts(count: int, angle_deg: float, rate_radps: float) -> Starts:
    """Starts of one angle and one rate, about axes spread by the golden angle; the rates across them."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    flat = np.sqrt(1.0 - height**2)
    axes = np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=-1)
    half = 0.5 * np.radians(angle_deg)
    q = np.concatenate([np.full((count, 1), np.cos(half)), np.sin(half) * axes], axis=-1)
    return Starts(q, rate_radps * np.roll(axes, 1, axis=1))


def settling_orbits(body: Body, gains: Gains, most_am2: float, starts: Starts, orbits: float) -> Array:
    """Orbits after which the error of each start stays under ``SETTLED_DEG``; else more than ``orbits``.

    Args:
        body: with a diagonal inertia tensor or not; its wheel is left out.
        gains: k_w and k_a, numbers.
        most_am2: of each coil.
        starts: k of them.
        orbits: length of the flight.

    Returns:
        (k,); for an unsettled start ``orbits`` plus its last error in half turns, a slope for the search.
    """
    w0, inertia = body.rate_radps, np.asarray(body.inertia_kgm2)
    steps = int(orbits * 2.0 * np.pi / w0 / STEP_S)
    u = np.linspace(0.0, STEP_S * w0 * steps, 2 * steps + 1)
    fields = inertial_field(u, body) * body.field_t
    loop = _Loop(inertia, np.linalg.inv(inertia), gains, most_am2)
    x, last = np.concatenate([starts.q, starts.omega_radps], axis=-1), np.zeros(len(starts.q))
    for step in range(steps):
        x = side_by_side.step(loop.rates, x, fields[2 * step : 2 * step + 3], STEP_S)
        last = np.where(angle_deg(x) > SETTLED_DEG, (step + 1.0) / steps * orbits, last)
    return np.where(last >= orbits, orbits + angle_deg(x) / 180.0, last)


def minimax(
    body: Body, start: Gains, most_am2: float, starts: Starts, orbits: float, rounds: int = ROUNDS
) -> tuple[Gains, float]:
    """The gains with the least longest settling time found from ``start``, and that, orbits."""

    def cost(logs: Array) -> float:
        return float(settling_orbits(body, near_gains(start, logs), most_am2, starts, orbits).max())

    simplex = 0.5 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    place: Array = np.zeros(2)
    found = minimize(
        cost, place, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": rounds}
    )
    return near_gains(start, np.asarray(found.x, dtype=np.float64)), float(found.fun)


@dataclass(frozen=True, slots=True)
class _Loop:
    """The controlled motion of many starts at once: x = (q_body_from_target, omega)."""

    inertia: Array
    inverse: Array
    gains: Gains
    most_am2: float

    def rates(self, x: Array, b_t: Array) -> Array:
        """dx/dt."""
        q, omega = x[:, :4], x[:, 4:]
        b = in_body(q, b_t)
        error = np.where(q[:, :1] >= 0.0, 4.0, -4.0) * q[:, 1:]
        wanted = -np.cross(b, self.gains.k_w * omega + self.gains.k_a * error)
        m = np.clip(wanted, -self.most_am2, self.most_am2)
        torque = np.cross(m, b) - np.cross(omega, omega @ self.inertia.T)
        return np.concatenate([quaternion_rate(q, omega), torque @ self.inverse.T], axis=1)
