"""The best gains of a law on a body, under rules that are the same for every law.

A budget of flights is spent so: one with the scenario's own gains, one for each common gain to see whether
the law uses it, then the points of a Halton sequence over the logarithms of the free gains, then the simplex
of Nelder and Mead from the best of these. Every flight is of the rigid body in the direct dipole's field from
the scenario's start. Nothing is random: the sequence begins anew for each law.

Source: Halton 1960 for the sequence, Nelder and Mead 1965 for the simplex, both by SciPy.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import qmc

from fsw.core.laws.table import LAWS
from fsw.input.schema import Nested, TableError, merge
from fsw.table.table import lay_over
from sim.design.tuning.cost import LOST, Cost, cost_of
from sim.design.tuning.free_gains import FreeGain, as_control, common_gains, own_gains
from sim.design.tuning.rigid_flight import fly
from sim.scenario.schema import load

BUDGET = 24
"""Flights for a law."""
ORBITS = 4.0
"""Length of each."""
SPREAD_PART = 0.6
"""Of the flights that are left, the part for the sequence."""
USED = 1e-9
"""A gain whose change alters the cost by less is not used by the law."""
DIRECT: Nested = {"knowledge": "perfect", "field": {"model": "direct_dipole"}}

Array = NDArray[np.float64]
Watch = Callable[[int], None]


@dataclass(frozen=True, slots=True)
class TunedGains:
    """The best gains found.

    Attributes:
        law: whose.
        driver: of the coils.
        control: the keys of ``[control]`` that were searched.
        cost: with them.
        before: the cost with the scenario's own gains.
        flights: that it took.
    """

    law: str
    driver: str
    control: Nested
    cost: Cost
    before: Cost
    flights: int


@dataclass(slots=True)
class _Trials:
    """The flights of a search, counted, and the best of them."""

    scenario: str
    over: Nested
    law: str
    orbits: float
    step_s: float | None
    watch: Watch
    flown: int = 0
    best: tuple[float, Nested, Cost] = field(default=(np.inf, {}, Cost(LOST, None, np.inf)))

    def cost(self, control: Nested) -> Cost:
        """Of a flight with these gains; one that no table allows is lost."""
        values = lay_over(merge(self.over, DIRECT), {"control": merge({"law": self.law}, control)})
        try:
            scenario = load(self.scenario, values)
            found = cost_of(fly(scenario, self.orbits, self.step_s), scenario, LAWS[self.law].aim)
        except (TableError, ArithmeticError):
            found = Cost(LOST, None, np.inf)
        self.flown += 1
        self.watch(self.flown)
        if found.total < self.best[0]:
            self.best = (found.total, control, found)
        return found


def tune(
    scenario: str,
    over: Nested,
    law: str,
    budget: int = BUDGET,
    orbits: float = ORBITS,
    step_s: float | None = None,
    watch: Watch = lambda done: None,
) -> TunedGains:
    """The best gains of a law of the table.

    Args:
        scenario: its name or path.
        over: laid over it, the driver among it.
        law: the name of the law.
        budget: flights.
        orbits: length of each.
        step_s: of the flights; None: as ``fly`` has it.
        watch: called with the number of flights done.

    Raises:
        TableError: the scenario is not valid.
    """
    whole = load(scenario, over)
    trials = _Trials(scenario, over, law, orbits, step_s, watch)
    before = trials.cost({})
    free = [*_used(trials, common_gains(whole), before), *own_gains(law)]
    if free:
        _search(trials, free, budget)
    _, control, cost = trials.best
    return TunedGains(law, whole.coils.driver, control, cost, before, trials.flown)


def _used(trials: _Trials, common: Sequence[FreeGain], before: Cost) -> list[FreeGain]:
    """Those of the common gains that the law uses: with another value the cost changes."""
    used = []
    for gain in common:
        middle = float(np.sqrt(gain.low * gain.high))
        found = trials.cost(as_control([gain], [middle]))
        if abs(found.total - before.total) > USED:
            used.append(gain)
    return used


def _search(trials: _Trials, free: Sequence[FreeGain], budget: int) -> None:
    low, high = np.log([gain.low for gain in free]), np.log([gain.high for gain in free])
    left = max(0, budget - trials.flown)
    spread = qmc.Halton(len(free), scramble=False).random(round(SPREAD_PART * left) + 1)[1:]

    def cost(logarithms: Array) -> float:
        if trials.flown >= budget:
            return LOST + 1.0
        inside = np.clip(logarithms, low, high)
        return trials.cost(as_control(free, np.exp(inside).tolist())).total

    costs = [cost(low + point * (high - low)) for point in spread]
    start = low + spread[int(np.argmin(costs))] * (high - low)
    edges = np.vstack([np.zeros(len(free)), np.diag(0.15 * (high - low))])
    simplex = np.clip(start + np.where(start + edges > high, -edges, edges), low, high)
    most = max(1, budget - trials.flown)
    minimize(cost, start, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": most})
