from fractions import Fraction

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilBoot, CoilStatus
from sim.audit.auditor import AuditLimits, ViolationKind, audit


def found(report):
    """Kind, time, tick and coil of each violation."""
    return [(one.kind, one.time_s, one.tick, one.coil) for one in report.violations]


def spans(report):
    return [(pulse.coil, pulse.start_s, pulse.end_s) for pulse in report.pulses]


# --- what must pass


@pytest.mark.long
@pytest.mark.parametrize("tick_hz", [1, 2, 3, 7, 10, 64])
@pytest.mark.parametrize("sync", [True, False])
def test_pulses_just_inside_the_limits_pass_at_any_tick_rate(judge, bus_log, fired, tick_hz, sync):
    pulses = [fired(0, 100 * tick_hz), fired(2, 203 * tick_hz), fired(2, 306 * tick_hz, level=-3)]
    report = judge(bus_log(tick_hz, 312 * tick_hz, pulses, boots=[0], sync=sync))
    assert found(report) == []
    assert report.ok
    assert report.exit_code == 0
    assert spans(report) == [(0, 100, 103), (2, 203, 206), (2, 306, 309)]
    assert report.min_gap_any_s == 100.0
    assert report.min_gap_per_coil_s == [None, None, 100.0]
    assert report.max_pulse_s == 3.0
    assert report.pulses_per_coil == [1, 0, 2]


def test_a_log_without_pulses_passes(judge, bus_log):
    report = judge(bus_log(ticks=20))
    assert report.ok
    assert (report.pulses, report.max_pulse_s, report.min_gap_any_s) == ((), None, None)
    assert report.duty_total == 0.0


def test_duty_is_the_fraction_of_the_time_driven(judge, bus_log, fired):
    report = judge(bus_log(1, 301, [fired(0, 10), fired(1, 150, 2000)]))
    assert report.duty_per_coil == [0.01, 2 / 300, 0.0]
    assert report.duty_total == pytest.approx(5 / 300)


# --- pulses


@pytest.mark.parametrize("sync", [True, False])
def test_a_pulse_of_3_1_s_at_10_hz(judge, bus_log, fired, sync):
    report = judge(bus_log(10, 1500, [fired(1, 1234, 3100)], sync=sync))
    tick = 1234 if sync else None
    assert found(report) == [(ViolationKind.PULSE, Fraction("123.4"), tick, 1)]
    assert "pulse of 3.100 s exceeds 3.000 s" in str(report.violations[0])
    assert not report.ok
    assert report.exit_code == 1
    assert report.max_pulse_s == 3.1


def test_a_pulse_that_ends_within_a_tick_is_measured_by_what_remained(judge, bus_log, fired):
    report = judge(bus_log(1, 200, [fired(2, 110, 3100)]))
    assert found(report) == [(ViolationKind.PULSE, 110, 110, 2)]
    assert report.pulses[0].length_s == Fraction("3.1")


@pytest.mark.parametrize("duration_ms", [2001, 2500, 2999, 3000])
@pytest.mark.parametrize("tick_hz", [1, 3, 7, 10])
def test_shorter_pulses_are_measured_to_the_millisecond(judge, bus_log, fired, duration_ms, tick_hz):
    report = judge(bus_log(tick_hz, 20 * tick_hz, [fired(0, 10 * tick_hz, duration_ms)]))
    assert report.ok
    assert abs(report.pulses[0].length_s - Fraction(duration_ms, 1000)) < Fraction(1, 1000)


@pytest.mark.parametrize("tick_hz", [1, 3, 7, 10])
def test_one_millisecond_too_long_is_too_long(judge, bus_log, fired, tick_hz):
    report = judge(bus_log(tick_hz, 20 * tick_hz, [fired(0, 10 * tick_hz, 3001)]))
    assert found(report) == [(ViolationKind.PULSE, 10, 10 * tick_hz, 0)]


def test_a_pulse_driven_one_tick_beyond_its_announced_end(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)])
    log.change(114, level=1, coil=0, seq=1)
    assert found(judge(log)) == [(ViolationKind.PULSE, 110, 110, 0)]


@pytest.mark.parametrize(("tick", "remaining_ms"), [(111, 2001), (112, 1001), (113, 1)])
def test_a_pulse_that_announces_too_much_although_it_ends_in_time(judge, bus_log, fired, tick, remaining_ms):
    log = bus_log(1, 200, [fired(0, 110)])
    log.change(tick, remaining_ms=remaining_ms)
    report = judge(log)
    assert found(report) == [(ViolationKind.ANNOUNCED, 110, 110, 0)]
    assert "announces 3.001 s, which exceeds 3.000 s" in str(report.violations[0])
    assert report.max_pulse_s == 3.0


