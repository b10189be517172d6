"""Since when a unit is out of use: from its first isolation on, until it is readmitted."""

import pytest

from fsw.core.events import Event
from fsw.wire.messages import FswEvent, PlantEvent
from sim.record.candump import LogEntry
from sim.report.summary import BusTally

EPOCH_US = 1_427_424_417_000_000


def tally_of(*events, message=FswEvent):
    """The tally of events, each with its time in seconds and its argument."""
    tally = BusTally(EPOCH_US)
    for seconds, event, argument in events:
        frame = message(2, event, 0, argument).encode()
        tally.take(LogEntry(1, EPOCH_US + round(seconds * 1e6), "vcan0", frame))
    return tally


@pytest.mark.parametrize(
    ("isolated", "readmitted", "unit"),
    [
        ((Event.SENSOR_ISOLATED, 103), (Event.SENSOR_READMITTED, 103), "magnetometer"),
        ((Event.SENSOR_ISOLATED, 402), (Event.SENSOR_READMITTED, 402), "cell 2"),
        ((Event.COIL_FAULT, 201), (Event.COIL_READMITTED, 201), "coil 1"),
    ],
)
def test_a_unit_is_out_of_use_until_it_is_readmitted(isolated, readmitted, unit):
    assert tally_of((17.5, *isolated)).out_of_use == {unit: 17.5}
    back = tally_of((17.5, *isolated), (30.0, *readmitted))
    assert (back.out_of_use, back.isolated) == ({}, [unit])
    again = tally_of((17.5, *isolated), (30.0, *readmitted), (41.25, *isolated))
    assert (again.out_of_use, again.isolated) == ({unit: 41.25}, [unit])


def test_another_fault_of_a_unit_that_is_out_already_does_not_begin_its_time_anew():
    tally = tally_of((5.0, Event.SENSOR_ISOLATED, 201), (9.0, Event.SENSOR_ISOLATED, 204))
    assert tally.out_of_use == {"sun sensor": 5.0}


def test_a_readmission_is_of_its_own_unit():
    tally = tally_of(
        (1.0, Event.COIL_FAULT, 101),
        (2.0, Event.SENSOR_ISOLATED, 101),
        (3.0, Event.SENSOR_READMITTED, 101),
        (4.0, Event.COIL_READMITTED, 301),
    )
    assert tally.out_of_use == {"coil 0": 1.0}


def test_no_other_node_takes_a_unit_out_of_use_or_back():
    assert tally_of((1.0, Event.SENSOR_ISOLATED, 101), message=PlantEvent).out_of_use == {}
