from math import dist

import pytest

from fsw.core.algebra.vector import add, norm, scale, sub, unit
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.sun import apparent_sun, earthlight_eci, lit, sun_eci

SUN = unit((0.3, -0.8, -0.5))
ACROSS = unit((0.8, 0.3, 0.0))
"""Normal to the Sun."""


def test_the_almanac_sun_holds_in_both_frames_of_date(reference_rows, vector_of):
    for row in reference_rows("earth_sun.csv"):
        sun = sun_eci(row["unix_s"])
        assert dist(sun, vector_of(row, "sun_mod_")) < 3e-4
        assert dist(sun, vector_of(row, "sun_teme_")) < 3e-4


def test_the_sun_vector_is_a_unit_vector(reference_rows):
    for row in reference_rows("earth_sun.csv"):
        assert norm(sun_eci(row["unix_s"])) == pytest.approx(1.0, abs=1e-15)


def test_the_shadow_begins_and_ends_at_half_the_solar_disc(reference_rows, vector_of):
    rows = reference_rows("eclipse.csv")
    counts = {True: 0, False: 0}
    for row in rows:
        r_m = scale(1000.0, vector_of(row, "sat_", "_km"))
        is_lit = lit(r_m, unit(vector_of(row, "sun_", "_km")))
        assert is_lit == (row["lit_cylinder"] == "1")
        assert is_lit == (float(row["frac_exact"]) >= 0.5)
        counts[is_lit] += 1
    assert min(counts.values()) > 10


@pytest.mark.parametrize("along_m", [7e6, 1e3, 0.0])
def test_the_day_side_is_lit_however_near_the_axis(along_m):
    assert lit(scale(along_m, SUN), SUN)


@pytest.mark.parametrize(("height_m", "expected"), [(-1.0, False), (1.0, True)])
def test_the_edge_of_the_shadow_is_one_earth_radius_from_its_axis(height_m, expected):
    behind = scale(-3e6, SUN)
    out = scale(RADIUS_M + height_m, ACROSS)
    assert lit(tuple(a + b for a, b in zip(behind, out, strict=True)), SUN) is expected


class TestEarthlight:
    R_ECI_M = scale(RADIUS_M + 800e3, unit((2.0, -3.0, 6.0)))

    def test_by_hand_below_the_noon_sun(self):
        """At 800 km: (6378 / 7178)^2 = 0.7895, from below."""
        light = earthlight_eci(self.R_ECI_M, unit(self.R_ECI_M))
        assert light == pytest.approx(scale(-0.7895, unit(self.R_ECI_M)), rel=1e-3)

    @pytest.mark.parametrize("sine", [0.0, -0.3, -1.0])
    def test_there_is_none_where_the_sun_has_set(self, sine):
        across = unit((3.0, 2.0, 0.0))
        sun = add(scale(sine, unit(self.R_ECI_M)), scale((1.0 - sine * sine) ** 0.5, across))
        assert norm(earthlight_eci(self.R_ECI_M, sun)) == pytest.approx(0.0, abs=1e-16)
        assert apparent_sun(self.R_ECI_M, sun, 0.4)[0] == pytest.approx(sun, abs=1e-15)

    @pytest.mark.parametrize("albedo", [0.0, 0.15, 0.6])
    def test_the_apparent_sun_is_turned_towards_the_earth(self, albedo):
        sun = unit((1.0, 1.0, 2.0))
        found, slope = apparent_sun(self.R_ECI_M, sun, albedo)
        seen = add(sun, scale(albedo, earthlight_eci(self.R_ECI_M, sun)))
        assert found == pytest.approx(unit(seen), abs=1e-15)
        ahead, behind = (apparent_sun(self.R_ECI_M, sun, albedo + h)[0] for h in (1e-6, -1e-6))
        assert slope == pytest.approx(scale(5e5, sub(ahead, behind)), abs=1e-9)
        assert norm(slope) > 0.1
