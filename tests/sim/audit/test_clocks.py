"""Ticks and timestamps: which of them are judged, and that they agree."""

from fractions import Fraction

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import NAMES, CoilBoot, CoilStatus, Sync
from sim.audit.auditor import AuditLimits, ViolationKind, audit
from sim.audit.check import render
from sim.record.candump import LogEntry

EPOCH_US = 1_427_513_417_000_000


def every(period_us, statuses):
    """The statuses as a log without SYNC."""
    return [LogEntry(i + 1, i * period_us, "can0", status.encode()) for i, status in enumerate(statuses)]


def found(report):
    """Kind, time, tick and coil of each violation."""
    return [(one.kind, one.time_s, one.tick, one.coil) for one in report.violations]


def with_sync(log, change):
    """The log's entries with each SYNC run through ``change``, which may give any frame."""
    return [
        entry._replace(frame=change(Sync.decode(entry.frame.data)))
        if entry.frame.can_id == Sync.ID
        else entry
        for entry in log.entries()
    ]


# --- simulated time


def test_a_gap_that_only_the_timestamps_show(judge, bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    log.shifts_us = dict.fromkeys(range(150, 400), -100_000)
    report = judge(log)
    assert found(report) == [
        (ViolationKind.TIMESTAMP, 150, 150, None),
        (ViolationKind.GAP, Fraction("202.9"), 203, 1),
    ]
    assert "0.100 s early" in str(report.violations[0])
    assert "99.900 s after" in str(report.violations[1])


def test_a_pulse_that_only_the_timestamps_show(judge, bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100)])
    log.shifts_us = {103: 100_000}
    report = judge(log)
    assert found(report) == [(ViolationKind.PULSE, 100, 100, 0), (ViolationKind.TIMESTAMP, 103, 103, None)]
    assert "pulse of 3.100 s" in str(report.violations[0])


def test_a_status_between_two_ticks_that_shows_a_coil_on_for_longer(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100)])
    entries = log.entries()
    last_driven = entries[103 * 3]
    assert last_driven.frame == log.statuses[103][0]
    entries.insert(104 * 3, last_driven._replace(timestamp_us=last_driven.timestamp_us + 100_000))
    assert (ViolationKind.PULSE, 100, 100, 0) in found(audit(entries, AuditLimits()))


def test_one_microsecond_off_simulated_time_is_named_once(judge, bus_log):
    log = bus_log(10, 100)
    log.shifts_us = dict.fromkeys(range(50, 100), 1)
    assert found(judge(log)) == [(ViolationKind.TIMESTAMP, 5, 50, None)]


@pytest.mark.long
@pytest.mark.parametrize("name", ["COIL_STATUS", "SYNC"])
@pytest.mark.parametrize("first", [0, 1200])
def test_a_single_frame_off_simulated_time_is_named(bus_log, name, first):
    entries = [
        entry._replace(timestamp_us=entry.timestamp_us + 20_000)
        if entry.timestamp_us == EPOCH_US + 123_400_000 and NAMES[entry.frame.can_id] == name
        else entry
        for entry in bus_log(10, 1300).entries(first)
    ]
    report = audit(entries, AuditLimits())
    assert found(report) == [(ViolationKind.TIMESTAMP, Fraction("123.4"), 1234, None)]
    assert f"timestamp of {name} is 0.020 s late" in str(report.violations[0])


@pytest.mark.long
@pytest.mark.parametrize("tick_hz", [3, 6, 7, 64])
@pytest.mark.parametrize("up", [0, 1])
@pytest.mark.parametrize("sync", [True, False])
def test_the_rounding_of_timestamps_to_microseconds_is_no_violation(judge, bus_log, fired, tick_hz, up, sync):
    log = bus_log(tick_hz, 220 * tick_hz, [fired(0, 102), fired(1, 102 + 103 * tick_hz)], sync=sync)
    inexact = [tick for tick in range(log.ticks) if tick * 1_000_000 % tick_hz]
    log.shifts_us = dict.fromkeys(inexact, up)
    assert judge(log).ok