@pytest.mark.parametrize("sync", [True, False])
def test_a_pulse_still_on_when_the_log_ends_is_judged_too(judge, bus_log, fired, sync):
    report = judge(bus_log(10, 1032, [fired(0, 1000, 3100)], sync=sync))
    assert found(report) == [(ViolationKind.PULSE, 100, 1000 if sync else None, 0)]


def test_a_pulse_cut_short_by_the_board_counts_only_as_driven(judge, bus_log, fired):
    log = bus_log(1, 300, [fired(0, 110), fired(1, 211)])
    for tick in (112, 113):
        log.change(tick, level=0, remaining_ms=0)
    report = judge(log)
    assert report.ok
    assert spans(report) == [(0, 110, 111), (1, 211, 214)]


# --- gaps


@pytest.mark.parametrize("sync", [True, False])
def test_a_gap_of_99_9_s_at_10_hz(judge, bus_log, fired, sync):
    report = judge(bus_log(10, 2200, [fired(0, 1000), fired(1, 2029)], sync=sync))
    assert found(report) == [(ViolationKind.GAP, Fraction("202.9"), 2029 if sync else None, 1)]
    assert "starts 99.900 s after the end of the pulse of coil 0" in str(report.violations[0])
    assert report.min_gap_any_s == 99.9


def test_a_shared_back_off_holds_for_any_coil_and_one_per_coil_for_the_same(judge, bus_log, fired):
    log = bus_log(1, 400, [fired(0, 100), fired(1, 110), fired(2, 120), fired(0, 203), fired(1, 212)])
    shared = judge(log, shared=True)
    assert [(one.kind, one.tick) for one in shared.violations] == [
        (ViolationKind.GAP, 110),
        (ViolationKind.GAP, 120),
        (ViolationKind.GAP, 203),
        (ViolationKind.GAP, 212),
    ]
    assert found(judge(log, shared=False)) == [(ViolationKind.GAP, 212, 212, 1)]


@pytest.mark.parametrize("before", [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)])
def test_a_shared_back_off_is_from_the_pulse_that_ended_last(judge, bus_log, fired, before):
    third = 3 - sum(before)
    report = judge(bus_log(1, 400, [fired(before[0], 100), fired(before[1], 203), fired(third, 250)]))
    assert found(report) == [(ViolationKind.GAP, 250, 250, third)]
    assert f"starts 44.000 s after the end of the pulse of coil {before[1]}" in str(report.violations[0])


def test_one_coil_may_follow_another_at_once_where_the_back_off_is_per_coil(judge, bus_log, fired):
    assert judge(bus_log(1, 200, [fired(0, 100), fired(1, 103)]), shared=False).ok


def test_a_second_request_that_follows_at_once_is_another_pulse(judge, bus_log, fired):
    report = judge(bus_log(1, 200, [fired(0, 100, 1000), fired(0, 101, 1000)]), shared=False)
    assert found(report) == [(ViolationKind.GAP, 101, 101, 0)]


def test_a_second_request_shown_in_the_same_tick_is_another_pulse(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)])
    log.statuses[112].append(CoilStatus(1, 0, 0, 0, 0, 9).encode())
    report = judge(log, shared=False)
    assert found(report)[0] == (ViolationKind.GAP, 111, 111, 0)
    assert "starts 0.000 s after the end of its own pulse" in str(report.violations[0])
    assert spans(report)[:2] == [(0, 110, 112), (0, 111, 112)]


def test_limits_other_than_the_usual_are_judged_as_given(judge, bus_log, fired):
    log = bus_log(10, 500, [fired(0, 100, 1500), fired(1, 315, 1500)])
    assert judge(log, pulse_us=1_500_000, backoff_us=20_000_000).ok
    assert found(judge(log, pulse_us=1_499_999, backoff_us=20_000_001)) == [
        (ViolationKind.PULSE, 10, 100, 0),
        (ViolationKind.GAP, Fraction("31.5"), 315, 1),
        (ViolationKind.PULSE, Fraction("31.5"), 315, 1),
    ]


# --- boots


def test_a_pulse_99_s_after_a_boot_and_none_after_100_s(judge, bus_log, fired):
    report = judge(bus_log(1, 400, [fired(0, 199), fired(1, 350)], boots=[100, 250]))
    assert found(report) == [(ViolationKind.BOOT, 199, 199, 0)]
    assert " 99.000 s after the boot" in str(report.violations[0])


def test_a_pulse_in_the_very_tick_of_a_boot(judge, bus_log, fired):
    report = judge(bus_log(1, 200, [fired(0, 100)], boots=[100]))
    assert found(report) == [(ViolationKind.BOOT, 100, 100, 0)]
    assert " 0.000 s after the boot" in str(report.violations[0])


