"""The pulses to come: a search among what pulsed coils can do, one choice at each opportunity.

At an opportunity one coil fires at one of three levels with either sign, or none does: 19 choices. A pulse
changes the rate at once, and the body then moves freely until the next opportunity, as in ``riccati``:

    x+ = F (x + (J^-1 (T_p m x b), 0)) + G (d + m_r x b) - (w0' h, w0' h^2 / 2) e3

d the constant torque, m_r the residual dipole, w0' the change of the rate of a non-circular orbit, h the time
between opportunities. The sequence sought has the least sum of rate |Omega / w0|^2 + |theta|^2 plus, after
its end, what a dipole without limits would leave, x^T P x + 2 x^T (S d + s); by beam search: only the
sequences with the least cost so far and to go continue from an opportunity. No sum and no choice depends on
how a processor orders its work.

Source: the choice among 18 pulses and none: Tavares et al. (ConSat, PoSAT-1); the horizon: Ovchinnikov,
Roldugin 2019, section 3.3; beam search: Lowerre 1976. Their combination is this project's.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.core.laws.plan.cost_to_go import times
from fsw.core.laws.plan.pulse_model import NO_PULSE, Pulse, PulseModel
from fsw.core.laws.plan.riccati import Array

SEQUENCES = 32
"""How many continue from one opportunity to the next."""
BARRED = 1_000_000
"""Wait, in opportunities, of a coil that may never be fired: longer than any search."""

Numbers = NDArray[np.int64]


class Opportunity(NamedTuple):
    """What is known of one, in orbital axes.

    ``kicks`` are the changes of rate by each choice, rad/s, shape (19, 3), ``drift`` is what is known to be
    added to the state until the next one, shape (6,), and ``cost`` is (P S s) at the next one, shape (6, 10).
    """

    kicks: Array
    drift: Array
    cost: Array


def first_pulse(
    state: Sequence[float],
    ahead: Sequence[Opportunity],
    model: PulseModel,
    waits: tuple[int, int, int],
) -> Pulse:
    """The first choice of the best sequence; none if nothing is ahead.

    Args:
        state: x and d, orbital axes, nine numbers.
        ahead: the opportunities to come.
        model: the choices at each, and the motion from one to the next.
        waits: by coil, opportunities that pass before it may be fired.
    """
    problem, pulses = model.problem, model.pulses
    f, g, by_coil = problem.free[:, :6], problem.free[:, 6:], len(pulses) // 3
    x, torque_nm = np.array(state[:6]).reshape(6, 1), np.array(state[6:]).reshape(3, 1)
    known = np.array([*state[6:], 1.0]).reshape(4, 1)
    spent, waiting = np.zeros(1), np.array(waits).reshape(3, 1)
    first, best = np.zeros(0, dtype=np.int64), 0
    for opportunity in ahead:
        p, s = opportunity.cost[:, :6], opportunity.cost[:, 6:]
        spent = spent + np.add.reduce(problem.cost[:, None] * x * x, axis=0)
        drifted = times(f, x) + (times(g, torque_nm) + opportunity.drift[:, None])
        pushes = times(f[:, :3], opportunity.kicks.T)
        total = spent[:, None] + _to_go(drifted, pushes, p, times(s, known))
        total[:, 1:][np.repeat(waiting.T > 0, by_coil, axis=1)] = np.inf
        sequence, choice = np.divmod(_least(total.ravel()), len(pulses))
        best = int(np.argmin(total[sequence, choice]))
        first = first[sequence] if len(first) else choice
        x, spent = drifted[:, sequence] + pushes[:, choice], spent[sequence]
        waiting = np.maximum(waiting[:, sequence] - 1, 0)
        fired = np.flatnonzero(choice)
        waiting[(choice[fired] - 1) // by_coil, fired] = model.rest - 1
    return pulses[int(first[best])] if len(first) else NO_PULSE


def _to_go(states: Array, pushes: Array, p: Array, slope: Array) -> Array:
    """(x + u)^T P (x + u) + 2 (x + u)^T s for each state x and each push u, shape (states, pushes)."""
    weighted = times(p, states)
    of_state = np.add.reduce(states * (weighted + 2.0 * slope), axis=0)
    of_push = np.add.reduce(pushes * times(p, pushes), axis=0)
    both = times((2.0 * (weighted + slope)).T, pushes)
    total: Array = of_state[:, None] + of_push[None, :] + both
    return total


def _least(costs: Array) -> Numbers:
    """The places of the least costs that are finite; of equal ones the first."""
    finite = np.flatnonzero(costs < np.inf)
    if len(finite) <= SEQUENCES:
        return finite
    bound = np.partition(costs, SEQUENCES - 1)[SEQUENCES - 1]
    below, at = np.flatnonzero(costs < bound), np.flatnonzero(costs == bound)
    return np.concatenate([below, at[: SEQUENCES - len(below)]])
