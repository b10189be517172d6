"""Rate groups: on time, evenly, never in between, and nonsense is refused."""

import pytest

from fsw.core.rates import RateGroup


@pytest.mark.parametrize(("divisor", "offset"), [(1, 0), (2, 1), (7, 3), (60, 59)])
def test_due_once_every_divisor_ticks_at_the_offset(divisor, offset):
    group = RateGroup(divisor, offset)
    due = [tick for tick in range(10 * divisor) if group.due(tick)]
    assert due == [offset + n * divisor for n in range(10)]


def test_due_does_not_drift_over_a_year_of_ticks():
    group = RateGroup(7, 3)
    year = 365 * 86400 * 100
    assert [group.due(year // 7 * 7 + n) for n in range(7)] == [n == 3 for n in range(7)]


@pytest.mark.parametrize(("divisor", "offset", "length"), [(1, 0, 3), (10, 0, 6), (7, 3, 35)])
def test_each_item_has_its_turn_as_often_as_the_others(divisor, offset, length):
    group = RateGroup(divisor, offset)
    turns = [group.in_turn(tick, length) for tick in range(4 * divisor * length) if group.due(tick)]
    assert turns == 4 * list(range(length))


@pytest.mark.parametrize(("divisor", "offset"), [(0, 0), (-1, 0), (5, 5), (5, 6), (5, -1)])
def test_a_group_that_would_never_run_is_refused(divisor, offset):
    with pytest.raises(ValueError, match="rate group"):
        RateGroup(divisor, offset)
