"""The periodic Riccati equation by one invariant subspace.

The motion between steps does not depend on the step, only the push of the dipole does. So each step of state
and costate (x, p), p = P x, is

    (x, p)+ = M_k (x, p),   M_k^-1 = (A^-1, A^-1 R_k; Q A^-1, A^T + Q A^-1 R_k),   R_k = N_k N_k^T / effort,

one inverse, of A, for all. The product over an orbit has six decaying modes; with (V1; V2) a basis of them,
by an ordered Schur form, P = V2 V1^-1 at the beginning of the orbit. The other steps follow by recursion.
The product loses digits as its modes grow apart: where effort is cheap P does not come again after an orbit,
which is checked.

Source: Yang 2017, as in Ovchinnikov, Roldugin 2019, section 3.2.
"""

import numpy as np
from scipy.linalg import schur

from fsw.core.laws.plan.riccati import Array, NotHeldError, Problem, backward, pushes_of

REPEATS = 1e-4
"""Largest relative change of P over an orbit."""


def periodic_cost(problem: Problem, b_orbit_t: Array) -> Array:
    """P at the beginning of the orbit, (6, 6).

    Args:
        problem: the problem.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).

    Raises:
        NotHeldError: the product has not six modes that decay, or P does not come again after an orbit.
    """
    to_scaled = np.repeat([problem.step_s, 1.0], 3)  # rates as angles of a step: numbers of like size
    a = problem.free[:, :6] * to_scaled[:, None] / to_scaled
    cost = np.diag(problem.cost / to_scaled**2)
    pushes = pushes_of(problem, b_orbit_t) * to_scaled[:, None]
    back = np.linalg.inv(a)
    whole = np.eye(12)
    for push in pushes:
        reach = push @ push.T / problem.effort
        step_back = np.block([[back, back @ reach], [cost @ back, a.T + cost @ back @ reach]])
        whole = whole @ step_back
    _, basis, decaying = schur(whole, sort=_decays)
    if decaying != 6:
        raise NotHeldError("no periodic dipole holds this body on this orbit")
    found = np.linalg.solve(basis[:6, :6].T, basis[6:, :6].T).T
    symmetric: Array = 0.5 * (found + found.T) * np.outer(to_scaled, to_scaled)
    _, costs = backward(problem, b_orbit_t, np.hstack([symmetric, np.zeros((6, 3))]))
    if not np.abs(costs[0, :, :6] - symmetric).max() <= REPEATS * np.abs(symmetric).max():
        raise NotHeldError("no cost that comes again after an orbit is found for this body")
    return symmetric


def _decays(real: float, imaginary: float = 0.0) -> bool:
    """Of the product backwards in time, a multiplier whose mode decays forwards."""
    return abs(complex(real, imaginary)) > 1.0
