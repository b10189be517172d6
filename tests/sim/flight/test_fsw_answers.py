"""How long the plant waits for boot and answers, and how many frames it takes from a babbling node."""

import time
from itertools import repeat

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import FswBoot, PlantBoot, PlantEnd, Sync, TickDone
from sim.flight import fsw_answers
from sim.flight.fsw_answers import (
    MOST_WAITING,
    CounterpartError,
    Silence,
    await_boot,
    frames_until,
    has_answer,
    late_answers,
    lockstep_answers,
    waiting_frames,
)

BOOT = FswBoot(0, 1, 2).encode()
NOISE = Frame(0x7FF, b"")
SYNC = Sync(3, 1_427_424_417).encode()


def done(tick):
    return TickDone(tick, 7).encode()


@pytest.fixture
def babbling(bus_of):
    """A bus with a frame of noise at every call."""
    bus = bus_of()
    bus.queue = repeat(NOISE)
    bus.receive = lambda timeout_s: next(bus.queue)
    return bus


class TestBoot:
    def test_is_asked_for_and_what_is_not_a_boot_is_passed_over(self, bus_of):
        bus = bus_of([NOISE, done(9), BOOT])
        assert await_boot(bus, 1.0, lambda *seen: None, lambda waited_s: None) == BOOT
        assert [frame.can_id for frame in bus.sent] == [PlantBoot.ID]

    @pytest.mark.interpreted
    def test_a_silent_bus_is_given_up_after_the_time_that_was_given(self, bus_of, monkeypatch):
        monkeypatch.setattr(fsw_answers, "BOOT_REQUEST_S", 0.01)
        bus, waited = bus_of(), []
        with pytest.raises(CounterpartError, match="has not booted within 0 s"):
            await_boot(bus, 0.05, lambda *seen: None, waited.append)
        assert len(bus.sent) == len(waited) > 1
        assert waited == sorted(waited)

    def test_another_plant_is_refused_and_reported(self, bus_of):
        overheard = []
        with pytest.raises(CounterpartError, match="another plant sent SYNC before the flight began"):
            await_boot(bus_of([SYNC]), 1.0, lambda *seen: overheard.append(seen), lambda waited_s: None)
        assert overheard == [(0, [SYNC], [], False)]


class TestLockstep:
    def test_ends_with_the_answer_that_names_the_tick(self, bus_of):
        bus = bus_of([done(2), NOISE, done(3), done(4)])
        assert lockstep_answers(bus, 3, SYNC, 1.0) == [done(2), NOISE, done(3)]
        assert list(bus.queue) == [done(4)]

    @pytest.mark.interpreted
    def test_the_sync_that_is_sent_again_stands_among_the_answers(self, bus_of, monkeypatch):
        monkeypatch.setattr(fsw_answers, "REPEAT_SYNC_S", 0.01)
        bus = bus_of([NOISE], answer=lambda tick: [done(tick)])
        assert lockstep_answers(bus, 3, SYNC, 1.0) == [NOISE, SYNC, done(3)]

    def test_babble_does_not_stretch_the_time(self, babbling):
        began = time.monotonic()
        with pytest.raises(CounterpartError, match="no answer from the flight software to tick 3"):
            lockstep_answers(babbling, 3, SYNC, 0.05)
        assert time.monotonic() - began < 1.0


class TestWaitingFrames:
    def test_are_all_that_is_there(self, bus_of):
        assert waiting_frames(bus_of([NOISE, SYNC])) == [NOISE, SYNC]

    def test_are_bounded(self, babbling):
        assert len(waiting_frames(babbling)) == MOST_WAITING

    def test_so_are_those_after_a_deadline_that_has_passed(self, babbling):
        assert len(list(frames_until(babbling, time.monotonic() - 1.0))) == MOST_WAITING


class TestLateAnswers:
    def test_end_with_the_one_that_names_the_last_tick(self, bus_of):
        assert late_answers(bus_of([done(8), done(9), NOISE]), 9) == [done(8), done(9)]

    @pytest.mark.interpreted
    def test_or_when_no_tick_is_answered_any_more_whatever_others_say(self, babbling, monkeypatch):
        monkeypatch.setattr(fsw_answers, "LATE_TIMEOUT_S", 0.02)
        began = time.monotonic()
        late_answers(babbling, 9)
        assert time.monotonic() - began < 1.0


class TestSilence:
    """Of ticks that last 1 s, judged by a clock that the test sets."""

    @pytest.fixture
    def at(self, monkeypatch):
        clock = {"now": 100.0}
        monkeypatch.setattr(fsw_answers.time, "monotonic", lambda: clock["now"])
        return lambda now: clock.update(now=now)

    def test_too_long_is_an_error_that_names_the_last_tick_answered(self, at):
        silence = Silence(2.0, 1.0, began=100.0)
        at(101.0)
        silence.end([NOISE, done(0)], 0)
        for tick in (1, 2):
            at(101.0 + tick)
            silence.end([NOISE], tick)
        at(104.0)
        with pytest.raises(CounterpartError, match="since tick 0 for 2 s"):
            silence.end([], 3)

    def test_time_for_which_the_plant_was_stopped_does_not_count(self, at):
        silence = Silence(2.5, 1.0, began=100.0)
        at(101.0)
        silence.end([done(0)], 0)
        at(1000.0)
        silence.end([], 1)
        at(1000.4)
        silence.end([], 2)

    def test_one_long_tick_is_no_silence(self, at):
        silence = Silence(0.5, 1.0, began=100.0)
        at(102.0)
        silence.end([], 0)


def test_an_answer_names_its_tick_and_is_whole():
    assert has_answer([NOISE, done(3)], 3)
    assert not has_answer([done(2), done(3).replace(data=b"\3"), PlantEnd(3).encode()], 3)
