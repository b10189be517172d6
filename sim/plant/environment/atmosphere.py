"""The upper atmosphere: density, and the velocity relative to the air, for many points at once."""

import numpy as np

from sim.plant.environment.orbit import EARTH_RADIUS_M, Array

EARTH_RATE_RADPS = 7.2921159e-5
FLATTENING = 1.0 / 298.257223563

_LAYERS = np.array(
    [
        (150.0, 2.070e-9, 22.523),
        (180.0, 5.464e-10, 29.740),
        (200.0, 2.789e-10, 37.105),
        (250.0, 7.248e-11, 45.546),
        (300.0, 2.418e-11, 53.628),
        (350.0, 9.518e-12, 53.298),
        (400.0, 3.725e-12, 58.515),
        (450.0, 1.585e-12, 60.828),
        (500.0, 6.967e-13, 63.822),
        (600.0, 1.454e-13, 71.835),
        (700.0, 3.614e-14, 88.667),
        (800.0, 1.170e-14, 124.64),
        (900.0, 5.245e-15, 181.05),
        (1000.0, 3.019e-15, 268.00),
    ]
)
"""Base altitude [km], density there [kg/m^3], scale height [km]."""


def altitude_m(r_m: Array) -> Array:
    """Height above the ellipsoid, h = r - a (1 - f sin^2 phi), to first order in f: within 100 m, (n,).

    Args:
        r_m: geocentric positions, axis 3 along the pole, (n, 3).
    """
    r_norm_m = np.linalg.norm(r_m, axis=1)
    sine = r_m[:, 2] / r_norm_m
    height_m: Array = r_norm_m - EARTH_RADIUS_M * (1.0 - FLATTENING * sine * sine)
    return height_m


def density_kgpm3(height_m: Array) -> Array:
    """Static exponential atmosphere: rho = rho_0 exp(-(h - h_0) / H) in layers (Vallado 2013, table 8-4).

    Mean solar activity. The lowest layer is extended below 150 km, the highest above 1000 km.

    Args:
        height_m: above the ellipsoid, (n,).
    """
    height_km = 1e-3 * height_m
    base_km, density, scale_km = _LAYERS[np.searchsorted(_LAYERS[1:, 0], height_km, side="right")].T
    rho: Array = density * np.exp((base_km - height_km) / scale_km)
    return rho


def flow_mps(r_m: Array, v_mps: Array) -> Array:
    """Velocity relative to an atmosphere that turns with the Earth: v - w_E x r, (n, 3).

    Args:
        r_m: positions, frame ``eci``, (n, 3).
        v_mps: velocities, (n, 3).
    """
    return v_mps - EARTH_RATE_RADPS * np.stack([-r_m[:, 1], r_m[:, 0], np.zeros(len(r_m))], axis=1)
