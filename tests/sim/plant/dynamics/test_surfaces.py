"""Air and light on plates, against their equations in vectors, and in cases that can be told without."""

import numpy as np
import pytest

from sim.plant.config import BodyConfig, PlateConfig
from sim.plant.dynamics import surfaces
from sim.plant.rotation import ZERO

P = 4.54e-6


def unit(*v):
    return tuple((np.array(v) / np.linalg.norm(v)).tolist())


PLATES = (
    PlateConfig(0.30, unit(1.0, 0.2, -0.1), (0.21, 0.03, -0.02), 2.2, 0.3, 0.2),
    PlateConfig(0.12, unit(-0.3, 1.0, 0.4), (-0.05, 0.31, 0.04), 2.5, 0.0, 0.7),
    PlateConfig(0.45, unit(0.2, -0.5, 1.0), (0.06, -0.02, 0.4), 1.9, 0.8, 0.1),
    PlateConfig(0.08, unit(-1.0, -0.4, 0.3), (-0.3, -0.1, 0.05), 2.1, 0.0, 0.0),
)


def drag_by_vectors(plates, v, density):
    """A force on each plate, each with its own arm."""
    speed = np.linalg.norm(v)
    torque = np.zeros(3)
    for plate in plates:
        cosine = max(np.dot(plate.normal_body, v) / speed, 0.0)
        force = -0.5 * density * speed**2 * plate.drag_coefficient * plate.area_m2 * cosine * (v / speed)
        torque += np.cross(plate.centre_body_m, force)
    return torque


def light_by_photons(plates, sun, pressure):
    """Momentum of what comes in less that of what goes out: mirrored, scattered by Lambert's law (2/3)."""
    torque = np.zeros(3)
    for plate in plates:
        n = np.array(plate.normal_body)
        cosine = n @ sun
        if cosine <= 0.0:
            continue
        power = pressure * plate.area_m2 * cosine
        arriving = -np.array(sun)
        mirrored = arriving + 2.0 * cosine * n
        force = power * (arriving - plate.specular * mirrored)
        force += power * plate.diffuse * (-2.0 / 3.0) * n
        torque += np.cross(plate.centre_body_m, force)
    return torque


DIRECTIONS = [unit(*v) for v in np.random.default_rng(1).standard_normal((30, 3))]


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_drag_against_vectors(direction):
    v = 7430.0 * np.array(direction)
    assert surfaces.drag(PLATES, tuple(v), 3.2e-12) == pytest.approx(
        drag_by_vectors(PLATES, v, 3.2e-12), rel=1e-12, abs=1e-20
    )


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_light_against_its_momentum(direction):
    assert surfaces.solar_pressure(PLATES, direction, P) == pytest.approx(
        light_by_photons(PLATES, np.array(direction), P), rel=1e-12, abs=1e-22
    )


def test_drag_pushes_a_plate_back_along_the_flow():
    """A plate ahead on axis 2, hung out along +3: the push is along -2, so the torque is about +1."""
    plate = PlateConfig(0.5, (0.0, 1.0, 0.0), (0.0, 0.0, 0.4), 2.2)
    torque = surfaces.drag([plate], (0.0, 7500.0, 0.0), 1e-12)
    assert torque == pytest.approx((0.4 * 0.5 * 1e-12 * 2.2 * 0.5 * 7500.0**2, 0.0, 0.0))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_centre_of_pressure_behind_the_mass_centre_steadies_as_feathers_do(sign):
    """Nose (axis 2) turned from the flow: the torque turns it back; with the pressure ahead, further away."""
    tail = [PlateConfig(0.3, n, (0.0, -0.5, 0.0)) for n in ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))]
    nose = [PlateConfig(0.3, n, (0.0, 0.5, 0.0)) for n in ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))]
    flow = (7500.0 * np.sin(sign * 0.1), 7500.0 * np.cos(0.1), 0.0)  # nose to flow: a turn about sign * -3
    assert sign * surfaces.drag(tail, flow, 1e-12)[2] < 0.0
    assert sign * surfaces.drag(nose, flow, 1e-12)[2] > 0.0


