"""The orbit of the sweep, as far as the tests fly."""

import pytest

from fsw.table.config import flight_config
from sim.design.limits.linear_flight import orbits_of
from sim.scenario.schema import flight_table, load


@pytest.fixture(scope="session")
def two_orbits():
    return orbits_of(flight_config(flight_table(load("microsat"))), 2.0)
