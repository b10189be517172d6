from math import dist

import pytest

from fsw.core.algebra.vector import norm, scale, unit
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.sun import lit, sun_eci

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