def test_light_presses_a_black_plate_away_from_the_sun_and_a_mirror_twice_as_much():
    black, mirror = (PlateConfig(0.5, (1.0, 0.0, 0.0), (0.0, 0.2, 0.0), 2.2, s) for s in (0.0, 1.0))
    assert surfaces.solar_pressure([black], (1.0, 0.0, 0.0), P) == pytest.approx((0.0, 0.0, 0.2 * 0.5 * P))
    assert surfaces.solar_pressure([mirror], (1.0, 0.0, 0.0), P) == pytest.approx((0.0, 0.0, 0.2 * P))


def test_a_mirror_is_pushed_along_its_normal_alone():
    mirror = PlateConfig(0.5, unit(1.0, 2.0, 3.0), unit(1.0, 2.0, 3.0), 2.2, 1.0)
    assert surfaces.solar_pressure([mirror], unit(1.0, 1.0, 0.0), P) == pytest.approx(ZERO, abs=1e-20)


def test_the_back_of_a_plate_feels_nothing():
    plate = PlateConfig(0.5, (1.0, 0.0, 0.0), (0.1, 0.2, 0.3), 2.2, 0.5, 0.2)
    for away in ((-1.0, 0.0, 0.0), (-0.1, 0.995, 0.0), (0.0, 1.0, 0.0)):
        assert surfaces.drag([plate], tuple(7500.0 * part for part in away), 1e-12) == ZERO
        assert surfaces.solar_pressure([plate], away, P) == ZERO


def test_without_air_light_or_plates_there_is_no_torque():
    assert surfaces.drag(PLATES, (7000.0, 100.0, 50.0), 0.0) == pytest.approx(ZERO, abs=0.0)
    assert surfaces.solar_pressure(PLATES, unit(1.0, 1.0, 1.0), 0.0) == ZERO
    assert surfaces.drag((), (7000.0, 100.0, 50.0), 1e-12) == pytest.approx(ZERO, abs=0.0)
    assert surfaces.solar_pressure((), unit(1.0, 1.0, 1.0), P) == ZERO


def test_a_box_is_turned_by_the_shift_of_its_mass_centre_alone():
    """Area times half the depth is the same for all its sides: what they give about its middle cancels."""
    size, shift = np.array([0.1, 0.2, 0.3]), np.array([0.01, -0.02, 0.015])
    signs_and_axes = [(sign, axis) for axis in range(3) for sign in (-1.0, 1.0)]

    def box(mass_centre):
        for sign, axis in signs_and_axes:
            normal = sign * np.eye(3)[axis]
            centre = 0.5 * size[axis] * normal - mass_centre
            yield PlateConfig(np.prod(size) / size[axis], tuple(normal), tuple(centre), 2.2, 0.4, 0.3)

    for direction in DIRECTIONS:
        flow = tuple(7500.0 * part for part in direction)
        assert surfaces.drag(list(box(np.zeros(3))), flow, 1e-12) == pytest.approx(ZERO, abs=1e-20)
        assert surfaces.solar_pressure(list(box(np.zeros(3))), direction, P) == pytest.approx(ZERO, abs=1e-22)
        seen_m2 = np.prod(size) * np.sum(np.abs(direction) / size)
        force = -0.5e-12 * 7500.0**2 * 2.2 * seen_m2 * np.array(direction)
        assert surfaces.drag(list(box(shift)), flow, 1e-12) == pytest.approx(
            np.cross(-shift, force), abs=1e-18
        )


@pytest.mark.parametrize(
    ("parts", "match"),
    [
        ({"area_m2": 0.0}, "area_m2"),
        ({"normal_body": (1.0, 1.0, 0.0)}, "unit length"),
        ({"drag_coefficient": -0.1}, "drag_coefficient"),
        ({"specular": 0.7, "diffuse": 0.4}, "specular and diffuse"),
        ({"specular": -0.1}, "specular and diffuse"),
    ],
)
def test_a_plate_that_cannot_be_is_refused(parts, match):
    with pytest.raises(ValueError, match=match):
        PlateConfig(**{"area_m2": 0.5, "normal_body": (1.0, 0.0, 0.0)} | parts)


def test_plates_belong_to_a_body():
    assert BodyConfig(((1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)), plates=PLATES).plates == PLATES
