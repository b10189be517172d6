"""Whether field and Sun bear each other out.

Before an attitude is known, their angle is all that can be held against the model. Where it is wrong, one of
the two sensors is, and nothing tells which; and for minutes it may be right by chance. So no estimate begins
with a pair that has just contradicted itself, and one that has begun must prove itself, by taking both again
and again while the satellite turns, before what it refuses counts against a sensor.
"""

from typing import NamedTuple

MISFIT = 20
"""Good samples that a bad one undoes."""


class PairConfig(NamedTuple):
    """Times of a contradiction and of an agreement.

    ``say_ticks``: of contradiction before it is said; ``prove_ticks``: in which an estimate has to take both;
    ``agree_ticks``: for which they must agree after a contradiction.
    """

    say_ticks: int
    prove_ticks: int
    agree_ticks: int


class Compared(NamedTuple):
    """One tick.

    ``seen``: there are both; ``agree``: nothing speaks against them; ``unexplained``: their angle is wrong,
    or an estimate that is not credible refuses one, and neither is known to be wrong. ``took_both`` (and is
    credible) and ``refused`` (any) tell of the estimate, if it is ``known``.
    """

    seen: bool
    agree: bool
    unexplained: bool
    known: bool
    took_both: bool
    refused: bool


class Pair(NamedTuple):
    """What is known of both.

    ``apart``: ticks of contradiction without a proven estimate, those of agreement taken off, and
    ``contradictory``: they were enough to say so. ``proof``: ticks in which the estimate took both; below 0:
    ticks for which they must agree before there is one.
    """

    apart: int = 0
    contradictory: bool = False
    proof: int = 0


def proven(pair: Pair, config: PairConfig) -> bool:
    """Whether what the estimate refuses counts against a sensor."""
    return pair.proof >= config.prove_ticks


def judge_pair(before: Pair, tick: Compared, config: PairConfig) -> Pair:
    """The pair after a tick."""
    if tick.unexplained and not proven(before, config):
        apart = min(before.apart + 1, config.say_ticks)
    else:
        apart = max(before.apart - 1, 0)
    contradictory = apart == config.say_ticks or (before.contradictory and apart > 0)
    if contradictory and not before.contradictory:
        return Pair(apart, True, -config.agree_ticks)
    return Pair(apart, contradictory, _proof(before, tick, config))


def _proof(before: Pair, tick: Compared, config: PairConfig) -> int:
    """An estimate gains by each pair that it takes; without one, what it had proved is lost."""
    proof = before.proof
    if tick.known:
        if proven(before, config):
            return proof
        return max(0, proof - MISFIT) if tick.refused else proof + tick.took_both
    owed = min(proof, 0)
    if not tick.seen:
        return owed
    return min(owed + 1, 0) if tick.agree else max(owed - MISFIT, -config.agree_ticks)
