"""Worlds in which more changes than the onboard table foresees: honest, quiet, and still pointing."""

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from statistics import fmean

import numpy as np

from fsw.input.schema import Nested, merge
from sim.campaign.claim import Claim, ClaimOutcome, Spread, Study, Threshold
from sim.campaign.consistency import consistency_figures
from sim.campaign.flight import Figures, FlightResult, Order, fly_order
from sim.campaign.population import POPULATIONS, satellite
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import angle_rad
from sim.report.figures.estimate_error import converged_tick, estimate_error
from sim.scenario.schema import Scenario, orbit_period_s

TABLE = Path(__file__).with_suffix(".toml")
KIND, ORBITS = "50kg", 4.0
SATELLITES, FIRST_SEED = 20, 501
"""None of these satellites was flown while the filter was tuned."""
SOURCE = "Worlds beyond the table (sim/validate/worlds.toml); {} satellites of the 50 kg population"
BASE = "declared"
WORSE, OF_SATELLITES = 2.5, 0.9
"""By what factor a satellite may point worse than in its declared world, and what part of them has to."""
HARD = ("snap", "elements", "sun_turned")
"""Beyond what the table declares by so much that pointing is judged by itself."""
HARD_DEG = 12.0

Flights = Mapping[str, Sequence[FlightResult]]


def studies(most: int | None = None) -> list[Study]:
    """One study, as pointing is compared between worlds; ``most``: at most so many satellites."""
    count = SATELLITES if most is None else min(SATELLITES, most)
    seeds = range(FIRST_SEED, FIRST_SEED + count)
    names = [name for name in worlds() for _ in seeds]
    tasks = tuple(partial(fly_order, world_order(name, seed)) for name in worlds() for seed in seeds)

    def conclude(results: Sequence[FlightResult]) -> list[ClaimOutcome]:
        flights = {
            name: [one for at, one in zip(names, results, strict=True) if at == name] for name in worlds()
        }
        return [outcome for name in worlds() for outcome in _judge(name, flights)]

    return [Study("worlds", tasks, conclude, has_flights=True)]


@cache
def worlds() -> Mapping[str, Nested]:
    """By name, what is laid over a satellite."""
    return tomllib.loads(TABLE.read_text(encoding="utf-8"))


def world_order(name: str, seed: int) -> Order:
    """The flight of a satellite in a world."""
    changed = merge(satellite(KIND, seed), worlds()[name])
    label = f"satellite {seed} in the world {name}"
    return Order(POPULATIONS[KIND].scenario, changed, seed, ORBITS, world_figures, label)


def world_figures(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """``consistency_figures``, and three of validity and of the last orbit.

    ``valid_part``: of the ticks after convergence; ``first_valid_s``: since the first lit tick, the whole
    flight where there is none; ``last_orbit_deg``: RMS of the pointing error.
    """
    tick_hz, ticks = scenario.time.tick_hz, len(truth["t_s"])
    valid = estimates.valid[:ticks]
    converged = converged_tick(np.degrees(angle_rad(estimate_error(truth, estimates))), tick_hz)
    lit = int(np.argmax(truth["lit"] > 0.5))
    first = int(np.argmax(valid)) if valid.any() else ticks
    orbit = round(orbit_period_s(scenario) * tick_hz)
    pointing_deg = np.degrees(angle_rad(truth["q_body_from_orbit"]))[-orbit:]
    return {
        **consistency_figures(scenario, truth, estimates),
        "valid_part": 0.0 if converged is None else float(valid[converged:].mean()),
        "first_valid_s": (first - lit) / tick_hz,
        "last_orbit_deg": float(np.sqrt(np.mean(pointing_deg**2))),
    }


def _judge(name: str, flights: Flights) -> list[ClaimOutcome]:
    mine, source = flights[name], SOURCE.format(len(flights[name]))

    def claim(key: str, statement: str, unit: str, low: float = -np.inf, high: float = np.inf) -> Claim:
        words = f"{statement}, world {name}"
        return Claim(f"worlds.{name}.{key}", words, source, unit, low, high, Threshold.REQUIRED)

    inside = [fmean(one.figures[f"inside_{axis}"] for axis in (1, 2, 3)) for one in mine]
    wrong_s = [one.figures["wrong_5deg_s"] for one in mine]
    isolated = [float(len(one.summary["isolated"])) for one in mine]
    first_s = [one.figures["first_valid_s"] for one in mine]
    found = [
        _outcome(
            claim("inside", "Time inside 3 sigma, all axes, pooled", "1", low=0.95), inside, fmean(inside)
        ),
        _outcome(
            claim("inside_worst", "Time inside 3 sigma, each satellite", "1", low=0.9), inside, np.min(inside)
        ),
        _outcome(claim("isolated", "Healthy units isolated, all", "1", high=0.0), isolated, np.max(isolated)),
        _outcome(
            claim("wrong", "Longest time valid with an error above 5 deg, all", "s", high=120.0),
            wrong_s,
            np.max(wrong_s),
        ),
        _outcome(claim("first", "First valid attitude, all", "s", high=900.0), first_s, np.max(first_s)),
    ]
    if name in HARD:
        last_deg = [one.figures["last_orbit_deg"] for one in mine]
        pointing = claim("pointing", "RMS pointing error, last orbit, each", "deg", high=HARD_DEG)
        return [*found, _outcome(pointing, last_deg, np.max(last_deg))]
    valid = [one.figures["valid_part"] for one in mine]
    found.append(
        _outcome(
            claim("valid", "Part of the time valid after convergence, mean", "1", low=0.9),
            valid,
            fmean(valid),
        )
    )
    if name == BASE:
        return found
    pairs = zip(mine, flights[BASE], strict=True)
    worse = [one.figures["last_orbit_deg"] / base.figures["last_orbit_deg"] for one, base in pairs]
    limit = float(np.quantile(worse, OF_SATELLITES, method="lower"))
    statement = "Pointing error of the last orbit over that in the declared world, 9 satellites of 10"
    return [*found, _outcome(claim("pointing", statement, "1", high=WORSE), worse, limit)]


def _outcome(claim: Claim, values: Sequence[float], ours: float) -> ClaimOutcome:
    meet = sum(claim.meets(value) for value in values)
    spread = Spread(len(values), meet, *map(float, (np.min(values), np.median(values), np.max(values))))
    return claim.judge(float(ours), spread=spread)
