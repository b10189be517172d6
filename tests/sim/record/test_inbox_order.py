"""A telecommand that meets SYNC on the bus is in the log with the tick that acknowledges it."""

import pytest

from fsw.wire.messages import CoilFire, NavRate, TcAck, TcClear, TcSpin, TickDone
from sim.record.inbox_order import split_at_sync

TICK = 77
SPIN, CLEAR = TcSpin(0.02, counter=5).encode(), TcClear(counter=5).encode()
NAV, DONE = NavRate(1, 0.1, 0.0, 0.0).encode(), TickDone(TICK, 7).encode()


def ack(kind, counter=5, tick=TICK):
    return TcAck(0, kind.ID, counter, tick).encode()


def test_one_that_this_tick_acknowledges_was_in_the_inbox():
    after = [SPIN, ack(TcSpin), NAV, DONE]
    assert split_at_sync([], after, TICK) == ([SPIN], [ack(TcSpin), NAV, DONE])


def test_one_without_an_answer_was_not():
    assert split_at_sync([], [NAV, SPIN, DONE], TICK) == ([], [NAV, SPIN, DONE])


@pytest.mark.parametrize(
    "other",
    [ack(TcSpin, tick=TICK - 1), ack(TcSpin, counter=4), ack(TcClear), ack(TcSpin).replace(data=bytes(8))],
)
def test_nor_one_whose_answer_is_another_s(other):
    assert split_at_sync([], [SPIN, other, DONE], TICK) == ([], [SPIN, other, DONE])


def test_an_answer_to_one_that_was_known_is_that_one_s():
    after = [ack(TcSpin), SPIN, DONE]
    assert split_at_sync([SPIN], after, TICK) == ([], after)
    twice = [SPIN, ack(TcSpin), ack(TcSpin), DONE]
    assert split_at_sync([SPIN], twice, TICK) == ([SPIN], twice[1:])


def test_several_keep_their_order_and_what_is_broken_stays():
    broken = SPIN.replace(data=b"\0\0\0\0")
    after = [CLEAR, broken, SPIN, ack(TcClear), ack(TcSpin), DONE, SPIN]
    assert split_at_sync([], after, TICK) == ([CLEAR, SPIN], [broken, *after[3:]])


def test_without_telecommands_nothing_is_touched():
    after = [CoilFire(1, 0, 1, TICK, 3000).encode(), NAV, DONE]
    assert split_at_sync([SPIN], after, TICK) == ([], after)
