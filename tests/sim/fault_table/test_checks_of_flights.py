"""What each check finds in records that are made by hand, most of them at four ticks a second."""

from dataclasses import replace
from fractions import Fraction
from math import inf

import pytest

from fsw.wire.messages import Mode
from sim.fault_rig.currents import CurrentLimits, CurrentPulse
from sim.fault_rig.record import FaultFlightRecord
from sim.fault_table import checks
from sim.fault_table.case import prepare
from sim.fault_table.row import FaultRow
from sim.plant.coil_drive import OFF, CoilDrive

ROW = FaultRow("planted", "", "none")
HZ = 4
ON = CoilDrive((0.0, -0.1, 0.0), 1.0)


def flown(seconds, **values):
    """A record of a flight without pulses, in which fsw runs all the time."""
    ticks = seconds * HZ
    given = {"coil_drives": [OFF] * ticks, "modes": [Mode.POINT] * ticks}
    return FaultFlightRecord(HZ, **{**given, **values})


def test_the_bounds_of_the_currents_are_those_of_the_scenario():
    settings = (
        "coils.levels_am2=[0.6, 2.4, 9.0]",
        "coils.dipole_per_ampere_am2=30.0",
        "coils.pulse_s=2.5",
        "coils.backoff_s=80.0",
        "time.tick_hz=4",
    )
    limits = CurrentLimits(4, (0.02, 0.08, 0.3), Fraction(5, 2), Fraction(80), True)
    shared = checks.bounds_of(prepare(settings)[0])
    assert shared.currents == limits
    assert shared.backoff_s == 80.0
    alone = checks.bounds_of(prepare((*settings, 'coils.backoff="per_coil"'))[0])
    assert alone.currents == replace(limits, shared=False)


class TestLimits:
    """Invariant I is kept by what the board reports and by the currents that flow."""

    LASTING = [ON] * 4

    def judged(self, bounds, drives, entries, *expect):
        record = FaultFlightRecord(1, entries=entries, coil_drives=drives)
        return checks.keeps_limits(replace(ROW, expect=expect), record, bounds)[0]

    def test_a_current_that_the_board_does_not_report_is_found(self, bounds, bus_log):
        entries = bus_log(ticks=20).entries()
        assert self.judged(bounds, [OFF] * 20, entries)
        assert not self.judged(bounds, self.LASTING, entries)

    def test_but_not_where_no_guard_can_open_the_switch(self, bounds, bus_log, fired):
        entries = bus_log(ticks=20).entries()
        assert self.judged(bounds, self.LASTING, entries, "stuck")
        reported = bus_log(ticks=20, pulses=[fired(1, 10, 4000)]).entries()
        assert not self.judged(bounds, self.LASTING, reported, "stuck")

    def test_a_board_that_reports_nothing_keeps_nothing(self, bounds):
        assert not self.judged(bounds, [OFF] * 20, [])

    def test_over_time_a_pulse_must_have_been_driven_and_not_for_too_long(self, bounds):
        def judged(*pulses):
            return checks.keeps_limits_over_time(ROW, flown(9, pulses_by_time=[*pulses]), bounds)[0]

        assert not judged()
        assert judged(CurrentPulse(0, Fraction(2), Fraction(5)))
        assert not judged(CurrentPulse(0, Fraction(2), Fraction(51, 10)))


def test_a_number_that_is_none_is_found_from_the_first_tick_on(bounds):
    assert checks.state_is_finite(ROW, flown(9), bounds)[0]
    assert not checks.state_is_finite(ROW, flown(9, not_finite=0), bounds)[0]


class TestAnswers:
    """Every SYNC is answered, and an answer is short."""

    def test_one_that_is_not_answered_is_found(self, bounds):
        assert checks.answers_every_sync(ROW, flown(9), bounds)[0]
        assert not checks.answers_every_sync(ROW, flown(9, unanswered=[0]), bounds)[0]

    def test_an_end_in_the_first_tick_is_found(self, bounds):
        assert not checks.answers_every_sync(ROW, flown(9, ended=0), bounds)[0]

    @pytest.mark.parametrize(("frames", "holds"), [(64, True), (65, False)])
    def test_an_answer_is_at_most_64_frames(self, bounds, frames, holds):
        assert checks.answers_every_sync(ROW, flown(9, worst_answer=frames), bounds)[0] is holds

    def test_but_that_of_a_stopped_process_is_to_all_that_waited(self, bounds):
        row = replace(ROW, kind="stopped")
        assert checks.answers_every_sync(row, flown(9, worst_answer=4096), bounds)[0]
        assert not checks.answers_every_sync(row, flown(9, unanswered=[7]), bounds)[0]


@pytest.mark.parametrize(("asked", "holds"), [([5], True), ([5, 30], True), ([4], False), ([6], False)])
def test_a_pulse_begins_in_the_tick_of_its_request(bounds, asked, holds):
    drives = [OFF] * 5 + [ON] * 3 + [OFF] * 30
    assert checks.no_extra_pulse(ROW, flown(9, coil_drives=drives, request_ticks=asked), bounds)[0] is holds


