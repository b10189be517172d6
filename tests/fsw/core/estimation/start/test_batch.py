"""The batch of samples: what is kept, what is driven in between, and when the motion is looked for."""

from dataclasses import replace
from math import inf

import pytest
from cell_samples import REFERENCE, cell_filter
from changed import changed

from fsw.core.algebra.vector import ZERO, scale
from fsw.core.estimation.start.batch import (
    AGAIN_S,
    GAP_S,
    LEAST_S,
    MOST_S,
    SHORT_S,
    SPACING_S,
    SampleBatch,
    discard_samples,
    keep_sample,
    pass_tick,
    rest,
    search_due,
)
from fsw.core.estimation.start.batch_sample import UNKNOWN, BatchSample
from fsw.core.estimation.start.first import StartLimits, estimate_from_batch

SUN = (0.6, -0.48, 0.64)


def sample(lit=1.0, coarse=None):
    return BatchSample(
        0.0,
        ZERO,
        (2e-5, -1e-5, 3e-5),
        (0.5, 0.0, 0.2),
        (3e-5, 1e-5, -2e-5),
        SUN,
        (7e6, 1e5, 2e5),
        lit,
        0.1,
        coarse,
    )


def begun(lit=1.0, coarse=None):
    batch = SampleBatch()
    keep_sample(batch, sample(lit, coarse))
    return batch


def filled(seconds, coarse=None, lit=1.0, tick_s=1.0):
    batch = begun(lit, coarse)
    for _ in range(round(seconds / tick_s)):
        pass_tick(batch, (0.1, 0.0, -0.2), tick_s)
        keep_sample(batch, sample(lit, coarse))
    return batch


def test_nothing_is_kept_before_the_first_sample():
    batch = SampleBatch()
    pass_tick(batch, (1.0, 2.0, 3.0), 1.0)
    assert batch == SampleBatch()


@pytest.mark.interpreted
def test_discarded_samples_leave_nothing():
    batch = filled(30.0)
    batch.search = "under way"
    discard_samples(batch)
    assert batch == SampleBatch()


def test_a_copy_goes_on_by_itself():
    batch = filled(30.0)
    before, copy = batch.copy(), batch.copy()
    pass_tick(copy, (0.1, 0.2, 0.3), 10.0)
    keep_sample(copy, sample())
    assert batch == before != copy


@pytest.mark.parametrize("tick_s", [1.0, 0.25, 7.0])
def test_a_sample_is_kept_when_it_is_due(tick_s):
    batch = filled(90.0, tick_s=tick_s)
    spacing = [one.since_s for one in batch.samples[1:]]
    assert all(SPACING_S <= since < SPACING_S + tick_s for since in spacing)
    assert batch.span_s == pytest.approx(sum(spacing))


def test_the_dipole_of_a_leg_is_the_mean_of_what_was_driven():
    batch = begun()
    for tick in range(20):
        pass_tick(batch, (0.6, 0.0, -0.3) if tick < 5 else ZERO, 1.0)
    keep_sample(batch, sample())
    assert batch.samples[1].m_body_am2 == pytest.approx((0.15, 0.0, -0.075))
    assert batch.driven_am2s == ZERO


def test_after_a_gap_it_begins_anew():
    batch = filled(100.0)
    for _ in range(round(GAP_S)):
        pass_tick(batch, ZERO, 1.0)
    assert len(batch.samples) == 6
    pass_tick(batch, ZERO, 1.0)
    assert batch == SampleBatch()


def test_the_oldest_are_dropped():
    assert filled(3000.0).span_s <= MOST_S


@pytest.mark.interpreted
def test_while_a_search_is_under_way_none_is_dropped():
    batch = filled(MOST_S)
    full, batch.search = batch.samples, "under way"
    pass_tick(batch, ZERO, SPACING_S)
    keep_sample(batch, sample())
    assert batch.samples[:-1] == full
    assert batch.search == "under way"
    batch.search = None
    pass_tick(batch, ZERO, SPACING_S)
    keep_sample(batch, sample())
    assert len(batch.samples) == len(full)


def test_the_rest_is_what_was_driven_since_the_last_sample():
    batch = filled(40.0)
    assert rest(batch, ZERO, SUN, ZERO) is None
    for tick in range(8):
        pass_tick(batch, (0.6, 0.0, -0.3) if tick < 2 else ZERO, 1.0)
    since = rest(batch, (1e-5, 2e-5, 3e-5), SUN, (7e6, 0.0, 1e5))
    assert (since.since_s, since.b_eci_t, since.r_eci_m) == (8.0, (1e-5, 2e-5, 3e-5), (7e6, 0.0, 1e5))
    assert since.m_body_am2 == pytest.approx((0.15, 0.0, -0.075))


