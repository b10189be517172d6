"""The Earth's light against the integral over a diffuse sphere."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

from sim.plant.environment.orbit import EARTH_RADIUS_M
from sim.plant.hardware.sun_sensing import earthlight

E = np.array([2.0, -3.0, 6.0]) / 7.0
ACROSS = np.cross(E, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(E, [0.0, 0.0, 1.0]))


def sun_at(zenith_deg):
    """Unit vector to a Sun so far from the zenith of the point below the satellite."""
    return cos(radians(zenith_deg)) * E + sin(radians(zenith_deg)) * ACROSS


def integral(r_m, sun, steps=120):
    """Sum over patches of the Earth in view: 0.3 / pi cos(in) cos(out) dA / d^2, towards each of them."""
    distance = np.linalg.norm(r_m)
    edge = np.arccos(EARTH_RADIUS_M / distance)
    theta, phi = np.meshgrid(
        (np.arange(steps) + 0.5) / steps * edge, (np.arange(2 * steps) + 0.5) / steps * pi, indexing="ij"
    )
    third = np.cross(E, ACROSS)
    ring = np.cos(phi)[..., None] * ACROSS + np.sin(phi)[..., None] * third
    normals = np.sin(theta)[..., None] * ring + np.cos(theta)[..., None] * E
    to_satellite = r_m - EARTH_RADIUS_M * normals
    d = np.linalg.norm(to_satellite, axis=-1)
    out = (normals * to_satellite).sum(axis=-1) / d
    area = EARTH_RADIUS_M**2 * np.sin(theta) * (edge / steps) * (pi / steps)
    weight = 0.3 / pi * np.maximum(normals @ sun, 0.0) * out * area / d**2
    return -(weight[..., None] * to_satellite / d[..., None]).sum(axis=(0, 1))


def turn_deg(sun, light):
    """By how much the light turns a measured Sun."""
    seen = sun + light
    return np.degrees(np.arccos(min(1.0, seen @ sun / np.linalg.norm(seen))))


@pytest.mark.parametrize("altitude_km", [500.0, 800.0])
@pytest.mark.parametrize("zenith_deg", [0.0, 15.0, 40.0, 60.0, 80.0, 90.0, 110.0, 180.0])
def test_it_is_the_light_of_a_diffuse_earth(altitude_km, zenith_deg):
    r_m, sun = (EARTH_RADIUS_M + 1e3 * altitude_km) * E, sun_at(zenith_deg)
    found, expected = np.array(earthlight(tuple(r_m), tuple(sun), 0.3)), integral(r_m, sun)
    assert found == pytest.approx(expected, abs=0.02)
    assert turn_deg(sun, found) == pytest.approx(turn_deg(sun, expected), abs=0.6)


def test_by_hand_below_the_noon_sun():
    """At 800 km: 0.3 (6378 / 7178)^2 = 0.237, from below."""
    light = np.array(earthlight(tuple((EARTH_RADIUS_M + 800e3) * E), tuple(E), 0.3))
    assert light == pytest.approx(-0.23685 * E, rel=1e-3)


def test_it_turns_a_sun_high_in_the_sky_by_degrees():
    r_m = tuple((EARTH_RADIUS_M + 800e3) * E)
    turns = [
        turn_deg(sun_at(deg), np.array(earthlight(r_m, tuple(sun_at(deg)), 0.3))) for deg in range(0, 91, 5)
    ]
    assert max(turns) == pytest.approx(7.8, abs=0.1)


@pytest.mark.parametrize("zenith_deg", [91.0, 118.0, 180.0])
def test_no_light_where_the_sun_has_set(zenith_deg):
    assert not any(earthlight(tuple((EARTH_RADIUS_M + 800e3) * E), tuple(sun_at(zenith_deg)), 0.3))
