"""How the satellite sees the Sun: a Sun sensor or Sun cells, each with its board."""

from math import exp, pi, sqrt
from typing import final

import numpy as np

from fsw.wire.frame import Frame
from hil_stub.sensors.sun_cells import SunCellBoard
from hil_stub.sensors.sun_sensor import SunSensor
from sim.plant.config import PlantConfig
from sim.plant.environment.orbit import EARTH_RADIUS_M, Array
from sim.plant.hardware.sensors import Delay, SunSensorPhysics, quantise
from sim.plant.interference import Interference
from sim.plant.random_streams import Normals
from sim.plant.rotation import ZERO, Mat3, Vec3, from_vector, matrix, transform
from sim.plant.sensor_config import CellConfig, SunCellsConfig, SunSensorConfig

# --- The Earth's light on small plates, by integration over the part of the Earth that is in view

RINGS, SECTORS = 8, 12
"""Patches of equal solid angle: within 0.01 of the integral, for plates in any attitude."""

_ANGLES = 2.0 * np.pi * (np.arange(SECTORS) + 0.5) / SECTORS
_COSINES, _SINES = np.tile(np.cos(_ANGLES), RINGS), np.tile(np.sin(_ANGLES), RINGS)
_PLACES = np.repeat((np.arange(RINGS) + 0.5) / RINGS, SECTORS)


def earth_view(r_eci_m: Vec3, sun_eci: Vec3, normals_eci: Array) -> Array:
    """Light of a diffuse Earth that reflects all, relative to the Sun's, on plates with these normals, (n,).

    The sum over patches of the solid angle, in the direction d, of max(0, p . s) max(0, n . d) / pi, p being
    the vertical there: each part of the Earth is as bright as the sine of the Sun's elevation there.

    Args:
        r_eci_m: position of the satellite.
        sun_eci: unit vector s to the Sun.
        normals_eci: outward unit normals n, (n, 3).
    """
    r = np.array(r_eci_m)
    distance_m = sqrt(r @ r)
    up, s = r / distance_m, np.array(sun_eci)
    ratio = EARTH_RADIUS_M / distance_m
    edge = sqrt(1.0 - ratio * ratio)
    if up @ s <= -edge:  # the Sun has set on all of the Earth in view
        return np.zeros(len(normals_eci))
    across, third = _horizontal(up.tolist())
    down = 1.0 - (1.0 - edge) * _PLACES
    aside = np.sqrt(1.0 - down * down)
    towards = np.outer(aside * _COSINES, across) + np.outer(aside * _SINES, third) - np.outer(down, up)
    reach = down / ratio - np.sqrt(np.maximum(0.0, 1.0 - (aside / ratio) ** 2))
    verticals = up / ratio + reach[:, None] * towards
    solid = 2.0 * pi * (1.0 - edge) / len(down)
    bright = np.maximum(0.0, verticals @ s) * (solid / pi)
    light: Array = bright @ np.maximum(0.0, towards @ normals_eci.T)
    return light


