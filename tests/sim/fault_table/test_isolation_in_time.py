"""When a unit is found and by whom, in records at four ticks a second, of faults that begin after 25 s."""

from dataclasses import replace
from math import inf

import pytest

from fsw.core.fdir.faults import Sensor, SensorFault
from fsw.core.monitors import Monitor
from fsw.core.telemetry import Event as Number
from fsw.wire.messages import Mode
from hil_stub.coils.events import CoilEventCode
from sim.fault_rig.record import BoardEvent, FaultFlightRecord, ReportedEvent
from sim.fault_table import isolation
from sim.fault_table.row import FaultRow, RowFault
from sim.plant.coil_drive import OFF

HZ, ONSET = 4, 100
MAG = FaultRow("planted", "", "none", unit="magnetometer", lasts_s=60.0)


def record(*events, board=(), lit=True):
    ticks = 500
    return FaultFlightRecord(
        HZ,
        onset=ONSET,
        events=list(events),
        board_events=list(board),
        coil_drives=[OFF] * ticks,
        lit=[lit] * ticks,
        error_deg=[0.3] * ticks,
        modes=[Mode.POINT] * ticks,
    )


def tripped(tick, monitor):
    return ReportedEvent(tick, Number.MONITOR_TRIPPED, monitor)


def named(tick, sensor=Sensor.MAGNETOMETER):
    return ReportedEvent(tick, Number.SENSOR_ISOLATED, 100 * sensor + SensorFault.REFUSED)


def test_the_time_to_a_finding_is_in_seconds_from_the_onset_of_the_fault(bounds):
    fault = RowFault("none", {}, inf, "magnetometer", after_s=10.0)
    assert isolation.onset_tick(fault, record()) == ONSET + 40
    assert isolation.isolation_s(fault, record(named(139), named(150), named(180))) == 2.5
    assert isolation.doubt_s(fault, record(ReportedEvent(150, Number.SENSORS_DISAGREE, 0))) == 2.5
    assert isolation.isolates_faulty_unit(MAG, record(named(200)), bounds) == (True, "found after 25 s")


@pytest.mark.parametrize(("lit_tick", "shows"), [(139, False), (140, True), (159, True), (160, False)])
def test_a_fault_shows_from_its_first_second_to_its_last(lit_tick, shows):
    fault = RowFault("sun_swapped", {}, 5.0, "sun sensor", after_s=10.0)
    flown = record(lit=False)
    flown.lit[lit_tick] = True
    assert isolation.shows(fault, flown) is shows


class TestGivenUp:
    """A fault of 60 s in the shadow need not be named if the attitude is not valid when it ends."""

    def judged(self, bounds, not_valid, lit=()):
        flown = record(lit=False)
        for tick in not_valid:
            flown.error_deg[tick] = None
        for tick in lit:
            flown.lit[tick] = True
        return isolation.isolates_or_disputes_faulty_unit(MAG, flown, bounds)[0]

    def test_it_is_the_last_tick_of_the_fault_that_counts(self, bounds):
        assert self.judged(bounds, [339]) is True
        assert self.judged(bounds, [*range(100, 339), *range(340, 500)]) is False

    @pytest.mark.parametrize(("lit", "holds"), [(99, True), (100, False), (339, False), (340, True)])
    def test_it_is_the_light_during_the_fault_that_counts(self, bounds, lit, holds):
        assert self.judged(bounds, [339], [lit]) is holds

    def test_a_fault_that_goes_on_after_the_flight_has_not_ended(self, bounds):
        row = replace(MAG, lasts_s=100.25)
        flown = record(lit=False)
        flown.error_deg = [None] * 500
        assert isolation.isolates_or_disputes_faulty_unit(row, flown, bounds)[0] is False


class TestSilentBoard:
    """The monitor of the board that is silent trips, and no other does."""

    def judged(self, bounds, *events):
        return isolation.monitor_trips_for_silent_board(MAG, record(*events), bounds)[0]

    def test_it_trips(self, bounds):
        assert self.judged(bounds, tripped(100, Monitor.FIELD_FRESH), tripped(180, Monitor.FIELD_FRESH))

    def test_none_does(self, bounds):
        assert not self.judged(bounds)
        assert not self.judged(bounds, tripped(99, Monitor.FIELD_FRESH)), "before the fault"

    @pytest.mark.parametrize("other", [Monitor.COIL_STATUS_FRESH, Monitor.RATE_BOUNDED])
    def test_another_does(self, bounds, other):
        right = tripped(110, Monitor.FIELD_FRESH)
        assert not self.judged(bounds, tripped(110, other))
        assert not self.judged(bounds, right, tripped(120, other))
        assert self.judged(bounds, tripped(99, other), right), "before the fault"


class TestStuckOn:
    """SAFE is entered once a driver is stuck on, and the board says what it is."""

    ROW = FaultRow("planted", "", "none", unit="coil 2", expect=("stuck",))

    @pytest.mark.parametrize(("tick", "holds"), [(99, False), (100, True), (499, True)])
    def test_safe_is_entered_after_it(self, bounds, tick, holds):
        flown = record()
        flown.modes[tick] = Mode.SAFE
        assert isolation.enters_safe(self.ROW, flown, bounds)[0] is holds

    def test_of_what_fsw_cannot_detect_nothing_is_said(self, bounds):
        row = replace(self.ROW, unit="coil board")
        assert isolation.enters_safe(row, record(), bounds)[0] is None

    @pytest.mark.parametrize(("other_tick", "holds"), [(99, True), (112, True), (113, False)])
    def test_a_pulse_of_3_s_in_which_it_begins_may_be_called_wrong_first(self, bounds, other_tick, holds):
        other = BoardEvent(other_tick, CoilEventCode.NO_CURRENT, 0)
        stuck = BoardEvent(120, CoilEventCode.CURRENT_WHILE_OFF, None)
        assert isolation.board_identifies_unit(self.ROW, record(board=[other, stuck]), bounds)[0] is holds

    def test_what_the_board_said_of_a_coil_before_its_fault_does_not_count(self, bounds):
        row = replace(self.ROW, expect=())
        early = BoardEvent(99, CoilEventCode.NO_CURRENT, 2)
        assert not isolation.board_identifies_unit(row, record(board=[early]), bounds)[0]
