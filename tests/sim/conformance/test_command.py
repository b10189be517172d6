"""``conformance``: what it says before it opens a bus."""

import pytest

from fsw.bus.interface import BusError
from sim.conformance.command import conformance
from sim.errors import HarnessError
from sim.scenario.schema import load


def test_a_scenario_with_a_continuous_driver_has_no_limits_of_a_pulsed_board():
    with pytest.raises(HarnessError, match=r"tumbling: coils\.driver: .* continuous"):
        conformance(load("tumbling"), "coil", "no such bus", armed=False, deadman_s=5.0)


def test_its_sensors_are_those_of_any_scenario():
    with pytest.raises(BusError, match="no such bus"):
        conformance(load("tumbling"), "sun", "no such bus", armed=False, deadman_s=5.0)
