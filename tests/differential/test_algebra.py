"""Kernel and filterpy give the same flights of satellites that differ from their tables."""

import pytest

from sim.campaign.flight import fly_order
from sim.campaign.population import population_order

ORBITS = 1.0


def figures(satellite, algebra):
    """Pointing, error of the estimate and honesty of a flight."""
    overrides = {"flight": {"estimator": {"algebra": algebra}}}
    summary = fly_order(population_order("50kg", satellite, ORBITS, overrides=overrides)).summary
    return {
        "pointing_deg": summary["pointing_deg"]["rms_last_orbit"],
        "sunlit_deg": summary["estimate_deg"]["rms_sunlit"],
        "eclipse_deg": summary["estimate_deg"]["rms_eclipse"],
        "within_3sigma": summary["estimate_deg"]["within_3sigma"],
        "nees": summary["nees_mean"],
    }


@pytest.mark.long
@pytest.mark.parametrize("satellite", range(900, 910))
@pytest.mark.slow
def test_a_flight_has_the_same_figures(satellite):
    assert figures(satellite, "kernel") == pytest.approx(figures(satellite, "filterpy"), rel=0.01)
