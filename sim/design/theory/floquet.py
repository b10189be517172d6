"""Floquet theory: monodromy matrix, characteristic multipliers, degree of stability.

The monodromy matrix of x' = A(u) x, A of period 2 pi, is the product of the transition matrices of equal
steps, each by the Radau IIA method of five stages (order 9). It is stiffly stable: strong damping of one axis
(a boom) does not need shorter steps. All steps, and any number of systems, are computed at once; the product
is taken last.

Source: Hairer, Wanner 1996, Solving Ordinary Differential Equations II, IV.5.
"""

from math import log, pi

import numpy as np
from numpy.polynomial import Polynomial, legendre
from numpy.typing import NDArray

from sim.design.theory.linear import System
from sim.value_types import Array

STEPS = 64
"""Steps an orbit: degree of stability to 1e-10."""

ROUGH_STEPS = 24
"""Steps an orbit for pictures and for the start of a search: degree of stability to 1e-6."""

NEUTRAL = 1e-9
"""A degree of stability within it of zero is neither stable nor unstable."""

SETTLED = 0.05
"""A deviation has settled once it has fallen to this fraction."""


def monodromy(system: System, steps: int = STEPS) -> Array:
    """The state transition matrix from u = 0 to 2 pi, shape (..., n, n)."""
    return product(transitions(system, steps))


def transitions(system: System, steps: int) -> Array:
    """The transition matrix of each of ``steps`` equal steps over the orbit, shape (..., steps, n, n).

    With the stages Y = 1 (x) x + h (a (x) A) Y of Radau IIA, whose last one is the state at the step's end.
    """
    h, stages = 2.0 * pi / steps, len(_NODES)
    u = h * (np.arange(steps)[:, None] + _NODES)
    matrices = system(u.ravel())
    n, shape = matrices.shape[-1], matrices.shape[:-3]
    coupled = np.einsum("ij,...jab->...iajb", -h * _WEIGHTS, matrices.reshape(*shape, steps, stages, n, n))
    coupled = coupled.reshape(*shape, steps, stages * n, stages * n) + np.eye(stages * n)
    states = np.linalg.solve(coupled, np.tile(np.eye(n), (stages, 1)))
    return np.asarray(states[..., -n:, :], dtype=np.float64)


def product(matrices: Array) -> Array:
    """The product of (..., k, n, n) over k, the last one leftmost, by halves."""
    while (count := matrices.shape[-3]) > 1:
        even = count - count % 2
        with np.errstate(over="ignore", invalid="ignore"):
            pairs = matrices[..., 1:even:2, :, :] @ matrices[..., 0:even:2, :, :]
        matrices = np.concatenate([pairs, matrices[..., even:, :, :]], axis=-3)
    return matrices[..., 0, :, :]


def multipliers(monodromy_matrix: Array) -> NDArray[np.complex128]:
    """Characteristic multipliers by decreasing modulus, shape (..., n); of a pair the one with +i first."""
    values = np.linalg.eigvals(monodromy_matrix).astype(np.complex128)
    order = np.lexsort((-values.imag, -np.abs(values)), axis=-1)
    return np.take_along_axis(values, order, axis=-1)


def degree_of_stability(monodromy_matrix: Array) -> Array:
    """Largest ln|multiplier| / (2 pi), per radian of u, shape (...); negative: asymptotically stable.

    Infinite where the motion of one orbit is beyond the range of numbers.
    """
    finite = np.asarray(np.isfinite(monodromy_matrix).all(axis=(-2, -1)))
    largest = np.abs(np.linalg.eigvals(np.where(finite[..., None, None], monodromy_matrix, 0.0))).max(axis=-1)
    return np.where(finite, np.log(np.where(finite, largest, 1.0)) / (2.0 * pi), np.inf)


def settling_orbits(degree: float) -> float | None:
    """Orbits after which the slowest mode has fallen to ``SETTLED`` of itself; None if it does not."""
    return log(SETTLED) / (2.0 * pi * degree) if degree < -NEUTRAL else None


def _radau_table(stages: int) -> tuple[Array, Array]:
    """Nodes c and weights a of Radau IIA: collocation at the zeros of P_s - P_(s-1) on [0, 1]."""
    zeros = np.sort(legendre.legroots([0.0] * (stages - 1) + [-1.0, 1.0]).real)
    nodes = np.append(0.5 * (zeros[:-1] + 1.0), 1.0)
    weights = np.empty((stages, stages))
    for column, node in enumerate(nodes):
        lagrange = Polynomial.fromroots(np.delete(nodes, column))
        integral = (lagrange / lagrange(node)).integ()
        weights[:, column] = integral(nodes) - integral(0.0)
    return nodes, weights


_NODES, _WEIGHTS = _radau_table(5)