@pytest.mark.parametrize(("shift_us", "text"), [(1, "0.000001 s late"), (-1, "0.000001 s early")])
def test_a_microsecond_is_one_at_1_hz_too(judge, bus_log, shift_us, text):
    log = bus_log(1, 20)
    log.shifts_us = dict.fromkeys(range(10, 20), shift_us)
    (violation,) = judge(log).violations
    assert (violation.kind, violation.tick) == (ViolationKind.TIMESTAMP, 10)
    assert text in violation.sentence


# --- other timestamps


def test_timestamps_of_another_pace_show_no_real_time(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    log.shifts_us = {tick: 86_400_000_000 - 999_000 * tick for tick in range(400)}
    report = audit(log.entries(), AuditLimits())
    assert (report.ok, report.exit_code) == (True, 3)
    assert report.not_real_time == "its timestamps run at 1000 times the pace of its ticks"
    assert "limits kept by ticks; real time not judged: its timestamps run" in render(report)
    by_ticks = audit(log.entries(), AuditLimits(), ticks_alone=True)
    assert by_ticks.exit_code == 0
    assert "timestamps are not simulated time: judged by ticks alone" in by_ticks.notes


def test_timestamps_that_are_all_equal_show_no_real_time(bus_log, fired):
    entries = [entry._replace(timestamp_us=7) for entry in bus_log(1, 400, [fired(0, 100)]).entries()]
    report = audit(entries, AuditLimits())
    assert (report.exit_code, report.not_real_time) == (3, "its timestamps are all equal")


def recorded(log, held):
    """A recorder's own stamps, a day off, in which these ticks last so many us longer."""
    late_us, log.shifts_us = 86_400_123_456, {}
    for tick in range(log.ticks):
        log.shifts_us[tick] = late_us
        late_us += held.get(tick, 0)
    return log.entries()


def test_a_tick_held_in_a_pulse_is_a_violation_by_the_recorders_clock(bus_log, fired):
    log = bus_log(10, 1500, [fired(1, 1234)])
    report = audit(recorded(log, {1245: 10_000_000}), AuditLimits())
    assert found(report) == [(ViolationKind.PULSE, Fraction("123.4"), 1234, 1)]
    assert "by the recorder's clock the pulse of 12.800 s exceeds 3.000 s" in str(report.violations[0])


def test_a_tick_held_at_the_end_of_a_pulse_is_a_doubt(bus_log, fired):
    """The board has announced its end, and may have waited for SYNC."""
    log = bus_log(10, 1500, [fired(1, 1234)])
    report = audit(recorded(log, {1263: 10_000_000}), AuditLimits())
    assert (report.violations, report.exit_code) == ((), 1)
    assert report.doubt == "by the recorder's clock the pulse of coil 1 at tick 1234 may have lasted 13.000 s"


def test_ticks_rushed_between_pulses_are_a_violation_by_the_recorders_clock(bus_log, fired):
    log = bus_log(1, 600, [fired(0, 300), fired(1, 403)])
    report = audit(recorded(log, dict.fromkeys(range(304, 394), -900_000)), AuditLimits())
    assert found(report) == [(ViolationKind.GAP, 403, 403, 1)]
    assert "by the recorder's clock the pulse starts 20.000 s after the end" in str(report.violations[0])


@pytest.mark.parametrize(("held_us", "exit_code"), [(50_000, 0), (50_001, 1)])
def test_the_tolerance_of_a_recorders_clock_is_fifty_milliseconds(bus_log, fired, held_us, exit_code):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    assert audit(recorded(log, {101: held_us}), AuditLimits()).exit_code == exit_code
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    assert audit(recorded(log, {150: -held_us}), AuditLimits()).exit_code == exit_code


def test_a_step_back_of_the_recorders_clock_is_one_finding(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203), fired(2, 306)])
    report = audit(recorded(log, {150: -3_600_000_000}), AuditLimits())
    assert (report.violations, report.exit_code) == ((), 3)
    assert report.not_real_time == "the recorder's clock goes back by 3599.000 s at tick 151"


