"""Steps of a bench log: the response to a command by its rises and falls, and how well it is known."""

from dataclasses import dataclass
from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.value_types import Array

WEAK_SIGMAS = 20.0
"""Below so many standard deviations a single sample does not show the phase of a step."""
LEAST_NT2 = 1e-12
"""In place of a variance of nothing."""


class Share(NamedTuple):
    """Readings in a row of which an edge is made: which, the weight of each, the variance of one, nT^2."""

    rows: NDArray[np.int64]
    weight: float
    variance: Array


class Edge(NamedTuple):
    """A change of the command: the step of the reading, nT, sensor axes, and the readings of which it is.

    ``unchanged_s``, ``changed_s``: ages of the last sample without the step and of the first with it.
    """

    step_nt: Array
    shares: tuple[Share, Share]
    unchanged_s: float
    changed_s: float


@dataclass(frozen=True, slots=True)
class Step:
    """The response of a magnetometer to one command, all its rises and falls taken together.

    Attributes:
        command_am2: what was commanded, by axis.
        response_nt, sigma_nt: on less off, and the standard deviation of that.
        edges: how many rises and falls.
        unchanged_s: age of the last sample after an edge that shows none of the step, mean; 0: there is none.
        changed_s: age of the first sample that shows all of it, mean; NaN where the step is too weak.
    """

    command_am2: tuple[float, float, float]
    response_nt: Array
    sigma_nt: Array
    edges: int
    unchanged_s: float
    changed_s: float


def fall_as_rise(edge: Edge) -> Edge:
    """The edge at which a command ends, as that at which it begins."""
    before, later = (share._replace(weight=-share.weight) for share in edge.shares)
    return edge._replace(step_nt=-edge.step_nt, shares=(before, later))


def step_of(command: tuple[float, float, float], edges: list[Edge]) -> Step:
    """The response to a command: the mean of its rises and falls."""
    steps = np.array([edge.step_nt for edge in edges])
    sigma, apart = _sigma(edges)
    if len(edges) > 1:  # of the scatter between edges, drift included, what the mean of them keeps
        sigma = np.maximum(sigma, steps.std(axis=0, ddof=1) / np.sqrt(len(edges)) * sigma / apart)
    least_nt = WEAK_SIGMAS * float(np.linalg.norm(sigma))
    clear = [edge for edge in edges if float(np.linalg.norm(edge.step_nt)) > least_nt]
    unchanged_s = float(np.mean([edge.unchanged_s for edge in clear])) if clear else nan
    changed_s = float(np.mean([edge.changed_s for edge in clear])) if clear else nan
    return Step(command, steps.mean(axis=0), np.asarray(sigma, float), len(edges), unchanged_s, changed_s)


def _sigma(edges: list[Edge]) -> tuple[Array, Array]:
    """Of the mean of edges, and what it were if they shared no readings, as a rise and its fall do."""
    shares = [share for edge in edges for share in edge.shares]
    apart = sum(share.weight**2 * len(share.rows) * share.variance for share in shares)
    last = max(int(share.rows[-1]) for share in shares)
    weights, variance = np.zeros(last + 1), np.zeros((last + 1, 3))
    for share in shares:
        weights[share.rows] += share.weight
        variance[share.rows] = np.maximum(variance[share.rows], share.variance)
    both = np.array([weights**2 @ variance, np.maximum(apart, LEAST_NT2)])
    sigma, alone = np.sqrt(both) / len(edges)
    return sigma, alone
