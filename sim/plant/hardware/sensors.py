"""Sensor physics: the readings of the boards' instruments."""

from math import cos, pi, sin, sqrt
from typing import final

from sim.plant.random_streams import Normals
from sim.plant.rotation import ZERO, Mat3, Vec3, from_vector, matrix, transform
from sim.plant.sensor_config import AS_NAMED, MagnetometerConfig, SunSensorConfig, Wiring

LEAST_LIT = 0.5
"""Visible fraction of the Sun's disc below which the Sun sensor has no reading."""

_TO_EVEN = 1.5 * 2.0**52
"""Added and subtracted, it rounds a smaller number to the nearest integer, a half to the even one."""
_EXACT = 2.0**50

_Values = tuple[float, ...]


@final
class Delay:
    """The values ``latency_s`` ago: linear between samples; before the first, the first.

    Args:
        latency_s: age of the returned values.
        tick_hz: samples a second.
    """

    def __init__(self, latency_s: float, tick_hz: int) -> None:
        ticks, self._part = divmod(latency_s * tick_hz, 1.0)
        self._length = int(ticks) + 2
        self._samples: list[_Values] = []

    def take(self, now: _Values) -> _Values:
        """Take the sample ``now``; the delayed values."""
        samples, part = self._samples, self._part
        if samples:
            samples.pop(0)
        while len(samples) < self._length:
            samples.append(now)
        if not part:  # whole ticks
            return samples[1]
        early, late = samples[0], samples[1]
        return tuple([late[k] + part * (early[k] - late[k]) for k in range(len(late))])


@final
class MagnetometerPhysics:
    """b = scale (N R (b_body + K m)) + bias(t, shadow) + noise, then quantised and limited to the range.

    R turns body into sensor axes, N takes them to the directions in which the three sensors point, which need
    not be orthogonal; K m is the coils' own field. The field is that of ``latency_s`` ago. Finally the wiring
    assigns the three values to the channels.

    Args:
        config: the errors.
        seed: of the stream ``magnetometer``.
        tick_hz: samples a second.
    """

    def __init__(self, config: MagnetometerConfig, seed: int, tick_hz: int = 1) -> None:
        self._config = config
        self._delay = Delay(config.latency_s, tick_hz) if config.latency_s else None
        self._sensor_from_body = matrix(from_vector(config.misalignment_rad))
        if any(config.non_orthogonality_rad):
            self._sensor_from_body = _skewed(config.non_orthogonality_rad, self._sensor_from_body)
        self._noise = Normals(seed, "magnetometer")

    def measure(
        self, b_body_t: Vec3, m_body_am2: Vec3, t_s: float = 0.0, lit: float = 1.0
    ) -> tuple[Vec3, bool]:
        """The reading [T] and whether it is valid: within the range on every axis.

        Args:
            b_body_t: the Earth's field at this instant.
            m_body_am2: the coils' dipole at this instant.
            t_s: this instant, since tick 0.
            lit: visible fraction of the Sun's disc.
        """
        config, noise = self._config, self._noise
        if m_body_am2 != ZERO:
            (bx, by, bz), own = b_body_t, transform(config.coil_coupling_t_per_am2, m_body_am2)
            b_body_t = (bx + own[0], by + own[1], bz + own[2])
        bx, by, bz = transform(self._sensor_from_body, b_body_t)
        if self._delay is not None:
            late = self._delay.take((bx, by, bz))
            bx, by, bz = late[0], late[1], late[2]
        (sx, sy, sz), (ox, oy, oz) = config.scale, self._bias_t(t_s, lit)
        sigma, quantum, most = config.noise_t, config.quantum_t, config.saturation_t
        x = quantise(sx * bx + ox + sigma * noise.next(), quantum)
        y = quantise(sy * by + oy + sigma * noise.next(), quantum)
        z = quantise(sz * bz + oz + sigma * noise.next(), quantum)
        if -most <= x <= most and -most <= y <= most and -most <= z <= most:
            return wired((x, y, z), config.wiring), True
        limited = (min(max(x, -most), most), min(max(y, -most), most), min(max(z, -most), most))
        return wired(limited, config.wiring), False

    def _bias_t(self, t_s: float, lit: float) -> Vec3:
        """The constant offset, that which follows the orbit, and that of the shadow."""
        config = self._config
        x, y, z = config.bias_t
        if config.orbit_bias_t != ZERO:
            (ax, ay, az), (px, py, pz) = config.orbit_bias_t, config.orbit_bias_phase_rad
            angle = 2.0 * pi * t_s / config.orbit_s
            x, y, z = x + ax * sin(angle + px), y + ay * sin(angle + py), z + az * sin(angle + pz)
        if lit < 1.0 and config.shadow_bias_t != ZERO:
            dark, (dx, dy, dz) = 1.0 - lit, config.shadow_bias_t
            x, y, z = x + dark * dx, y + dark * dy, z + dark * dz
        return (x, y, z)