def test_a_step_ahead_of_the_recorders_clock_is_told_and_breaks_no_limit(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    report = audit(recorded(log, {150: 3_600_000_000, 180: 2_000_000}), AuditLimits())
    assert report.exit_code == 0
    told = "the recorder's clock goes on by 3600.000 s more than its ticks at tick 151, and once more"
    assert f"{told}: ticks that were held, or a step of that clock" in report.notes


def test_rushed_ticks_that_a_step_ahead_of_the_recorders_clock_would_hide_are_a_doubt(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    rushed = dict.fromkeys(range(110, 200), -900_000)
    assert audit(recorded(log, rushed), AuditLimits()).violations
    log = bus_log(1, 400, [fired(0, 100), fired(1, 203)])
    report = audit(recorded(log, rushed | {150: 90_000_000}), AuditLimits())
    assert (report.violations, report.exit_code) == ((), 1)
    assert "coil 1 at tick 203 may start" in report.doubt


def test_a_boot_counts_by_the_recorders_clock(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 250)], boots=[150])
    report = audit(recorded(log, dict.fromkeys(range(160, 200), -900_000)), AuditLimits())
    assert found(report) == [(ViolationKind.BOOT, 250, 250, 0)]


def test_whether_stamps_are_simulated_does_not_hang_on_the_first_sync(bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100)])
    log.shifts_us = {0: 1}
    assert {kind for kind, *_ in found(audit(log.entries(), AuditLimits()))} == {ViolationKind.TIMESTAMP}


def test_ticks_are_judged_where_timestamps_are_not_simulated(judge, bus_log, fired):
    log = bus_log(10, 1500, [fired(1, 1234, 3100)])
    log.shifts_us = {tick: 1000 - 90_000 * tick for tick in range(1500)}
    assert found(judge(log)) == [(ViolationKind.PULSE, Fraction("123.4"), 1234, 1)]


def test_without_sync_time_counts_from_the_first_entry(judge, bus_log, fired):
    report = judge(bus_log(1, 200, [fired(1, 100, 3100)], sync=False))
    assert found(report) == [(ViolationKind.PULSE, 100, None, 1)]
    assert "no tick rate in the log: judged by timestamps, a COIL_STATUS every 1.000 s" in report.notes


def test_without_sync_the_most_common_spacing_is_the_period(bus_log, fired):
    log = bus_log(10, 1500, [fired(1, 1000, 3000)], sync=False)
    log.statuses |= {tick: [] for tick in range(200, 260)}
    report = audit(log.entries(), AuditLimits())
    assert report.ok
    assert (report.pulses[0].start_s, report.pulses[0].end_s) == (100, 103)


@pytest.mark.parametrize("period_us", [400_000, 2_000_000, 999_000])
def test_without_sync_the_period_need_not_be_a_whole_rate(period_us):
    pulse = [CoilStatus(1, 2, 0, 0, 0, 1)] * (3_000_000 // period_us)
    idle = CoilStatus(0, 0, 0, 0, 0, 1)
    length_us = len(pulse) * period_us
    statuses = [idle] * 5 + pulse + [idle] * 5
    assert audit(every(period_us, statuses), AuditLimits(pulse_us=length_us)).ok
    report = audit(every(period_us, statuses), AuditLimits(pulse_us=length_us - 1))
    assert found(report) == [(ViolationKind.PULSE, Fraction(4 * period_us, 1_000_000), None, 2)]


def test_without_sync_statuses_within_half_a_period_are_of_one_tick():
    idle, one, two = (CoilStatus(level, coil, 0, 0, 0, 1) for level, coil in [(0, 0), (1, 1), (1, 2)])
    entries = every(1_000_000, [idle] * 5 + [one] + [idle] * 5)
    for after_us, kinds in [
        (0, [ViolationKind.TWO_COILS]),
        (500_000, [ViolationKind.TWO_COILS]),
        (500_001, [ViolationKind.TWO_COILS, ViolationKind.GAP]),
    ]:
        other = LogEntry(99, 5_000_000 + after_us, "can0", two.encode())
        report = audit([*entries[:6], other, *entries[6:]], AuditLimits())
        assert [one.kind for one in report.violations] == kinds
        assert {one.coil for one in report.violations} == {2}


def test_without_sync_a_coil_was_on_until_the_last_status_that_says_so():
    idle, on = CoilStatus(0, 0, 0, 0, 0, 1), CoilStatus(1, 0, 0, 0, 0, 1)
    entries = every(1_000_000, [idle] * 5 + [on] * 3 + [idle] * 5)
    entries.insert(8, LogEntry(99, 7_100_000, "can0", on.encode()))
    report = audit(entries, AuditLimits())
    assert found(report) == [(ViolationKind.PULSE, 4, None, 0)]
    assert "pulse of 3.100 s" in str(report.violations[0])


@pytest.mark.parametrize("sooner_us", [0, 300_000, 999_000])
def test_without_sync_a_pulse_may_end_within_a_tick_wherever_time_begins(bus_log, fired, sooner_us):
    log = bus_log(1, 200, [fired(1, 150, 2500)], sync=False)
    boot = LogEntry(0, log.timestamp_us(0) - sooner_us, "can0", CoilBoot(0, 1, 0).encode())
    (pulse,) = audit([boot, *log.entries()], AuditLimits()).pulses
    assert pulse.length_s == Fraction("2.5")


def test_without_sync_doubled_statuses_do_not_make_the_period_zero(bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)], sync=False)
    log.statuses = {tick: frames * 3 for tick, frames in log.statuses.items()}
    report = audit(log.entries(), AuditLimits())
    assert report.ok
    assert (report.pulses[0].start_s, report.pulses[0].end_s) == (110, 113)