def test_a_second_pulse_without_a_request_is_found(bounds):
    drives = [OFF] * 5 + [ON] * 3 + [OFF] * 30 + [ON] * 3
    judged = checks.no_extra_pulse(ROW, flown(9, coil_drives=drives, request_ticks=[5]), bounds)
    assert judged == (False, "a pulse began in tick 38 without a request")


@pytest.mark.parametrize(("asked", "holds"), [(39, True), (40, False), (439, False), (440, True)])
def test_a_back_off_passes_between_a_boot_and_the_first_request(bounds, asked, holds):
    record = flown(200, boots=[40], request_ticks=[asked])
    assert checks.waits_after_boot(ROW, record, bounds)[0] is holds


class TestControlContinues:
    """A pulse is requested in the last 440 s of a flight of 1000 s, or it ends in SAFE."""

    @pytest.mark.parametrize(("asked_s", "holds"), [(559, False), (561, True), (999, True)])
    def test_by_the_last_request(self, bounds, asked_s, holds):
        record = flown(1000, request_ticks=[12, asked_s * HZ])
        assert checks.control_continues(ROW, record, bounds)[0] is holds

    @pytest.mark.parametrize(("last", "holds"), [(Mode.SAFE, True), (Mode.POINT, False), (None, False)])
    def test_or_by_the_mode_at_the_end(self, bounds, last, holds):
        record = flown(1000)
        record.modes = [Mode.SAFE] * 3999 + [last]
        assert checks.control_continues(ROW, record, bounds)[0] is holds

    @pytest.mark.parametrize(
        ("lasts_s", "unit", "holds"),
        [(inf, "magnetometer", False), (inf, "coil board", None), (300.0, "coil board", False)],
    )
    def test_not_expected_of_a_unit_that_stays_faulty_and_cannot_be_isolated(
        self, bounds, lasts_s, unit, holds
    ):
        row = replace(ROW, lasts_s=lasts_s, unit=unit)
        assert checks.control_continues(row, flown(1000), bounds)[0] is holds


@pytest.mark.parametrize(("rejected", "holds"), [(0, False), (1, True)])
def test_corrupt_frames_must_have_been_counted(bounds, rejected, holds):
    assert checks.counts_rejected_frames(ROW, flown(9, rejected=rejected), bounds)[0] is holds


class TestRecovers:
    """After a fault that ends at 50 s the error stays below 2 deg for 600 s, within an orbit of 3000 s."""

    def record(self, *errors_deg_for_s):
        errors = [deg for deg, seconds in errors_deg_for_s for _ in range(seconds * HZ)]
        return flown(len(errors) // HZ, onset=20 * HZ, end=50 * HZ, error_deg=errors)

    def judged(self, bounds, *errors_deg_for_s):
        record = self.record((0.5, 50), *errors_deg_for_s)
        return checks.recovers(ROW, record, replace(bounds, orbit_s=3000.0))

    def test_at_once(self, bounds):
        assert self.judged(bounds, (1.9, 600)) == (True, "estimate recovers after 0 s")

    @pytest.mark.parametrize(("wrong_s", "holds"), [(3000, True), (3001, False)])
    @pytest.mark.parametrize("deg", [2.0, None])
    def test_within_an_orbit(self, bounds, deg, wrong_s, holds):
        judged = self.judged(bounds, (deg, wrong_s), (1.9, 600))
        assert judged == (holds, f"estimate recovers after {wrong_s} s")

    @pytest.mark.parametrize("deg", [2.0, None])
    def test_from_the_last_error_on(self, bounds, deg):
        judged = self.judged(bounds, (1.9, 599), (deg, 1), (1.9, 600))
        assert judged == (True, "estimate recovers after 600 s")

    @pytest.mark.parametrize("errors", [((1.9, 599),), ((1.9, 599), (2.0, 1)), ((None, 900),)])
    def test_not_at_all(self, bounds, errors):
        assert self.judged(bounds, *errors) == (False, "the estimate does not recover")

    def test_nor_from_a_fault_without_an_end(self, bounds):
        record = self.record((0.5, 900))
        record.end = None
        assert checks.recovers(ROW, record, bounds) == (False, "the estimate does not recover")


class TestBounded:
    """A valid estimate is at most 15 deg wrong in the last 300 s of a flight."""

    def judged(self, bounds, *errors_deg, unit="magnetometer"):
        row = replace(ROW, unit=unit)
        return checks.valid_estimate_is_close(row, flown(500, error_deg=[*errors_deg]), bounds)

    def test_at_its_worst(self, bounds):
        assert self.judged(bounds, *[0.5] * 2000) == (True, "")
        worst = self.judged(bounds, *[0.5] * 1000, 16.0, *[0.5] * 999)
        assert worst == (False, "an estimate marked as valid is 16 deg off")

    @pytest.mark.parametrize(("after", "holds"), [(1199, False), (1200, True)])
    def test_over_the_last_300_s(self, bounds, after, holds):
        assert self.judged(bounds, *[90.0] * 800, *[0.5] * after)[0] is holds

    def test_what_is_not_valid_is_not_wrong(self, bounds):
        assert self.judged(bounds, *[None] * 2000)[0]
        assert not self.judged(bounds, *[None] * 1999, 90.0)[0]

    def test_a_unit_that_cannot_be_isolated_gives_no_verdict(self, bounds):
        assert self.judged(bounds, *[90.0] * 2000, unit="coil board")[0] is None
