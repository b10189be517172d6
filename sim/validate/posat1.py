"""Claims on PoSAT-1's predictive law, from every phase of the field."""

from math import inf
from statistics import median
from typing import Any

from fsw.input.schema import Nested, merge
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.campaign.flight import Figures, FlightResult, Order
from sim.campaign.study import Figure, Group, campaign, figure_of, summary_number, summary_value
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.scenario.schema import Scenario

SOURCE = "Tavares et al., ConSat: PoSAT-1"
NODES_DEG = (0.0, 60.0, 120.0, 180.0, 240.0, 300.0)
TILTS = {"pitch": [0.0, 0.0, 1.0], "roll": [0.0, 1.0, 0.0]}
"""Axes about which the boom begins tilted: the orbit's normal, along-track."""
FREE: Nested = {"coils": {"driver": "continuous", "max_dipole_am2": 60.0, "on_fraction": 1.0}}
"""Any dipole up to the highest level, at the timing of the pulses."""

SETTLE = summary_value("axis1_deg.settle_orbits_5deg", inf)
LIMITS_KEPT = summary_value("limits_ok", 0.0)


def studies() -> list[Study]:
    """Libration damping restricted and free, damping in spin, spin-up."""
    return [libration(), spin(), spin_up()]


def libration() -> Study:
    """60 deg of libration; the restricted law against the unrestricted one."""
    settled = "under 5 deg from then on after"
    figures = (
        Figure(
            "median", f"Boom from 60 deg {settled}, median", "orbits", SETTLE, "median", "pulses", high=3.0
        ),
        Figure("all", f"Boom from 60 deg {settled}, all", "orbits", SETTLE, "worst", "pulses", high=4.5),
        Figure(
            "limits",
            "Actuator limits kept, by the independent audit",
            "1",
            LIMITS_KEPT,
            "worst",
            "pulses",
            low=1.0,
        ),
    )
    groups = (Group("pulses", _starts("posat1", 8.0)), Group("free", _starts("posat1", 8.0, FREE)))
    study = campaign("posat1", SOURCE, groups, figures)
    count = len(groups[0].orders)
    claim = Claim(
        "posat1.restricted", "Median settling, restricted over unrestricted law", SOURCE, "1", 0.85, 1.15
    )

    def conclude(flights: Any) -> list[ClaimOutcome]:  # noqa: ANN401  (as in Study)
        return [*study.conclude(flights), _ratio(claim, flights[:count], flights[count:])]

    return Study(study.id, study.tasks, conclude, has_flights=True)


def spin() -> Study:
    """60 deg of libration damped while the body spins."""
    figures = (
        Figure("all", "Boom from 60 deg under 5 deg from then on after, all", "orbits", SETTLE, high=4.0),
        Figure(
            "tilt",
            "Mean tilt in the last orbit",
            "deg",
            summary_value("axis1_deg.mean_last_orbit"),
            low=1.8,
            high=2.2,
        ),
        Figure(
            "deviation",
            "Spin's largest deviation in the last orbit",
            "rad/s",
            summary_value("spin_radps.max_dev_last_orbit"),
            high=6e-4,
        ),
        Figure("limits", "Actuator limits kept, by the independent audit", "1", LIMITS_KEPT, low=1.0),
    )
    return campaign("posat1-spin", SOURCE, (Group("", _starts("posat1-spin", 10.0)),), figures)


def spin_up() -> Study:
    """From rest to 0.02 rad/s, twelve phases."""
    figures = (
        Figure("time", "Spin within 1e-3 rad/s after, median", "min", _spun_up_min, "median", high=19.2),
        Figure(
            "pulses",
            "Pulses until then, median",
            "pulses",
            summary_value("spin_radps.pulses_to_settle", inf),
            "median",
            high=12.0,
        ),
        Figure(
            "error_median",
            "Final error of the spin, median",
            "rad/s",
            figure_of("spin_error"),
            "median",
            high=5e-4,
        ),
        Figure("error_all", "Final error of the spin, all", "rad/s", figure_of("spin_error"), high=8e-4),
        Figure("limits", "Actuator limits kept, by the independent audit", "1", LIMITS_KEPT, low=1.0),
    )
    phases = [(node, u0) for node in NODES_DEG for u0 in (0.0, 90.0)]
    orders = tuple(
        Order("posat1-spinup", {"orbit": {"raan_deg": node, "u0_deg": u0}}, orbits=2.0, measure=final_spin)
        for node, u0 in phases
    )
    return campaign("posat1-spinup", SOURCE, (Group("", orders),), figures)


def _starts(scenario: str, orbits: float, overrides: Nested | None = None) -> tuple[Order, ...]:
    """Twelve starts: six nodes, tilted in pitch and in roll."""
    return tuple(
        Order(
            scenario,
            merge(overrides or {}, {"orbit": {"raan_deg": node}, "initial": {"axis": axis}}),
            orbits=orbits,
        )
        for node in NODES_DEG
        for axis in TILTS.values()
    )


def _ratio(claim: Claim, restricted: list[FlightResult], free: list[FlightResult]) -> ClaimOutcome:
    ours, theirs = (median(SETTLE(flight) for flight in flights) for flights in (restricted, free))
    return claim.judge(ours / theirs, f"medians {ours:.2f} and {theirs:.2f} orbits")


def _spun_up_min(flight: FlightResult) -> float:
    return summary_number(flight, "spin_radps.settle_s_1e-3", inf) / 60.0


def final_spin(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """How far the spin is from its reference at the end."""
    spin_radps = float(truth["omega_body_orbit_radps"][-1, 0])
    return {"spin_error": abs(spin_radps - scenario.control.spin_radps)}
