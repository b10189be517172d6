"""Gain of the precession by roll: its decay by averaging, and by Floquet theory.

The momentum of a spinning satellite, small angles from the orbit normal, nutation damped: its components E1
along the radius and E2 ahead, over the argument of latitude u, on a circular orbit in the direct dipole's
field b = B0 (-2 sin u sin i, cos u sin i, cos i), without further torques:

    E1' = E2 - c cos^2 u E1,   E2' = -E1 - 2 c sin u cos u E1,   c = k_h B0^2 sin^2 i / w0.

In space the mean over an orbit, to first order in c, is a decay of -c/8 about the line of nodes and of
-3c/8 across it: each error decays for any gain that is positive. With c of 1 and more the roll of the
nutation, which is no error of the momentum, is fed back as strongly as it is damped.

Source of the law: Alfriend 1975, as in Ovchinnikov, Roldugin 2019, eq. 4, where the stability is shown from
the gains and extended by Floquet theory; the equations here are derived for a body that spins.
"""

import numpy as np

from sim.design.theory.bodies import DIPOLE_TM3
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import System
from sim.value_types import Array


def motion(c: float) -> System:
    """The matrix of the motion over u, for a gain c."""

    def at(u: Array) -> Array:
        sine, cosine = np.sin(u), np.cos(u)
        a = np.zeros((*u.shape, 2, 2))
        a[..., 0, 0], a[..., 0, 1] = -c * cosine**2, 1.0
        a[..., 1, 0] = -1.0 - 2.0 * c * sine * cosine
        return a

    return at


def averaged(c: float) -> tuple[float, float]:
    """The two decays per radian, slowest first, to first order in c."""
    return -c / 8.0, -3.0 * c / 8.0


def degree(c: float) -> float:
    """Degree of stability by Floquet theory, per radian."""
    return float(degree_of_stability(monodromy(motion(c))))


def gain_of(c: float, orbit_rate_radps: float, radius_m: float, inclination_rad: float) -> float:
    """The k_h of a gain c, 1 / (T^2 s); infinite over the equator, where the field does not turn."""
    field_t = DIPOLE_TM3 / radius_m**3 * np.sin(inclination_rad)
    return float(c * orbit_rate_radps / field_t**2) if field_t else float("inf")
