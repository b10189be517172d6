"""Flights of the sweep in ``sim.design.limits``, some of them whole ones beside the linear."""

from functools import cache, partial
from math import degrees, hypot

import numpy as np

from fsw.input.schema import Nested, merge
from sim.campaign.claim import Study
from sim.campaign.flight import Figures, Order, fly_order
from sim.campaign.runner import run
from sim.campaign.study_cache import with_cache
from sim.design.limits.linear_flight import COUNTED, ORBITS, fly
from sim.design.limits.sweep import NO_TORQUE, SCENARIO, STARTS_RAD, LinearOrder, Orbits, all_orders
from sim.progress import progress
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.scenario.schema import Scenario, load
from sim.validate.microsat import pointing_deg

WHOLE: tuple[tuple[str, str, Nested], ...] = (
    ("`mpc`, no torque", "mpc", NO_TORQUE),
    ("`pulse_mpc`, no torque", "pulse_mpc", NO_TORQUE),
    ("`mpc`, the torque not told", "mpc", {}),
    ("`pulse_mpc`, the torque not told", "pulse_mpc", {}),
)
"""With perfect knowledge the law is told attitude and no torque, and so it is in these linear flights."""

Rows = dict[str, list[float]]


def rms_deg(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """RMS pointing error of the orbits that count."""
    error_deg = pointing_deg(truth)
    return {"rms_deg": float(np.sqrt(np.mean(error_deg[-round(COUNTED * len(error_deg)) :] ** 2)))}


@cache
def orbits() -> Orbits:
    """Those of all flights of this process."""
    return Orbits()


def linear_deg(order: LinearOrder) -> list[float]:
    """The error of a linear flight."""
    return [order.error_deg(orbits())]


def both_deg(law: str, overrides: Nested) -> list[float]:
    """The error of a whole flight from the first start, then that of linear flights from each."""
    overrides = merge(overrides, {"knowledge": "perfect", "control": {"law": law}})
    scenario, start = load(SCENARIO, overrides), STARTS_RAD[0]
    initial = {"axis": list(start), "angle_deg": degrees(hypot(*start)), "rate_degps": [0.0] * 3}
    order = Order(SCENARIO, merge(overrides, {"initial": initial}), orbits=ORBITS, measure=rms_deg)
    linear = [fly(scenario, theta_rad, orbits().of(scenario), torque_known=False) for theta_rad in STARTS_RAD]
    return [fly_order(order).figures["rms_deg"], *(flight.rms_deg() for flight in linear)]


def fly_all(workers: int) -> Rows:
    """Every error by the key of its order, or the name of what is checked.

    Raises:
        HarnessError: a flight cannot be flown; those before it are kept.
    """
    tasks = {name: partial(both_deg, law, overrides) for name, law, overrides in WHOLE}
    tasks |= {order.key: partial(linear_deg, order) for order in all_orders()}
    studies = [Study(name, (task,), lambda errors: [], has_flights=True) for name, task in tasks.items()]
    with progress("flying", len(studies)) as watch:
        flown = run(with_cache(studies), workers, watch, lambda study: None)
    return {study.study.id: study.results[0] for study in flown}
