"""Directions in Braille: an arrow ends where it points, within any room."""

import pytest

from sim.watch.terminal import picture, project, sparkline


def at(cells, letter):
    return [
        (row, column)
        for row, line in enumerate(cells)
        for column, cell in enumerate(line)
        if cell.text == letter
    ]


def test_up_is_up_and_down_is_down():
    cells = picture({"body 1": (1.0, 0.0, 0.0), "nadir": (-1.0, 0.0, 0.0)}, 40, 20)
    (up,), (down,) = at(cells, "1"), at(cells, "n")
    assert up[0] < 10 < down[0]
    assert abs(up[1] - 20) <= 1
    assert cells[5][20].name == "body 1"


def test_the_axes_stand_apart():
    ends = [project(axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    for one, other in ((0, 1), (1, 2), (0, 2)):
        assert sum((a - b) ** 2 for a, b in zip(ends[one], ends[other], strict=True)) > 0.3


@pytest.mark.parametrize(("columns", "rows"), [(1, 1), (10, 4), (200, 60)])
def test_any_room_is_filled_and_not_exceeded(columns, rows):
    cells = picture({"field": (0.0, 0.6, 0.8), "Sun": (0.0, 0.0, -1.0)}, columns, rows)
    assert [len(line) for line in cells] == [columns] * rows


def test_a_sparkline_has_gaps_and_its_largest_is_full():
    assert sparkline([None, 0.0, 4.0, 8.0], 10) == " ▁▅█"
    assert sparkline([1.0] * 50, 30) == "█" * 30
    assert sparkline([], 30) == ""
    assert sparkline([0.0, None], 30) == "▁ "