# --- the tick rate


@pytest.mark.parametrize("tick_hz", [1, 3, 10, 100])
@pytest.mark.parametrize("first", [0, 1, 1234, 4321])
def test_the_tick_rate_of_a_log_that_starts_anywhere(bus_log, fired, tick_hz, first):
    log = bus_log(tick_hz, first + 12 * tick_hz, [fired(0, first + 5 * tick_hz, 3100)])
    report = audit(log.entries(first), AuditLimits())
    assert found(report) == [(ViolationKind.PULSE, Fraction(first, tick_hz) + 5, first + 5 * tick_hz, 0)]
    assert report.span_s == 12 - Fraction(1, tick_hz)
    assert report.statuses == 12 * tick_hz


def test_the_tick_rate_of_the_log_overrules_that_of_the_scenario(judge, bus_log, fired):
    report = judge(bus_log(10, 1500, [fired(1, 1234, 3100)]), tick_hz=1)
    assert found(report) == [(ViolationKind.PULSE, Fraction("123.4"), 1234, 1)]
    assert "the log has 10 ticks a second, its scenario says 1" in report.notes


def test_lost_sync_frames_change_neither_the_tick_rate_nor_a_pulse(bus_log, fired):
    log = bus_log(10, 1500, [fired(1, 1234)])
    report = audit(log.entries(without_sync={10, 500, 501, 1235, 1264}), AuditLimits())
    assert report.ok
    assert (report.pulses[0].start_s, report.pulses[0].end_s) == (Fraction("123.4"), Fraction("126.4"))


@pytest.mark.long
@pytest.mark.parametrize("late", [{1234}, {1235}, {1264}, {1265}, {1233, 1236, 1263}, set(range(1230, 1270))])
def test_statuses_that_come_after_their_sync_belong_to_their_tick(bus_log, fired, late):
    log = bus_log(10, 1500, [fired(1, 1234), fired(2, 1234 + 1030)], late=late)
    report = audit(log.entries(), AuditLimits())
    assert report.ok
    assert (report.pulses[0].start_s, report.pulses[0].end_s) == (Fraction("123.4"), Fraction("126.4"))
    assert not any("COIL_STATUS" in note for note in report.notes)


def test_a_boot_that_comes_after_its_sync_belongs_to_its_tick(bus_log, fired):
    assert audit(bus_log(1, 200, [fired(1, 150)], boots=[50], late={50}).entries(), AuditLimits()).ok
    assert not audit(bus_log(1, 200, [fired(1, 149)], boots=[50], late={50}).entries(), AuditLimits()).ok


def test_a_log_without_its_beginning_says_where_it_begins(bus_log, fired):
    log = bus_log(10, 1500, [fired(1, 1234)])
    told = "the log begins at tick 700: what came before it is not judged"
    assert told in audit(log.entries(700), AuditLimits()).notes
    assert not any("begins" in note for note in audit(log.entries(0), AuditLimits()).notes)


def test_a_log_too_short_to_tell_its_tick_rate_is_judged_by_the_scenarios(bus_log, fired):
    log = bus_log(100, 50, [fired(1, 20, 100), fired(2, 40, 100)])
    assert found(audit(log.entries(), AuditLimits(tick_hz=100))) == [
        (ViolationKind.GAP, Fraction("0.4"), 40, 2)
    ]
    assert found(audit(log.entries(), AuditLimits())) == [(ViolationKind.GAP, Fraction("0.4"), None, 2)]


