"""Units by the events of the flight software that isolate them."""

import pytest

from fsw.core.events import Event
from fsw.core.fdir.faults import CoilFault, SensorFault
from sim.flight.isolations import isolated_unit


@pytest.mark.parametrize("fault", [*SensorFault])
def test_a_sensor_is_named_whatever_its_fault(fault):
    assert isolated_unit(Event.SENSOR_ISOLATED, 100 + fault) == "magnetometer"
    assert isolated_unit(Event.SENSOR_ISOLATED, 200 + fault) == "sun sensor"


@pytest.mark.parametrize("fault", [*CoilFault])
@pytest.mark.parametrize("coil", [0, 1, 2])
def test_a_coil_has_its_number_on_the_bus(coil, fault):
    assert isolated_unit(Event.COIL_FAULT, 100 * (coil + 1) + fault) == f"coil {coil}"


@pytest.mark.parametrize("event", sorted(set(Event) - {Event.SENSOR_ISOLATED, Event.COIL_FAULT}))
def test_other_events_isolate_no_unit(event):
    assert isolated_unit(event, 101) is None


def test_an_argument_that_names_no_unit_is_shown():
    assert isolated_unit(Event.SENSOR_ISOLATED, 907) == "unit 907"
