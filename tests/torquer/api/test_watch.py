"""``torquer.watch``: moments of a log or a bus, for programs."""

import socket
from itertools import pairwise
from threading import Event, Thread

import pytest

import torquer
from fsw.bus.link import LoopLink
from fsw.wire.messages import CoilRefused, CoilRefusedReason, Sync


@pytest.fixture
def log(tmp_path):
    return tmp_path / "some.log"


@pytest.fixture
def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def line(frame, at_s):
    return f"({at_s:.6f}) x {frame.can_id:03X}#{frame.data.hex().upper()}\n"


def test_a_run_has_a_moment_a_second_and_one_at_its_end(flown):
    found = list(torquer.watch(flown))
    ticks = flown.summary["ticks"]
    assert [one.tick for one in found] == list(range(ticks))
    assert [one.ended for one in found] == [False] * (ticks - 1) + [True]
    assert found[-1].pulses == flown.summary["pulses"]["total"]


def test_a_valid_estimate_predicts_the_field_that_is_measured(flown):
    predicted = [one for one in torquer.watch(flown) if one.field_off_deg is not None]
    assert predicted
    assert all(one.q_body_from_orbit is not None and one.field_off_deg < 5.0 for one in predicted)


def test_what_happens_is_told_once_and_all_of_it(flown):
    seldom = [one.words for moment in torquer.watch(flown, every_s=60.0) for one in moment.happenings]
    often = [one.words for moment in torquer.watch(flown) for one in moment.happenings]
    assert seldom == often
    assert seldom[-1] == "the flight is over"


def test_more_than_the_view_keeps_is_told(log):
    refusal = CoilRefused(2, 7, CoilRefusedReason.LOCKOUT, 33).encode()
    log.write_text(line(refusal, 1.0) * 2000)
    (moment,) = torquer.watch(log)
    assert len(moment.happenings) == moment.refused == 2000
    assert moment.tick is None


def test_moments_are_as_far_apart_as_is_asked(flown):
    found = list(torquer.watch(flown, every_s=60.0))
    times = [one.unix_s for one in found[:-1]]
    assert {later - sooner for sooner, later in pairwise(times)} == {60}


def test_of_a_log_in_which_time_goes_back_both_parts_are_shown(log):
    ticks = [*range(3), *range(3)]
    log.write_text("".join(line(Sync(tick, 100 + tick).encode(), 1.0 + tick) for tick in ticks))
    assert [one.tick for one in torquer.watch(log)] == ticks


@pytest.mark.long
def test_a_bus_is_watched_until_it_is_silent(free_port):
    host, heard = LoopLink(free_port), Event()
    sender = Thread(target=send_until, args=(host, heard))
    sender.start()
    try:
        with torquer.watch(f"loop:{free_port}", silent_s=1.0) as watched:
            first = next(watched)
            heard.set()
            others = list(watched)
    finally:
        heard.set()
        sender.join()
        host.close()
    assert first.tick in range(21)
    assert others[-1].tick == 20


def send_until(bus, heard):
    """Twenty ticks again and again: who has joined late hears them too."""
    while not heard.wait(0.05):
        bus.send([Sync(tick, 100 + tick).encode() for tick in range(21)])


def test_a_log_that_was_cut_short_is_shown_and_fails(copy, log):
    log.write_bytes(copy.log.read_bytes()[:-3])
    watched, found = torquer.watch(log), []
    with pytest.raises(torquer.Error, match="the log was cut short"):
        found.extend(watched)
    assert found


@pytest.mark.parametrize(
    ("source", "given", "sentence"),
    [
        ("lop", {}, "unknown bus 'lop'"),
        ("none/run", {}, "none/run: no such file"),
        ("auto", {"pace": "fast"}, "--pace fast"),
        ("auto", {"every_s": 0.0}, "watch: every_s"),
        ("some.log", {"scenario": "nosat"}, "there is no scenario 'nosat'"),
    ],
)
def test_what_cannot_be_watched_is_one_sentence(source, given, sentence, log, monkeypatch):
    log.write_text(line(Sync(0, 100).encode(), 1.0))
    monkeypatch.chdir(log.parent)
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.watch(source, **given)
    assert "\n" not in str(caught.value)
