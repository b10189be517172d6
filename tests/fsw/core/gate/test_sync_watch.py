"""Which SYNC is believed: what is near, what is strange, and what two strange ones in a row are."""

from dataclasses import replace
from itertools import pairwise
from random import Random

import pytest

from fsw.core.gate.sync_watch import FEW_TICKS, LEAP_S, MOST_DOUBTED, Belief, SyncWatch, judge_sync, near
from fsw.core.packing import pack

FAR = 10**9
AT = 5000
LEAP_TICKS = LEAP_S
"""At 1 Hz."""
LAST = 2**32 - 1


class Count:
    """A count of ticks that follows what is believed."""

    def __init__(self, tick=AT, leap_ticks=LEAP_TICKS):
        self.tick, self.watch, self.leap_ticks = tick, SyncWatch(), leap_ticks

    def hear(self, tick):
        """A SYNC: what it is taken for."""
        belief = judge_sync(self.watch, self.tick, tick, self.leap_ticks)
        if belief in (Belief.NEXT, Belief.RESTARTED):
            self.tick = tick
        return belief

    def answers(self, *ticks):
        """Which of the SYNCs are answered, in order."""
        return [tick for tick in ticks if self.hear(tick) is not Belief.IGNORED]


@pytest.fixture
def count():
    return Count()


class TestNear:
    @pytest.mark.parametrize("tick", [0, 7, FAR, LAST])
    def test_the_first_may_be_any(self, tick):
        assert Count(-1).hear(tick) is Belief.NEXT

    @pytest.mark.requirement("REQ-BUS-03")
    @pytest.mark.parametrize(
        ("tick", "believed"),
        [(AT + 1, True), (AT + LEAP_TICKS, True), (AT + LEAP_TICKS + 1, False), (AT - 1, False), (0, False)],
    )
    def test_ahead_and_not_far(self, count, tick, believed):
        assert near(AT, tick, LEAP_TICKS) is believed
        assert count.hear(tick) is (Belief.NEXT if believed else Belief.IGNORED)
        assert count.watch.strange_tick == (-1 if believed else tick)

    @pytest.mark.parametrize("leap_ticks", [60, 600, 6000])
    def test_how_far_is_up_to_the_tick_rate(self, leap_ticks):
        assert Count(leap_ticks=leap_ticks).hear(AT + leap_ticks) is Belief.NEXT
        skipped = Count(leap_ticks=leap_ticks)
        assert skipped.hear(AT + leap_ticks + 1) is Belief.IGNORED
        after = AT + FEW_TICKS + 2
        skipped.hear(after)
        assert not skipped.watch.settled(after - 1 + leap_ticks)
        assert skipped.watch.settled(after + leap_ticks)


class TestOneStrange:
    @pytest.mark.requirement("REQ-BUS-03")
    @pytest.mark.parametrize("strange", [FAR, 0, AT - 1, AT + 1000, LAST])
    def test_moves_nothing(self, count, strange):
        assert count.answers(strange, AT + 1, AT + 2) == [AT + 1, AT + 2]
        assert count.watch.doubted == ()

    def test_many_that_have_nothing_to_do_with_each_other_move_nothing(self, count):
        strange = [FAR + 7 * i for i in range(3 * MOST_DOUBTED)]
        assert count.answers(*strange) == []
        assert len(count.watch.doubted) == MOST_DOUBTED
        assert count.answers(AT + 1) == [AT + 1]

    @pytest.mark.parametrize("first", [FAR, 0, AT - 100])
    def test_between_true_ones_they_never_add_up(self, first):
        """From the first tick on, and though they go on tick by tick themselves."""
        count, believed = Count(0), []
        for i in range(1, 300):
            believed += count.answers(i, AT + first + i)
        assert believed == list(range(1, 300))

    @pytest.mark.parametrize("skip", [1, 2, LEAP_TICKS])
    @pytest.mark.parametrize("late", [0, 1])
    def test_nor_with_a_duplicate_before_though_the_count_is_not_settled(self, count, skip, late):
        """A duplicate is of the tick that was answered; once the count has gone on it names no plant."""
        tick = AT + skip
        assert count.hear(tick) is Belief.NEXT
        assert count.hear(tick) is Belief.IGNORED
        assert count.answers(tick + 1, tick + 2) == [tick + 1, tick + 2]
        assert count.hear(tick + late) is Belief.IGNORED
        assert count.hear(tick + 3) is Belief.NEXT

    def test_what_was_strange_in_a_count_that_is_not_settled_stays_so(self, count):
        """The plant that was left for a forged skip may be believed again."""
        assert count.answers(AT + 50, AT + 50, AT + 1, AT + 51, AT + 2) == [AT + 50, AT + 51, AT + 2]


