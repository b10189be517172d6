"""Units by the events of the flight software that isolate them."""

import pytest

from fsw.core.events import Event
from fsw.core.fdir.faults import CoilFault, SensorFault
from sim.flight.isolations import isolated_unit, readmitted_unit


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


@pytest.mark.parametrize("cell", range(1, 7))
def test_a_cell_has_its_number(cell):
    assert isolated_unit(Event.SENSOR_ISOLATED, 100 * (2 + cell) + SensorFault.FROZEN) == f"cell {cell}"


@pytest.mark.parametrize(
    ("event", "reversed_"),
    [(Event.SENSOR_READMITTED, Event.SENSOR_ISOLATED), (Event.COIL_READMITTED, Event.COIL_FAULT)],
)
@pytest.mark.parametrize("argument", [101, 202, 303])
def test_a_readmission_names_the_unit_of_its_isolation(event, reversed_, argument):
    assert readmitted_unit(event, argument) == isolated_unit(reversed_, argument)
    assert isolated_unit(event, argument) is None
    assert readmitted_unit(reversed_, argument) is None
