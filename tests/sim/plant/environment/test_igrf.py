from datetime import UTC, datetime

import numpy as np
import pytest

from sim.plant.environment.igrf import REFERENCE_RADIUS_M, Igrf

Y2020 = datetime(2020, 1, 1, tzinfo=UTC).timestamp()


@pytest.fixture(scope="module")
def igrf14(reference):
    return reference("igrf14.csv")


@pytest.fixture(scope="module")
def points(igrf14):
    times = Y2020 + 86400.0 * igrf14.column("days_since_2020")
    return times, 1e3 * igrf14.columns("r_ecef_x_km", "r_ecef_y_km", "r_ecef_z_km")


def test_field_against_the_reference_poles_and_date_line_included(igrf14, points):
    ours_nt = 1e9 * Igrf().at(*points)
    assert np.abs(ours_nt - igrf14.columns("b_ecef_x_nT", "b_ecef_y_nT", "b_ecef_z_nT")).max() < 1e-3
    assert {"exact_pole", "date_line"} <= {row["kind"] for row in igrf14.rows}


def test_coefficients_are_linear_in_days_not_in_decimal_years(igrf14, points):
    ours_nt = 1e9 * Igrf().at(*points)
    other = igrf14.columns("b_decyear_x_nT", "b_decyear_y_nT", "b_decyear_z_nT")
    assert 0.1 < np.abs(ours_nt - other).max() < 0.5


def test_points_do_not_depend_on_each_other(points):
    times, r = points
    field = Igrf()
    together = field.at(times, r)
    for i in range(0, len(times), 17):
        assert field.at(times[i : i + 1], r[i : i + 1])[0] == pytest.approx(together[i], rel=1e-13)


def test_degree_one_is_a_dipole():
    """B = (a/r)^3 (3 (m . e) e - m) with m = (g11, h11, g10), here of 2020."""
    m_nt = np.array([-1451.37, 4653.35, -29403.41])
    r = np.array([[3.1e6, -5.2e6, 4.3e6], [0.0, 0.0, 7.0e6], [-6.9e6, 1e3, -2e5]])
    r_norm = np.linalg.norm(r, axis=1)[:, None]
    e = r / r_norm
    expected = (REFERENCE_RADIUS_M / r_norm) ** 3 * (3.0 * (e @ m_nt)[:, None] * e - m_nt)
    assert 1e9 * Igrf(1).at(np.full(3, Y2020), r) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("degree", "most_deg"), [(8, 0.3), (10, 0.06)])
def test_truncation_costs_what_is_known_of_it(points, degree, most_deg):
    times, r = points
    high = 7.178e6 * r / np.linalg.norm(r, axis=1)[:, None]
    full, short = Igrf().at(times, high), Igrf(degree).at(times, high)
    sine = np.linalg.norm(np.cross(full, short), axis=1)
    angle = np.arcsin(sine / (np.linalg.norm(full, axis=1) * np.linalg.norm(short, axis=1)))
    assert 0.0 < np.degrees(angle).max() < most_deg


def test_field_has_no_sources():
    """Divergence and curl vanish: central differences over 1 km."""
    step, origin = 1e3, np.array([2.1e6, -4.4e6, 5.2e6])
    offsets = np.concatenate([step * np.eye(3), -step * np.eye(3)])
    b = Igrf().at(np.full(6, Y2020), origin + offsets)
    gradient = (b[:3] - b[3:]) / (2.0 * step)  # row: direction of the derivative
    scale = np.abs(gradient).max()
    assert abs(np.trace(gradient)) < 1e-6 * scale
    assert np.abs(gradient - gradient.T).max() < 1e-6 * scale


@pytest.mark.parametrize("year", [1899, 2031])
def test_years_outside_the_table_are_refused(year):
    time = datetime(year, 6, 1, tzinfo=UTC).timestamp()
    with pytest.raises(ValueError, match="1900 to 2030"):
        Igrf().at(np.array([time]), np.array([[7e6, 0.0, 0.0]]))


@pytest.mark.parametrize("degree", [0, 14])
def test_degrees_outside_the_table_are_refused(degree):
    with pytest.raises(ValueError, match="1 to 13"):
        Igrf(degree)