@pytest.mark.requirement("REQ-BUS-04")
class TestTwoStrange:
    @pytest.mark.parametrize("first", [FAR, 0, 1, AT - 2, AT + LEAP_TICKS + 1, LAST - 2])
    @pytest.mark.parametrize("step", [0, 1])
    def test_equal_or_consecutive_begin_anew(self, count, first, step):
        assert count.hear(first) is Belief.IGNORED
        assert count.hear(first + step) is Belief.RESTARTED
        assert count.hear(first + step + 1) is Belief.NEXT

    @pytest.mark.parametrize("step", [-1, 2, 60])
    def test_others_do_not(self, count, step):
        assert count.answers(FAR, FAR + step) == []

    def test_others_may_stand_between(self, count):
        assert count.answers(0, FAR, 77, 1, 2, 3) == [1, 2, 3]

    def test_of_many_in_doubt_the_latest_are_remembered(self, count):
        assert count.answers(*[FAR + 7 * i for i in range(3 * MOST_DOUBTED)]) == []
        assert count.answers(20, 21) == [21]

    def test_and_the_oldest_are_forgotten(self, count):
        assert count.answers(*[FAR + 7 * i for i in range(1 + MOST_DOUBTED)]) == []
        assert count.answers(FAR, FAR) == [FAR]

    def test_a_plant_that_has_started_anew_is_followed_from_its_second_sync(self, count):
        assert count.answers(*range(100)) == list(range(1, 100))

    def test_one_of_which_every_other_sync_is_lost_from_the_first_two_that_come(self, count):
        assert count.answers(0, 2, 4, 6, 7, 9) == [7, 9]

    def test_a_first_sync_that_was_wrong_costs_one_tick(self):
        assert Count(-1).answers(FAR, *range(100)) == [FAR, *range(1, 100)]

    def test_in_lockstep_none(self):
        """The plant repeats its SYNC until that is answered."""
        assert Count(-1).answers(FAR, 0, 0, 1, 2) == [FAR, 0, 1, 2]

    def test_a_skip_that_was_wrong_costs_one_tick(self, count):
        assert count.answers(AT + 50, *range(AT + 1, AT + 100)) == [AT + 50, *range(AT + 2, AT + 100)]

    def test_a_pair_that_was_forged_costs_none(self, count):
        assert count.answers(FAR, FAR + 1, AT + 1, AT + 2) == [FAR + 1, AT + 1, AT + 2]

    def test_a_pair_of_either_kind_is_believed_once(self, count):
        assert count.answers(FAR, FAR, FAR + 1, FAR + 2) == [FAR, FAR + 1, FAR + 2]


class TestTheLastTick:
    """The count does not wrap: what comes after its last tick is a plant that has started anew."""

    def test_is_believed_like_any_other(self):
        count = Count(LAST - 3)
        assert [count.hear(tick) for tick in range(LAST - 2, LAST + 1)] == [Belief.NEXT] * 3

    @pytest.mark.parametrize(("first", "second"), [(0, 0), (0, 1), (1, 2)])
    def test_is_followed_by_a_restart(self, first, second):
        count = Count(LAST)
        assert [count.hear(first), count.hear(second)] == [Belief.IGNORED, Belief.RESTARTED]
        assert count.tick == second


