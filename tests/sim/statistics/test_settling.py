"""When something has settled."""

import numpy as np
import pytest

from sim.statistics.settling import HELD_S, Settling, held_ticks, settled_tick, spans


def flags(ticks):
    return np.array([tick == "#" for tick in ticks], dtype=bool)


CASES = [
    ("", None),
    ("####.", None),
    (".....", None),
    ("###", 0),
    ("##", None),
    ("..###", 2),
    (".#.##", None),
    ("##.###", 3),
]


@pytest.mark.parametrize(("ticks", "expected"), CASES)
def test_settled_is_what_holds_to_the_end_for_the_least_time(ticks, expected):
    assert settled_tick(flags(ticks), 3.0 / HELD_S) == expected


@pytest.mark.parametrize(("ticks", "expected"), CASES)
@pytest.mark.parametrize("block", [1, 2, 3])
def test_it_is_the_same_block_by_block(ticks, expected, block):
    settling, broken = Settling(3), []
    for first in range(0, len(ticks), block):
        broken.append(settling.take(flags(ticks[first : first + block])))
    assert settling.tick == expected
    assert any(broken) == ("." in ticks)


def test_the_least_time_is_not_cut_by_a_tick():
    assert (held_ticks(1.0), held_ticks(4.0), held_ticks(1.0 / 7.0)) == (600, 2400, 86)


# --- Spans of ticks


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
