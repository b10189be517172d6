"""A 1U with Sun cells as ``torquer new`` writes it: the shadow of a low orbit makes it lose its attitude."""

import pytest

from sim.campaign.flight import Order, fly_order
from sim.new_scenario.command import write_new
from sim.new_scenario.satellite import NewSatellite

ONE_U = NewSatellite(
    "one-u-low",
    altitude_km=400.0,
    inclination_deg=51.6,
    mass_kg=1.2,
    size_m=(0.1, 0.1, 0.1135),
    continuous=True,
    dipole_am2=0.1,
    cells=True,
)


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.slow
def test_no_healthy_unit_is_isolated_when_the_sun_is_back(tmp_path):
    """By seed 101 the attitude is up to 90 deg wrong when the second shadow ends."""
    file = write_new(ONE_U, tmp_path / "one-u-low.toml").file
    flight = fly_order(Order(str(file), seed=101, orbits=1.75))
    assert flight.summary["isolated"] == []
    assert any(event["name"] == "FILTER_STARTED" for event in flight.summary["events"])
