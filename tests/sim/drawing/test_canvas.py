"""A history of many samples is drawn as its envelope."""

import numpy as np

from sim.drawing.canvas import BINS, envelope


def test_an_envelope_keeps_every_extreme_and_passes_over_gaps():
    t = np.arange(100_000, dtype=float)
    y = np.sin(t / 7000.0)
    y[54_321], y[77_777] = 9.0, -9.0
    y[20_000:40_000] = np.nan
    x, drawn = envelope(t, y)
    assert len(x) == len(drawn) == 2 * BINS
    assert (np.diff(x) >= 0.0).all()
    assert (np.nanmax(drawn), np.nanmin(drawn)) == (9.0, -9.0)
    assert np.isnan(drawn[(x > 20_200) & (x < 39_800)]).all()
    assert np.isfinite(drawn[(x < 19_800) | (x > 40_200)]).all()


def test_a_short_history_is_drawn_as_it_is():
    t, y = np.arange(500.0), np.random.default_rng(3).standard_normal(500)
    x, drawn = envelope(t, y)
    assert (x == t).all()
    assert (drawn == y).all()
