"""The physics of coarse Sun cells: cosine, gain, shading, the Earth's light, noise, step, threshold."""

from math import exp, sqrt
from typing import final

import numpy as np

from sim.plant.environment.earth_view import earth_view
from sim.plant.hardware.sensors import Delay, quantise
from sim.plant.random_streams import Normals
from sim.plant.rotation import Mat3, Vec3, from_vector, matrix, transform
from sim.plant.sensor_config import CellConfig, SunCellsConfig

CLOUDS_S = 300.0
"""Time in which a satellite in low orbit comes over other clouds."""


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
        self._noise, self._clouds = Normals(seed, "sun_cells"), Normals(seed, "clouds")
        self._keep = exp(-1.0 / (CLOUDS_S * tick_hz))
        self._cloud = self._clouds.next()

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
            reflected = self._reflected()
            light = [light[k] + reflected * parts[k] for k in range(len(cells))]
        if self._delay is not None:
            light = list(self._delay.take(tuple(light)))
        return tuple([self._current(cells[k], light[k]) for k in range(len(cells))])

    def _reflected(self) -> float:
        """The fraction of the light that the Earth in view reflects now."""
        keep, config = self._keep, self._config
        self._cloud = keep * self._cloud + sqrt(1.0 - keep * keep) * self._clouds.next()
        return config.albedo * min(max(0.0, 1.0 + config.albedo_spread * self._cloud), 2.0)

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
