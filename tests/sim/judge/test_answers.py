"""What is read of a flight software's frames, and what of those that are not as they should be."""

import pytest

from fsw.wire.frame import Frame, crc8
from fsw.wire.messages import (
    CoilEvent,
    CoilFire,
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    FswBoot,
    NavAttitude,
    Severity,
    Sync,
    TickDone,
)
from sim.judge.answers import OutOfTurn, crc_as_sent, read_answers, tick_as_named
from sim.record.candump import LogEntry


def record(*frames, **options):
    entries = (LogEntry(line, 0, "loop", frame) for line, frame in enumerate(frames, 1))
    return read_answers(entries, **options)


def sync(tick):
    return Sync(tick, 1_000_000 + tick).encode()


def done(tick, crc=0):
    return TickDone(tick, crc).encode()


def fire(tick, seq=0, counter=0, **values):
    proper = {"level": 3, "coil": 1, "duration_ms": 3000}
    return CoilFire(seq=seq, tick=tick & 0xFF, counter=counter, **proper | values).encode()


BOOT = FswBoot(0, 1, 0).encode()


def test_each_tick_has_the_tick_in_which_it_was_answered():
    found = record(BOOT, sync(0), done(0), sync(1), sync(2), done(1), done(2), sync(3))
    assert found.ticks == 4
    assert found.answered_in == [0, 2, 2, -1]
    assert found.boots == [-1]


def test_a_boot_in_flight_is_kept_with_its_tick_and_its_counters_begin_anew():
    first = NavAttitude(1, 0.0, 0.0, 0.0, counter=5).encode()
    again = NavAttitude(1, 0.0, 0.0, 0.0, counter=0).encode()
    found = record(BOOT, BOOT, sync(0), first, done(0), sync(1), BOOT, again, done(1))
    assert found.boots == [-1, 1]
    assert not found.counters
    assert found.estimates == 2


def test_a_sync_that_is_repeated_is_no_tick():
    found = record(BOOT, sync(0), sync(0), sync(0), done(0))
    assert found.ticks == 1
    assert found.repeats == {0: 2}


def test_a_done_of_no_tick_is_odd():
    found = record(BOOT, sync(0), done(0), sync(1), done(1 << 24))
    assert found.odd_done == [(1, 1 << 24)]
    assert found.answered_in == [0, -1]


def test_a_done_of_a_tick_that_has_its_answer_is_odd_unless_its_sync_was_repeated():
    assert record(BOOT, sync(0), done(0), sync(1), done(0)).odd_done == [(1, 0)]
    assert record(BOOT, sync(0), sync(0), done(0), done(0), sync(1), done(1)).odd_done == []


@pytest.mark.parametrize(
    ("at", "named", "why"),
    [
        (0, 1, "the one after it"),
        (0, 2**32 - 1, "the one before it"),
        (7, 6, "the one before it"),
        (300, 0x2C01_0000, "the byte order is wrong, it is that tick with its bytes the other way round"),
        (300, 44, "the lowest byte of it alone"),
        (70_000, 4464, "the lowest two bytes of it alone"),
        (5, 0, "always the first"),
    ],
)
def test_what_another_tick_seems_to_come_of_is_told(at, named, why):
    assert tick_as_named(at, named) == f"TICK_DONE names tick {named} in the answer to tick {at}: {why}"
    assert tick_as_named(5, 9) == "TICK_DONE names tick 9 in the answer to tick 5"


def test_a_counter_that_stands_still_is_counted():
    still = NavAttitude(1, 0.0, 0.0, 0.0, counter=5).encode()
    assert record(BOOT, sync(0), still, done(0), sync(1), still, done(1)).counters == {"NAV_ATTITUDE": 1}


def test_a_request_after_the_answer_or_a_second_one_in_it_is_out_of_turn():
    late = record(BOOT, sync(0), done(0), fire(0), sync(1), done(1))
    assert late.out_of_turn == [OutOfTurn(0, "COIL_FIRE", True)]
    twice = record(BOOT, sync(0), fire(0), fire(0, 1, 1), done(0))
    assert twice.out_of_turn == [OutOfTurn(0, "COIL_FIRE", False)]


def test_what_answers_another_tick_or_a_sync_again_is_in_its_turn():
    each = record(BOOT, sync(0), fire(0), done(0), sync(1), fire(1, 1, 1), done(1))
    behind = record(BOOT, sync(0), sync(1), fire(0), done(0), fire(1, 1, 1), done(1))
    again = record(BOOT, sync(0), sync(0), fire(0), done(0), fire(0, 0, 1), done(0))
    assert [each.out_of_turn, behind.out_of_turn, again.out_of_turn] == [[], [], []]


def test_a_request_knows_what_became_of_it():
    refusal = CoilRefused(1, 7, CoilRefusedReason.LOCKOUT, 0).encode()
    found = record(
        BOOT, sync(0), fire(0, seq=7), done(0), refusal, sync(1), fire(1, seq=8, counter=1), done(1)
    )
    assert [one.refused for one in found.requests] == [CoilRefusedReason.LOCKOUT, 0]
    assert [one.tick for one in found.requests] == [0, 1]


def test_a_coil_is_stuck_until_its_current_is_gone():
    event = CoilEvent(Severity.FATAL, 3, 1, 0).encode()
    gone = CoilStatus(0, 0, 0, 0, 0, 0).encode()
    found = record(
        BOOT, sync(0), done(0), event, sync(1), fire(1), done(1), gone, sync(2), fire(2, 1, 1), done(2)
    )
    assert found.stuck_at == 1
    assert [one.stuck for one in found.requests] == [True, False]


def test_frames_that_are_not_whole_are_counted_and_change_nothing():
    whole = fire(0)
    broken = Frame(whole.can_id, whole.data[:-1] + bytes([whole.data[-1] ^ 1]))
    found = record(BOOT, sync(0), broken, Frame(TickDone.ID, b"\0" * 7), done(0))
    assert found.broken == {"COIL_FIRE": 1, "TICK_DONE": 1}
    assert found.first_broken["COIL_FIRE"] == (0, broken)
    assert not found.requests


def test_how_a_wrong_crc_was_made_is_found():
    body = fire(0).data[:-1]
    ways = {
        "over the identifier low byte first": crc8(b"\x80\x00" + body),
        "over the data alone, without the identifier": crc8(body),
        "without the final XOR": crc8(b"\x00\x80" + body) ^ 0xFF,
        "from the initial value 0": crc8(b"\x00\x80" + body, 0),
    }
    for way, crc in ways.items():
        assert crc_as_sent(Frame(0x80, body + bytes([crc]))) == f"its CRC is made {way}"
    assert crc_as_sent(Frame(0x80, body + bytes([crc8(b"\x00\x80" + body) ^ 0x40]))) == ""


def test_what_is_forged_before_a_sync_is_not_its_own():
    frames = (BOOT, sync(0), done(0), BOOT, fire(0), done(0), sync(1), fire(1), done(1))
    own = record(*frames, forged=True)
    assert (own.boots, len(own.requests), own.answered_in) == ([-1], 1, [0, 1])
    taken = record(*frames)
    assert (taken.boots, len(taken.requests)) == ([-1, 0], 2)
