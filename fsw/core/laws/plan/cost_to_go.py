"""The cost still to come of the linear-quadratic problem, with the same bits on every machine.

The recursion is that of ``riccati.backward``. That one multiplies by BLAS, which orders its sums to suit the
processor; here each sum is taken in the order of its terms, and what was computed by BLAS when the table was
loaded enters rounded to single precision, so that a plan made from it can be replayed elsewhere.

Source: as for ``riccati``.
"""

from dataclasses import replace

import numpy as np

from fsw.core.algebra.vector import Mat3, inverse
from fsw.core.laws.plan.riccati import Array, Problem, Schedule, skews


def times(a: Array, b: Array) -> Array:
    """A b of two matrices, each sum in the order of its terms."""
    summed: Array = np.add.reduce(a[:, :, None] * b[None, :, :], axis=1)
    return summed


def rounded(values: Array) -> Array:
    """The values in single precision: what differs only in the last bits becomes equal."""
    return values.astype(np.float32).astype(np.float64)


def rounded_problem(problem: Problem) -> Problem:
    """The problem with the motion over a step rounded."""
    return replace(problem, free=rounded(problem.free))


def rounded_schedule(schedule: Schedule) -> Schedule:
    """The schedule with motion and costs rounded."""
    problem = rounded_problem(schedule.problem)
    return replace(schedule, problem=problem, costs=rounded(schedule.costs))


def cost_to_go(problem: Problem, b_orbit_t: Array, drifts: Array, last: Array) -> list[Array]:
    """(P S s) at the beginning of each step, in their order; the cost is x^T P x + 2 x^T (S d + s) + ...

    Args:
        problem: the problem.
        b_orbit_t: field of each step, orbital axes, T, shape (n, 3).
        drifts: what else is known to be added to the state in each step, shape (n, 6); s is due to it.
        last: (P S s) at the end of the last step, shape (6, 10).
    """
    costs: list[Array] = []
    back, ahead = problem.free[:, :6].T, last
    pushes = [-times(problem.free[:, 6:], across) for across in skews(b_orbit_t)]
    for push, drift in zip(pushes[::-1], drifts[::-1], strict=True):
        reached = times(ahead[:, :6], np.hstack([problem.free, drift[:, None], push]))
        reached[:, 6:10] += ahead[:, 6:]
        curvature = times(push.T, reached)
        gain = times(_answer(curvature[:, 10:], problem.effort), curvature[:, :10])
        ahead = times(back, reached[:, :10] + times(reached[:, 10:], gain))
        ahead[range(6), range(6)] += problem.cost
        costs.append(ahead)
    return costs[::-1]


def _answer(curvature: Array, effort: float) -> Array:
    """-(curvature + effort E)^-1, 3 x 3."""
    (a, b, c), (d, e, f), (g, h, i) = curvature.tolist()
    matrix: Mat3 = ((a + effort, b, c), (d, e + effort, f), (g, h, i + effort))
    return -np.array(inverse(matrix))
