"""Bounds of zero: the flight software of a satellite that is as its table says, in one thing or in all."""

import pytest

from fsw.table.uncertainty import UncertaintyTable
from sim.campaign.flight import record_scenario
from sim.scenario.schema import load, parse_settings

CELLS = "cubesat-cells"
SATELLITES = {CELLS: 0.15, "realsat": 0.05}
"""How long each flies, orbits: until the filter has begun, and all of its parameters have been sent."""
BOUNDS = {
    satellite: tuple(
        name for name in UncertaintyTable.model_fields if satellite == CELLS or not name.startswith("cell_")
    )
    for satellite in SATELLITES
}


def flown(satellite, names):
    zero = {"flight": {"uncertainty": dict.fromkeys(names, 0.0)}}
    return record_scenario(load(satellite, zero), 1, SATELLITES[satellite])


@pytest.mark.long
@pytest.mark.parametrize(("satellite", "name"), [(one, name) for one in SATELLITES for name in BOUNDS[one]])
def test_it_estimates_the_rest_where_one_thing_is_certain(satellite, name):
    flight = flown(satellite, [name])
    assert flight.audit.ok
    assert flight.estimates.last is not None


@pytest.mark.long
@pytest.mark.parametrize("of", ["flight.cells", "sensors.cells"])
def test_an_earth_that_reflects_nothing_is_no_error(of):
    settings = parse_settings((f"{of}.albedo=0.0",))
    assert record_scenario(load(CELLS, settings), 1, SATELLITES[CELLS]).audit.ok


@pytest.mark.long
@pytest.mark.parametrize("satellite", SATELLITES)
def test_it_goes_on_where_all_is_certain_and_wrong(satellite):
    assert flown(satellite, BOUNDS[satellite]).audit.ok