class TestDue:
    @pytest.mark.parametrize(("coarse", "least_s"), [(None, LEAST_S), (SUN, SHORT_S)])
    def test_with_three_lit_cells_sooner(self, coarse, least_s):
        assert not search_due(filled(least_s - SPACING_S, coarse))
        assert search_due(filled(least_s, coarse))

    def test_one_sample_without_three_lit_cells_makes_it_the_long_one(self):
        batch = filled(SHORT_S, SUN)
        without = replace(batch.samples[2], coarse=None)
        batch.samples = (*batch.samples[:2], without, *batch.samples[3:])
        assert not search_due(batch)

    def test_only_with_a_sample_just_kept(self):
        assert not search_due(changed(filled(LEAST_S), pass_tick, ZERO, 1.0))
        assert not search_due(SampleBatch())

    @pytest.mark.interpreted
    def test_not_while_a_search_is_under_way(self):
        assert not search_due(replace(filled(LEAST_S), search="under way"))

    def test_not_in_the_shadow(self):
        assert not search_due(filled(LEAST_S, lit=0.0))

    def test_again_after_a_while(self):
        batch = replace(filled(LEAST_S), searched_s=0.0)
        for second in range(round(AGAIN_S)):
            assert second == 0 or not search_due(batch)
            pass_tick(batch, ZERO, 1.0)
            keep_sample(batch, sample())
        assert search_due(batch)


@pytest.mark.parametrize("tick_hz", [1, 3, 5, 7, 10, 20])
class TestTicks:
    """Sums of ticks are not exact where a tick is no binary fraction; nothing comes a tick later by that."""

    @pytest.mark.parametrize(("coarse", "at_s"), [(SUN, [100, 200, 300, 400]), (None, [400, 500, 600, 700])])
    def test_searches_begin_when_they_are_due(self, tick_hz, coarse, at_s):
        batch, searches = begun(coarse=coarse), []
        for tick in range(1, 750 * tick_hz):
            pass_tick(batch, ZERO, 1.0 / tick_hz)
            keep_sample(batch, sample(coarse=coarse))
            if search_due(batch):
                searches.append(tick)
                batch.searched_s = 0.0
        assert searches[:4] == [one * tick_hz for one in at_s]

    def test_a_batch_ends_after_the_gap_and_not_before(self, tick_hz):
        batch = begun()
        for _ in range(round(GAP_S * tick_hz)):
            pass_tick(batch, ZERO, 1.0 / tick_hz)
        assert batch.samples
        pass_tick(batch, ZERO, 1.0 / tick_hz)
        assert batch == SampleBatch()


@pytest.mark.interpreted
def test_every_number_of_a_batch_counts(blind_places):
    batch = filled(60.0, SUN)
    assert len(batch.samples) == 4
    assert blind_places(batch) == []


class TestSample:
    """What a tick gives the batch: a field as strong as modelled, cells, and whether the Sun is there."""

    CURRENTS = (0.5, None, 0.6, 0.0, 0.1, 0.3)

    def taken(self, field, reference=REFERENCE, currents=CURRENTS):
        limits = StartLimits(3e-6, inf, 0.0)
        batch = SampleBatch()
        assert estimate_from_batch(batch, field, currents, reference, limits, cell_filter()) is None
        return batch.samples

    @pytest.mark.parametrize(("part", "count"), [(0.9, 0), (0.95, 1), (1.05, 1), (1.1, 0)])
    def test_of_a_field_that_is_neither_too_weak_nor_too_strong(self, part, count):
        assert len(self.taken(scale(part, REFERENCE.b_eci_t))) == count

    def test_in_sunlight_and_in_the_shadow(self):
        (lit,) = self.taken(REFERENCE.b_eci_t)
        behind = REFERENCE.replace(r_eci_m=scale(-7.0e6, REFERENCE.sun_eci), radius_m=7.0e6)
        (dark,) = self.taken(REFERENCE.b_eci_t, behind)
        assert lit.lit == 1.0
        assert lit.earth > 0.1
        assert (dark.lit, dark.earth, dark.coarse) == (0.0, 0.0, None)
        assert lit.currents == dark.currents == (0.5, UNKNOWN, 0.6, 0.0, 0.1, 0.3)

    def test_a_cell_that_may_be_in_a_shade_is_unknown(self):
        """Cell 2 has one; the others show that the Sun is not on their side."""
        (taken,) = self.taken(REFERENCE.b_eci_t, currents=(0.5, 0.0, 0.2, 0.0, 0.1, 0.3))
        assert taken.currents == (0.5, 0.0, UNKNOWN, 0.0, 0.1, 0.3)
