"""The best gains of a law on a body, under rules that are the same for every law.

A budget of flights is spent so: one with the scenario's own gains, one for each common gain to see whether
the law uses it, then the points of a Halton sequence over the logarithms of the free gains, then the simplex
of Nelder and Mead from the best of these. Every flight is of the rigid body in the direct dipole's field from
the scenario's start. Nothing is random: the sequence begins anew for each law.

What is best there may be a fluke, or fail where the filter does not know all. So the best gains are proven by
a whole flight, beside one with the scenario's own, and where they are not better there, the next best that
are not near them; after ``CANDIDATES`` of them the scenario's own stay.

Gains that were found earlier are of the flight software of that day. They stay where whole flights of today
bear them out; otherwise the law is searched again.

Source: Halton 1960 for the sequence, Nelder and Mead 1965 for the simplex, both by SciPy.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import log

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from fsw.core.laws.table import LAWS
from fsw.input.schema import Nested, TableError, merge
from fsw.table.table import lay_over
from sim.campaign.flight import record_scenario
from sim.errors import HarnessError
from sim.report.figures.attitude_arrays import law_attitude, law_vector
from sim.scenario.schema import Scenario, load, orbit_period_s
from sim.tuning.cost import LOST, Cost, cost_of
from sim.tuning.flown import FlownMotion
from sim.tuning.free_gains import FreeGain, as_control, common_gains, flat, own_gains
from sim.tuning.rigid_flight import fly
from sim.value_types import Array

# --- A flight of a scenario as it is, as the search of gains judges it


def fly_whole(scenario: Scenario, seed: int, orbits: float) -> FlownMotion:
    """Fly it with filter, boards and bus.

    Raises:
        TableError: no plant or flight software can have these numbers.
        HarnessError: the flight cannot be flown.
    """
    truth, axes = record_scenario(scenario, seed, orbits).truth, scenario.body.law_axes
    return FlownMotion(
        orbit_period_s(scenario),
        truth["t_s"],
        law_attitude(truth["q_body_from_orbit"], axes),
        law_vector(truth["omega_body_orbit_radps"], axes),
    )


# --- The search

BUDGET = 24
"""Flights for a law."""
ORBITS = 4.0
"""Length of each."""
SPREAD_PART = 0.6
"""Of the flights that are left, the part for the sequence."""
CANDIDATES = 3
"""Gains of a law that are tried in a whole flight, at most."""
SEED = 2
"""Of the whole flights: a comparison flies others by default."""
NEAR = 0.3
"""Gains are near others where no logarithm differs by so much."""
WORSE = 0.1
"""By so much of it the cost of earlier gains may have grown."""
USED = 1e-9
"""A gain whose change alters the cost by less is not used by the law."""
DIRECT: Nested = {"knowledge": "perfect", "field": {"model": "direct_dipole"}}

WholeFlight = Callable[[Scenario, int, float], FlownMotion]
"""Flies a scenario as it is, with filter, boards and bus, with a seed, for so many orbits."""


@dataclass(frozen=True, slots=True)
class TunedGains:
    """The best gains found.

    Attributes:
        law: whose.
        driver: of the coils.
        control: the keys of ``[control]`` that were searched; empty: the scenario's own.
        cost: of the whole flight with them.
        before: of that with the scenario's own gains.
        flights: of the search; 0: gains that were found earlier, borne out today.
    """

    law: str
    driver: str
    control: Nested
    cost: Cost
    before: Cost
    flights: int


@dataclass(slots=True)
class _Trials:
    """The flights of a search, counted: of each the gains and the cost."""

    scenario: str
    over: Nested
    law: str
    orbits: float
    step_s: float | None
    whole: WholeFlight
    flown: list[tuple[float, Nested]] = field(default_factory=list)

    def cost(self, control: Nested) -> Cost:
        """Of a flight of the rigid body with these gains."""
        found = self._cost(control, DIRECT, lambda scenario: fly(scenario, self.orbits, self.step_s))
        self.flown.append((found.total, control))
        return found

    def whole_cost(self, control: Nested) -> Cost:
        """Of a whole flight with these gains."""
        return self._cost(control, {}, lambda scenario: self.whole(scenario, SEED, self.orbits))

    def _cost(self, control: Nested, world: Nested, flight: Callable[[Scenario], FlownMotion]) -> Cost:
        """A flight that no table allows, or that fails, is lost."""
        values = lay_over(merge(self.over, world), {"control": merge({"law": self.law}, control)})
        try:
            scenario = load(self.scenario, values)
            return cost_of(flight(scenario), scenario, LAWS[self.law].aim)
        except (TableError, HarnessError, ArithmeticError):
            return Cost(LOST, None, np.inf)

    def candidates(self) -> list[Nested]:
        """The best gains that were tried, none near another, nor the scenario's own; the best first."""
        chosen: list[Nested] = []
        for total, control in sorted(self.flown, key=lambda one: one[0]):
            if total >= LOST or len(chosen) == CANDIDATES:
                break
            if control and not any(_near(control, other) for other in chosen):
                chosen.append(control)
        return chosen


