"""The Earth's light on plates against a finer integral over its surface."""

from math import acos, pi

import numpy as np
import pytest

from sim.plant.environment.orbit import EARTH_RADIUS_M as R
from sim.plant.hardware.sun_sensing import earth_view


def over_the_surface(r_m, sun, normals, steps=90):
    """Sum over patches of the ground in view: 1 / pi cos(in) cos(out) dA / d^2 on each plate."""
    distance = np.linalg.norm(r_m)
    up = r_m / distance
    first = np.cross(up, [0.3, -0.5, 0.8])
    first /= np.linalg.norm(first)
    edge = acos(R / distance)
    theta, phi = np.meshgrid(
        (np.arange(steps) + 0.5) / steps * edge, (np.arange(2 * steps) + 0.5) / steps * pi, indexing="ij"
    )
    ring = np.cos(phi)[..., None] * first + np.sin(phi)[..., None] * np.cross(up, first)
    ground = np.sin(theta)[..., None] * ring + np.cos(theta)[..., None] * up
    to_satellite = r_m - R * ground
    d = np.linalg.norm(to_satellite, axis=-1)
    out = (ground * to_satellite).sum(axis=-1) / d
    area = R**2 * np.sin(theta) * (edge / steps) * (pi / steps)
    weight = np.maximum(ground @ sun, 0.0) * out * area / (pi * d**2)
    towards = -to_satellite / d[..., None]
    return np.array([(weight * np.maximum(towards @ normal, 0.0)).sum() for normal in normals])


def test_it_is_the_light_of_a_diffuse_earth_on_plates_in_any_attitude():
    random = np.random.default_rng(5)
    for _ in range(25):
        up, sun, *plates = (v / np.linalg.norm(v) for v in random.normal(size=(8, 3)))
        r_m = (R + random.uniform(400e3, 1000e3)) * up
        found = earth_view(tuple(r_m), tuple(sun), np.array(plates))
        assert found == pytest.approx(over_the_surface(r_m, sun, plates), abs=0.005)


def test_by_hand_below_the_noon_sun():
    """A plate that faces a lit Earth gets nearly its view factor, (R / r)^2; one that looks away nothing."""
    up = np.array([2.0, -3.0, 6.0]) / 7.0
    r_m = (R + 550e3) * up
    down, away = earth_view(tuple(r_m), tuple(up), np.array([-up, up]))
    assert 0.9 * (R / (R + 550e3)) ** 2 < down < (R / (R + 550e3)) ** 2
    assert away == 0.0


def test_none_where_the_sun_has_set_on_all_that_is_in_view():
    up, sun = np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.0, -0.8])
    assert not earth_view(tuple((R + 550e3) * up), tuple(sun), np.eye(3)).any()


@pytest.mark.parametrize("up", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)])
def test_along_an_axis_too(up):
    light = earth_view(tuple((R + 550e3) * part for part in up), up, -np.array([up]))
    assert light[0] == pytest.approx(0.83, abs=0.02)
