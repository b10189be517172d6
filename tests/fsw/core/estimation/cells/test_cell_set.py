"""What lights the cells, and from where the satellite shades them."""

from dataclasses import replace
from math import radians, sin

import numpy as np
import pytest
from cell_samples import CELLS, EXCESS_SIGMA, LIGHT_SIGMA, NOISE_SIGMA, REFERENCE

from fsw.core.algebra.vector import cross, norm, scale, unit
from fsw.core.estimation.cells.cell_set import GRAZING, PENUMBRA_M, SIGMAS, light
from fsw.core.orbit.earth import RADIUS_M


class TestLight:
    def test_the_earth_is_below_and_as_bright_as_the_sun_stands_high(self):
        seen = light(REFERENCE.r_eci_m, REFERENCE.sun_eci, 0.3)
        up = unit(REFERENCE.r_eci_m)
        assert seen.e_eci == pytest.approx(scale(-1.0, up))
        factor = (RADIUS_M / REFERENCE.radius_m) ** 2
        assert seen.earth == pytest.approx(0.3 * np.dot(up, REFERENCE.sun_eci) * factor)
        assert seen.earth > 0.1

    def test_is_none_of_the_earth_s_where_its_albedo_is_left_out_or_the_sun_has_set_below(self):
        assert light(REFERENCE.r_eci_m, REFERENCE.sun_eci, 0.0).earth == 0.0
        low = (*unit((0.05, 1.0, 0.0)),)
        set_below = light(scale(7.0e6, low), unit((-0.1, -0.05, 1.0)), 0.3)
        assert np.dot(low, set_below.s_eci) < -0.01
        assert set_below.earth == 0.0

    @pytest.mark.parametrize(("off_m", "there"), [(-1000.0, False), (1000.0, True)])
    def test_there_is_none_near_the_edge_of_the_shadow(self, off_m, there):
        """The cylinder of the shadow is wider by the penumbra and the errors of its edge."""
        sun = REFERENCE.sun_eci
        across = unit(cross(sun, (0.0, 0.0, 1.0)))
        behind = np.add(scale(-3.0e6, sun), scale(RADIUS_M + PENUMBRA_M + off_m, across))
        assert (light(tuple(behind), sun, 0.3) is not None) is there

    def test_there_is_none_in_the_shadow(self):
        assert light(scale(-7.0e6, REFERENCE.sun_eci), REFERENCE.sun_eci, 0.3) is None


class TestShade:
    @pytest.mark.parametrize(("deg", "shaded"), [(0.0, True), (25.0, True), (26.5, False), (180.0, False)])
    def test_is_a_cone_of_one_cell(self, deg, shaded):
        direction = (sin(radians(deg)), np.cos(radians(deg)), 0.0)
        assert norm(direction) == pytest.approx(1.0)
        assert CELLS.shaded(2, direction) is shaded
        assert not any(CELLS.shaded(cell, direction) for cell in (0, 1, 3, 4, 5))

    def test_one_that_faces_the_sun_shows_about_half_of_the_light_of_the_earth_at_most(self):
        zenith, off = np.meshgrid(
            np.radians(np.arange(0.0, 90.5, 0.5)), np.radians(np.arange(0.0, 90.5, 0.5))
        )
        view = 0.5 * (1.0 + np.cos(np.pi - zenith - off))  # the cell between Sun and Earth, off the Sun
        assert (np.cos(zenith) * view**2).max() == pytest.approx(GRAZING, abs=0.003)

    def test_a_cell_may_be_in_it_that_shows_no_more_than_the_earth_and_its_errors(self):
        most = GRAZING * 0.3 + SIGMAS * np.hypot(np.hypot(GRAZING * LIGHT_SIGMA, EXCESS_SIGMA), NOISE_SIGMA)
        assert CELLS.most_shaded == pytest.approx(most)
        assert CELLS.may_be_shaded(2, 0.99 * most)
        assert not CELLS.may_be_shaded(2, 1.01 * most)
        assert not CELLS.may_be_shaded(1, 0.0)
        assert replace(CELLS, albedo=0.0, light_sigma=0.0).most_shaded < most
