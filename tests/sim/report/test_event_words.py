"""Events in words: all that the nodes can report has a sentence, and a strange number does no harm."""

import pytest

from fsw.core.events import SEVERITY, Event
from fsw.core.fdir.faults import CoilFault, SensorFault
from fsw.wire.messages import Severity
from hil_stub.coils.events import CoilEventCode
from hil_stub.wheel.wheel_driver import WheelEventCode
from sim.report.event_words import event_names, event_table, in_words, isolated_unit, readmitted_unit
from sim.scenario.schema import load


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


# --- Events in words: all that the nodes can report has a sentence, and a strange number does no harm


def words(node, event, argument=0, severity=0):
    return in_words(
        {"t_s": 1.0, "node": node, "event": int(event), "severity": severity, "argument": argument}
    )


@pytest.mark.parametrize(
    ("node", "event"), [*(("FSW", event) for event in Event), *(("COIL", event) for event in CoilEventCode)]
)
def test_every_event_has_words_and_a_meaning(node, event):
    found = words(node, event)
    assert found.meaning
    assert not found.what.startswith("event ")


@pytest.mark.parametrize(
    ("event", "argument", "what"),
    [
        (Event.MODE_CHANGED, 3, "mode POINT"),
        (Event.MODE_CHANGED, 9, "event 1 (9)"),
        (Event.FILTER_STARTED, 0, "filter started"),
        (Event.MONITOR_TRIPPED, 5, "monitor tripped: the magnetometer is silent"),
        (Event.MONITOR_TRIPPED, 99, "monitor tripped: number 99"),
        (Event.REQUEST_REFUSED, 8, "pulse refused by the coil board: lockout"),
        (Event.SENSOR_ISOLATED, 205, "sun sensor isolated: silent"),
        (Event.SENSOR_READMITTED, 101, "magnetometer used again after: saturated"),
        (Event.COIL_FAULT, 301, "coil 2 isolated: open"),
        (Event.COIL_FAULT, 999, "number 9 isolated: number 99"),
        (200, 4, "event 200 (4)"),
    ],
)
def test_what_happened_is_said_with_its_argument(event, argument, what):
    assert words("FSW", event, argument).what == what


@pytest.mark.parametrize(
    ("node", "event", "name"),
    [
        *(("FSW", event, event.name) for event in Event),
        *(("COIL", event, event.name) for event in CoilEventCode),
        *(("WHEEL", event, event.name) for event in WheelEventCode),
        ("FSW", 200, None),
        ("MAG", 1, None),
    ],
)
def test_an_event_has_its_name_beside_its_number(node, event, name):
    found = event_names(node, int(event), 0)
    assert found == {"name": name, "severity_name": "INFO"}


@pytest.mark.parametrize(("severity", "name"), [*((one, one.name) for one in Severity), (99, None)])
def test_so_has_a_severity(severity, name):
    assert event_names("FSW", Event.MODE_CHANGED, int(severity))["severity_name"] == name


def test_a_strange_node_severity_or_number_is_no_error():
    found = words("MAG", 7, severity=99)
    assert (found.what, found.meaning, found.severity) == ("event 7 (0)", "", "")


def test_the_table_tells_the_orbit_too():
    event = {
        "t_s": 6041.0,
        "node": "FSW",
        "event": 1,
        "severity": SEVERITY[Event.MODE_CHANGED],
        "argument": 0,
    }
    table = event_table({"events": [event]}, load("microsat"))
    assert table.rows[0][:5] == ("6041.000", "1.00", "FSW", "info", "mode SAFE")
    assert event_table({}, load("microsat")).rows == []
    assert table.caption == event_table({"events": [event], "event_count": 1}, load("microsat")).caption == ""
    cut = event_table({"events": [event], "event_count": 4711}, load("microsat"))
    assert cut.caption == "The first 1 of 4711 events"