def test_without_a_boot_in_the_log_the_first_pulse_may_come_at_any_time(judge, bus_log, fired):
    assert judge(bus_log(1, 100, [fired(0, 5)])).ok


def test_a_boot_in_a_log_without_sync(judge, bus_log, fired):
    report = judge(bus_log(1, 200, [fired(2, 99)], boots=[0], sync=False))
    assert found(report) == [(ViolationKind.BOOT, 99, None, 2)]


def test_a_pulse_that_a_boot_cuts_off_did_not_start_after_it(judge, bus_log, fired):
    assert judge(bus_log(1, 200, [fired(0, 110, 1000)], boots=[111])).ok


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize(("boot", "seen"), [(111, 111), (112, 112), (113, None), (114, None)])
def test_a_coil_that_is_on_after_a_boot_is_named_once(judge, bus_log, fired, boot, seen, sync):
    """The pulse shows at 111, 112 and 113, and is over then."""
    report = judge(bus_log(1, 300, [fired(2, 110)], boots=[boot], sync=sync))
    tick = seen if sync else None
    assert found(report) == ([] if seen is None else [(ViolationKind.BOOT, seen, tick, 2)])
    assert all("on after the boot of the board" in str(violation) for violation in report.violations)


def test_a_coil_that_is_on_when_the_first_boot_of_a_log_comes(judge, bus_log, fired):
    report = judge(bus_log(1, 300, [fired(1, -1)], boots=[0]))
    assert found(report) == [(ViolationKind.BOOT, 0, 0, 1)]


def test_a_coil_that_is_driven_on_over_a_boot_after_the_status_of_its_tick(bus_log, fired):
    log = bus_log(1, 300, [fired(0, 150)])
    log.statuses[151].append(CoilBoot(0, 1, 0).encode())
    assert found(audit(log.entries(), AuditLimits())) == [(ViolationKind.BOOT, 152, 152, 0)]


def test_a_boot_that_cannot_be_trusted_is_noted(judge, bus_log):
    log = bus_log(ticks=20)
    log.statuses[5].insert(0, Frame(CoilBoot.ID, bytes(CoilBoot.LENGTH)))
    report = judge(log)
    assert report.ok
    assert report.notes == ("1 COIL_BOOT with a wrong CRC or length: no boot",)


def test_a_boot_counts_in_a_tick_with_two_statuses(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)], boots=[50])
    log.statuses[50] *= 2
    assert found(judge(log)) == [(ViolationKind.BOOT, 110, 110, 0)]


@pytest.mark.parametrize("silent", [range(100, 131), range(101, 131), range(100, 102)])
def test_a_boot_counts_from_its_own_tick_whenever_the_board_reports_next(judge, bus_log, fired, silent):
    log = bus_log(1, 300, [fired(0, 130)], boots=[100])
    log.statuses |= {tick: [] for tick in silent}
    assert (ViolationKind.BOOT, 130, 130, 0) in found(judge(log))
    log = bus_log(1, 300, [fired(0, 200)], boots=[100])
    log.statuses |= {tick: [] for tick in silent}
    assert judge(log).ok


def test_a_boot_right_after_the_status_of_its_tick_locks_the_next_interval(bus_log, fired):
    log = bus_log(1, 300, [fired(0, 150)])
    log.statuses[150].append(CoilBoot(0, 1, 0).encode())
    assert found(audit(log.entries(), AuditLimits())) == [(ViolationKind.BOOT, 150, 150, 0)]


@pytest.mark.parametrize(
    ("start", "missing", "verdict"),
    [
        (179, range(80, 91), "violation"),  # 99 s after tick 80, before which it did not boot
        (180, range(80, 91), "doubt"),
        (190, range(80, 91), "doubt"),  # 99 s after tick 91, at which it has booted
        (191, range(80, 91), "OK"),
        (92, range(91), "doubt"),  # nothing shows how long before tick 91 it has booted
        (191, range(91), "OK"),
    ],
)
def test_a_boot_among_missing_ticks_may_have_been_at_any_of_them(bus_log, fired, start, missing, verdict):
    log = bus_log(1, 300, [fired(0, start)], boots=[90])
    boot = next(entry for entry in log.entries() if entry.frame.can_id == CoilBoot.ID)
    gone = {log.timestamp_us(tick) for tick in missing}
    kept = [entry for entry in log.entries() if entry == boot or entry.timestamp_us not in gone]
    report = audit(kept, AuditLimits())
    said = "violation" if report.violations else "doubt" if report.doubt else "OK"
    assert said == verdict


# --- levels and coils


