"""Stretches without COIL_STATUS: which of them may hide a whole pulse."""

import pytest

from fsw.wire.messages import CoilStatus, Sync
from sim.audit.auditor import AuditLimits, audit
from sim.audit.check import render
from sim.audit.documents import as_json, suites
from sim.audit.log_clock import LogClock
from sim.audit.unreported_time import UnreportedTime


def silent(log, ticks):
    """The log without the statuses of these ticks."""
    log.statuses |= {tick: [] for tick in ticks}
    return log


def test_a_log_of_one_status_is_not_taken_for_a_judged_one(judge, bus_log):
    report = judge(silent(bus_log(ticks=500), [*range(7), *range(8, 500)]))
    assert (report.ok, report.exit_code) == (True, 1)
    assert report.unreported_s == 499
    told = "unreported: 499.000 s, in 2 stretches of at least 4.000 s, the first from t=0.000 s"
    assert told in report.notes
    verdict = render(report).splitlines()[-1]
    assert verdict.startswith("FAIL: limits kept as far as the board reports, but a pulse may have gone")
    assert "unreported in the 7.000 s from t=0.000 s: no status before or after it" in verdict
    assert as_json(report)["unreported_s"] == 499
    assert as_json(report)["ok"] is False
    assert next(case for case in suites(report)["log"] if case.name == "reported throughout").failure


@pytest.mark.parametrize("sync", [True, False])
def test_a_silence_that_hides_a_pulse_is_told(bus_log, fired, sync):
    log = silent(bus_log(1, 300, [fired(0, 100), fired(1, 110)], sync=sync), range(104, 131))
    report = audit(log.entries(), AuditLimits())
    assert report.violations == ()
    assert report.unreported_s == 27
    assert "seq is 1 before and 2 after it" in report.doubt
    assert report.exit_code == 1


def test_a_silence_without_a_new_request_hides_none(judge, bus_log, fired):
    report = judge(silent(bus_log(1, 300, [fired(0, 100)]), range(104, 131)))
    assert (report.exit_code, report.doubt) == (0, "")
    assert (
        "unreported: 27.000 s, in a stretch of at least 4.000 s, the first from t=103.000 s" in report.notes
    )


@pytest.mark.parametrize(("ticks", "exit_code"), [(3, 0), (4, 1)])
@pytest.mark.parametrize("tick_hz", [1, 10])
def test_a_silence_shorter_than_the_longest_pulse_and_a_tick_is_only_counted(
    judge, bus_log, fired, ticks, exit_code, tick_hz
):
    count = ticks if tick_hz == 1 else 27 + ticks
    log = silent(bus_log(tick_hz, 300, [fired(0, 100)]), range(102, 102 + count))
    report = judge(log)
    assert report.exit_code == exit_code
    assert (report.unreported_s > 0) is bool(exit_code)
    assert f"{count} ticks without COIL_STATUS" in report.notes


@pytest.mark.parametrize("sync", [True, False])
@pytest.mark.parametrize(("missing", "duration_ms"), [(1, 1000), (3, 3000)])
def test_a_pulse_that_fits_into_a_short_silence_is_told_by_seq(bus_log, fired, missing, duration_ms, sync):
    log = bus_log(1, 300, [fired(2, 100), fired(1, 204, duration_ms)], sync=sync)
    report = audit(silent(log, range(205, 205 + missing)).entries(), AuditLimits())
    assert (report.violations, report.unreported_s, report.exit_code) == ((), 0, 1)
    assert "unreported before t=20" in report.doubt
    assert "seq is 1 before and 2 then, with no coil on" in report.doubt


def test_of_a_pulse_one_status_is_enough(judge, bus_log, fired):
    log = bus_log(1, 300, [fired(2, 100), fired(1, 204)])
    assert judge(silent(log, (205, 206))).exit_code == 0


def test_a_board_that_reports_every_tick_but_not_its_pulse_is_told(judge, bus_log, fired):
    log = bus_log(1, 300, [fired(2, 100), fired(1, 204)])
    for tick in (205, 206, 207):
        log.change(tick, level=0, remaining_ms=0)
    report = judge(log)
    assert (report.exit_code, report.unreported_s) == (1, 0)
    assert "unreported before t=205.000 s: seq is 1 before and 2 then" in report.doubt


def test_a_silence_that_begins_within_a_pulse_hides_its_end(judge, bus_log, fired):
    report = judge(silent(bus_log(1, 300, [fired(0, 100)]), range(102, 131)))
    assert "a coil was on when it began" in report.doubt


def test_a_silence_to_the_end_of_the_log_may_hide_a_pulse(judge, bus_log):
    assert judge(silent(bus_log(ticks=100), range(97, 100))).exit_code == 0
    assert judge(silent(bus_log(ticks=100), range(96, 100))).exit_code == 1


def test_only_before_its_first_boot_is_a_board_known_to_be_off(judge, bus_log):
    assert judge(silent(bus_log(ticks=100, boots=[50]), range(50))).exit_code == 0
    report = judge(silent(bus_log(ticks=100, boots=[50]), range(10, 50)))
    assert (report.exit_code, report.unreported_s) == (1, 40)
    assert "the board boots after it" in report.doubt


def test_ticks_that_sync_skips_have_no_status_to_miss(bus_log, fired):
    entries = [
        entry
        for entry in silent(bus_log(1, 300, [fired(0, 100)]), range(100, 131)).entries()
        if entry.frame.can_id != Sync.ID or not 100 <= Sync.decode(entry.frame.data).tick < 131
    ]
    report = audit(entries, AuditLimits())
    assert report.exit_code == 0
    assert report.unreported_s == 31


