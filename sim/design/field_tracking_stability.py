"""Field tracking linearised: which bodies it stabilises, and how well.

About body = orbit the law m = -2 k_a (b - B) - k_w d(b - B)/dt has b - B = B x theta, so that

    m = -2 k_a B x theta - k_w B x Omega - k_w dB/dt x theta:

the PD law and a third term, whose torque k_w B x (dB/dt x theta) is no spring but turns with the field. The
states and the other terms are those of ``sim.design.theory.linear``; the third adds to w'

    J^-1 (k_w B0^2 / w0) [B x] [dB/du x] theta.

Source of the law: Martel, Pal, Psiaki 1988; Guelman et al. 2005; Ovchinnikov, Roldugin 2019, eq. 7. The
linearisation is of this project.
"""

from dataclasses import dataclass

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import ROUGH_STEPS, degree_of_stability, monodromy
from sim.design.theory.linear import Gains, System, closed_loop, dipole_field, skew
from sim.value_types import Array

RATES, STIFFNESSES = np.geomspace(0.03, 10.0, 14), np.geomspace(0.03, 10.0, 14)
"""Gains that are searched, in units of the body's mean moment of inertia: k_w B0^2 / w0, k_a B0^2 / w0^2."""


@dataclass(frozen=True, slots=True)
class BestTracking:
    """The best gains found.

    Attributes:
        degree: of stability, per radian of the orbit; negative is stable.
        gains: N m s / T^2 and N m / T^2.
    """

    degree: float
    gains: Gains


def tracking_loop(body: Body, gains: Gains) -> System:
    """The matrix of the motion under field tracking, (..., k, 6, 6) for u of shape (k,)."""
    pd_loop = closed_loop(body, gains)
    share = np.asarray(gains.k_w, dtype=np.float64) * body.field_t**2 / body.rate_radps
    inverse = np.linalg.inv(np.asarray(body.inertia_kgm2))

    def matrix(u: Array) -> Array:
        turning = inverse @ skew(dipole_field(u, body)) @ skew(_turning(u, body))
        whole = pd_loop(u)
        whole[..., :3, 3:6] += share[..., None, None, None] * turning
        return whole

    return matrix


def tracking_degree(body: Body, gains: Gains) -> Array:
    """Degree of stability, of the shape of the gains."""
    return degree_of_stability(monodromy(tracking_loop(body, gains), ROUGH_STEPS))


def best_tracking(body: Body) -> BestTracking:
    """The best of a grid of gains."""
    moment = float(np.trace(body.inertia_kgm2)) / 3.0
    square, w0 = body.field_t**2, body.rate_radps
    k_w, k_a = np.meshgrid(RATES * moment * w0 / square, STIFFNESSES * moment * w0**2 / square)
    degrees = tracking_degree(body, Gains(k_w, k_a))
    best = np.unravel_index(int(np.argmin(degrees)), degrees.shape)
    return BestTracking(float(degrees[best]), Gains(float(k_w[best]), float(k_a[best])))


def _turning(u: Array, body: Body) -> Array:
    """The change of ``dipole_field`` with u."""
    i = np.radians(body.inclination_deg)
    return np.stack([-2.0 * np.cos(u) * np.sin(i), -np.sin(u) * np.sin(i), np.zeros_like(u)], axis=-1)
