import pytest

from fsw.wire.messages import CoilStatus
from sim.audit.status_ticks import BoardStatus, StatusTicks


@pytest.fixture
def ticks():
    return StatusTicks()


def status(counter):
    """A status identified by its counter, and logged in the line of that number."""
    return BoardStatus(counter, 0, CoilStatus(0, 0, 0, 0, 0, 0, counter % 16), False)


def deal(ticks, tick, step, *counters):
    """What SYNC of a tick gives, as ticks and counters."""
    for counter in counters:
        ticks.add(status(counter))
    return [(this, [board.line for board in boards]) for this, boards in ticks.close(tick, step)]


def test_one_status_before_each_sync_belongs_to_its_tick(ticks):
    assert [deal(ticks, tick, 1, tick) for tick in range(40)] == [[(tick, [tick])] for tick in range(40)]
    assert ticks.silent == 0


def test_an_empty_tick_is_counted(ticks):
    deal(ticks, 0, 1, 0)
    assert deal(ticks, 1, 1) == []
    assert ticks.silent == 1
    assert deal(ticks, 2, 1, 2) == [(2, [2])]
    assert ticks.silent == 1
    assert deal(ticks, 3, 1) == deal(ticks, 4, 1) == []
    assert ticks.silent == 3


def test_two_statuses_after_an_empty_tick_are_one_for_each(ticks):
    deal(ticks, 0, 1, 0)
    deal(ticks, 1, 1)
    assert deal(ticks, 2, 1, 1, 2) == [(1, [1]), (2, [2])]
    assert ticks.silent == 0


def test_two_statuses_at_a_sync_after_a_lost_one_are_one_for_each(ticks):
    deal(ticks, 0, 1, 0)
    assert deal(ticks, 2, 2, 1, 2) == [(1, [1]), (2, [2])]


def test_two_statuses_where_no_tick_is_empty_are_of_one_tick(ticks):
    deal(ticks, 0, 1, 0)
    assert deal(ticks, 1, 1, 1, 2) == [(1, [1, 2])]


def test_more_statuses_than_ticks_keep_their_order(ticks):
    deal(ticks, 0, 1, 0)
    deal(ticks, 1, 1)
    assert deal(ticks, 2, 1, 1, 2, 3, 4) == [(1, [1, 2, 3]), (2, [4])]


def test_fewer_statuses_than_ticks_belong_to_the_last(ticks):
    deal(ticks, 0, 1, 0)
    assert deal(ticks, 5, 5, 4, 5) == [(4, [4]), (5, [5])]
    assert ticks.silent == 3


def test_statuses_that_go_on_being_late_belong_to_the_tick_before(ticks):
    deal(ticks, 14, 1, 14)
    assert deal(ticks, 15, 1) == []
    assert deal(ticks, 16, 1, 15) == [(15, [15])]
    assert deal(ticks, 17, 1, 16) == [(16, [16])]
    assert deal(ticks, 18, 1, 17, 18) == [(17, [17]), (18, [18])]
    assert ticks.silent == 0


def test_what_cannot_be_trusted_is_not_taken_for_late(ticks):
    deal(ticks, 0, 1, 0)
    deal(ticks, 1, 1)
    ticks.add(BoardStatus(9, 0, None, False))
    assert [tick for tick, _ in ticks.close(2, 1)] == [2]
    deal(ticks, 3, 1)
    assert deal(ticks, 4, 1, 1) == [(4, [1])]


def test_it_reports_whether_a_status_waits(ticks):
    assert not ticks.waiting
    ticks.add(status(0))
    assert ticks.waiting
    ticks.close(0, 1)
    assert not ticks.waiting