def test_a_short_pulse_within_ticks_that_sync_skips_has_no_status_to_miss(bus_log, fired):
    log = silent(bus_log(1, 300, [fired(0, 100)]), (101, 102, 103))
    skipped = audit(log.entries(without_sync=(101, 102, 103)), AuditLimits())
    assert (skipped.exit_code, skipped.doubt) == (0, "")
    assert audit(log.entries(without_sync=(101,)), AuditLimits()).exit_code == 0
    assert audit(log.entries(), AuditLimits()).exit_code == 1


def test_each_of_two_runs_in_one_log_begins_anew(bus_log):
    entries = bus_log(ticks=50).entries() + silent(bus_log(ticks=50), range(10)).entries()
    assert "in the 10.000 s from t=0.000 s" in audit(entries, AuditLimits()).doubt


def test_a_status_with_a_wrong_crc_reports_nothing(judge, bus_log):
    log = bus_log(ticks=100)
    for tick in range(40, 50):
        frame = log.statuses[tick][0]
        log.statuses[tick] = [frame.replace(data=bytes(CoilStatus.LENGTH))]
    assert judge(log).unreported_s == 10


SECOND = 1_000_000


class TestStretches:
    """At a tick a second: a stretch of four seconds may hide a pulse of three."""

    @pytest.fixture
    def time(self):
        clock = LogClock(units=1, period=SECOND, epoch_s=0, origin_us=0, simulated=True, contradictory=False)
        found = UnreportedTime(clock, AuditLimits())
        found.begin(SECOND)
        return found

    def report(self, time, second, seq=0, *, on=False):
        status = CoilStatus(
            level=int(on), coil=0, remaining_ms=1000 * on, current_ma=0, lockout_ms=0, seq=seq
        )
        time.take(second * SECOND, [status])

    def wait(self, time, ticks):
        for _ in range(ticks):
            time.sync()

    @pytest.mark.parametrize("ticks", [3, 4])
    def test_only_ticks_whose_sync_is_in_the_log_are_doubted(self, time, ticks):
        self.wait(time, ticks)
        self.report(time, 10)
        assert bool(time.doubt) is (ticks == 4)
        assert time.total == 9 * SECOND

    @pytest.mark.parametrize("ended_by", ["status", "boot", "run"])
    def test_ticks_are_counted_anew_after(self, time, ended_by):
        self.wait(time, 1)
        self.report(time, 2)
        self.wait(time, 2)
        if ended_by == "status":
            self.report(time, 4)
        elif ended_by == "boot":
            time.boot(4 * SECOND)
        else:
            time.begin(4 * SECOND)
        self.wait(time, 3)
        self.report(time, 9, seq=1)
        assert time.doubt == ""
        self.wait(time, 4)
        self.report(time, 20, seq=2)
        assert "seq is 1 before and 2 after it" in time.doubt

    def test_a_board_that_has_booted_is_off_and_has_accepted_nothing(self, time):
        self.report(time, 1, seq=7, on=True)
        time.boot(2 * SECOND)
        self.wait(time, 5)
        self.report(time, 8, seq=0)
        assert time.doubt == ""
        self.wait(time, 5)
        time.boot(20 * SECOND)
        assert "the board boots after it" in time.doubt

    def test_after_its_first_boot_a_second_one_may_hide_a_pulse(self, time):
        time.boot(2 * SECOND)
        self.wait(time, 5)
        time.boot(20 * SECOND)
        assert "in the 17.000 s from t=2.000 s: the board boots after it" in time.doubt

    def test_another_run_begins_with_the_coils_off_until_its_first_boot(self, time):
        self.report(time, 1, seq=7, on=True)
        time.begin(10 * SECOND)
        self.wait(time, 9)
        time.boot(20 * SECOND)
        assert (time.doubt, time.total) == ("", 0)
        self.report(time, 21, seq=0, on=True)
        time.begin(30 * SECOND)
        self.wait(time, 9)
        self.report(time, 40, seq=3)
        assert "no status before or after it" in time.doubt

    def test_one_coil_that_is_on_is_enough(self, time):
        on, off = (CoilStatus(int(on), int(on), 500 * on, 0, 0, 0) for on in (True, False))
        time.take(2 * SECOND, [off, on])
        self.wait(time, 5)
        self.report(time, 9)
        assert "a coil was on when it began" in time.doubt


def first_of_seq_zero(log, lost, lockout_ms):
    """The first request since the boot has the seq 0, and the statuses of these ticks are lost."""
    for tick in range(log.ticks):
        log.change(tick, seq=0, lockout_ms=lockout_ms(tick))
    return silent(log, lost)


def test_a_first_request_of_seq_zero_in_a_short_silence_is_told_by_its_back_off(judge, bus_log, fired):
    log = bus_log(1, 300, [fired(0, 150, 1000)], boots=[0])
    report = judge(first_of_seq_zero(log, (151,), lambda tick: 100_000 * (tick > 150)))
    assert "a pulse may have gone unreported before t=152.000 s" in report.doubt
    assert report.exit_code == 1


def test_a_first_request_of_seq_zero_in_a_long_silence_is_doubted(judge, bus_log, fired):
    log = bus_log(1, 400, [fired(0, 150)], boots=[0])
    report = judge(first_of_seq_zero(log, range(151, 270), lambda tick: 0))
    assert "the first request since the boot may have had the seq 0" in report.doubt
    assert report.exit_code == 1


def test_in_the_back_off_of_a_boot_no_first_request_is_accepted(judge, bus_log):
    log = bus_log(1, 400, boots=[0])
    assert judge(first_of_seq_zero(log, range(10, 99), lambda tick: 0)).exit_code == 0
