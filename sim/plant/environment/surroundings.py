"""The environment along the orbit, independent of attitude: computed in advance, read as plain floats.

Orbit, field and Sun are computed at nodes, many at once, and interpolated to every instant that the
integration or the sensors need. All instants lie on one grid of integers, so no time is ever accumulated.
"""

from typing import Final, final

import numpy as np

from fsw.wire.value import Value
from sim.plant.config import DisturbanceConfig, PlantConfig
from sim.plant.environment.atmosphere import altitude_m, density_kgpm3, flow_mps
from sim.plant.environment.field import make_field
from sim.plant.environment.orbit import MU_M3PS2, Array, make_orbit
from sim.plant.environment.sun import AU_M, illumination, sun_eci_m
from sim.plant.errors import PlantError
from sim.plant.rotation import ZERO, Mat3, Vec3

NODE_S = 10
"""Seconds between nodes."""

LIGHT_MPS = 299792458.0

_BEFORE, _AFTER = 2, 3
"""Nodes that the interpolation uses before and after an instant."""

_SUBSTEPS_A_BLOCK = 320
"""About how many integration steps are computed ahead at once."""


@final
class Exposure(Value):
    """Air and light at one instant.

    Args:
        flow_eci_mps: velocity relative to the air.
        density_kgpm3: of the air.
        sun_eci: unit vector from the satellite to the Sun.
        sunlight_pa: pressure of the light on a black plate that faces the Sun.
    """

    FIELDS = ("flow_eci_mps", "density_kgpm3", "sun_eci", "sunlight_pa")
    __slots__ = FIELDS

    def __init__(self, flow_eci_mps: Vec3, density_kgpm3: float, sun_eci: Vec3, sunlight_pa: float) -> None:
        self.flow_eci_mps = flow_eci_mps
        self.density_kgpm3 = density_kgpm3
        self.sun_eci = sun_eci
        self.sunlight_pa = sunlight_pa


VACUUM: Final = Exposure(ZERO, 0.0, ZERO, 0.0)


@final
class Surroundings(Value):
    """The quantities that the torques need at one instant.

    Args:
        e_eci: unit vector of the radius.
        gradient_ps2: 3 mu / r^3.
        b_eci_t: field.
        exposure: only if drag or solar pressure is configured.
    """

    FIELDS = ("e_eci", "gradient_ps2", "b_eci_t", "exposure")
    __slots__ = FIELDS

    def __init__(self, e_eci: Vec3, gradient_ps2: float, b_eci_t: Vec3, exposure: Exposure = VACUUM) -> None:
        self.e_eci = e_eci
        self.gradient_ps2 = gradient_ps2
        self.b_eci_t = b_eci_t
        self.exposure = exposure


@final
class Sample(Value):
    """The quantities that sensors and truth need at one tick.

    Args:
        r_eci_m: position.
        orbit_from_eci: rows: radius, along-track, normal.
        orbit_rate_radps: rate |r x v| / r^2 of the orbital frame, about its axis 3.
        b_eci_t: field.
        sun_eci: unit vector from the satellite to the Sun.
        lit: visible fraction of the Sun's disc.
        v_eci_mps: velocity.
    """

    FIELDS = ("r_eci_m", "orbit_from_eci", "orbit_rate_radps", "b_eci_t", "sun_eci", "lit", "v_eci_mps")
    __slots__ = FIELDS

    def __init__(
        self,
        r_eci_m: Vec3,
        orbit_from_eci: Mat3,
        orbit_rate_radps: float,
        b_eci_t: Vec3,
        sun_eci: Vec3,
        lit: float,
        v_eci_mps: Vec3,
    ) -> None:
        self.r_eci_m = r_eci_m
        self.orbit_from_eci = orbit_from_eci
        self.orbit_rate_radps = orbit_rate_radps
        self.b_eci_t = b_eci_t
        self.sun_eci = sun_eci
        self.lit = lit
        self.v_eci_mps = v_eci_mps


