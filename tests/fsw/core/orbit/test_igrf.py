import subprocess
import sys
from itertools import pairwise
from math import acos, degrees, dist
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.algebra.vector import dot, norm, scale, sub, unit
from fsw.core.orbit import igrf
from fsw.core.orbit.earth import gmst82_rad, rotate_about_pole
from fsw.core.orbit.igrf_coefficients import COEFFICIENTS_NT, EPOCHS_UNIX_S, MAX_DEGREE
from fsw.core.orbit.propagation import state_eci

ROOT = Path(__file__).resolve().parents[4]
PLACE_M = (-3.1e6, 4.7e6, 4.3e6)


def test_the_kernel_agrees_with_the_reference_to_full_degree(reference_rows, vector_of, gauss_at):
    rows = reference_rows("igrf14.csv")
    assert {"random", "exact_pole"} <= {row["kind"] for row in rows}
    for row in rows:
        b_t = igrf.gradient(
            scale(1000.0, vector_of(row, "r_ecef_", "_km")), igrf.harmonics(gauss_at(row["unix_s"]), 13)
        )
        assert scale(1e9, b_t) == pytest.approx(vector_of(row, "b_ecef_", "_nT"), abs=0.001)


def test_the_onboard_coefficients_are_the_plants_own(gauss_by_year):
    onboard = {(n, m): values for n, m, *values in COEFFICIENTS_NT}
    expected = {
        key: [gauss_by_year[year][key] for year in (2015, 2020, 2025, 2030)]
        for key in gauss_by_year[2025]
        if key[0] <= MAX_DEGREE
    }
    assert onboard == expected
    assert len(onboard) == 120


def test_the_coefficient_module_is_what_the_tool_writes():
    tool = ROOT / "tools" / "generate_igrf_coefficients.py"
    assert subprocess.run([sys.executable, str(tool), "--check"], check=False).returncode == 0


@pytest.mark.parametrize("start_s", EPOCHS_UNIX_S[:-1])
@pytest.mark.parametrize("days", [0, 1.5, 400, 1825])
def test_a_prepared_field_is_linear_in_elapsed_time(gauss_at, start_s, days):
    epoch_s = start_s + 86400.0 * days
    model = igrf.prepare(epoch_s)
    for unix_s in (epoch_s, start_s + 17.0, start_s + 86400.0 * 1000.25):
        expected = igrf.gradient(PLACE_M, igrf.harmonics(gauss_at(unix_s), MAX_DEGREE))
        assert dist(igrf.field_ecef_t(PLACE_M, unix_s, model), expected) < 1e-15


def test_the_last_moment_of_the_table_is_the_2030_model(gauss_by_year):
    model = igrf.prepare(EPOCHS_UNIX_S[-1])
    expected = igrf.gradient(PLACE_M, igrf.harmonics(gauss_by_year[2030], MAX_DEGREE))
    assert dist(igrf.field_ecef_t(PLACE_M, EPOCHS_UNIX_S[-1], model), expected) < 1e-15


@pytest.mark.parametrize("epoch_s", [EPOCHS_UNIX_S[0] - 1, EPOCHS_UNIX_S[-1] + 1])
def test_an_epoch_outside_the_table_is_refused(epoch_s):
    with pytest.raises(ValueError, match="2015 to 2030"):
        igrf.prepare(epoch_s)


@pytest.mark.parametrize("degree", [0, 11])
def test_a_degree_that_is_not_aboard_is_refused(degree):
    with pytest.raises(ValueError, match="degrees 1 to 10"):
        igrf.prepare(EPOCHS_UNIX_S[1], degree)


def test_degree_one_is_the_tilted_dipole(gauss_by_year):
    gauss = gauss_by_year[2025]
    moment_t = scale(1e-9, (gauss[1, 1], gauss[1, -1], gauss[1, 0]))
    r_hat = unit(PLACE_M)
    strength = (igrf.REFERENCE_RADIUS_M / norm(PLACE_M)) ** 3
    expected = scale(strength, sub(scale(3.0 * dot(moment_t, r_hat), r_hat), moment_t))
    assert dist(igrf.gradient(PLACE_M, igrf.harmonics(gauss, 1)), expected) < 1e-18


def test_degree_ten_points_within_six_hundredths_of_a_degree_of_degree_thirteen(
    itamsat, itamsat_epoch_unix_s, gauss_at
):
    full = igrf.harmonics(gauss_at(itamsat_epoch_unix_s), 13)
    aboard = igrf.prepare(itamsat_epoch_unix_s)
    worst_deg = 0.0
    for unix_s in range(itamsat_epoch_unix_s, itamsat_epoch_unix_s + 86400, 30):
        r_eci_m, _ = state_eci(itamsat, unix_s)
        r_ecef_m = rotate_about_pole(gmst82_rad(unix_s), r_eci_m)
        truth, model = igrf.gradient(r_ecef_m, full), igrf.field_ecef_t(r_ecef_m, unix_s, aboard)
        worst_deg = max(worst_deg, degrees(acos(min(1.0, dot(unit(truth), unit(model))))))
    assert 0.01 < worst_deg <= 0.06


@pytest.mark.long
@given(
    direction=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda d: norm(d) > 0.1),
    radius_m=st.floats(6.4e6, 8e6),
)
def test_the_field_has_neither_sources_nor_currents(direction, radius_m):
    model = igrf.prepare(EPOCHS_UNIX_S[2] + 4e7).at_epoch
    place, step_m = scale(radius_m, unit(direction)), 1000.0
    slopes = []
    for axis in range(3):
        ends = []
        for sign in (1.0, -1.0):
            moved = list(place)
            moved[axis] += sign * step_m
            ends.append(igrf.gradient(tuple(moved), model))
        slopes.append(scale(0.5 / step_m, sub(*ends)))
    steepest = max(norm(slope) for slope in slopes)
    assert abs(slopes[0][0] + slopes[1][1] + slopes[2][2]) < 1e-5 * steepest
    for i, j in ((0, 1), (1, 2), (2, 0)):
        assert abs(slopes[i][j] - slopes[j][i]) < 1e-5 * steepest


def test_the_field_is_continuous_through_the_pole():
    model = igrf.prepare(EPOCHS_UNIX_S[2]).at_epoch
    fields = [igrf.gradient((x_m, 0.0, 7e6), model) for x_m in (-1.0, -1e-9, 0.0, 1e-9, 1.0)]
    assert all(dist(a, b) < 5e-11 for a, b in pairwise(fields))