def _horizontal(up: list[float]) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to ``up`` and to each other."""
    x, y, z = up
    if abs(x) < 0.7:
        size = sqrt(y * y + z * z)
        across = (0.0, z / size, -y / size)
    else:
        size = sqrt(x * x + z * z)
        across = (-z / size, 0.0, x / size)
    a, b, c = across
    return np.array(across), np.array((y * c - z * b, z * a - x * c, x * b - y * a))


# --- The physics of coarse Sun cells: cosine, gain, shading, the Earth's light, noise, step, threshold

CLOUDS_S = 300.0
"""Time in which a satellite in low orbit comes over other clouds."""


@final
class CloudyEarth:
    """The light that the Earth reflects, which varies over the clouds: a first-order Markov process.

    Args:
        albedo: its mean, a fraction of sunlight.
        spread: its standard deviation, as a fraction of the mean.
        seed: of the stream ``clouds``.
        tick_hz: steps a second.
    """

    def __init__(self, albedo: float, spread: float, seed: int, tick_hz: int) -> None:
        self._albedo = albedo
        self._spread = spread
        self._clouds = Normals(seed, "clouds")
        self._keep = exp(-1.0 / (CLOUDS_S * tick_hz))
        self._cloud = self._clouds.next()

    def reflected(self) -> float:
        """The fraction of sunlight that the Earth in view reflects, a step later."""
        keep = self._keep
        self._cloud = keep * self._cloud + sqrt(1.0 - keep * keep) * self._clouds.next()
        return self._albedo * min(max(0.0, 1.0 + self._spread * self._cloud), 2.0)


@final
class SunCellPhysics:
    """c = g (lit max(0, n . s) + A light(n)) + noise, then quantised, and 0 below the threshold.

    n is the true normal, s the Sun, A the fraction of the light that the Earth reflects, which varies over
    the clouds as a first-order Markov process of time constant ``CLOUDS_S``; light(n) is ``earth_view``. A
    cell shaded by the satellite itself gets only the Earth's light. The light is that of ``latency_s`` ago.

    Args:
        config: the cells.
        seed: of the streams ``sun_cells`` and ``clouds``.
        tick_hz: samples a second.
    """

    def __init__(self, config: SunCellsConfig, seed: int, tick_hz: int = 1) -> None:
        self._config = config
        self._delay = Delay(config.latency_s, tick_hz) if config.latency_s else None
        self._normals = [_turned(cell.normal_body, cell.turn_rad) for cell in config.cells]
        self._noise = Normals(seed, "sun_cells")
        self._earth = CloudyEarth(config.albedo, config.albedo_spread, seed, tick_hz)

    def measure(self, body_from_eci: Mat3, r_eci_m: Vec3, sun_eci: Vec3, lit: float) -> tuple[float, ...]:
        """The current of each cell, relative to the nominal one in full sunlight.

        Args:
            body_from_eci: rows of the true attitude's matrix.
            r_eci_m: position.
            sun_eci: unit vector to the Sun.
            lit: visible fraction of the Sun's disc.
        """
        config, sun_body = self._config, transform(body_from_eci, sun_eci)
        cells, normals = config.cells, self._normals
        light = [lit * _cosine(cells[k], normals[k], sun_body) for k in range(len(cells))]
        if config.albedo:
            parts = earth_view(r_eci_m, sun_eci, np.array(normals) @ np.array(body_from_eci)).tolist()
            reflected = self._earth.reflected()
            light = [light[k] + reflected * parts[k] for k in range(len(cells))]
        if self._delay is not None:
            light = list(self._delay.take(tuple(light)))
        return tuple([self._current(cells[k], light[k]) for k in range(len(cells))])

    def _current(self, cell: CellConfig, light: float) -> float:
        current = cell.gain * light + self._config.noise * self._noise.next()
        current = quantise(current, self._config.quantum)
        return current if current >= self._config.threshold else 0.0


def _cosine(cell: CellConfig, normal: Vec3, sun_body: Vec3) -> float:
    """Of the Sun's incidence; 0 from behind and in the shade."""
    (x, y, z), (nx, ny, nz) = sun_body, normal
    for (ax, ay, az), cosine in cell.shades:
        if ax * x + ay * y + az * z > cosine:
            return 0.0
    return max(0.0, nx * x + ny * y + nz * z)


def _turned(normal: Vec3, turn_rad: Vec3) -> Vec3:
    """A direction after a turn; the transpose turns the direction, not the axes."""
    x, y, z = turn_rad
    return transform(matrix(from_vector((-x, -y, -z))), normal)


# --- Sunlight that the Earth reflects, at the satellite


