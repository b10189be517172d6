"""Gains of the inertial PD law: their ratio by averaging, their size by Floquet theory.

Small turns theta from a target fixed in eci, with w = omega / w0 and ' = d/du, u the argument of latitude:

    w' = -J^-1 G(u) (K_w w + K_a theta),     theta' = w,     K_w = k_w B0^2 / w0,  K_a = 2 k_a B0^2 / w0^2,

G = |B|^2 E - B B^T of the direct dipole's field, here in axes that do not turn with the orbit; the gravity
gradient is left out. Weak gains act by the mean of G alone. Then every mode z of J and <G> obeys
z'' + g (K_w z' + K_a z) = 0 with g an eigenvalue of J^-1 <G>, and the slowest is critical at

    K_a = K_w^2 g_min / 4,     k_a = k_w^2 g_min B0^2 / 8.

That leaves k_w alone, which Floquet theory gives: the least degree of stability on this line.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Ovchinnikov, Roldugin, Penkov 2015 (Acta Astronautica
110): a simple scheme by analytical results and Floquet theory. The review prints no formula; the line of
critical damping is derived here from what it says.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.linalg import eigvals
from scipy.optimize import minimize, minimize_scalar

from sim.design.pd_limits import weaker
from sim.design.theory import side_by_side
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import Gains, System, dipole_field, feedback_scales, skew
from sim.design.theory.side_by_side import angle_deg, in_body, quaternion_rate
from sim.value_types import Array

POINTS = 720
"""Points of the orbit over which the field is averaged."""
SPAN = (-2.0, 2.0)
"""Logarithms of k_w over the natural one between which the best is sought."""


def inertial_field(u: Array, body: Body) -> Array:
    """The direct dipole's field in units of B0, in the axes of the orbit at u = 0, shape (..., 3)."""
    b1, b2, b3 = np.moveaxis(dipole_field(u, body), -1, 0)
    cosine, sine = np.cos(u), np.sin(u)
    return np.stack([cosine * b1 - sine * b2, sine * b1 + cosine * b2, b3], axis=-1)


def inertial_projection(u: Array, body: Body) -> Array:
    """G(u) of that field, in the same axes: (..., 3, 3)."""
    cross = skew(inertial_field(u, body))
    return -cross @ cross


def inertial_loop(body: Body, gains: Gains) -> System:
    """A(u) of the controlled motion, body axes those of the target, which are the orbit's at u = 0."""
    inverse = np.linalg.inv(np.asarray(body.inertia_kgm2))
    k_w, k_a = feedback_scales(body, gains).tolist()

    def matrix(u: Array) -> Array:
        torque = -inverse @ inertial_projection(u, body)
        whole = np.zeros((*u.shape, 6, 6))
        whole[..., :3, :3], whole[..., :3, 3:] = k_w * torque, k_a * torque
        whole[..., 3:, :3] = np.eye(3)
        return whole

    return matrix


def slowest(body: Body) -> float:
    """g_min, the least eigenvalue of J^-1 <G>, 1/(kg m^2)."""
    u = 2.0 * np.pi * np.arange(POINTS) / POINTS
    mean = inertial_projection(u, body).mean(axis=0)
    return float(np.min(eigvals(mean, np.asarray(body.inertia_kgm2)).real))


def critical_gains(body: Body, k_w: float) -> Gains:
    """The gains of the line: k_a = k_w^2 g_min B0^2 / 8."""
    return Gains(k_w, k_w**2 * slowest(body) * body.field_t**2 / 8.0)


def natural_k_w(body: Body) -> float:
    """The k_w at which the averaged slowest mode decays as exp(-u): K_w g_min / 2 = 1."""
    return 2.0 * body.rate_radps / (slowest(body) * body.field_t**2)


def inertial_degree(body: Body, gains: Gains) -> float:
    """The degree of stability, per radian of u."""
    return float(degree_of_stability(monodromy(inertial_loop(body, gains))))


