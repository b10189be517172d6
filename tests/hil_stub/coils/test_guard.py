"""Two clocks: a pulse is over when the first says so, a back-off when the last does."""

import pytest

from fsw.wire.messages import CoilFire
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.guard import Guard
from hil_stub.coils.interlock import CoilLimits

PULSE_MS, BACKOFF_MS = 3000, 100_000


def asking(tick, seq=1, coil=1, level=-2, duration_ms=PULSE_MS):
    return CoilFire(level, coil, seq, tick & 0xFF, duration_ms)


class Timers:
    """A guard whose ticks and clock are moved apart at will."""

    def __init__(self, hz=1, shared=True):
        self.hz = hz
        self.guard = Guard(CoilLimits(hz, PULSE_MS, BACKOFF_MS, shared))
        self.tick, self.clock_ms = 0, 70_000
        self.guard.pass_time(self.clock_ms)

    def go(self, ticks, milliseconds=None):
        self.tick += ticks
        self.clock_ms += 1000 * ticks // self.hz if milliseconds is None else milliseconds
        self.guard.pass_time(self.clock_ms)
        if ticks:
            self.guard.elapse(ticks)

    def ask(self, **changes):
        return self.guard.ask(asking(self.tick, **changes), self.tick)


@pytest.fixture(params=[1, 10])
def timers(request):
    return Timers(request.param)


def test_where_both_agree_it_is_the_interlock(timers):
    hz = timers.hz
    timers.go(100 * hz - 1)
    assert timers.ask() is Reason.LOCKOUT
    timers.go(1)
    assert timers.ask() is None
    assert (timers.guard.coil, timers.guard.level, timers.guard.seq) == (1, -2, 1)
    for tick in range(3 * hz):
        assert timers.guard.remaining_ms() == PULSE_MS - tick * 1000 // hz
        assert (timers.guard.on, timers.guard.fraction) == (True, 1.0)
        timers.go(1)
    assert (timers.guard.on, timers.guard.level, timers.guard.fraction) == (False, -2, 0.0)
    assert timers.guard.lockout_ms(0) == BACKOFF_MS
    timers.go(1)
    assert timers.guard.level == 0


def test_ticks_that_come_too_often_shorten_no_back_off(timers):
    timers.go(100 * timers.hz, milliseconds=10_000)
    assert timers.guard.lockout_ms(2) == 90_000
    assert timers.guard.locked_out
    assert timers.ask() is Reason.LOCKOUT
    timers.go(1, milliseconds=89_999)
    assert timers.ask() is Reason.LOCKOUT
    timers.go(1, milliseconds=1)
    assert timers.ask() is None


def test_nor_does_a_clock_that_runs_too_fast(timers):
    timers.go(1, milliseconds=10**6)
    assert timers.ask() is Reason.LOCKOUT
    timers.go(100 * timers.hz - 1, milliseconds=0)
    assert timers.ask() is None


def test_ticks_that_stay_away_stretch_no_pulse(timers):
    timers.go(100 * timers.hz)
    timers.ask()
    timers.go(1, milliseconds=2999)
    assert 0 < timers.guard.remaining_ms() <= 1
    timers.go(1, milliseconds=1)
    assert (timers.guard.on, timers.guard.remaining_ms(), timers.guard.level) == (False, 0, -2)
    timers.go(1, milliseconds=1)
    assert timers.guard.level == 0


def test_a_pulse_that_one_of_them_has_ended_is_refused_for_the_other(timers):
    timers.go(100 * timers.hz)
    timers.ask()
    timers.go(1, milliseconds=10**6)
    assert not timers.guard.on
    assert timers.ask(seq=2) is Reason.COIL_ON
    assert timers.guard.lockout_ms(1) == 103_000 - 1000 // timers.hz


def test_a_request_that_one_of_them_refuses_changes_neither(timers):
    timers.go(100 * timers.hz, milliseconds=10_000)
    assert timers.ask() is Reason.LOCKOUT
    assert (timers.guard.on, timers.guard.level, timers.guard.seq) == (False, 0, None)
    timers.go(0, milliseconds=90_000)
    assert timers.ask() is None, "it is no repetition: it was never carried out"


def test_a_clock_that_runs_back_stands_still(timers):
    timers.go(100 * timers.hz, milliseconds=99_000)
    timers.go(1, milliseconds=-50_000)
    assert timers.guard.lockout_ms(0) == 1000
    timers.go(1, milliseconds=50_000)
    assert timers.guard.lockout_ms(0) == 1000


