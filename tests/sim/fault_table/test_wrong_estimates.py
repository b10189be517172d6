"""No attitude is called valid that is wrong for long: what is found in records that are made by hand."""

from dataclasses import replace

import pytest

from fsw.core.events import Event
from sim.fault_rig.record import FaultFlightRecord, ReportedEvent
from sim.fault_table.row import FaultRow, Unseen
from sim.fault_table.wrong_estimates import never_wrong_for_long


def flown(*errors_deg, tick_hz=1, lit=True):
    """A record of a flight whose every tick was answered; None: no valid attitude."""
    ticks = len(errors_deg)
    return FaultFlightRecord(tick_hz, error_deg=list(errors_deg), done=[True] * ticks, lit=[lit] * ticks)


class TestHonesty:
    """A valid attitude may be more than 5 deg wrong for 120 s on end and no longer."""

    ROW = FaultRow("planted", "", "none")

    @pytest.mark.parametrize(("seconds", "holds"), [(120, True), (121, False)])
    @pytest.mark.parametrize("tick_hz", [1, 4])
    def test_the_time_is_that_of_the_ticks(self, bounds, seconds, holds, tick_hz):
        record = flown(*[0.2] * 50, *[5.1] * (seconds * tick_hz), *[0.2] * 50, tick_hz=tick_hz)
        assert never_wrong_for_long(self.ROW, record, bounds)[0] is holds

    def test_it_counts_to_the_end_of_the_flight_and_says_how_wrong(self, bounds):
        record = flown(0.1, 4.9, *[7.0] * 100, 63.0, *[9.0] * 99)
        assert never_wrong_for_long(self.ROW, record, bounds) == (
            False,
            "valid while up to 63 deg wrong, for 200 s on end",
        )

    @pytest.mark.parametrize("between", [4.9, None])
    def test_an_attitude_that_is_right_or_not_valid_ends_it(self, bounds, between):
        record = flown(*[30.0] * 100, between, *[30.0] * 100)
        assert never_wrong_for_long(self.ROW, record, bounds)[0]

    def test_a_flight_software_that_does_not_answer_calls_nothing_valid(self, bounds):
        record = flown(*[30.0] * 300)
        record.done = [False] * 300
        assert never_wrong_for_long(self.ROW, record, bounds) == (True, "")

    @pytest.mark.parametrize("every", [2, 3, 100])
    def test_a_tick_that_is_not_answered_neither_ends_it_nor_counts(self, bounds, every):
        record = flown(*[90.0] * 3000)
        record.done = [tick % every != 0 for tick in range(3000)]
        holds, finding = never_wrong_for_long(self.ROW, record, bounds)
        assert not holds
        assert finding == f"valid while up to 90 deg wrong, for {sum(record.done)} s on end"

    @pytest.mark.parametrize("between", [4.9, None])
    def test_an_answer_that_is_right_or_not_valid_ends_it_among_such_ticks(self, bounds, between):
        record = flown(*([30.0] * 100 + [between]) * 20)
        record.done = [tick % 2 == 0 for tick in range(len(record.error_deg))]
        holds, finding = never_wrong_for_long(self.ROW, record, bounds)
        assert holds, finding

    def test_where_both_sensors_agree_on_what_is_wrong_nothing_can_be_expected(self, bounds):
        row = FaultRow("planted", "", "none", unseen=Unseen.ALWAYS)
        holds, finding = never_wrong_for_long(row, flown(*[30.0] * 300), bounds)
        assert holds
        assert finding == "valid while up to 30 deg wrong, for 300 s on end"

    @pytest.mark.parametrize(
        ("unseen", "deg", "holds"),
        [
            (Unseen.NEVER, 14.0, False),
            (Unseen.IN_SHADOW, 14.0, True),
            (Unseen.IN_SHADOW, 16.0, False),
            (Unseen.ALONE, 14.0, True),
            (Unseen.ALONE, 16.0, False),
            (Unseen.AT_FIRST, 14.0, True),
            (Unseen.AT_FIRST, 16.0, False),
        ],
    )
    def test_less_of_the_only_sensor_that_is_left_in_the_shadow(self, bounds, unseen, deg, holds):
        row = FaultRow("planted", "", "none", unseen=unseen)
        assert never_wrong_for_long(row, flown(*[deg] * 1000, lit=False), bounds)[0] is holds

    @pytest.mark.parametrize(("deg", "holds"), [(14.0, True), (16.0, False)])
    def test_less_of_a_fault_within_a_declared_bound(self, bounds, deg, holds):
        row = FaultRow("planted", "", "none", unseen=Unseen.WITHIN_BOUND)
        found, finding = never_wrong_for_long(row, flown(*[deg] * 300), bounds)
        assert found is holds
        assert bool(finding) is not holds

    @pytest.mark.parametrize(("onset", "holds"), [(100, True), (150, False)])
    def test_or_from_the_fault_of_the_other_on(self, bounds, onset, holds):
        row = FaultRow("planted", "", "none", unseen=Unseen.ALONE)
        record = flown(*[14.0] * 300)
        record.onset = onset
        assert never_wrong_for_long(row, record, bounds)[0] is holds

    @pytest.mark.parametrize(("wrong", "holds"), [(720, True), (721, False)])
    @pytest.mark.parametrize("tick_hz", [1, 4])
    def test_nor_in_the_first_ten_minutes_of_some(self, bounds, wrong, holds, tick_hz):
        row = FaultRow("planted", "", "none", unseen=Unseen.AT_FIRST)
        record = flown(*[30.0] * (wrong * tick_hz), tick_hz=tick_hz)
        assert never_wrong_for_long(row, record, bounds)[0] is holds

    @pytest.mark.parametrize(
        ("deg", "wrong_s", "holds"), [(14.0, 3000, True), (16.0, 121, False), (14.0, 3121, False)]
    )
    @pytest.mark.parametrize("tick_hz", [1, 4])
    def test_less_of_cells_in_the_orbit_after_each_start(self, bounds, deg, wrong_s, holds, tick_hz):
        """Of an orbit of 3000 s, and of one start long after the first."""
        row, orbit = FaultRow("planted", "", "none", unseen=Unseen.SETTLING), replace(bounds, orbit_s=3000.0)
        record = flown(*[0.2] * (5000 * tick_hz), *[deg] * (wrong_s * tick_hz), tick_hz=tick_hz)
        record.events = [
            ReportedEvent(10, Event.FILTER_STARTED, 0),
            ReportedEvent(5000 * tick_hz, Event.FILTER_STARTED, 1),
        ]
        assert never_wrong_for_long(row, record, orbit)[0] is holds

    def test_but_once_the_sun_is_back_it_counts(self, bounds):
        row = FaultRow("planted", "", "none", unseen=Unseen.IN_SHADOW)
        record = flown(*[14.0] * 300)
        record.lit[:150] = [False] * 150
        assert never_wrong_for_long(row, record, bounds) == (
            False,
            "valid while up to 14 deg wrong, for 150 s on end",
        )
