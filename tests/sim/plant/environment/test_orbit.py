from dataclasses import replace
from math import pi, radians, sqrt

import numpy as np
import pytest

from fsw.core.orbit.tle import tle_epoch_unix_s
from sim.plant.config import OrbitConfig
from sim.plant.environment.orbit import (
    EARTH_RADIUS_M,
    MU_M3PS2,
    CircularOrbit,
    Sgp4Orbit,
    make_orbit,
)

CIRCLE = OrbitConfig(
    altitude_m=800e3, inclination_rad=radians(98.6), raan_rad=radians(35.0), u0_rad=radians(20.0)
)
A = EARTH_RADIUS_M + 800e3
TIMES = np.linspace(0.0, 12000.0, 57)


def with_checksum(line):
    """The line with its last digit made right."""
    return line[:-1] + str(sum(int(c) if c.isdigit() else c == "-" for c in line[:-1]) % 10)


def test_circle_keeps_radius_and_speed_and_obeys_gravity():
    r, v = CircularOrbit(CIRCLE).at(TIMES)
    assert np.linalg.norm(r, axis=1) == pytest.approx(A, rel=1e-14)
    assert np.linalg.norm(v, axis=1) == pytest.approx(sqrt(MU_M3PS2 / A), rel=1e-14)
    before, after = (CircularOrbit(CIRCLE).at(TIMES + dt)[1] for dt in (-0.5, 0.5))
    assert (after - before) == pytest.approx(-MU_M3PS2 / A**3 * r, abs=1e-6)


def test_circle_velocity_is_the_rate_of_position():
    before, after = (CircularOrbit(CIRCLE).at(TIMES + dt)[0] for dt in (-0.5, 0.5))
    assert (after - before) == pytest.approx(CircularOrbit(CIRCLE).at(TIMES)[1], abs=1e-2)


def test_circle_starts_at_its_argument_of_latitude_and_has_its_plane():
    r, v = CircularOrbit(CIRCLE).at(np.zeros(1))
    node = np.array([np.cos(CIRCLE.raan_rad), np.sin(CIRCLE.raan_rad), 0.0])
    normal = np.cross(r[0], v[0]) / np.linalg.norm(np.cross(r[0], v[0]))
    assert np.arccos(normal[2]) == pytest.approx(CIRCLE.inclination_rad)
    assert normal @ node == pytest.approx(0.0, abs=1e-12)
    u = np.arctan2(r[0] @ np.cross(normal, node), r[0] @ node)
    assert u == pytest.approx(CIRCLE.u0_rad)
    assert v[0, 2] > 0.0  # a start after the ascending node goes north


def test_circle_closes_after_its_period():
    period = 2.0 * pi * sqrt(A**3 / MU_M3PS2)
    r, _ = CircularOrbit(CIRCLE).at(np.array([0.0, period]))
    assert r[1] == pytest.approx(r[0], abs=1e-5)


@pytest.mark.parametrize(("name", "altitude_km"), [("ITAMSAT", 800.0), ("UO-11", 605.0)])
def test_sgp4_of_real_elements_flies_where_the_satellite_was(elements, name, altitude_km):
    tle = elements[name]
    r, v = Sgp4Orbit(tle, tle_epoch_unix_s(*tle)).at(np.linspace(0.0, 6000.0, 600))
    altitudes_km = (np.linalg.norm(r, axis=1) - EARTH_RADIUS_M) / 1e3
    assert altitudes_km.mean() == pytest.approx(altitude_km, abs=15.0)
    normal = np.cross(r, v)
    inclination = np.arccos(normal[:, 2] / np.linalg.norm(normal, axis=1))
    assert np.degrees(inclination).mean() == pytest.approx(float(tle[1][8:16]), abs=0.05)


def test_sgp4_is_a_matter_of_absolute_time(itamsat):
    epoch = tle_epoch_unix_s(*itamsat)
    later, _ = Sgp4Orbit(itamsat, epoch + 100_000).at(TIMES)
    same, _ = Sgp4Orbit(itamsat, epoch).at(TIMES + 100_000.0)
    assert later == pytest.approx(same, abs=1e-3)


def test_sgp4_passes_the_node_at_its_own_epoch(itamsat):
    """NORAD gives its elements at the ascending node; a second is 0.06 deg of latitude."""
    epoch_s = 0.11593543 * 86400 - (tle_epoch_unix_s(*itamsat) % 86400)  # before the rounded epoch
    r, v = Sgp4Orbit(itamsat, tle_epoch_unix_s(*itamsat)).at(np.array([epoch_s]))
    assert np.degrees(np.arctan2(r[0, 2], np.linalg.norm(r[0, :2]))) == pytest.approx(0.0, abs=1e-3)
    assert v[0, 2] > 0.0


def test_sgp4_refuses_a_time_at_which_the_satellite_has_decayed(itamsat):
    draggy = with_checksum(itamsat[0].replace(" 11414-3", " 99999-0"))
    orbit = Sgp4Orbit((draggy, itamsat[1]), tle_epoch_unix_s(*itamsat))
    with pytest.raises(ValueError, match=r"SGP4 at 2592000 s after the epoch: .*decayed"):
        orbit.at(86400.0 * np.array([0.0, 1.0, 30.0]))


@pytest.mark.parametrize("damage", ["checksum", "length", "order"])
def test_malformed_elements_are_refused(itamsat, damage):
    one, two = itamsat
    tle = {"checksum": (one.replace("22826U", "22827U"), two), "length": (one[:-1], two), "order": (two, one)}
    with pytest.raises(ValueError, match=r"line|checksum"):
        make_orbit(OrbitConfig(tle=tle[damage]), 0)


def test_the_configuration_chooses(itamsat):
    assert isinstance(make_orbit(CIRCLE, 0), CircularOrbit)
    assert isinstance(make_orbit(OrbitConfig(tle=itamsat), 0), Sgp4Orbit)


class TestAhead:
    @pytest.mark.parametrize("km", [5.0, -80.0, 3000.0])
    def test_on_a_circle_it_is_the_angle_of_the_arc(self, km):
        ahead = make_orbit(replace(CIRCLE, along_track_m=1e3 * km), 0)
        turned = make_orbit(replace(CIRCLE, u0_rad=CIRCLE.u0_rad + 1e3 * km / A), 0)
        for found, expected in zip(ahead.at(TIMES), turned.at(TIMES), strict=True):
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-3)

    @pytest.mark.parametrize("km", [5.0, -80.0])
    def test_on_elements_it_is_the_way_along_the_track_on_average(self, itamsat, km):
        epoch = tle_epoch_unix_s(*itamsat)
        orbits = (make_orbit(OrbitConfig(tle=itamsat, along_track_m=d), epoch) for d in (1e3 * km, 0.0))
        times = np.linspace(0.0, 6041.0, 400)
        (r, _), (r0, v0) = (orbit.at(times) for orbit in orbits)
        along = ((r - r0) * v0).sum(axis=1) / np.linalg.norm(v0, axis=1) / 1e3
        assert along.mean() == pytest.approx(km, rel=1e-3)
        assert along == pytest.approx(km, rel=3e-3)
        normal = np.cross(r0, v0)
        across = ((r - r0) * normal).sum(axis=1) / np.linalg.norm(normal, axis=1)
        assert np.abs(across).max() < 1.0

    def test_nothing_ahead_is_the_orbit_itself(self, itamsat):
        assert isinstance(make_orbit(replace(CIRCLE, along_track_m=0.0), 0), CircularOrbit)
        assert isinstance(make_orbit(OrbitConfig(tle=itamsat, along_track_m=0.0), 0), Sgp4Orbit)