def earthlight(r_eci_m: Vec3, sun_eci: Vec3, albedo: float) -> Vec3:
    """Vector a = -A (R / r)^2 max(0, e . s) e, e = r / |r|: Earth's light relative to the Sun's, ``eci``.

    The vector of irradiance, towards its source: a plate with the normal n that sees all of the Earth gets
    the fraction n . a of what it would get if it faced the Sun. (R / r)^2 is the view factor of the Earth
    from a plate that faces it; the illumination of all of the Earth in view is taken as that below the
    satellite. There is none if the Sun has set there, hence none in eclipse.

    The integral over a diffuse Earth, computed in its test, is within 0.02 of it, and deflects a measured Sun
    direction by at most 0.6 deg more, between 500 and 800 km. A diffuse Earth is also the model of Flatley
    and Moore 1994 (NASA TM-104596). With measured reflectivity it depends on the place as well (Bhanderi and
    Bak 2005, Modeling Earth Albedo for Satellites in Earth Orbit).

    Args:
        r_eci_m: position of the satellite.
        sun_eci: unit vector s to the Sun.
        albedo: A, the fraction of sunlight that the Earth reflects.
    """
    (x, y, z), (sx, sy, sz) = r_eci_m, sun_eci
    r2_m2 = x * x + y * y + z * z
    towards_m = max(0.0, x * sx + y * sy + z * sz)
    factor = -albedo * EARTH_RADIUS_M**2 * towards_m / (r2_m2 * r2_m2)
    return (factor * x, factor * y, factor * z)


# --- What the satellite senses of the Sun


@final
class SunView:
    """What there is to see at one instant: attitude, place, unit vectors to the Sun, its visible fraction."""

    __slots__ = ("body_from_eci", "lit", "r_eci_m", "sun_body", "sun_eci")

    def __init__(self, body_from_eci: Mat3, r_eci_m: Vec3, sun_eci: Vec3, sun_body: Vec3, lit: float) -> None:
        self.body_from_eci = body_from_eci
        self.r_eci_m = r_eci_m
        self.sun_eci = sun_eci
        self.sun_body = sun_body
        self.lit = lit


class SunSensing:
    """A sensor and its board."""

    def begin_tick(self, tick: int, view: SunView, faulty: Interference) -> list[Frame]:
        """The frames that the board sends in this tick."""
        raise NotImplementedError

    def restart(self) -> None:
        """Power-cycle the board."""
        raise NotImplementedError


@final
class FineSunSensing(SunSensing):
    """The Sun sensor."""

    def __init__(self, sensor: SunSensorConfig, seed: int, tick_hz: int) -> None:
        self._physics = SunSensorPhysics(sensor, seed, tick_hz)
        self._tick_hz = tick_hz
        self._earth: CloudyEarth | None = None
        if sensor.albedo:
            self._earth = CloudyEarth(sensor.albedo, sensor.albedo_spread, seed, tick_hz)
        self.restart()

    def begin_tick(self, tick: int, view: SunView, faulty: Interference) -> list[Frame]:
        """``SUN_VECTOR``, deflected by the Earth's light if that disturbs the sensor."""
        around = ZERO
        if self._earth is not None:
            light_eci = earthlight(view.r_eci_m, view.sun_eci, self._earth.reflected())
            around = transform(view.body_from_eci, light_eci)
        sun_body, valid = self._physics.measure(view.sun_body, view.lit, around)
        sun_body, valid = faulty.sun(sun_body, valid)
        return self._board.begin_tick(tick, sun_body, valid)

    def restart(self) -> None:
        """Power-cycle the board."""
        self._board = SunSensor(self._tick_hz)


@final
class CellSensing(SunSensing):
    """Sun cells."""

    def __init__(self, cells: SunCellsConfig, seed: int, tick_hz: int) -> None:
        self._physics = SunCellPhysics(cells, seed, tick_hz)
        self._tick_hz = tick_hz
        self.restart()

    def begin_tick(self, tick: int, view: SunView, faulty: Interference) -> list[Frame]:
        """``SUN_CELLS``."""
        currents = self._physics.measure(view.body_from_eci, view.r_eci_m, view.sun_eci, view.lit)
        return self._board.begin_tick(tick, faulty.cells(currents), True)

    def restart(self) -> None:
        """Power-cycle the board."""
        self._board = SunCellBoard(self._tick_hz)


def make_sun_sensing(config: PlantConfig) -> SunSensing:
    """The configured sensor or cells."""
    given, seed, tick_hz = config.sun_sensor, config.seed, config.tick_hz
    if isinstance(given, SunCellsConfig):
        return CellSensing(given, seed, tick_hz)
    return FineSunSensing(given, seed, tick_hz)