class Environment:
    """Surroundings at every half step of the integration, samples at every tick.

    Nodes every 10 s, Lagrange interpolation over six of them: below 1e-4 nT and 1e-5 m from the models
    themselves. The orbital frame turns about its normal alone: the rotation of the orbital plane (4e-7 rad/s
    at most for 800 km) is left out of its rate.

    Args:
        config: the plant.
        substeps: integration steps a tick.
    """

    def __init__(self, config: PlantConfig, substeps: int) -> None:
        self._orbit = make_orbit(config.orbit, config.epoch_unix_s)
        self._field = make_field(config.field, config.epoch_unix_s)
        self._epoch_unix_s = config.epoch_unix_s
        self._disturbance = config.disturbance
        self._stages_per_tick = 2 * substeps
        ticks_per_node = NODE_S * config.tick_hz
        self._nodes_per_block = max(1, _SUBSTEPS_A_BLOCK // (ticks_per_node * substeps))
        self._ticks_per_block = self._nodes_per_block * ticks_per_node
        self._weights = _lagrange_weights(ticks_per_node * self._stages_per_tick)
        self._block: int | None = None
        self._stages: list[Surroundings] = []
        self._samples: list[Sample] = []

    def stages(self, tick: int) -> list[Surroundings]:
        """Start, middle, end of each substep of a tick, in time: 2 substeps + 1 of them."""
        offset = self._enter(tick) * self._stages_per_tick
        return self._stages[offset : offset + self._stages_per_tick + 1]

    def start(self, tick: int) -> Surroundings:
        """The first of them: the surroundings at the instant of the tick."""
        place = self._enter(tick)
        return self._stages[place * self._stages_per_tick]

    def sample(self, tick: int) -> Sample:
        """The sample at a tick."""
        place = self._enter(tick)
        return self._samples[place]

    def _enter(self, tick: int) -> int:
        """Compute the block of the tick if needed; return the tick's place in it."""
        block, place = divmod(tick, self._ticks_per_block)
        if block != self._block:
            self._compute(block)
            self._block = block
        return place

    def _compute(self, block: int) -> None:
        count = self._nodes_per_block
        first = block * count
        t_s = NODE_S * np.arange(first - _BEFORE, first + count + _AFTER, dtype=np.float64)
        try:
            r_m, v_mps = self._orbit.at(t_s)
            b_t = self._field.at(t_s, r_m)
        except ValueError as error:
            raise PlantError(str(error)) from None
        nodes = np.hstack([r_m, v_mps, b_t, sun_eci_m(self._epoch_unix_s, t_s)])
        inner = sum(
            weight[:, None] * nodes[place : place + count, None, :]
            for place, weight in enumerate(self._weights)
        )
        rows = np.vstack([np.reshape(inner, (-1, nodes.shape[1])), nodes[_BEFORE + count]])
        self._stages = _surroundings(rows, _exposures(rows, self._disturbance))
        self._samples = _samples(rows[:: self._stages_per_tick])


def _lagrange_weights(steps: int) -> Array:
    """Weights of each node of the window at x = 0, 1/steps, ... < 1, shape (nodes, steps).

    The k-th is the product over j != k of (x - x_j) / (x_k - x_j), nodes at x = -2, ..., 3.
    """
    x = np.arange(steps) / steps
    places = np.arange(-_BEFORE, _AFTER + 1)
    return np.array([np.prod([(x - j) / (k - j) for j in places if j != k], axis=0) for k in places])


def _surroundings(rows: Array, exposures: list[Exposure]) -> list[Surroundings]:
    r_m = rows[:, 0:3]
    r_norm_m = np.sqrt((r_m * r_m).sum(axis=1))
    gradient_ps2 = 3.0 * MU_M3PS2 / r_norm_m**3
    e, gradients = _tuples(r_m / r_norm_m[:, None]), gradient_ps2.tolist()
    b_t = _tuples(rows[:, 6:9])
    return [Surroundings(e[k], gradients[k], b_t[k], exposures[k]) for k in range(len(rows))]


def _exposures(rows: Array, disturbance: DisturbanceConfig) -> list[Exposure]:
    density_scale, flux_wpm2 = disturbance.density_scale, disturbance.solar_flux_wpm2
    if density_scale is None and flux_wpm2 is None:
        return [VACUUM] * len(rows)
    r_m, v_mps, _, sun_m = np.hsplit(rows, 4)
    to_sun = sun_m - r_m
    distance_m = np.linalg.norm(to_sun, axis=1)
    sunlight_pa = (flux_wpm2 or 0.0) / LIGHT_MPS * (AU_M / distance_m) ** 2 * illumination(r_m, sun_m)
    flows = _tuples(flow_mps(r_m, v_mps))
    densities = ((density_scale or 0.0) * density_kgpm3(altitude_m(r_m))).tolist()
    suns, pressures = _tuples(to_sun / distance_m[:, None]), sunlight_pa.tolist()
    return [Exposure(flows[k], densities[k], suns[k], pressures[k]) for k in range(len(rows))]


def _samples(rows: Array) -> list[Sample]:
    r_m, v_mps, b_t, sun_m = np.hsplit(rows, 4)
    h_m2ps = np.cross(r_m, v_mps)
    r_norm_m, h_norm_m2ps = np.linalg.norm(r_m, axis=1), np.linalg.norm(h_m2ps, axis=1)
    e1, e3 = r_m / r_norm_m[:, None], h_m2ps / h_norm_m2ps[:, None]
    radius, along, normal = _tuples(e1), _tuples(np.cross(e3, e1)), _tuples(e3)
    to_sun = sun_m - r_m
    suns = _tuples(to_sun / np.linalg.norm(to_sun, axis=1)[:, None])
    places, velocities, fields = _tuples(r_m), _tuples(v_mps), _tuples(b_t)
    rates, lit = (h_norm_m2ps / r_norm_m**2).tolist(), illumination(r_m, sun_m).tolist()
    return [
        Sample(
            places[k], (radius[k], along[k], normal[k]), rates[k], fields[k], suns[k], lit[k], velocities[k]
        )
        for k in range(len(rows))
    ]


def _tuples(vectors: Array) -> list[Vec3]:
    x, y, z = vectors.T.tolist()
    return list(zip(x, y, z, strict=True))
