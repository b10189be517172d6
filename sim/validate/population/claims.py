"""Claims on populations of satellites that differ from their onboard tables: quiet, honest, and pointing."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.stats import chi2

from sim.campaign.claim import Threshold
from sim.campaign.consistency import LAST_ORBITS, POINTED_DEG
from sim.campaign.flight import FlightResult, Order
from sim.campaign.population import POPULATIONS, nominal_scenario, population_order
from sim.campaign.study import Figure, FlightStudy, Group, Pick, campaign, figure_of

SOURCE = "Tolerances of a satellite of this size whose dipole was measured: own estimate"
SATELLITES = {"50kg": 100, "3u": 30, "6u": 30}
TUMBLING, TWICE = 30, 30
CUBESATS = ("3u", "6u")
ORBITS, ORBITS_FROM_5_DEGPS = 8.0, 14.0

SMALL_DIPOLE_AM2 = 0.04
"""Up to this the pulses with shared back-off can hold the 50 kg satellite pointed closely."""
POINTED_ORBITS = 2.5
WRONG_S = 120.0
"""Three sigma of an attitude that becomes valid are 5 deg."""

HONEST = "0.9973 by an honest filter"
"""Why a figure nearer to 1 than to this is no better, and no limit closer."""

STATES = 6
"""Attitude and rate."""

SINCE_POINT = "point_"
SINCE = {"": "", SINCE_POINT: ", since it first came to POINT"}
"""How the names of figures of honesty begin, by when they count from, and how that is said."""


def studies(most: int | None = None) -> list[FlightStudy]:
    """All of them, each with at most ``most`` satellites, the first ones."""

    def seeds(count: int) -> range:
        return range(1, 1 + (count if most is None else min(count, most)))

    return [
        microsatellites(seeds(SATELLITES["50kg"])),
        large_dipoles(seeds(SATELLITES["50kg"])),
        *(cubesats(kind, seeds(SATELLITES[kind])) for kind in CUBESATS),
        *(continuous_cubesats(kind, seeds(SATELLITES[kind])) for kind in CUBESATS),
        tumbling("tumbling", (1.0, 2.0), ORBITS, seeds(TUMBLING)),
        tumbling("tumbling_5degps", (5.0, 5.0), ORBITS_FROM_5_DEGPS, seeds(TUMBLING)),
        twice_the_bounds(seeds(TWICE)),
    ]


def microsatellites(seeds: Sequence[int]) -> FlightStudy:
    """The 50 kg satellite with shared back-off."""
    figures = (
        *quiet_and_honest(len(seeds)),
        Figure("estimate", "RMS error of the estimate, median", "deg", ESTIMATE, "median", high=0.4),
        Figure("estimate_worst", "RMS error of the estimate, all", "deg", ESTIMATE, high=0.7),
        IN_POINT,
        Figure(
            "pointed",
            f"Within {POINTED_DEG:g} deg for good after, dipole up to {SMALL_DIPOLE_AM2:g} A m^2, all",
            "orbits",
            figure_of("pointed_orbits"),
            counts=_has_small_dipole,
            high=POINTED_ORBITS,
        ),
        _pointing("pointing", "median", of="median", high=2.5, threshold=Threshold.REQUIRED),
        _pointing("pointing_small_dipole", "dipole up to 0.04 A m^2, all", _has_small_dipole, high=4.0),
        _pointing("pointing_worst", "all", high=8.0),
    )
    orders = tuple(population_order("50kg", seed, ORBITS) for seed in seeds)
    return _study("50kg", orders, figures, SATELLITES["50kg"])


def large_dipoles(seeds: Sequence[int]) -> FlightStudy:
    """Those of the 50 kg satellites whose dipole is large, with a back-off of each coil by itself."""
    per_coil = {"coils": {"backoff": "per_coil"}}
    orders = [population_order("50kg", seed, ORBITS, overrides=per_coil) for seed in seeds]
    large = tuple(order for order in orders if _dipole_am2(order) > SMALL_DIPOLE_AM2)
    statement = "dipole above 0.04 A m^2, back-off per coil, all"
    return _study("50kg_per_coil", large, (ISOLATED, _pointing("pointing", statement, high=4.0)), 0)


def cubesats(kind: str, seeds: Sequence[int]) -> FlightStudy:
    """Cubesats: honest, and pointing, where most have a dipole of which their pulses can counter a part."""
    orders = tuple(population_order(kind, seed, ORBITS) for seed in seeds)
    return _study(kind, orders, (*quiet_and_honest(len(seeds)), *_reached()), SATELLITES[kind])


def continuous_cubesats(kind: str, seeds: Sequence[int]) -> FlightStudy:
    """The same cubesats and coils without limits of pulses: any dipole is held, half of each tick."""
    coils = {
        "driver": "continuous",
        "max_dipole_am2": nominal_scenario(POPULATIONS[kind].scenario).coils.levels_am2[-1],
        "on_fraction": 0.5,
    }
    orders = tuple(population_order(kind, seed, ORBITS, overrides={"coils": coils}) for seed in seeds)
    return _study(f"{kind}_continuous", orders, (ISOLATED, WRONG, *_reached()), SATELLITES[kind])


def _reached() -> tuple[Figure, Figure]:
    """What half of the satellites reach, and what share reaches it."""
    statement = f"Share with an RMS pointing error up to {POINTED_DEG:g} deg, last {LAST_ORBITS:.0f} orbits"
    return (
        _pointing("pointing", "median", of="median", high=POINTED_DEG, threshold=Threshold.REQUIRED),
        Figure(
            *("pointing_share", statement, "1", lambda flight: float(_has_reached(flight, POINTED_DEG))),
            of="mean",
            low=0.9,
            threshold=Threshold.REQUIRED,
        ),
    )


def _has_reached(flight: FlightResult, most_deg: float) -> bool:
    return flight.figures["pointing_deg"] <= most_deg


def tumbling(name: str, rate_degps: tuple[float, float], orbits: float, seeds: Sequence[int]) -> FlightStudy:
    """50 kg satellites that start by tumbling about any axis: honest once they have come to POINT."""
    orders = tuple(population_order("50kg", seed, orbits, rate_degps=rate_degps) for seed in seeds)
    return _study(name, orders, (*quiet_and_honest(len(seeds), SINCE_POINT), IN_POINT), TUMBLING)


def twice_the_bounds(seeds: Sequence[int]) -> FlightStudy:
    """50 kg satellites that differ from their table by twice what is declared."""
    orders = tuple(population_order("50kg", seed, ORBITS, twice=True) for seed in seeds)
    return _study("twice", orders, (ISOLATED, WRONG), TWICE)


def isolated_units(flight: FlightResult) -> float:
    """How many units were isolated; all are healthy."""
    return float(len(flight.summary["isolated"]))


def inside(combine: Callable[[Sequence[float]], float], since: str = "") -> Callable[[FlightResult], float]:
    """The parts of the time inside 3 sigma about the three axes, combined; ``since``: a key of ``SINCE``."""
    return lambda flight: float(combine([flight.figures[f"{since}inside_{axis}"] for axis in (1, 2, 3)]))


ESTIMATE = figure_of("estimate_deg")
ISOLATED = Figure(
    *("isolated", "Healthy units isolated in a flight, all", "1", isolated_units),
    high=0.0,
    threshold=Threshold.REQUIRED,
)
WRONG = Figure(
    "wrong",
    "Longest time valid with an error above 5 deg, all",
    "s",
    figure_of("wrong_5deg_s"),
    high=WRONG_S,
    threshold=Threshold.REQUIRED,
)
IN_POINT = Figure("in_point", "In POINT at the end, all", "1", figure_of("in_point"), low=1.0)


def consistent(statement: str, flights: int, pick: Pick) -> Figure:
    """That the mean NEES of so many flights is that of chi-square, 6 for six states, within 95 %.

    Above, the filter claims more than it knows; below it is timid: what its bounds allow for does not happen.

    Source: Bar-Shalom, Li, Kirubarajan 2001, section 5.4.2.
    """
    low, high = (float(chi2.ppf(part, STATES * flights)) / flights for part in (0.025, 0.975))
    return Figure("nees", statement, "1", pick, "mean", low=low, high=high, threshold=Threshold.PAPER)


def quiet_and_honest(flights: int, since: str = "") -> tuple[Figure, ...]:
    """Nothing healthy isolated, and the filter as sure as it may be; ``since``: a key of ``SINCE``."""
    pooled, each = "Time inside 3 sigma by axis, pooled", "Time inside 3 sigma, worst axis, all"
    nees, when = "Mean NEES of attitude and rate", SINCE[since]
    return (
        ISOLATED,
        Figure("inside", pooled + when, "1", inside(np.mean, since), "mean", low=0.99, wide=HONEST),
        Figure("inside_worst", each + when, "1", inside(np.min, since), low=0.95, wide=HONEST),
        consistent(nees + when, flights, figure_of(f"{since}nees")),
        WRONG,
    )


def _pointing(
    name: str,
    which: str,
    counts: Callable[[FlightResult], bool] | None = None,
    of: str = "worst",
    *,
    high: float,
    threshold: Threshold = Threshold.OWN,
) -> Figure:
    statement = f"RMS pointing error, last {LAST_ORBITS:.0f} orbits, {which}"
    pick = figure_of("pointing_deg")
    return Figure(name, statement, "deg", pick, of, counts=counts, high=high, threshold=threshold)


def _study(name: str, orders: tuple[Order, ...], figures: Sequence[Figure], made_for: int) -> FlightStudy:
    return campaign(f"population.{name}", SOURCE, (Group("", orders),), figures, "satellites", made_for)


def _has_small_dipole(flight: FlightResult) -> bool:
    return flight.figures["dipole_am2"] <= SMALL_DIPOLE_AM2


def _dipole_am2(order: Order) -> float:
    return float(np.linalg.norm(order.overrides["disturbance"]["residual_dipole_am2"]))
