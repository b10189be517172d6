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

from dataclasses import dataclass
from enum import IntEnum
from typing import final

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
from fsw.core.estimation.start.best import Best, better_of
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
    """SURVEY: the cost of all starts; IMPROVE: the best of them; CARRY: the one found; ENDED."""

    SURVEY = 0
    IMPROVE = 1
    CARRY = 2
    ENDED = 3


@final
@dataclass(slots=True)
class MotionSearch:
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

    def copy(self) -> "MotionSearch":
        """A search that goes on by itself from here; the arrays are shared, since none is changed."""
        return MotionSearch(
            self.searched,
            self.stage,
            self.at,
            self.steps,
            self.motions,
            self.q,
            self.omega,
            self.equations,
            self.best,
        )


def start_search(samples: tuple[BatchSample, ...], model: BatchModel) -> MotionSearch:
    """A search over these samples."""
    motions, first = starts(samples, model), samples[0]
    q, omega = motions.q, motions.numbers[:, 0:3]
    equations = add_sample(
        at_priors(motions, model, len(q)), motions, expected(motions, first, model), first, model
    )
    return MotionSearch(len(samples), Stage.SURVEY, 0, 0, motions, q, omega, equations)


def at_end(search: MotionSearch, samples: tuple[BatchSample, ...]) -> bool:
    """Whether the next piece is the last one."""
    return search.stage is Stage.CARRY and search.at >= len(samples) - 1


def work(
    search: MotionSearch, samples: tuple[BatchSample, ...], rest: BatchSample | None, model: BatchModel
) -> Estimate | None:
    """Do a piece of work; the estimate at this tick, if the search ends with one.

    It ends without where the samples leave more than one motion, or none fits.

    Args:
        search: under way.
        samples: of the batch, oldest first; there may be more than when it began.
        rest: what was driven since the last of them; None: the last is of this tick.
        model: what the table says.
    """
    last = len(samples) - 1 if search.stage is Stage.CARRY else search.searched - 1
    try:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # an absurd motion has no cost
            if search.at < last:
                _next_leg(search, samples, model)
            elif search.stage is Stage.SURVEY:
                _choose(search, samples[0], model)
            elif search.stage is Stage.IMPROVE:
                _improve(search, samples[0], model)
            else:
                return _end(search, samples, rest, model)
    except np.linalg.LinAlgError:  # the equations of damaged samples
        search.stage = Stage.ENDED
    return None


def _pass_again(
    search: MotionSearch, stage: Stage, motions: Motions, first: BatchSample, model: BatchModel
) -> None:
    """Set out with these motions, varied, from the first sample, which is counted."""
    going = varied(motions, model)
    equations = at_priors(motions, model, len(going.q))
    search.equations = add_sample(equations, motions, expected(going, first, model), first, model)
    search.stage, search.at, search.motions = stage, 0, motions
    search.q, search.omega = going.q, going.numbers[:, 0:3]


def _next_leg(search: MotionSearch, samples: tuple[BatchSample, ...], model: BatchModel) -> None:
    """Carry the motions to the next sample, which is counted."""
    before, after = samples[search.at], samples[search.at + 1]
    going = _going(search, model)
    search.q, search.omega = _flown(search, going, before, after, model)
    seen = expected(Motions(search.q, going.numbers), after, model)
    search.equations = add_sample(search.equations, search.motions, seen, after, model)
    search.at += 1


def _going(search: MotionSearch, model: BatchModel) -> Motions:
    """The motions that go through the samples, as they began."""
    return search.motions if search.stage is Stage.SURVEY else varied(search.motions, model)


def _flown(
    search: MotionSearch, going: Motions, before: BatchSample, after: BatchSample, model: BatchModel
) -> tuple[Matrix, Matrix]:
    alike, rotor = len(search.motions.q), model.config.rotor
    return flown(search.q, search.omega, leg(before, after), disturbances(going), rotor, alike)


def _choose(search: MotionSearch, first: BatchSample, model: BatchModel) -> None:
    """Let the best of the starts go through the samples again."""
    best = _order(search.equations.costs)[:IMPROVED]
    _pass_again(search, Stage.IMPROVE, search.motions.chosen(best), first, model)


def _order(costs: Matrix) -> list[int]:
    """The numbers of the motions, the cheapest first."""
    order: list[int] = np.argsort(costs, kind="stable").tolist()
    return order


def _improve(search: MotionSearch, first: BatchSample, model: BatchModel) -> None:
    """Keep the motions that are better than before, and step all of them while there are steps left."""
    best = better_of(search.motions, search.equations, search.q[: len(search.motions.q)], search.best)
    if search.steps >= STEPS:
        _find(search, best, first, model)
        return
    tried = best.motions.changed(improving_step(best.equations, best.damping))
    search.steps, search.best = search.steps + 1, best
    _pass_again(search, Stage.IMPROVE, tried, first, model)


def _find(search: MotionSearch, best: Best, first: BatchSample, model: BatchModel) -> None:
    """Let the best motion go through the samples once more, if it is the only one that they allow."""
    costs, ends = best.equations.costs, best.ends
    order = _order(costs)
    chosen = order[0]
    others = [one for one in order[1:] if abs(ends[one].dot(ends[chosen])) < APART]
    alone = all([costs[one] - costs[chosen] > LEAD for one in others])
    if not (alone and _fits(float(costs[chosen]), best.equations)):
        search.stage = Stage.ENDED
        return
    search.steps, search.best = 0, None
    _pass_again(search, Stage.CARRY, best.motions.chosen([chosen]), first, model)


def _fits(cost: float, equations: Equations) -> bool:
    """Whether half of chi square is small enough for the numbers that were measured."""
    return 2.0 * cost <= MOST_MISFIT * float(equations.measured[0])


def _end(
    search: MotionSearch, samples: tuple[BatchSample, ...], rest: BatchSample | None, model: BatchModel
) -> Estimate | None:
    """The estimate at this tick; let the motion go through the samples again if it has not settled."""
    q, omega = search.q, search.omega
    if rest is not None:
        q, omega = _flown(search, _going(search, model), samples[-1], rest, model)
    estimate, cost = estimate_of(search.motions, search.equations, q, omega, model)
    fits = _fits(cost, search.equations)
    settled = float(search.equations.costs[0]) - cost < SETTLED
    if not fits or settled or search.steps + 1 >= CARRIED:
        search.stage = Stage.ENDED
        return estimate if fits and settled else None
    better = search.motions.changed(improving_step(search.equations, np.zeros(1)))
    search.steps += 1
    _pass_again(search, Stage.CARRY, better, samples[0], model)
    return None