@final
class SunSensorPhysics:
    """s = R (s_body + a_body) of unit length, turned about each axis by a small random angle, then quantised.

    a is the light of the Earth, if it is in view: the signals of the sensor's cells vary with the cosine of
    the incidence, and the vector that they form is the sum of all light. Light and directions are those of
    ``latency_s`` ago. In view is what lies within ``fov_half_rad`` of a boresight.

    Args:
        config: the errors.
        seed: of the stream ``sun_sensor``.
        tick_hz: samples a second.
    """

    def __init__(self, config: SunSensorConfig, seed: int, tick_hz: int = 1) -> None:
        self._config = config
        self._delay = Delay(config.latency_s, tick_hz) if config.latency_s else None
        self._cos_half = cos(config.fov_half_rad)
        self._sensor_from_body = matrix(from_vector(config.misalignment_rad))
        self._noise = Normals(seed, "sun_sensor")

    def measure(self, sun_body: Vec3, lit: float, earthlight_body: Vec3 = ZERO) -> tuple[Vec3, bool]:
        """The unit vector to the Sun and whether it is valid: in view, and at least half of the disc visible.

        Args:
            sun_body: true unit vector.
            lit: visible fraction of the Sun's disc.
            earthlight_body: a, relative to the Sun's light.
        """
        noise, sigma = self._noise, self._config.noise_rad
        ax, ay, az = sigma * noise.next(), sigma * noise.next(), sigma * noise.next()
        if self._delay is not None:
            late = self._delay.take((*sun_body, lit, *earthlight_body))
            sun_body, lit, earthlight_body = (late[0], late[1], late[2]), late[3], (late[4], late[5], late[6])
        if lit < LEAST_LIT or not self._in_view(sun_body):
            return ZERO, False
        if earthlight_body != ZERO and self._in_view(earthlight_body):
            (x, y, z), (ex, ey, ez) = sun_body, earthlight_body
            sun_body = (x + ex, y + ey, z + ez)
        x, y, z = transform(self._sensor_from_body, sun_body)
        x, y, z = x + ay * z - az * y, y + az * x - ax * z, z + ax * y - ay * x
        factor, quantum = 1.0 / sqrt(x * x + y * y + z * z), self._config.quantum
        return (
            quantise(x * factor, quantum),
            quantise(y * factor, quantum),
            quantise(z * factor, quantum),
        ), True

    def _in_view(self, light_body: Vec3) -> bool:
        boresights = self._config.boresights_body
        x, y, z = light_body
        least = self._cos_half * sqrt(x * x + y * y + z * z)
        seen = not boresights
        for bx, by, bz in boresights:
            seen = seen or x * bx + y * by + z * bz >= least
        return seen


def wired(by_axis: Vec3, wiring: Wiring) -> Vec3:
    """The values by axis, rearranged by channel."""
    if wiring == AS_NAMED:
        return by_axis
    return _along(by_axis, wiring[0]), _along(by_axis, wiring[1]), _along(by_axis, wiring[2])


def _along(by_axis: Vec3, axis: int) -> float:
    """The value along an axis of this number, negative for the opposite sense."""
    x, y, z = by_axis
    number = abs(axis)
    value = x if number == 1 else y if number == 2 else z
    return value * (1.0 if axis > 0 else -1.0)


def _skewed(non_orthogonality_rad: Vec3, axes: Mat3) -> Mat3:
    """N times the sensor's orthogonal axes: the unit vectors along which its three sensors measure.

    x stays, y lies in the plane of x and y; the cosines between them are sin xy, sin xz and sin yz, so that N
    is lower triangular. Three such angles are what a scalar calibration finds besides offsets and scales
    (Merayo et al. 2000, Scalar calibration of vector magnetometers).

    Args:
        non_orthogonality_rad: right angle minus the angles xy, xz and yz.
        axes: rows of the orthogonal axes, body axes.
    """
    xy, xz, yz = map(sin, non_orthogonality_rad)
    yy = sqrt(1.0 - xy * xy)
    zy = (yz - xy * xz) / yy
    zz = sqrt(1.0 - xz * xz - zy * zy)
    (a, b, c), (d, e, f), (g, h, i) = axes
    body_from_axes = ((a, d, g), (b, e, h), (c, f, i))
    return (axes[0], transform(body_from_axes, (xy, yy, 0.0)), transform(body_from_axes, (xz, zy, zz)))


def quantise(value: float, quantum: float) -> float:
    """The multiple of a step nearest to a value; the value itself without a step."""
    if not quantum:
        return value
    steps = value / quantum
    if -_EXACT < steps < _EXACT:
        return quantum * (steps + _TO_EVEN - _TO_EVEN)
    return quantum * round(steps)
