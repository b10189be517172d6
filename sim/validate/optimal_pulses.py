"""Claims on the law that plans pulses: on the matched satellite, and beside ``mpc`` on random ones."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sim.campaign.claim import Claim, ClaimOutcome, Study, Threshold
from sim.campaign.flight import FlightResult, Order
from sim.campaign.population import population_order
from sim.campaign.study import Figure, Group, campaign, describe_order, figure_of, spread_of, summary_value
from sim.validate.microsat import LAST_ORBITS, POINTING_RUNS, STARTS_WITHIN_DEG, pointing_order
from sim.validate.population.claims import ORBITS, quiet_and_honest

LAW = "pulse_mpc"
SOURCE = "Search among the pulses to come; with all known, a prototype left 0.042, 0.465, 1.54 deg"
TORQUES = (("zero", 0.0, 0.12), ("3e-8", 3e-8, 0.5), ("1e-7", 1e-7, 1.65))
"""Name, bias torque per axis [N m], limit of the RMS pointing error [deg]."""
SATELLITES = 30
BESIDE = f"Pointing error of {LAW} over that of mpc, RMS of the last 3 orbits, the same 50 kg satellites"
MOST_WORSE = 1.05


def studies(most: int | None = None) -> list[Study]:
    """Both, the second with at most ``most`` satellites."""
    count = SATELLITES if most is None else min(SATELLITES, most)
    return [matched(), beside_mpc(range(1, 1 + count))]


def matched() -> Study:
    """Ten seeds of each torque on ``microsat``, filter in the loop."""
    law = {"control": {"law": LAW}}
    groups = [
        Group(name, tuple(pointing_order(seed, torque, law) for seed in range(1, POINTING_RUNS + 1)))
        for name, torque, _ in TORQUES
    ]
    pointing = [
        Figure(
            f"rms_{name}",
            f"RMS pointing error of {LAW}, last {LAST_ORBITS:.0f} orbits, torque {torque:g} N m about each "
            f"axis, from up to {STARTS_WITHIN_DEG:g} deg off, all seeds",
            "deg",
            figure_of("rms_deg"),
            group=name,
            high=limit_deg,
        )
        for name, torque, limit_deg in TORQUES
    ]
    limits = [
        Figure(
            f"limits_{name}",
            "Actuator limits kept, by the independent audit",
            "1",
            summary_value("limits_ok", 0.0),
            group=name,
            low=1.0,
            threshold=Threshold.PAPER,
        )
        for name, *_ in TORQUES
    ]
    return campaign(LAW, SOURCE, groups, pointing + limits)


def beside_mpc(seeds: Sequence[int]) -> Study:
    """The same random satellites by either law; honest and quiet by the one that plans pulses."""
    groups = [Group("", _orders(LAW, seeds)), Group("mpc", _orders("mpc", seeds))]
    name = f"{LAW}-population"
    study = campaign(name, SOURCE, groups, quiet_and_honest(len(seeds)), "flights")

    def conclude(flights: Any) -> list[ClaimOutcome]:  # noqa: ANN401  (as in Study)
        ours, theirs = flights[: len(seeds)], flights[len(seeds) :]
        return [*study.conclude(flights), *compared(name, ours, theirs)]

    return Study(name, study.tasks, conclude, has_flights=True)


def compared(
    name: str, ours: Sequence[FlightResult], theirs: Sequence[FlightResult]
) -> tuple[ClaimOutcome, ClaimOutcome]:
    """Median over median, and the worst satellite."""
    pointing = figure_of("pointing_deg")
    ratios = [pointing(one) / pointing(other) for one, other in zip(ours, theirs, strict=True)]
    above, below = (float(np.median([pointing(one) for one in flights])) for flights in (ours, theirs))
    worst = int(np.argmax(ratios))
    better = Claim(f"{name}.median", f"{BESIDE}: of the medians", SOURCE, "1", high=1.0)
    none_worse = Claim(f"{name}.none_worse", f"{BESIDE}: all", SOURCE, "1", high=MOST_WORSE)
    where = f"worst: {describe_order(ours[worst].order)}: {ratios[worst]:.3g}"
    return better.judge(above / below), none_worse.judge(ratios[worst], where, spread_of(none_worse, ratios))


def _orders(law: str, seeds: Sequence[int]) -> tuple[Order, ...]:
    overrides = {"control": {"law": law}}
    return tuple(population_order("50kg", seed, ORBITS, overrides=overrides) for seed in seeds)
