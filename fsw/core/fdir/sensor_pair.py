"""Whether field and Sun agree with each other.

Without an attitude their angle is all that can be compared with the model. Where it is wrong one of the two
sensors is faulty, and nothing isolates it; and for minutes it may be right by chance. So no estimate begins
with a pair that has just contradicted itself, and one that has begun must prove itself, by taking both again
and again while the satellite turns, before what it refuses counts against a sensor.
"""

from typing import NamedTuple

MISFIT = 20
"""Good samples that a bad one undoes."""


class PairConfig(NamedTuple):
    """Times of a contradiction and of an agreement.

    ``report_ticks``: of contradiction before it is reported; ``prove_ticks``: in which an estimate has to
    take both; ``agree_ticks``: for which they must agree after a contradiction.
    """

    report_ticks: int
    prove_ticks: int
    agree_ticks: int


class Comparison(NamedTuple):
    """Field and Sun in one tick.

    ``both``: both were measured; ``agree``: nothing speaks against them; ``unexplained``: their angle is
    wrong, or an estimate that is not credible refuses one, and neither sensor has a fault of its own that
    explains it. ``estimated``: there is an estimate; ``took_both``: it took both, and is credible;
    ``refused``: it refused any.
    """

    both: bool
    agree: bool
    unexplained: bool
    estimated: bool
    took_both: bool
    refused: bool


class Pair(NamedTuple):
    """What both together have shown.

    ``apart``: ticks of contradiction without a proven estimate, less those of agreement, and
    ``contradictory``: they were enough to report it. ``proof``: ticks in which the estimate took both; below
    0: ticks for which they must agree before there is one.
    """

    apart: int = 0
    contradictory: bool = False
    proof: int = 0


def proven(pair: Pair, config: PairConfig) -> bool:
    """Whether what the estimate refuses counts against a sensor."""
    return pair.proof >= config.prove_ticks


def judge_pair(before: Pair, comparison: Comparison, config: PairConfig) -> Pair:
    """The pair after a tick."""
    if comparison.unexplained and not proven(before, config):
        apart = min(before.apart + 1, config.report_ticks)
    else:
        apart = max(before.apart - 1, 0)
    contradictory = apart == config.report_ticks or (before.contradictory and apart > 0)
    if contradictory and not before.contradictory:
        return Pair(apart, True, -config.agree_ticks)
    return Pair(apart, contradictory, _proof(before, comparison, config))


def _proof(before: Pair, comparison: Comparison, config: PairConfig) -> int:
    """An estimate gains by each pair that it takes; without one, what it had proved is lost."""
    proof = before.proof
    if comparison.estimated:
        if proven(before, config):
            return proof
        return max(0, proof - MISFIT) if comparison.refused else proof + comparison.took_both
    owed = min(proof, 0)
    if not comparison.both:
        return owed
    return min(owed + 1, 0) if comparison.agree else max(owed - MISFIT, -config.agree_ticks)