@pytest.mark.parametrize(("stated", "tick_hz"), [(11, 11), (10, 10), (9, 10), (None, 10)])
def test_of_several_tick_rates_that_fit_the_scenarios_is_taken_else_the_lowest(
    bus_log, fired, stated, tick_hz
):
    log = bus_log(11, 13, [fired(1, 2, 100)])
    report = audit(log.entries(without_sync={10}), AuditLimits(tick_hz=stated))
    assert report.pulses[0].start_s == Fraction(2, tick_hz)


@pytest.mark.parametrize("level", [3, 4])
def test_what_comes_after_the_last_sync_is_judged(bus_log, fired, level):
    entries = bus_log(1, 112, [fired(0, 110, level=level)]).entries()
    assert NAMES[entries[-3].frame.can_id] == "COIL_STATUS"
    report = audit(entries[:-2], AuditLimits())
    assert found(report) == ([(ViolationKind.LEVEL, 111, 111, 0)] if level == 4 else [])
    assert len(report.pulses) == 1


# --- SYNC itself


@pytest.mark.parametrize("last", [150, 157, 199])
def test_a_unix_time_that_contradicts_its_tick_is_named_once(bus_log, last):
    entries = with_sync(
        bus_log(10, 200),
        lambda sync: sync.replace(unix_time_s=sync.unix_time_s + (150 <= sync.tick <= last)).encode(),
    )
    report = audit(entries, AuditLimits())
    assert found(report) == [(ViolationKind.SYNC, 15, 150, None)]
    assert f"unix_time_s {EPOCH_US // 10**6 + 16}, its tick says {EPOCH_US // 10**6 + 15}" in str(report)


def test_ticks_that_jump_forward_to_hide_a_short_gap(bus_log, fired):
    log = bus_log(1, 300, [fired(0, 100), fired(1, 202)])
    entries = with_sync(
        log, lambda sync: Sync(sync.tick + (sync.tick > 150), sync.unix_time_s + (sync.tick > 150)).encode()
    )
    assert not audit(entries, AuditLimits()).ok


def test_ticks_that_go_back(bus_log, fired):
    entries = bus_log(1, 50, [fired(0, 48)]).entries() + bus_log(1, 20).entries(5)
    report = audit(entries, AuditLimits())
    assert (ViolationKind.SYNC, 5, 5, None) in found(report)
    assert "SYNC goes back from tick 49 to tick 5" in "".join(map(str, report.violations))
    assert [(pulse.start_s, pulse.end_s) for pulse in report.pulses] == [(48, 49)]


def test_a_sync_that_is_sent_again_is_no_time(bus_log, fired):
    """In lockstep, to a flight software that is silent: neither a violation, nor a tick."""
    log = bus_log(1, 300, [fired(0, 100)])
    entries = [entry for one in log.entries() for entry in [one] * (1 + 2 * (one.frame.can_id == Sync.ID))]
    report = audit(entries, AuditLimits())
    assert report.ok
    assert [(pulse.start_s, pulse.end_s) for pulse in report.pulses] == [(100, 103)]


def test_a_sync_that_is_sent_again_with_another_time_is_a_violation(bus_log):
    entries = bus_log(1, 50).entries()
    last = next(e for e in entries if e.frame.can_id == Sync.ID and Sync.decode(e.frame.data).tick == 40)
    sync = Sync.decode(last.frame.data)
    entries.insert(
        entries.index(last) + 1, last._replace(frame=sync.replace(unix_time_s=sync.unix_time_s + 9).encode())
    )
    assert (ViolationKind.SYNC, 40, 40, None) in found(audit(entries, AuditLimits()))


def test_a_pulse_does_not_last_from_one_run_into_the_next(bus_log, fired):
    """Both show the same coil and the same request."""
    entries = bus_log(1, 50, [fired(0, 48)]).entries() + bus_log(1, 20, [fired(0, 5)]).entries(6)
    report = audit(entries, AuditLimits())
    assert [(pulse.start_s, pulse.end_s) for pulse in report.pulses] == [(5, 8), (48, 49)]
    assert not any("without COIL_STATUS" in note for note in report.notes)


