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


@pytest.mark.parametrize(
    ("kind", "deadman_s", "says"),
    [("coil", 1.9, "at least 2 s"), ("coil", 2.0, "no such bus"), ("sun", 0.1, "no such bus")],
)
def test_a_dead_man_that_a_late_sync_would_wake_is_refused(kind, deadman_s, says):
    with pytest.raises((HarnessError, BusError), match=says):
        conformance(load("microsat"), kind, "no such bus", armed=False, deadman_s=deadman_s)