def tune(
    scenario: str,
    over: Nested,
    law: str,
    budget: int = BUDGET,
    orbits: float = ORBITS,
    step_s: float | None = None,
    whole: WholeFlight = fly_whole,
) -> TunedGains:
    """The best gains of a law of the table.

    Args:
        scenario: its name or path.
        over: laid over it, the driver among it.
        law: the name of the law.
        budget: flights of the search.
        orbits: length of each.
        step_s: of the flights; None: as ``fly`` has it.
        whole: flies a scenario as it is.

    Raises:
        TableError: the scenario is not valid.
    """
    as_it_is = load(scenario, over)
    trials = _Trials(scenario, over, law, orbits, step_s, whole)
    before = trials.cost({})
    free = [*_used(trials, common_gains(as_it_is), before), *own_gains(law)]
    if free:
        _search(trials, free, budget)
    control, cost, own = _proven(trials)
    return TunedGains(law, as_it_is.coils.driver, control, cost, own, len(trials.flown))


def confirm(
    scenario: str,
    over: Nested,
    law: str,
    control: Nested,
    total: float,
    budget: int = BUDGET,
    orbits: float = ORBITS,
    step_s: float | None = None,
    whole: WholeFlight = fly_whole,
) -> TunedGains:
    """Gains that were found earlier at a cost of ``total``, if they still fly so; else the best of a search.

    They stay too where the search finds none that are better today.

    The other arguments are those of ``tune``.

    Raises:
        TableError: the scenario is not valid.
    """
    trials = _Trials(scenario, over, law, orbits, step_s, whole)
    cost = trials.whole_cost(control)
    own = trials.whole_cost({}) if control else cost
    if cost.total <= min(total * (1.0 + WORSE), own.total):
        return TunedGains(law, load(scenario, over).coils.driver, control, cost, own, 0)
    found = tune(scenario, over, law, budget, orbits, step_s, whole)
    return found if found.cost.total <= cost.total else replace(found, control=control, cost=cost)


def _proven(trials: _Trials) -> tuple[Nested, Cost, Cost]:
    """The best gains that whole flights bear out, their cost, and that of the scenario's own."""
    own = trials.whole_cost({})
    for control in trials.candidates():
        cost = trials.whole_cost(control)
        if cost.total < own.total:
            return control, cost, own
    return {}, own, own


def _near(one: Nested, other: Nested) -> bool:
    """Whether two choices of the same gains differ little."""
    mine, its = flat(one), flat(other)
    return mine.keys() == its.keys() and all(abs(log(mine[key] / its[key])) < NEAR for key in mine)


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
    left = max(0, budget - len(trials.flown))
    spread = qmc.Halton(len(free), scramble=False).random(round(SPREAD_PART * left) + 1)[1:]

    def cost(logarithms: Array) -> float:
        if len(trials.flown) >= budget:
            return LOST + 1.0
        inside = np.clip(logarithms, low, high)
        return trials.cost(as_control(free, np.exp(inside).tolist())).total

    costs = [cost(low + point * (high - low)) for point in spread]
    start = low + spread[int(np.argmin(costs))] * (high - low)
    edges = np.vstack([np.zeros(len(free)), np.diag(0.15 * (high - low))])
    simplex = np.clip(start + np.where(start + edges > high, -edges, edges), low, high)
    most = max(1, budget - len(trials.flown))
    minimize(cost, start, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": most})