def test_a_log_whose_clock_begins_in_1970(judge, bus_log, fired):
    assert judge(bus_log(10, 1500, [fired(1, 1234)], epoch_s=0)).violations == ()


def test_a_first_sync_of_the_wrong_length_has_no_tick(bus_log):
    entries = with_sync(bus_log(1, 50), lambda sync: sync.encode() if sync.tick else Frame(Sync.ID, b"\0"))
    assert found(audit(entries, AuditLimits()))[0] == (ViolationKind.SYNC, 0, None, None)


def test_a_sync_of_the_wrong_length(bus_log):
    log = bus_log(1, 50)
    entries = with_sync(log, lambda sync: Frame(Sync.ID, b"\0") if sync.tick == 30 else sync.encode())
    assert found(audit(entries, AuditLimits())) == [(ViolationKind.SYNC, 30, 30, None)]


def test_syncs_that_fit_no_tick_rate(bus_log):
    entries = with_sync(bus_log(1, 50), lambda sync: Sync(sync.tick, 1000 - sync.tick).encode())
    for tick_hz in (None, 1):
        report = audit(entries, AuditLimits(tick_hz=tick_hz))
        assert {one.kind for one in report.violations} == {ViolationKind.SYNC}
    report = audit(entries, AuditLimits())
    assert found(report) == [(ViolationKind.SYNC, 0, None, None)]
    assert "no tick rate" in str(report.violations[0])
    assert report.violations[0].line == 0, "it is of no line, but of all"


@pytest.mark.parametrize("tick_hz", [None, 1])
@pytest.mark.parametrize("at_tick", [0, 1, 30])
def test_one_sync_of_an_absurd_tick_is_a_violation_of_sync(bus_log, tick_hz, at_tick):
    log = bus_log(1, 50)
    entries = log.entries()
    place = next(i for i, e in enumerate(entries) if e.frame == Sync(at_tick, log.epoch_s + at_tick).encode())
    forged = Sync(2**32 - 7, log.epoch_s + at_tick + 1).encode()
    entries.insert(place + 1, entries[place]._replace(frame=forged))
    report = audit(entries, AuditLimits(tick_hz=tick_hz))
    assert ViolationKind.SYNC in {one.kind for one in report.violations}
    assert report.exit_code == 1


@pytest.mark.parametrize("beyond", [0, 1, 200])
def test_a_log_may_end_with_the_last_tick_and_not_go_on_after_it(bus_log, beyond):
    """The count does not wrap: a SYNC(0) after the last tick is one of another count."""
    log, last = bus_log(100, 500), 2**32 - 1
    entries, first = [], last - 499 + beyond
    for entry in log.entries():
        frame = entry.frame
        if frame.can_id == Sync.ID:
            tick = first + Sync.decode(frame.data).tick
            frame = Sync(tick, log.epoch_s + tick // 100).encode()
        entries.append(entry._replace(timestamp_us=entry.timestamp_us + first * 10_000, frame=frame))
    report = audit(entries, AuditLimits(tick_hz=100))
    assert (ViolationKind.SYNC in {one.kind for one in report.violations}) is (beyond > 0)
    assert report.exit_code == (1 if beyond else 0)


def test_nothing_is_judged_of_nothing():
    report = audit([], AuditLimits())
    assert not report.ok
    assert report.notes == ("the log has no end mark", "no COIL_STATUS in the log: nothing to judge")


def test_a_lone_status_is_judged(bus_log):
    status = bus_log(ticks=2).statuses[1][0]
    assert audit([LogEntry(1, 0, "can0", status)], AuditLimits()).ok


def test_without_sync_the_rate_of_the_scenario_tells_the_time(bus_log, fired):
    """Every other status is lost: by their spacing alone the rate would be half of it."""
    log = bus_log(10, 2500, [fired(0, 1001), fired(1, 2035)], sync=False)
    every_other = [entry for entry in log.entries() if entry.frame.can_id == CoilStatus.ID][::2]
    report = audit(every_other, AuditLimits(tick_hz=10))
    assert report.violations == ()
    assert not any("a COIL_STATUS every 0.200 s" in note for note in report.notes)
    assert any("a COIL_STATUS every 0.100 s" in note for note in report.notes)
