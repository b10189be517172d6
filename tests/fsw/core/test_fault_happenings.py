"""The events of faults: one for each that is new or gone."""

import pytest

from fsw.core import telemetry
from fsw.core.events import Event, Happening
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.fdir.faults import CoilFault, SensorFault
from fsw.core.fdir.fdir import Health
from fsw.core.fdir.sensors.health import SensorHealth, Watch
from fsw.core.fdir.sensors.pair import Pair, Standing
from fsw.core.telemetry import find_faults

FROZEN, SILENT = SensorFault.FROZEN, SensorFault.SILENT
OPEN, WEAK = CoilFault.OPEN, CoilFault.WEAK


def sensors(field=0, sun=0, **changes):
    return Health(sensors=SensorHealth(Watch(fault=field), Watch(fault=sun), **changes))


def coils(*faults):
    return Health(coils=CoilHealth(faults=faults))


def happenings(before, after):
    return telemetry.fault_happenings(find_faults(before), find_faults(after))


class TestHappenings:
    @pytest.mark.parametrize(
        ("before", "after", "event", "argument"),
        [
            (sensors(), sensors(field=FROZEN), Event.SENSOR_ISOLATED, 100 + FROZEN),
            (sensors(), sensors(sun=SILENT), Event.SENSOR_ISOLATED, 200 + SILENT),
            (sensors(field=SILENT), sensors(field=FROZEN), Event.SENSOR_ISOLATED, 100 + FROZEN),
            (sensors(field=FROZEN), sensors(), Event.SENSOR_READMITTED, 100 + FROZEN),
            (sensors(), sensors(pair=Pair(Standing.DISPUTED)), Event.SENSORS_DISAGREE, 0),
            (coils(0, 0, 0), coils(0, WEAK, 0), Event.COIL_FAULT, 200 + WEAK),
            (coils(0, WEAK, 0), coils(0, OPEN, 0), Event.COIL_FAULT, 200 + OPEN),
            (coils(0, WEAK, OPEN), coils(0, WEAK, 0), Event.COIL_READMITTED, 300 + OPEN),
        ],
    )
    def test_each_change_is_an_event(self, before, after, event, argument):
        assert happenings(before, after) == [Happening(event, argument)]

    @pytest.mark.parametrize(
        ("before", "after"),
        [
            (sensors(field=FROZEN, sun=SILENT), sensors(field=FROZEN, sun=SILENT)),
            (sensors(pair=Pair(Standing.DISPUTED)), sensors(pair=Pair(Standing.DISPUTED))),
            (sensors(pair=Pair(Standing.DISPUTED)), sensors()),
            (coils(OPEN, 0, WEAK), coils(OPEN, 0, WEAK)),
        ],
    )
    def test_what_lasts_and_a_dispute_that_ends_is_none(self, before, after):
        assert happenings(before, after) == []

    def test_they_are_in_a_fixed_order(self):
        found = Health(
            SensorHealth(Watch(FROZEN), Watch(SILENT), Pair(Standing.DISPUTED)), CoilHealth((1, 2, 3))
        )
        assert happenings(Health(), found) == [
            Happening(Event.SENSOR_ISOLATED, 100 + FROZEN),
            Happening(Event.SENSOR_ISOLATED, 200 + SILENT),
            Happening(Event.SENSORS_DISAGREE, 0),
            *(Happening(Event.COIL_FAULT, 100 * number + number) for number in (1, 2, 3)),
        ]
