"""The search for the motion behind a batch of samples, a few pieces in each tick.

The unknowns are attitude and rate at the first sample and, with their priors, residual dipole, torque,
inertia, the bias of the field, excess and gain of each cell and the light of the Earth, taken as constant
over the batch. The starts are rotations about the first field, with the rates that the field's own motion
leaves open; the best of them are improved by the Levenberg-Marquardt method. The motion is found if no other
that ends ``APART`` or more away comes within ``LEAD`` nats of it. It is then carried on through the samples
that have come meanwhile, and improved until it has settled.

All motions go through the samples side by side. A piece is one leg of all, from one sample to the next, or
the work at the end. So the work of a tick does not grow with the number of samples.

Source: Marquardt 1963; batch estimators as in Crassidis and Junkins 2012, section 1.6.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.start.batch_fit import (
    Equations,
    add_sample,
    at_priors,
    estimate_of,
    improving_step,
)
from fsw.core.estimation.start.batch_model import (
    BatchModel,
    Motions,
    disturbances,
    expected,
    leg,
    starts,
    varied,
)
from fsw.core.estimation.start.batch_sample import BatchSample
from fsw.core.estimation.start.best import Best, improved
from fsw.core.estimation.start.motions import flown

PIECES = 4
"""Of work in a tick."""
IMPROVED, STEPS = 14, 12
LEAD = 8.0
APART = 0.9848
"""Cosine of half the angle, 20 deg."""
MOST_MISFIT = 3.0
"""Largest chi square of a found motion per number measured."""
SETTLED, CARRIED = 0.5, 6
"""A motion has settled when another step promises fewer nats, so is within one standard deviation; it is
carried through the samples at most so many times."""


class Stage(IntEnum):
    """SURVEY: the cost of all starts; IMPROVE: the best of them; CARRY: the one found, to this tick."""

    SURVEY = 0
    IMPROVE = 1
    CARRY = 2


class MotionSearch(NamedTuple):
    """A search under way.

    ``searched``: how many samples of the batch are fitted, from the first on; ``at``: the index of the one
    that the motions have reached; ``steps``: how often they were improved. ``motions``: those that go through
    the samples, as they began; ``q`` and ``omega``: where they are now, followed, except in the survey, by
    where each is with one of its numbers varied; ``equations``: of the samples so far.
    """

    searched: int
    stage: Stage
    at: int
    steps: int
    motions: Motions
    q: Matrix
    omega: Matrix
    equations: Equations
    best: Best | None = None


Ended = Estimate | None
"""None where the samples leave more than one motion, or none fits."""


def begun(samples: tuple[BatchSample, ...], model: BatchModel) -> MotionSearch:
    """A search over these samples."""
    return _passing(Stage.SURVEY, len(samples), 0, starts(samples, model), samples[0], model)


def at_end(search: MotionSearch, samples: tuple[BatchSample, ...]) -> bool:
    """Whether the next piece is the last one."""
    return search.stage is Stage.CARRY and search.at >= len(samples) - 1


def worked(
    search: MotionSearch, samples: tuple[BatchSample, ...], rest: BatchSample | None, model: BatchModel
) -> MotionSearch | Ended:
    """The search after a piece of work, or the estimate at this tick with which it ends.

    Args:
        search: before.
        samples: of the batch, oldest first; there may be more than when it began.
        rest: what was driven since the last of them; None: the last is of this tick.
        model: what the table says.
    """
    last = len(samples) - 1 if search.stage is Stage.CARRY else search.searched - 1
    try:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # an absurd motion has no cost
            if search.at < last:
                return _leg_on(search, samples, model)
            if search.stage is Stage.SURVEY:
                return _chosen(search, samples[0], model)
            if search.stage is Stage.IMPROVE:
                return _improved(search, samples[0], model)
            return _estimate(search, samples, rest, model)
    except np.linalg.LinAlgError:  # the equations of damaged samples
        return None


def _passing(
    stage: Stage,
    count: int,
    steps: int,
    motions: Motions,
    first: BatchSample,
    model: BatchModel,
    best: Best | None = None,
) -> MotionSearch:
    """A search with the motions at the first sample, which is counted."""
    going = motions if stage is Stage.SURVEY else varied(motions, model)
    equations = at_priors(motions, model, len(going.q))
    equations = add_sample(equations, motions, expected(*going, first, model), first, model)
    return MotionSearch(count, stage, 0, steps, motions, going.q, going.numbers[:, 0:3], equations, best)


def _leg_on(search: MotionSearch, samples: tuple[BatchSample, ...], model: BatchModel) -> MotionSearch:
    """The search with the motions at the next sample, which is counted."""
    before, after = samples[search.at], samples[search.at + 1]
    going = _going(search, model)
    q, omega = _flown(search, going, before, after, model)
    seen = expected(q, going.numbers, after, model)
    equations = add_sample(search.equations, search.motions, seen, after, model)
    return search._replace(at=search.at + 1, q=q, omega=omega, equations=equations)


def _going(search: MotionSearch, model: BatchModel) -> Motions:
    """The motions that go through the samples, as they began."""
    return search.motions if search.stage is Stage.SURVEY else varied(search.motions, model)


def _flown(
    search: MotionSearch, going: Motions, before: BatchSample, after: BatchSample, model: BatchModel
) -> tuple[Matrix, Matrix]:
    alike, rotor = len(search.motions.q), model.config.rotor
    return flown(search.q, search.omega, leg(before, after), disturbances(going), rotor, alike)


def _chosen(search: MotionSearch, first: BatchSample, model: BatchModel) -> MotionSearch:
    """The best of the starts go through the samples again."""
    best = _order(search.equations.costs)[:IMPROVED]
    motions = search.motions.chosen(best)
    return _passing(Stage.IMPROVE, search.searched, 0, motions, first, model)


def _order(costs: Matrix) -> list[int]:
    """The numbers of the motions, the cheapest first."""
    order: list[int] = np.argsort(costs, kind="stable").tolist()
    return order


def _improved(search: MotionSearch, first: BatchSample, model: BatchModel) -> MotionSearch | None:
    """Keep the motions that are better than before, and step all of them while there are steps left."""
    best = improved(search.motions, search.equations, search.q[: len(search.motions.q)], search.best)
    if search.steps >= STEPS:
        return _found(search.searched, best, first, model)
    tried = best.motions.changed(improving_step(best.equations, best.damping))
    return _passing(Stage.IMPROVE, search.searched, search.steps + 1, tried, first, model, best)


def _found(count: int, best: Best, first: BatchSample, model: BatchModel) -> MotionSearch | None:
    """The best motion goes through the samples once more, if it is the only one that they allow."""
    costs, ends = best.equations.costs, best.ends
    order = _order(costs)
    chosen = order[0]
    others = [one for one in order[1:] if abs(ends[one].dot(ends[chosen])) < APART]
    alone = all(costs[one] - costs[chosen] > LEAD for one in others)
    if not (alone and _fits(float(costs[chosen]), best.equations)):
        return None
    return _passing(Stage.CARRY, count, 0, best.motions.chosen([chosen]), first, model)


def _fits(cost: float, equations: Equations) -> bool:
    """Whether half of chi square is small enough for the numbers that were measured."""
    return 2.0 * cost <= MOST_MISFIT * float(equations.measured[0])


def _estimate(
    search: MotionSearch, samples: tuple[BatchSample, ...], rest: BatchSample | None, model: BatchModel
) -> MotionSearch | Ended:
    """The estimate at this tick; the motion goes through the samples again if it has not settled."""
    q, omega = search.q, search.omega
    if rest is not None:
        q, omega = _flown(search, _going(search, model), samples[-1], rest, model)
    estimate, cost = estimate_of(search.motions, search.equations, q, omega, model)
    if not _fits(cost, search.equations):
        return None
    if float(search.equations.costs[0]) - cost < SETTLED:
        return estimate
    if search.steps + 1 >= CARRIED:
        return None
    better = search.motions.changed(improving_step(search.equations, np.zeros(1)))
    return _passing(Stage.CARRY, search.searched, search.steps + 1, better, samples[0], model)
