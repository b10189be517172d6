"""The scenario realsat is a satellite of the population."""

import numpy as np
import pytest

from sim.campaign.flight import Order, record_order
from sim.campaign.population import satellite
from sim.scenario.schema import flight_table, load

SEED = 4


def numbers(values, at=()):
    """Every number of nested values with its key."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from numbers(value, (*at, key))
        else:
            yield (*at, key), np.array(value, dtype=float)


def test_is_a_satellite_of_the_50_kg_population_rounded():
    flown, one = load("realsat").model_dump(), satellite("50kg", SEED)
    del one["flight"]["uncertainty"]  # ordinary bounds are those of the population
    for keys, drawn in numbers(one):
        value = flown
        for key in keys:
            value = value[key]
        assert np.array(value) == pytest.approx(drawn, abs=0.025 * np.abs(drawn).max()), keys


def test_the_onboard_table_is_that_of_microsat():
    """But for what microsat declares of itself, the law, and a demand that lasts is forgotten more slowly."""
    real, nominal = flight_table(load("realsat")), flight_table(load("microsat"))
    for section in ("orbit", "body", "coils", "time", "estimator"):
        assert getattr(real, section) == getattr(nominal, section), section
    assert real.control.leak_s == 2.0 * nominal.control.leak_s
    assert (real.control.law, nominal.control.law) == ("pulse_mpc", "mpc")
    same = {"leak_s": nominal.control.leak_s, "law": nominal.control.law}
    assert real.control.model_copy(update=same) == nominal.control


@pytest.mark.long
@pytest.mark.slow
def test_the_flight_that_the_readme_begins_with_meets_what_it_requires():
    summary = record_order(Order("realsat")).summary()
    assert [requirement["verdict"] for requirement in summary["requirements"]] == ["met"] * 3
    assert summary["isolated"] == []
