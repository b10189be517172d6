from math import cos, radians, sin

import numpy as np
import pytest

from sim.plant.config import FieldConfig, OrbitConfig
from sim.plant.environment.field import DIPOLE_TM3, DirectDipole, make_field
from sim.plant.environment.orbit import CircularOrbit

EPOCH = 1_427_424_417
INCLINATION = radians(98.6)
ORBIT = CircularOrbit(OrbitConfig(altitude_m=800e3, inclination_rad=INCLINATION, raan_rad=1.0, u0_rad=0.2))
TIMES = np.arange(0.0, 86400.0, 300.0)
R, V = ORBIT.at(TIMES)


def angle_deg(a, b):
    sine = np.linalg.norm(np.cross(a, b), axis=1)
    return np.degrees(np.arctan2(sine, (a * b).sum(axis=1)))


def test_direct_dipole_in_the_orbital_frame():
    """B_orbit = (mu_e / r^3) (-2 sin u sin i, cos u sin i, cos i)."""
    b = DirectDipole().at(TIMES, R)
    r_norm = np.linalg.norm(R, axis=1)
    e1, e3 = R / r_norm[:, None], np.cross(R, V)
    e3 /= np.linalg.norm(e3, axis=1)[:, None]
    in_orbit = np.stack([(b * e1).sum(axis=1), (b * np.cross(e3, e1)).sum(axis=1), (b * e3).sum(axis=1)])
    u = 0.2 + np.linalg.norm(V, axis=1) / r_norm * TIMES
    si, ci = sin(INCLINATION), cos(INCLINATION)
    expected = DIPOLE_TM3 / r_norm**3 * np.stack([-2 * np.sin(u) * si, np.cos(u) * si, ci + 0 * u])
    assert in_orbit == pytest.approx(expected, abs=1e-15)


def test_igrf_turns_with_the_earth():
    """The same place over the ground has the same field, turned, a sidereal day later."""
    field = make_field(FieldConfig(), EPOCH)
    sidereal_day_s = 86164.0905
    place = np.repeat(R[:1], 4, axis=0)
    b = field.at(np.array([0.0, 0.25, 0.5, 1.0]) * sidereal_day_s, place)
    assert b[3] == pytest.approx(b[0], abs=1e-9)
    assert np.linalg.norm(b[1] - b[0]) > 1e-6
    turned = R[0] * [-1.0, -1.0, 1.0]
    half = field.at(np.array([0.5 * sidereal_day_s]), turned[None])[0]
    assert half == pytest.approx(b[0] * [-1.0, -1.0, 1.0], abs=1e-9)


def test_field_points_north_over_the_equator_and_down_over_the_north_pole():
    equator, pole = np.array([[7e6, 0.0, 0.0]]), np.array([[0.0, 0.0, 7e6]])
    for model in ("igrf14", "tilted_dipole", "direct_dipole"):
        field = make_field(FieldConfig(model), EPOCH)
        assert field.at(np.zeros(1), equator)[0, 2] > 1.5e-5
        assert field.at(np.zeros(1), pole)[0, 2] < -3e-5


def test_tilted_dipole_is_as_far_from_igrf_as_is_known():
    full = make_field(FieldConfig("igrf14"), EPOCH).at(TIMES, R)
    dipole = make_field(FieldConfig("tilted_dipole"), EPOCH).at(TIMES, R)
    difference = angle_deg(full, dipole)
    assert difference.mean() == pytest.approx(8.0, abs=1.5)
    assert difference.max() == pytest.approx(32.0, abs=5.0)


def test_degree_matters_to_igrf_alone():
    def b(model, degree):
        return make_field(FieldConfig(model, degree), EPOCH).at(TIMES, R)

    assert 0.0 < np.abs(b("igrf14", 13) - b("igrf14", 10)).max() < 5e-8
    assert (b("igrf14", 1) == b("tilted_dipole", 13)).all()
    assert (b("direct_dipole", 1) == b("direct_dipole", 13)).all()


class TestStorm:
    QUIET = make_field(FieldConfig(), EPOCH)
    STORM = make_field(FieldConfig(storm_t=3e-7), EPOCH)

    def test_it_pulsates_at_high_latitude_and_elsewhere_it_is_the_ring_currents(self):
        added = self.STORM.at(TIMES, R) - self.QUIET.at(TIMES, R)
        size, north = np.linalg.norm(added, axis=1), np.abs(R[:, 2]) / np.linalg.norm(R, axis=1)
        near_equator, near_pole = north < np.sin(radians(30.0)), north > np.sin(radians(75.0))
        assert added[near_equator] == pytest.approx(np.tile([0.0, 0.0, -6e-8], (near_equator.sum(), 1)))
        assert 4e-7 < size[near_pole].max() < 6e-7
        assert size[near_pole].mean() > 3e-7

    def test_without_one_the_field_is_the_quiet_one(self):
        assert (make_field(FieldConfig(storm_t=0.0), EPOCH).at(TIMES, R) == self.QUIET.at(TIMES, R)).all()
