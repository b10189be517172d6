"""The physics of Sun cells: cosine, gain, turn, shading, threshold, the Earth's light and its clouds."""

from dataclasses import replace
from math import cos, exp, radians, sin, sqrt

import numpy as np
import pytest

from sim.plant.environment.orbit import EARTH_RADIUS_M
from sim.plant.hardware import sun_sensing
from sim.plant.hardware.sun_sensing import SunCellPhysics, earth_view
from sim.plant.rotation import from_vector, matrix
from sim.plant.sensor_config import CellConfig, SunCellsConfig

NORMALS = ((1.0, 0.0, 0.0), (0.0, 0.6, 0.8), (0.0, -1.0, 0.0))
CELLS = SunCellsConfig(tuple(CellConfig(normal) for normal in NORMALS))
BODY_FROM_ECI = matrix(from_vector((0.3, -0.7, 0.5)))
UP_BODY = (-0.48, 0.6, 0.64)


def sun_eci(sun_body):
    """The inertial direction that has these body components."""
    return tuple(np.array(BODY_FROM_ECI).T @ np.array(sun_body))


def measured(config, sun_body, lit=1.0, seed=1, times=1):
    physics = SunCellPhysics(config, seed)
    return [physics.measure(BODY_FROM_ECI, R_M, sun_eci(sun_body), lit) for _ in range(times)]


SUN = tuple(np.array((0.5, 0.7, 0.4)) / sqrt(0.9))
R_M = tuple((EARTH_RADIUS_M + 550e3) * np.array(sun_eci(UP_BODY)))


def test_a_cell_shows_the_cosine_and_nothing_from_behind():
    (currents,) = measured(CELLS, SUN)
    assert currents == pytest.approx([SUN[0], 0.6 * SUN[1] + 0.8 * SUN[2], 0.0])


@pytest.mark.parametrize("lit", [0.0, 0.4])
def test_it_dims_with_the_sun_s_disc(lit):
    full, dim = measured(CELLS, SUN)[0], measured(CELLS, SUN, lit)[0]
    assert dim == pytest.approx([lit * one for one in full])


def test_gain_and_turn_are_each_cell_s_own():
    turned = CellConfig(NORMALS[0], gain=0.9, turn_rad=(0.0, 0.0, radians(30.0)))
    config = replace(CELLS, cells=(turned, *CELLS.cells[1:]))
    (currents,) = measured(config, SUN)
    normal = (cos(radians(30.0)), sin(radians(30.0)), 0.0)
    assert currents[0] == pytest.approx(0.9 * np.dot(normal, SUN))
    assert currents[1:] == pytest.approx(measured(CELLS, SUN)[0][1:])


@pytest.mark.parametrize(("half_deg", "shaded"), [(20.0, True), (10.0, False)])
def test_the_satellite_takes_the_sun_from_a_cell_in_its_shade(half_deg, shaded):
    axis = tuple(np.array((SUN[0] + 0.27, SUN[1], SUN[2])) / np.linalg.norm((SUN[0] + 0.27, SUN[1], SUN[2])))
    off_deg = np.degrees(np.arccos(np.dot(axis, SUN)))
    assert 10.0 < off_deg < 20.0
    cell = replace(CELLS.cells[0], shades=((axis, cos(radians(half_deg))),))
    (currents,) = measured(replace(CELLS, cells=(cell, *CELLS.cells[1:])), SUN)
    assert bool(currents[0] == 0.0) is shaded
    assert currents[1] > 0.5


def test_a_small_current_reads_as_zero():
    low = (0.03, sqrt(1.0 - 0.03**2) * 0.8, -sqrt(1.0 - 0.03**2) * 0.6)
    assert measured(CELLS, low)[0][0] == pytest.approx(0.03)
    assert measured(replace(CELLS, threshold=0.04), low)[0][0] == 0.0


def test_currents_are_whole_quanta():
    fine = measured(replace(CELLS, noise=0.01), SUN)[0]
    coarse = measured(replace(CELLS, noise=0.01, quantum=0.125, threshold=0.0), SUN)[0]
    assert coarse == tuple(0.125 * round(max(0.0, one) / 0.125) for one in fine)
    assert coarse != fine


def test_the_earth_s_light_is_that_of_its_view_also_in_the_shade():
    (currents,) = measured(replace(CELLS, albedo=0.3), SUN)
    eci = np.array(NORMALS) @ np.array(BODY_FROM_ECI)
    light = 0.3 * earth_view(R_M, sun_eci(SUN), eci)
    assert light.max() > 0.02
    assert currents == pytest.approx(np.array(measured(CELLS, SUN)[0]) + light)


@pytest.mark.interpreted
def test_it_varies_over_the_clouds_as_a_markov_process(monkeypatch):
    monkeypatch.setattr(sun_sensing, "CLOUDS_S", 3.0)
    one = replace(CELLS, cells=CELLS.cells[1:2], albedo=0.3, albedo_spread=0.2)
    bare = measured(replace(one, albedo=0.0), SUN)[0][0]
    brightest = np.array(measured(one, SUN, times=4000))[:, 0] - bare
    part = brightest / brightest.mean() - 1.0
    assert part.std() == pytest.approx(0.2, rel=0.1)
    for lag in (1, 3, 6):
        found = np.corrcoef(part[:-lag], part[lag:])[0, 1]
        assert found == pytest.approx(exp(-lag / 3.0), abs=0.1)


def test_noise_is_each_sample_s_and_each_cell_s_own():
    seen = np.array(measured(replace(CELLS, noise=0.01), SUN, times=2000))[:, :2]
    np.testing.assert_allclose(seen.std(axis=0), 0.01, rtol=0.1)
    assert abs(np.corrcoef(seen.T)[0, 1]) < 0.1


def test_a_late_sample_is_that_of_before():
    physics = SunCellPhysics(replace(CELLS, latency_s=1.0), 1)
    first = physics.measure(BODY_FROM_ECI, R_M, sun_eci(SUN), 1.0)
    second = physics.measure(BODY_FROM_ECI, R_M, sun_eci((1.0, 0.0, 0.0)), 1.0)
    third = physics.measure(BODY_FROM_ECI, R_M, sun_eci((1.0, 0.0, 0.0)), 1.0)
    assert first == second
    assert third == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize("count", [0, 7])
def test_there_are_one_to_six(count):
    with pytest.raises(ValueError, match=f"{count} Sun cells: from 1 to 6"):
        SunCellsConfig((CELLS.cells[0],) * count)
