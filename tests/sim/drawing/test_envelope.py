"""A history of many samples is drawn as its envelope, however it is handed over."""

import numpy as np
import pytest

from sim.drawing.envelope import BINS, Envelope


def envelope(y, *cuts):
    """Of one history, handed over in parts."""
    gathered = Envelope(len(y), 1)
    for part in np.split(y, cuts):
        gathered.take(part[:, None])
    return gathered.places, gathered.points[:, 0]


def at_once(y):
    """The same by a second formula."""
    bins = np.array_split(y, BINS) if len(y) % BINS == 0 else None
    assert bins is not None, "bins are equal here"
    pairs = [(np.nanmin(values), np.nanmax(values)) for values in bins]
    return np.array([pair if b[0] <= b[-1] else pair[::-1] for pair, b in zip(pairs, bins, strict=True)])


def test_it_keeps_every_extreme_and_passes_over_gaps():
    y = np.sin(np.arange(100_000) / 7000.0)
    y[54_321], y[77_777] = 9.0, -9.0
    y[20_000:40_000] = np.nan
    x, drawn = envelope(y)
    assert len(x) == len(drawn) == 2 * BINS
    assert (np.diff(x) >= 0).all()
    assert (np.nanmax(drawn), np.nanmin(drawn)) == (9.0, -9.0)
    assert np.isnan(drawn[(x > 20_200) & (x < 39_800)]).all()
    assert np.isfinite(drawn[(x < 19_800) | (x > 40_200)]).all()


def test_each_bin_goes_as_the_history_does_from_its_first_to_its_last_sample():
    y = np.random.default_rng(2).standard_normal(13 * BINS)
    assert (envelope(y)[1] == at_once(y).ravel()).all()


def test_a_short_history_is_drawn_as_it_is():
    y = np.random.default_rng(3).standard_normal(500)
    x, drawn = envelope(y, 1, 77)
    assert (x == np.arange(500)).all()
    assert (drawn == y).all()


@pytest.mark.parametrize("length", [2 * BINS, 2 * BINS + 1, 5000, 7 * BINS, 100_003])
@pytest.mark.parametrize("seed", [1, 2])
def test_the_parts_in_which_it_comes_do_not_matter(length, seed):
    random = np.random.default_rng(seed)
    y = random.standard_normal(length)
    y[random.random(length) < 0.3] = np.nan
    cuts = np.sort(random.integers(1, length, 12))
    places, points = envelope(y, *cuts)
    assert (places == envelope(y)[0]).all()
    assert np.array_equal(points, envelope(y)[1], equal_nan=True)


def test_histories_side_by_side_are_those_alone():
    both = np.random.default_rng(4).standard_normal((9000, 2))
    gathered = Envelope(9000, 2)
    gathered.take(both)
    for column in (0, 1):
        assert (gathered.points[:, column] == envelope(both[:, column])[1]).all()
