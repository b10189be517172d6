from datetime import datetime

import numpy as np
import pytest

from sim.plant.environment.sun import AU_M, illumination, sun_eci_m


@pytest.fixture(scope="module")
def sun(reference):
    return reference("earth_sun.csv")


@pytest.fixture(scope="module")
def eclipse(reference):
    return reference("eclipse.csv")


@pytest.fixture(scope="module")
def ours(sun):
    times = [datetime.fromisoformat(row["utc_iso"]).timestamp() for row in sun.rows]
    return np.concatenate([sun_eci_m(int(t), np.array([t % 1.0])) for t in times])


@pytest.mark.parametrize("frame", ["mod", "teme"])
def test_direction_is_good_to_the_almanac_formula(sun, ours, frame):
    reference = sun.columns(*(f"sun_{frame}_{axis}" for axis in "xyz"))
    direction = ours / np.linalg.norm(ours, axis=1)[:, None]
    assert np.linalg.norm(np.cross(direction, reference), axis=1).max() < 3e-4
    assert (direction * reference).sum(axis=1).min() > 0.0


def test_direction_is_of_date_not_of_j2000(sun, ours):
    j2000 = sun.columns("sun_geo_x", "sun_geo_y", "sun_geo_z")
    direction = ours / np.linalg.norm(ours, axis=1)[:, None]
    assert np.linalg.norm(np.cross(direction, j2000), axis=1).max() > 6e-3


def test_distance(sun, ours):
    assert np.linalg.norm(ours, axis=1) == pytest.approx(1e3 * sun.column("sun_dist_km"), rel=1e-4)


def test_illumination_against_the_reference(eclipse):
    lit = illumination(
        1e3 * eclipse.columns("sat_x_km", "sat_y_km", "sat_z_km"),
        1e3 * eclipse.columns("sun_x_km", "sun_y_km", "sun_z_km"),
    )
    assert np.abs(lit - eclipse.column("frac_planar")).max() < 1e-7
    assert np.abs(lit - eclipse.column("frac_exact")).max() < 5e-3
    for row, fraction in zip(eclipse.rows, lit, strict=True):
        assert {"sunlit": fraction == 1.0, "umbra": fraction == 0.0}.get(row["class"], 0.0 < fraction < 1.0)


def test_illumination_falls_steadily_into_the_shadow():
    angles = np.linspace(0.0, np.pi, 20001)
    r = 7.2e6 * np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    lit = illumination(r, np.broadcast_to([AU_M, 0.0, 0.0], r.shape))
    assert lit[0] == 1.0
    assert lit[-1] == 0.0
    assert (np.diff(lit) <= 1e-12).all()
    assert ((lit > 0.0) & (lit < 1.0)).sum() > 40
