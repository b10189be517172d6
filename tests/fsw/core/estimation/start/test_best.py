"""Motions under improvement: each keeps what was better, and steps more boldly after it."""

import numpy as np

from fsw.core.estimation.start.batch_fit import Equations
from fsw.core.estimation.start.batch_model import Motions
from fsw.core.estimation.start.best import BOLDER, FIRST_DAMPING, MORE_CAREFUL, better_of


def passed(first, costs):
    """Three motions that have gone through the samples, told apart by their numbers."""
    numbers = first + np.arange(6.0).reshape(3, 2)
    q = first + np.arange(12.0).reshape(3, 4)
    normal = first + np.arange(12.0).reshape(3, 2, 2)
    return Motions(q, numbers), Equations(normal, numbers + 0.5, np.array(costs), numbers[:, 0]), q + 0.25


def test_the_first_are_the_best():
    motions, equations, ends = passed(0.0, [3.0, 1.0, 2.0])
    best = better_of(motions, equations, ends, None)
    assert (best.motions, best.equations) == (motions, equations)
    np.testing.assert_array_equal(best.damping, FIRST_DAMPING)


def test_each_is_kept_or_replaced_by_itself():
    before = better_of(*passed(0.0, [3.0, 1.0, np.nan]), None)
    now = passed(100.0, [2.0, 1.5, 2.0])
    best = better_of(*now, before)
    np.testing.assert_array_equal(best.equations.costs, [2.0, 1.0, np.nan])
    for kept, old, new in (
        (best.motions.q, before.motions.q, now[0].q),
        (best.motions.numbers, before.motions.numbers, now[0].numbers),
        (best.equations.normal, before.equations.normal, now[1].normal),
        (best.ends, before.ends, now[2]),
    ):
        np.testing.assert_array_equal(kept, [new[0], old[1], old[2]])
    np.testing.assert_allclose(best.damping / FIRST_DAMPING, [BOLDER, MORE_CAREFUL, MORE_CAREFUL])