def test_silence_is_off_and_a_full_lockout_on_both(timers):
    timers.go(100 * timers.hz)
    timers.ask()
    timers.guard.silence()
    assert (timers.guard.on, timers.guard.level, timers.guard.remaining_ms()) == (False, 0, 0)
    assert [timers.guard.lockout_ms(coil) for coil in range(3)] == [BACKOFF_MS] * 3
    timers.go(100 * timers.hz)
    timers.guard.sync()
    assert timers.ask() is Reason.REPEATED_SEQ, "what was carried out before is still known"
    assert timers.ask(seq=2) is None


class TestWhatIsDrivenNow:
    """A board enters a tick ahead of its SYNC: what it tells of that instant is not so yet."""

    @pytest.fixture
    def firing(self, timers):
        timers.go(100 * timers.hz)
        assert not timers.guard.drives
        assert timers.ask() is None
        return timers

    def test_from_when_it_was_asked_until_its_time_is_over(self, firing):
        guard, began_ms = firing.guard, firing.clock_ms
        assert (guard.drives, guard.ends_ms) == (True, began_ms + PULSE_MS)
        guard.pass_time(began_ms + PULSE_MS - 1)
        assert (guard.drives, guard.ends_ms) == (True, began_ms + PULSE_MS)
        guard.pass_time(began_ms + PULSE_MS)
        assert not guard.drives

    def test_the_last_tick_lasts_until_sync(self, firing):
        firing.go(3 * firing.hz - 1, milliseconds=10)
        firing.guard.sync()
        assert firing.guard.drives, "a tick is left"
        firing.go(1, milliseconds=10)
        assert (firing.guard.on, firing.guard.drives) == (False, True)
        firing.guard.sync()
        assert not firing.guard.drives

    def test_a_tick_on_without_sync_it_is_over_too(self, firing):
        firing.go(3 * firing.hz, milliseconds=10)
        assert firing.guard.drives
        firing.go(1, milliseconds=10)
        assert not firing.guard.drives

    def test_the_clock_ends_it_in_the_middle_of_a_tick(self, firing):
        firing.guard.pass_time(firing.clock_ms + PULSE_MS)
        assert (firing.guard.on, firing.guard.drives) == (False, False)
        firing.guard.sync()
        assert not firing.guard.drives

    def test_silence_ends_it_at_once(self, firing):
        firing.go(3 * firing.hz, milliseconds=10)
        firing.guard.silence()
        assert not firing.guard.drives

    def test_a_request_is_timed_from_when_it_comes(self, timers):
        timers.go(100 * timers.hz)
        timers.guard.pass_time(timers.clock_ms + 700)
        assert timers.ask() is None
        assert timers.guard.ends_ms == timers.clock_ms + 700 + PULSE_MS
        timers.go(103 * timers.hz, milliseconds=700 + PULSE_MS + BACKOFF_MS - 1)
        assert timers.ask(seq=2) is Reason.LOCKOUT
        timers.go(0, milliseconds=1)
        assert timers.ask(seq=2) is None

    def test_without_a_clock_it_is_what_the_ticks_say(self):
        guard = Guard(CoilLimits(1))
        guard.pass_time(None)
        guard.elapse(100)
        assert guard.ask(asking(100), 100) is None
        assert (guard.drives, guard.ends_ms) == (True, None)
        guard.elapse(3)
        assert not guard.drives


def test_without_a_clock_the_ticks_decide():
    guard = Guard(CoilLimits(1))
    guard.elapse(100)
    assert (guard.locked_out, guard.ask(asking(100), 100)) == (False, None)
    guard.elapse(2)
    assert guard.remaining_ms() == 1000
    guard.silence()
    assert guard.lockout_ms(0) == BACKOFF_MS


@pytest.mark.parametrize("clock_ms", [None, 5000])
@pytest.mark.parametrize("backoff_ms", [0, 10])
def test_after_silence_nothing_is_accepted_before_a_sync(clock_ms, backoff_ms):
    """Whatever the back-off, and however many ticks are entered in the meantime."""
    guard = Guard(CoilLimits(1, backoff_ms=backoff_ms))
    guard.pass_time(clock_ms)
    guard.silence()
    guard.elapse(7)
    guard.pass_time(None if clock_ms is None else clock_ms + 7000)
    assert guard.locked_out
    assert guard.ask(asking(7), 7) is Reason.LOCKOUT
    assert not guard.drives
    guard.sync()
    assert (guard.locked_out, guard.ask(asking(7), 7)) == (False, None)


def test_a_guard_that_has_just_booted_shows_no_level():
    assert Guard(CoilLimits(1)).level == 0


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_the_back_off_of_one_coil_is_told_even_when_the_others_are_free(coil):
    timers = Timers(shared=False)
    timers.go(100)
    assert not timers.guard.locked_out
    assert timers.ask(coil=coil) is None
    timers.go(3)
    assert [timers.guard.lockout_ms(other) > 0 for other in range(3)] == [other == coil for other in range(3)]
    assert timers.guard.locked_out
    timers.go(100)
    assert not timers.guard.locked_out
