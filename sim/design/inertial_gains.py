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

import numpy as np
from scipy.linalg import eigvals
from scipy.optimize import minimize, minimize_scalar

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import Gains, System, dipole_field, feedback_scales, skew
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
