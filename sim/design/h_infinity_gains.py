"""Gains of the PD law with the least H-infinity norm.

    m = -b x (k_w Omega + 2 k_a theta)

is the structured law among those of ``norms``: for each pair of gains the loop has a norm, and the pair with
the least one bears every torque with the least error. The norm is flat about its least value, and the search
is by the simplex of Nelder and Mead over the logarithms of the gains.

Source: Zanchettin, Lovera 2011, as in Ovchinnikov, Roldugin 2019, section 3.2: there by a randomised search.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from fsw.core.laws.plan.riccati import Array, Problem, skews
from sim.design.periodic_norms import Norms, UnstableLoopError, norms

ROUGH = 9
"""Frequencies during the search."""
EVALUATIONS = 80
UNSTABLE = 1e6
"""Stands for the norm of a loop that has none."""


class PdDesign(NamedTuple):
    """Gains, N m s / T^2 and N m / T^2, and the norms of their loop."""

    k_w: float
    k_a: float
    norms: Norms


def pd_tabulated(b_orbit_t: Array, k_w: float, k_a: float) -> Array:
    """The PD law as gains of each step, from (Omega, theta) to the dipole, orbital axes, (n, 3, 6)."""
    across = skews(b_orbit_t)
    return np.concatenate([-k_w * across, -2.0 * k_a * across], axis=2)


def best_pd(problem: Problem, b_orbit_t: Array, unit_nm: float, start: tuple[float, float]) -> PdDesign:
    """The pair of gains with the least H-infinity norm near a pair that is stable.

    Raises:
        UnstableLoopError: no pair that was tried is stable.
    """

    def norm(logarithms: Array) -> float:
        k_w, k_a = np.exp(logarithms)
        try:
            return norms(problem, b_orbit_t, pd_tabulated(b_orbit_t, k_w, k_a), unit_nm, ROUGH).h_infinity
        except UnstableLoopError:
            return UNSTABLE

    found = minimize(
        norm,
        np.log(start),
        method="Nelder-Mead",
        options={"maxfev": EVALUATIONS, "xatol": 1e-2, "fatol": 1e-4},
    )
    k_w, k_a = np.exp(found.x).tolist()
    return PdDesign(k_w, k_a, norms(problem, b_orbit_t, pd_tabulated(b_orbit_t, k_w, k_a), unit_nm))