@pytest.mark.parametrize("level", [4, 7, -4, -8])
def test_a_level_out_of_range_is_named_once(judge, bus_log, fired, level):
    report = judge(bus_log(1, 200, [fired(2, 110, level=level)]))
    assert found(report) == [(ViolationKind.LEVEL, 111, 111, 2)]
    assert f"level {level} is outside -3..3" in str(report.violations[0])


def test_a_level_out_of_range_in_the_middle_of_a_pulse(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(2, 110)])
    log.change(112, level=4)
    assert found(judge(log)) == [(ViolationKind.LEVEL, 112, 112, 2)]


@pytest.mark.parametrize("level", [-3, -2, -1, 1, 2, 3])
def test_levels_in_range_pass(judge, bus_log, fired, level):
    report = judge(bus_log(1, 200, [fired(2, 110, level=level)]))
    assert report.ok
    assert report.pulses[0].level == level


def test_a_coil_that_does_not_exist(judge, bus_log, fired):
    assert found(judge(bus_log(1, 200, [fired(3, 110)]))) == [(ViolationKind.COIL, 110, 110, 3)]


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("shared", [True, False])
def test_two_coils_driven_in_one_tick(judge, bus_log, fired, sync, first, shared):
    log = bus_log(1, 200, [fired(0, 110)], sync=sync)
    other = CoilStatus(2, 1, 0, 0, 0, 9).encode()
    log.statuses[112].insert(0 if first else 1, other)
    report = judge(log, shared=shared)
    assert (ViolationKind.TWO_COILS, 111, 111 if sync else None, 1) in found(report)
    assert "coil 0 is on too" in str(report.violations)


def test_two_coils_that_start_together(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110, 1000)])
    log.statuses[111].append(CoilStatus(2, 1, 0, 0, 0, 9).encode())
    assert found(judge(log)) == [(ViolationKind.TWO_COILS, 110, 110, 1)]


def test_a_coil_shown_while_another_one_has_time_left(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)])
    log.change(113, coil=1, seq=2)
    assert (ViolationKind.TWO_COILS, 112, 112, 1) in found(judge(log, shared=False))


def test_a_second_status_in_a_tick_cannot_hide_what_the_first_shows(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110, level=4)])
    for tick in (111, 112, 113):
        log.statuses[tick].append(CoilStatus(0, 0, 0, 0, 0, 1).encode())
    report = judge(log)
    assert found(report) == [(ViolationKind.LEVEL, 111, 111, 0)]
    assert spans(report) == [(0, 110, 113)]
    assert "3 ticks with more than one COIL_STATUS" in report.notes


# --- frames


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: data[:-1] + bytes([data[-1] ^ 1]),
        lambda data: bytes([data[0] ^ 0x10]) + data[1:],
        lambda data: data[:-1],
        lambda data: b"",
    ],
)
def test_a_status_with_a_wrong_crc_or_length(judge, bus_log, spoil):
    log = bus_log(1, 200)
    log.statuses[57] = [Frame(CoilStatus.ID, spoil(log.statuses[57][0].data))]
    assert found(judge(log)) == [(ViolationKind.FRAME, 57, 57, None)]


def test_a_status_with_a_wrong_crc_does_not_end_the_pulse(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)])
    log.statuses[112] = [Frame(CoilStatus.ID, bytes(8))]
    report = judge(log)
    assert found(report) == [(ViolationKind.FRAME, 112, 112, None)]
    assert spans(report) == [(0, 110, 113)]


def test_missing_statuses_are_counted_and_do_not_end_a_pulse(judge, bus_log, fired):
    log = bus_log(10, 1500, [fired(0, 1000)])
    for tick in (500, 1010, 1011):
        log.statuses[tick] = []
    report = judge(log)
    assert report.ok
    assert spans(report) == [(0, 100, 103)]
    assert "3 ticks without COIL_STATUS" in report.notes


def test_a_pulse_whose_last_statuses_are_missing_lasts_as_announced(judge, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 110)])
    for tick in (112, 113, 114):
        log.statuses[tick] = []
    assert spans(judge(log)) == [(0, 110, 113)]


def test_frames_of_others_and_remote_frames_are_not_judged(judge, bus_log):
    log = bus_log(ticks=20)
    log.statuses[7].append(Frame(CoilStatus.ID | 0x4000_0000, b""))
    log.statuses[7].append(Frame(CoilStatus.ID | 0x8000_0000, bytes(8)))
    assert judge(log).ok


def test_a_log_without_status_is_not_ok(judge, bus_log):
    log = bus_log(ticks=20)
    log.statuses = {tick: [] for tick in range(20)}
    report = judge(log)
    assert not report.ok
    assert report.exit_code == 1
    assert "no COIL_STATUS in the log: nothing to judge" in report.notes
    assert report.span_s == 0
