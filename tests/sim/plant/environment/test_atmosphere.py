from itertools import pairwise

import numpy as np
import pytest

from sim.plant.environment.atmosphere import _LAYERS, EARTH_RATE_RADPS, altitude_m, density_kgpm3, flow_mps
from sim.plant.environment.earth import gmst82_rad

EPOCH = 1_427_424_417


def geodetic_altitude_m(r_m):
    """Bowring's iteration on the ellipsoid of WGS-84, one point."""
    a, f = 6378137.0, 1.0 / 298.257223563
    e2 = f * (2.0 - f)
    p, z = np.hypot(r_m[0], r_m[1]), r_m[2]
    latitude = np.arctan2(z, p * (1.0 - e2))
    for _ in range(20):
        n = a / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
        latitude = np.arctan2(z + e2 * n * np.sin(latitude), p)
    n = a / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
    return p * np.cos(latitude) + z * np.sin(latitude) - a * a / n


def test_altitude_is_over_the_ellipsoid_to_first_order():
    angles = np.linspace(-np.pi / 2, np.pi / 2, 91)
    r = 7.0e6 * np.stack([np.cos(angles) * 0.6, np.cos(angles) * 0.8, np.sin(angles)], axis=1)
    exact = [geodetic_altitude_m(point) for point in r]
    assert np.abs(altitude_m(r) - exact).max() < 100.0
    assert altitude_m(r)[0] - altitude_m(r)[45] == pytest.approx(21385.0, abs=100.0)


@pytest.mark.parametrize(
    ("height_km", "density"),
    [
        (150, 2.070e-9),
        (200, 2.789e-10),
        (400, 3.725e-12),
        (500, 6.967e-13),
        (800, 1.170e-14),
        (1000, 3.019e-15),
    ],
)
def test_density_at_the_feet_of_layers(height_km, density):
    assert density_kgpm3(np.array([1e3 * height_km]))[0] == pytest.approx(density, rel=1e-12)


def test_layers_meet():
    """A slip of the pen in a base density or a scale height would tear them apart."""
    for (h0, rho0, scale), (h1, rho1, _) in pairwise(_LAYERS):
        assert rho0 * np.exp((h0 - h1) / scale) == pytest.approx(rho1, rel=2e-3)


def test_density_falls_with_height_and_is_none_far_out():
    heights = np.linspace(120e3, 36_000e3, 20_001)
    density = density_kgpm3(heights)
    assert (np.diff(density) < 0.0).all()
    assert density[0] < 1e-8
    assert density[-1] < 1e-50
    assert density_kgpm3(np.array([450e3]))[0] == pytest.approx(1.585e-12)


def test_air_turns_with_the_earth():
    """A point that turns with the Earth meets no wind; eastward over the equator the air runs along."""
    r = np.array([[4.1e6, -5.2e6, 2.3e6], [0.0, 0.0, 7e6], [7e6, 0.0, 0.0]])
    turning = np.cross([0.0, 0.0, EARTH_RATE_RADPS], r)
    assert flow_mps(r, turning) == pytest.approx(np.zeros((3, 3)), abs=1e-9)
    v = np.array([[0.0, 7.5e3, 0.0]] * 3)
    assert flow_mps(r, v)[1] == pytest.approx((0.0, 7.5e3, 0.0))
    assert flow_mps(r, v)[2] == pytest.approx((0.0, 7.5e3 - 7e6 * EARTH_RATE_RADPS, 0.0))


def test_rate_of_the_air_is_that_of_sidereal_time():
    turned = np.diff(gmst82_rad(EPOCH, np.array([0.0, 600.0])))[0]
    assert turned / 600.0 == pytest.approx(EARTH_RATE_RADPS, rel=1e-6)