def best_on_line(body: Body) -> tuple[Gains, float]:
    """The gains of the line with the least degree of stability, and that."""
    natural = natural_k_w(body)

    def degree(log_k_w: float) -> float:
        return inertial_degree(body, critical_gains(body, natural * float(np.exp(log_k_w))))

    coarse = min(np.linspace(*SPAN, 17).tolist(), key=degree)
    found = minimize_scalar(degree, bounds=(coarse - 0.25, coarse + 0.25), method="bounded")
    return critical_gains(body, natural * float(np.exp(found.x))), float(found.fun)


def best_of_all(body: Body) -> tuple[Gains, float]:
    """The same over k_w and k_a apart, by a simplex that begins on the line."""
    start, _ = best_on_line(body)
    corners = 0.3 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    place: Array = np.zeros(2)

    def degree(logs: Array) -> float:
        return inertial_degree(body, near_gains(start, logs))

    found = minimize(degree, place, method="Nelder-Mead", options={"initial_simplex": corners, "maxfev": 150})
    return near_gains(start, np.asarray(found.x, dtype=np.float64)), float(found.fun)


def near_gains(start: Gains, logs: Array) -> Gains:
    """k_w and k_a, each times the exponential of its number in ``logs``."""
    k_w, k_a = float(np.asarray(start.k_w)), float(np.asarray(start.k_a))
    return Gains(k_w * float(np.exp(logs[0])), k_a * float(np.exp(logs[1])))


# --- Gains that hold for every inertia within bounds

SHARES = np.geomspace(2.0, 0.02, 60)
"""Values of e that are tried, largest first."""


def corners(body: Body, error: float) -> list[Body]:
    """The body with each moment smaller or greater by ``error`` of itself, where a body can have them."""
    j = np.diag(np.asarray(body.inertia_kgm2))
    found = []
    for signs in product((-1.0, 1.0), repeat=3):
        a, b, c = (j * (1.0 + error * np.array(signs))).tolist()
        if 2.0 * max(a, b, c) <= a + b + c:
            found.append(replace(body, inertia_kgm2=diagonal((a, b, c))))
    return found


def worst_degree(body: Body, gains: Gains, error: float) -> float:
    """The greatest degree of stability of all corners, per radian of u."""
    return max(inertial_degree(corner, gains) for corner in corners(body, error))


def robust_share(body: Body, gains: Gains, error: float) -> float | None:
    """The largest e with which all corners are stable; None where none of those tried is.

    Averaging shows that gains e k_w and e^2 k_a stabilise inertial pointing for any inertia if e is small
    enough. How small it must be is found here: the largest e with which the loop of ``inertial_loop`` is
    stable for the least and the greatest value of each moment, in all combinations that a rigid body can
    have.

    Source: Ovchinnikov, Roldugin 2019, section 3.1, after Celani 2015 (Acta Astronautica 107).
    """
    return next((float(e) for e in SHARES if worst_degree(body, weaker(gains, float(e)), error) < 0.0), None)


# --- Gains for the least settling time from the worst of many starts, with coils of limited dipole

STEP_S = 40.0
"""Of the integration."""
SETTLED_DEG = 5.0
"""Error below which a flight has settled."""
ROUNDS = 24
"""Costs that the search computes, if not given."""


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
    """The gains with the least longest settling time found from ``start``, and that, orbits.

    Inertial pointing by m = -b x (k_w omega + k_a E), E = 4 qv, each coil limited to its dipole, on a
    circular orbit in the direct dipole's field. From each start the attitude has settled once its error stays
    under an angle. The cost of (k_w, k_a) is the longest of these times; it has no derivative, and a simplex
    lowers it. Without the limit of the dipole the gains would grow without bound.

    Source: Ovchinnikov, Roldugin 2019, section 3.1, after Bruni, Celani 2017. Theirs is a search by a global
    method over uncertain starts; here a local one over starts that are given.
    """

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
