from math import cos, dist, radians, sin

import pytest

from fsw.core.algebra.vector import cross, dot, scale, unit
from fsw.core.orbit.earth import DIPOLE_TM3, gmst82_rad, rotate_about_pole
from fsw.core.orbit.field import FieldKind, direct_dipole_eci_t, field_eci_t, prepare_field
from fsw.core.orbit.igrf import field_ecef_t, prepare
from fsw.core.orbit.propagation import circular_orbit, state_eci

EPOCH_S = 1_700_000_000
PLACE_M = (-3.1e6, 4.7e6, 4.3e6)


@pytest.mark.parametrize(("inclination_deg", "u_deg"), [(97.6, 33.0), (51.6, 212.0), (28.0, 90.0)])
def test_the_direct_dipole_in_orbit_axes(inclination_deg, u_deg):
    r, v = state_eci(circular_orbit(550.0, inclination_deg, 77.0, u_deg, EPOCH_S), EPOCH_S)
    e1, e3 = unit(r), unit(cross(r, v))
    b = direct_dipole_eci_t(r)
    i, u = radians(inclination_deg), radians(u_deg)
    expected = scale(DIPOLE_TM3 / dot(r, e1) ** 3, (-2.0 * sin(u) * sin(i), cos(u) * sin(i), cos(i)))
    assert dist((dot(b, e1), dot(b, cross(e3, e1)), dot(b, e3)), expected) < 1e-18


def test_the_igrf_turns_with_the_earth():
    field = prepare_field(FieldKind.IGRF14, EPOCH_S, degree=10)
    unix_s = EPOCH_S + 4321.5
    turn = gmst82_rad(unix_s)
    b_ecef_t = field_ecef_t(rotate_about_pole(turn, PLACE_M), unix_s, prepare(EPOCH_S, 10))
    b_eci_t = field_eci_t(field, PLACE_M, unix_s)
    assert dist(rotate_about_pole(turn, b_eci_t), b_ecef_t) < 1e-18
    assert dist(field_eci_t(field, PLACE_M, unix_s + 10_000.0), b_eci_t) > 1e-6


def test_the_tilted_dipole_is_igrf_of_degree_one_whatever_the_degree_asked():
    tilted = prepare_field(FieldKind.TILTED_DIPOLE, EPOCH_S, degree=10)
    first = prepare_field(FieldKind.IGRF14, EPOCH_S, degree=1)
    assert field_eci_t(tilted, PLACE_M, EPOCH_S) == field_eci_t(first, PLACE_M, EPOCH_S)


def test_the_direct_dipole_neither_turns_nor_ages():
    field = prepare_field(FieldKind.DIRECT_DIPOLE, 0.0)
    assert field_eci_t(field, PLACE_M, 0.0) == field_eci_t(field, PLACE_M, EPOCH_S)
    assert field_eci_t(field, PLACE_M, 0.0) == direct_dipole_eci_t(PLACE_M)


@pytest.mark.parametrize("kind", [FieldKind.IGRF14, FieldKind.TILTED_DIPOLE])
def test_a_field_outside_its_years_is_refused(kind):
    with pytest.raises(ValueError, match="2015 to 2030"):
        prepare_field(kind, 0.0)
