"""The analysis of ``torquer design``: gains searched or given, their stability and margins."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import NEUTRAL, ROUGH_STEPS, monodromy, multipliers, settling_orbits
from sim.design.theory.linear import Gains, closed_loop, resting_torque
from sim.design.theory.periodic_lqr import NotConvergedError, best_effort
from sim.design.theory.pulsed import PulsedLoop, Pulsing
from sim.design.theory.robustness import InertiaMaps, Margins, inertia_maps, margins
from sim.design.theory.search import (
    SEARCH_STEPS,
    Candidate,
    Degree,
    GainMap,
    Search,
    best_integral,
    candidate,
    continuous,
    gain_map,
    search,
)
from sim.value_types import Array

Watch = Callable[[int], None]
ANALYSIS_STEPS = 2 * SEARCH_STEPS + 4
"""The steps that ``analyse`` reports to ``watch``."""


@dataclass(frozen=True, slots=True)
class Integral:
    """An integral term: gains with k_i, and their degree of stability."""

    gains: Gains
    degree: float


@dataclass(frozen=True, slots=True)
class Pulsed:
    """The gains on the pulsed actuator.

    Attributes:
        pulsing: how the coils pulse.
        periods: periods of pulse and back-off that the analysis puts into an orbit.
        averaged: degree of stability of the average torque, the dipole raised by period over pulse.
        unraised: the same with the law's own dipole, only while a pulse lasts.
        sampled: degree of stability of the pulses themselves.
        other: the same with all coils at once in place of in turn, or the other way.
        integral: the best k_i for the pulses, on the steady gains for pulses, or on those given.
        search: the best gains for the pulses; None where gains were given.
    """

    pulsing: Pulsing
    periods: int
    averaged: float
    unraised: float
    sampled: float
    other: float
    integral: Integral
    search: Search | None


@dataclass(frozen=True, slots=True)
class Analysis:
    """The analysis of one pair of gains for one body.

    Attributes:
        body: the satellite.
        chosen: the gains: given, or the best.
        search: None where gains were given.
        multipliers: characteristic multipliers.
        margins: how far gains and inertia may be off.
        integral: the best k_i, the other gains as they are.
        pulsed: None for a continuous driver.
        periodic_lqr: the least degree of stability of a periodic regulator; None if there is none.
        resting_torque_nm: torque on the body at rest in the nominal attitude.
    """

    body: Body
    chosen: Candidate
    search: Search | None
    multipliers: NDArray[np.complex128]
    margins: Margins
    integral: Integral
    pulsed: Pulsed | None
    periodic_lqr: float | None
    resting_torque_nm: Array

    @property
    def settling_orbits(self) -> float | None:
        """Orbits to 5 % of a deviation; None: it does not fall."""
        return settling_orbits(self.chosen.degree)

    @property
    def stabilised(self) -> bool:
        """Whether the search found gains that stabilise, or the given gains do."""
        return self.search.stabilised if self.search is not None else self.chosen.degree < -NEUTRAL


@dataclass(frozen=True, slots=True)
class PictureMaps:
    """The maps that the pictures show."""

    degree_maps: dict[str, GainMap]
    inertia: InertiaMaps


def analyse(
    body: Body, pulsing: Pulsing | None, given: Gains | None, watch: Watch = lambda done: None
) -> Analysis:
    """Analyse the best gains, or those given; ``watch`` is called with 0 to ``ANALYSIS_STEPS``."""
    fine, rough = continuous(body), continuous(body, ROUGH_STEPS)
    if given is not None:
        searched, chosen = None, candidate(fine, given)
    else:
        searched = search(body, fine, rough, watch)
        chosen = searched.best
    watch(SEARCH_STEPS)
    pulsed = _pulsed(body, pulsing, chosen.gains, given is None, watch) if pulsing is not None else None
    watch(2 * SEARCH_STEPS)
    integral = _integral(body, chosen.gains, rough, fine)
    watch(2 * SEARCH_STEPS + 1)
    lqr = None
    with suppress(NotConvergedError):
        lqr = best_effort(body)[1]
    watch(2 * SEARCH_STEPS + 2)
    allowed = margins(body, chosen.gains, rough)
    watch(ANALYSIS_STEPS)
    whole = multipliers(monodromy(closed_loop(body, chosen.gains)))
    return Analysis(body, chosen, searched, whole, allowed, integral, pulsed, lqr, resting_torque(body))


def picture_maps(analysis: Analysis) -> PictureMaps:
    """Compute the maps that the pictures show beside the analysis."""
    body, pulsed, searched = analysis.body, analysis.pulsed, analysis.search
    maps = {"continuous dipole": searched.map if searched else gain_map(body, continuous(body, ROUGH_STEPS))}
    if pulsed is not None:
        of_pulses = (
            pulsed.search.map if pulsed.search else gain_map(body, PulsedLoop(body, pulsed.pulsing).degree)
        )
        maps["pulses"] = of_pulses
    return PictureMaps(maps, inertia_maps(body, analysis.chosen.gains))


def _pulsed(body: Body, pulsing: Pulsing, gains: Gains, searched: bool, watch: Watch) -> Pulsed:
    loop, nine = PulsedLoop(body, pulsing), PulsedLoop(body, pulsing, 9)
    other = PulsedLoop(body, replace(pulsing, in_turn=not pulsing.in_turn))
    fine = continuous(body)
    found = None
    if searched:
        found = search(body, loop.degree, loop.degree, lambda done: watch(SEARCH_STEPS + done))
    held = gains if found is None else found.steady.gains
    return Pulsed(
        pulsing=pulsing,
        periods=loop.periods,
        averaged=float(fine(gains)),
        unraised=float(fine(gains.scaled(pulsing.duty))),
        sampled=float(loop.degree(gains)),
        other=float(other.degree(gains)),
        integral=_integral(body, held, nine.degree, nine.degree),
        search=found,
    )


def _integral(body: Body, gains: Gains, rough: Degree, fine: Degree) -> Integral:
    found = best_integral(body, gains, rough)
    return Integral(found, float(fine(found)))
