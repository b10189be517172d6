"""Motions under improvement: what each has reached so far, and how boldly to step on."""

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.start.batch_fit import Equations
from fsw.core.estimation.start.batch_model import Motions

FIRST_DAMPING, BOLDER, MORE_CAREFUL = 1e-2, 0.2, 10.0
"""Of the Levenberg-Marquardt method: at first, and its factors after a step that was better, or was not."""


@final
@dataclass(frozen=True, slots=True)
class Best:
    """The motions as improved so far, their equations, attitudes at the end, (n, 4), and damping."""

    motions: Motions
    equations: Equations
    ends: Matrix
    damping: Matrix


def better_of(motions: Motions, equations: Equations, ends: Matrix, before: Best | None) -> Best:
    """The best so far, with those that have just gone through the samples.

    Args:
        motions: n of them, as they began.
        equations: of them.
        ends: their attitudes at the last sample, (n, 4).
        before: the best of the passes before; None: this was the first.
    """
    if before is None:
        return Best(motions, equations, ends, np.full(len(ends), FIRST_DAMPING))
    earlier = before.equations
    better = equations.costs < earlier.costs
    return Best(
        Motions(
            _where(better, motions.q, before.motions.q),
            _where(better, motions.numbers, before.motions.numbers),
        ),
        Equations(
            _where(better, equations.normal, earlier.normal),
            _where(better, equations.gradient, earlier.gradient),
            _where(better, equations.costs, earlier.costs),
            _where(better, equations.measured, earlier.measured),
        ),
        _where(better, ends, before.ends),
        np.where(better, BOLDER * before.damping, MORE_CAREFUL * before.damping),
    )


def _where(better: NDArray[np.bool_], mine: Matrix, theirs: Matrix) -> Matrix:
    """The rows of one or the other, by motion."""
    rows: Matrix = np.where(better.reshape(-1, *(1,) * (mine.ndim - 1)), mine, theirs)
    return rows
