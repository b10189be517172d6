"""Flights of a rigid body in the direct dipole, and the claims on them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fsw.input.schema import Nested, merge
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.scenario.schema import load
from sim.tuning.flown import RigidFlight
from sim.tuning.rigid_flight import fly

REVIEW = "Ovchinnikov, Roldugin 2019"
BASE: Nested = {
    "knowledge": "perfect",
    "orbit": {"tle": None, "altitude_km": 800.0, "inclination_deg": 98.6, "raan_deg": 0.0, "u0_deg": 0.0},
    "time": {"epoch_utc": "2025-03-20T09:00:00Z"},
    "field": {"model": "direct_dipole"},
    "coils": {"driver": "continuous", "max_dipole_am2": 1e4, "on_fraction": 1.0},
    "disturbance": {"torque_nm": [0.0, 0.0, 0.0]},
    "control": {"k_i": 0.0},
}
"""The 50 kg satellite, nothing unknown or disturbing, coils that give what is asked for."""

NEAR: Nested = {"initial": {"axis": [1.0, 2.0, 3.0], "angle_deg": 20.0, "rate_degps": [0.0, 0.0, 0.0]}}
"""From 20 deg off, at rest."""

Measure = Callable[[Sequence[RigidFlight]], float]


@dataclass(frozen=True, slots=True)
class RigidTrial:
    """A flight: the law, what is laid over ``BASE``, how long, in what steps (None: as ``fly`` has them)."""

    law: str
    over: Nested
    orbits: float
    step_s: float | None = None

    def fly(self) -> RigidFlight:
        """Fly it."""
        named: Nested = {"control": {"law": self.law}}
        return fly(load("microsat", merge(merge(BASE, self.over), named)), self.orbits, self.step_s)


@dataclass(frozen=True, slots=True)
class TrialFigure:
    """A claim on the flights of a trial, and its figure.

    Attributes:
        name: last word of its id.
        statement: what the figure is.
        unit: of figure and limits.
        measure: the figure of the flights.
        low: least that passes.
        high: most that passes.
        wide: why a limit is far from the figure.
    """

    name: str
    statement: str
    unit: str
    measure: Measure
    low: float = float("-inf")
    high: float = float("inf")
    wide: str = ""


@dataclass(frozen=True, slots=True)
class Trial:
    """Flights and the claims on them.

    Attributes:
        id: first words of the claims' ids.
        source: section of the review, and the number of its author there.
        flights: what is flown.
        judged: the claims.
    """

    id: str
    source: str
    flights: tuple[RigidTrial, ...]
    judged: tuple[TrialFigure, ...]

    def study(self) -> Study:
        """The study of the trial."""
        return Study(self.id, tuple(flown.fly for flown in self.flights), self.conclude)

    def conclude(self, flights: Sequence[Any]) -> list[ClaimOutcome]:
        """The verdicts on the flights."""
        return [
            Claim(
                f"{self.id}.{one.name}",
                one.statement,
                f"{REVIEW}, {self.source}",
                one.unit,
                one.low,
                one.high,
                wide=one.wide,
            ).judge(one.measure(flights))
            for one in self.judged
        ]


def final_rms_deg(flight: RigidFlight) -> float:
    """The angle from the nominal attitude, over the last orbit."""
    return float(np.sqrt(np.mean(flight.pointing_deg[flight.orbit(-1)] ** 2)))


def gains(law: str, k_w: float, own: dict[str, float] | None = None, k_a: float = 0.0) -> Nested:
    """The common gains, and those of the law."""
    return {"control": {"k_w": k_w, "k_a": k_a, "gains": {law: own} if own else {}}}


def over(*parts: Nested) -> Nested:
    """All laid over each other."""
    whole: Nested = {}
    for part in parts:
        whole = merge(whole, part)
    return whole