class TestTheTime:
    """Whether field and Sun may be those of another time."""

    def test_is_not_in_doubt_where_few_syncs_are_lost(self, count):
        for _ in range(40):
            assert count.hear(count.tick + 1 + FEW_TICKS) is Belief.NEXT
            assert count.watch.settled(count.tick)

    def test_is_in_doubt_after_a_long_skip(self, count):
        count.hear(AT + 2 + FEW_TICKS)
        assert not count.watch.settled(count.tick + LEAP_TICKS - 1)
        assert count.watch.settled(count.tick + LEAP_TICKS)

    def test_a_short_skip_ends_no_doubt(self, count):
        count.hear(AT + 2 + FEW_TICKS)
        count.hear(count.tick + 2)
        assert not count.watch.settled(count.tick)

    @pytest.mark.parametrize("step", [0, 1])
    def test_is_in_doubt_after_a_restart(self, count, step):
        count.answers(FAR, FAR + step)
        assert not count.watch.settled(count.tick)

    def test_a_short_skip_that_was_forged_is_soon_in_doubt(self, count):
        assert count.answers(AT + 3, AT + 1, AT + 2) == [AT + 3, AT + 2]
        assert not count.watch.settled(count.tick)

    def test_the_checksum_is_of_all(self, count):
        before = pack(count.watch)
        count.hear(AT + 2 + FEW_TICKS)
        assert pack(count.watch) != before
        assert pack(count.watch) != pack(replace(count.watch, timed_tick=1))


class TestTheTickThatWasAnswered:
    def test_once_more_is_a_duplicate(self, count):
        assert count.hear(AT) is Belief.IGNORED
        assert count.watch.strange_tick == -1
        assert count.hear(AT + 1) is Belief.NEXT

    def test_again_and_again_has_not_heard_the_answer(self, count):
        """As a plant that lost it, or one that has started anew in this very tick."""
        assert [count.hear(AT) for _ in range(4)] == [Belief.IGNORED, Belief.UNANSWERED] * 2
        assert count.hear(AT + 1) is Belief.NEXT

    def test_after_the_tick_before_it_is_still_a_duplicate(self, count):
        assert count.answers(AT - 1, AT) == []


class TestAttack:
    """However SYNC is forged, the true plant is answered again and again."""

    def answered(self, forge, ticks=2000):
        """Which true ticks are answered while what ``forge(random)`` gives comes before each."""
        random, count, answered = Random(5), Count(0), []
        for tick in range(1, ticks):
            for false in forge(random, tick):
                count.hear(max(0, false))
            answered += count.answers(tick)
        return answered

    @pytest.mark.parametrize(
        "forge",
        [
            lambda random, tick: [x := random.randrange(LAST), x + 1],
            lambda random, tick: [random.randrange(LAST)] * 2,
            lambda random, tick: [x := random.randrange(LAST), x + 1, x + 2],
            lambda random, tick: [tick - 500, tick - 499],
            lambda random, tick: [FAR, FAR + 1],
            lambda random, tick: [FAR + tick, FAR + tick + 1],
            lambda random, tick: [FAR + tick] if tick > 2 else [FAR, FAR + 1],
            lambda random, tick: [x := random.randrange(LAST), x + 1, *random.sample(range(LAST), 20)],
        ],
        ids=["pair", "equal", "three", "back", "same", "goes on", "second plant", "pair and noise"],
    )
    def test_by_pairs_misses_none(self, forge):
        assert self.answered(forge) == list(range(1, 2000))

    @pytest.mark.parametrize("ahead", [2, 30, LEAP_TICKS])
    def test_by_skips_misses_every_other(self, ahead):
        answered = self.answered(lambda random, tick: [tick + ahead])
        assert max(b - a for a, b in pairwise(answered)) <= 2

    def test_by_skips_that_follow_the_count(self):
        """Each a skip ahead of what is believed."""
        count, answered = Count(0), []
        for tick in range(1, 2000):
            count.hear(count.tick + LEAP_TICKS)
            answered += count.answers(tick)
        assert max(b - a for a, b in pairwise(answered)) <= 2

    @pytest.mark.parametrize("seed", range(5))
    def test_once_it_is_over_the_plant_is_followed_within_two_ticks(self, seed):
        random = Random(seed)
        for _ in range(300):
            count, tick = Count(0), 0
            for _ in range(random.randrange(40)):
                tick += random.random() < 0.5
                near_or_far = [tick + random.randrange(-70, 70), random.randrange(LAST), count.tick + 1]
                count.hear(max(0, random.choice([tick, *near_or_far])))
            answered = count.answers(*range(tick + 1, tick + 50))
            assert answered[-46:] == list(range(tick + 4, tick + 50)), (seed, tick)
