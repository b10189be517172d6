"""Spans of ticks."""

import numpy as np
import pytest

from sim.report.figures.spans import spans


@pytest.mark.parametrize(
    ("ticks", "expected"),
    [
        ("", []),
        ("...", []),
        ("###", [(0, 3)]),
        (".##.", [(1, 3)]),
        ("#.##..#", [(0, 1), (2, 4), (6, 7)]),
    ],
)
def test_each_span_has_its_first_tick_and_the_one_past_its_last(ticks, expected):
    assert spans(np.array([tick == "#" for tick in ticks], dtype=bool)) == expected
