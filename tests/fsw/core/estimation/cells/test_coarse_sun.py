"""The coarse direction of the Sun from three lit cells."""

from dataclasses import replace

import numpy as np
import pytest
from cell_samples import CELLS, NORMALS

from fsw.core.algebra.vector import unit
from fsw.core.estimation.cells.coarse_sun import BRIGHT, coarse_sun

DIRECTIONS = [unit(v) for v in ((1.0, 1.2, 0.8), (-1.0, 0.9, -1.1), (0.7, -1.0, -0.9), (-0.8, -1.1, 1.0))]

OPEN = replace(CELLS, shades=((),) * 6)


def currents(sun, dark=()):
    shown = [max(0.0, float(np.dot(normal, sun))) for normal in NORMALS]
    return [0.0 if cell in dark else one for cell, one in enumerate(shown)]


@pytest.mark.parametrize("sun", DIRECTIONS)
def test_is_the_sun_where_nothing_else_shines(sun):
    assert coarse_sun(currents(sun), OPEN) == pytest.approx(sun, abs=1e-12)


@pytest.mark.parametrize("sun", DIRECTIONS)
def test_takes_a_brighter_cell_before_one_that_the_earth_lights(sun):
    """A cell on the other side from a lit one, dimmer than it, has no part."""
    shown = currents(sun)
    opposite = {0: 1, 1: 0, 2: 3, 3: 2, 4: 5, 5: 4}
    for cell, other in opposite.items():
        if shown[cell] > 0.3 and shown[other] == 0.0:
            shown[other] = 0.2
    assert coarse_sun(shown, OPEN) == pytest.approx(sun, abs=1e-12)


@pytest.mark.parametrize("missing", [None, 0.0, BRIGHT])
def test_there_is_none_without_a_third_lit_cell(missing):
    sun = DIRECTIONS[0]
    shown = currents(sun)
    brightest = max(range(6), key=lambda cell: shown[cell])
    shown[brightest] = missing
    assert coarse_sun(shown, OPEN) is None


@pytest.mark.parametrize("factor", [0.3, 0.6, 1.5])
def test_there_is_none_of_a_length_that_the_sun_does_not_give(factor):
    """Three cells that see the Earth alone are as bright as a Sun far away."""
    shown = [factor * one for one in currents(DIRECTIONS[0])]
    assert coarse_sun(shown, OPEN) is None


def test_three_cells_in_a_plane_give_none():
    flat = [0.5, 0.0, 0.6, 0.0, 0.0, 0.0]
    assert coarse_sun(flat, OPEN) is None
    assert coarse_sun([], OPEN) is None


class TestShade:
    """Cell 2 is in a shade where the Sun is near the axis y: cell 3, lit by the Earth, is no third."""

    SUN = unit((0.75, 0.6, 0.9))

    def shown(self, of_shaded, of_earthlit):
        shown = currents(self.SUN)
        shown[2], shown[3] = of_shaded, of_earthlit
        return shown

    def test_the_earth_is_not_taken_for_the_sun(self):
        shown = self.shown(0.0, 0.3)
        assert np.dot(coarse_sun(shown, OPEN), self.SUN) < 0.8
        assert coarse_sun(shown, CELLS) is None

    @pytest.mark.parametrize(("part", "there"), [(0.99, False), (1.01, True)])
    def test_a_cell_that_may_be_in_it_has_no_part(self, part, there):
        shown = self.shown(part * CELLS.most_shaded, 0.0)
        assert (coarse_sun(shown, CELLS) is not None) is there

    def test_three_that_see_the_sun_are_enough(self):
        sun = unit((1.3, -1.1, 1.0))
        assert currents(sun)[2] == 0.0
        assert coarse_sun(currents(sun), CELLS) == pytest.approx(sun, abs=1e-12)
