import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.commissioning.calibrate.flown.joint_fit import FreeSamples
from sim.commissioning.calibrate.flown.samples import Samples

OFFSET = np.array([21000.0, -34000.0, 8000.0])
MATRIX = np.array([[1.03, 0.02, -0.01], [-0.03, 0.97, 0.02], [0.01, -0.015, 1.01]])
"""Body from channels."""


@pytest.fixture(scope="session")
def truth():
    """M and o of ``observed``."""
    return MATRIX, OFFSET


@pytest.fixture(scope="session")
def observed():
    """Makes samples of a body in any attitude: ``noise_nt``, whether the Sun is seen, and how it may turn."""

    def make(n=1500, noise_nt=0.0, sun_noise=0.0, sun=True, fixed=False, seed=4):
        draw = np.random.default_rng(seed)
        b, s = draw.normal(size=(n, 3)), np.tile([0.6, -0.48, 0.64], (n, 1))
        b *= draw.uniform(22000.0, 48000.0, (n, 1)) / np.linalg.norm(b, axis=1)[:, None]
        turn = [np.eye(3)] * n if fixed else [np.linalg.qr(draw.normal(size=(3, 3)))[0] for _ in range(n)]
        turn = [one * np.sign(np.linalg.det(one)) for one in turn]
        body = np.array([c @ v for c, v in zip(turn, b, strict=True)])
        seen = np.array([c @ v for c, v in zip(turn, s, strict=True)])
        seen = seen + np.cross(seen, sun_noise * draw.normal(size=(n, 3)))
        field = body @ np.linalg.inv(MATRIX).T + OFFSET + noise_nt * draw.normal(size=(n, 3))
        return FreeSamples(
            field, seen if sun else np.full((n, 3), np.nan), b, s, max(noise_nt, 1.0), max(sun_noise, 1e-6)
        )

    return make


@pytest.fixture(scope="session")
def observed_slowly():
    """Makes samples of a body that turns by 1 rad while the field turns by half as much, seen by seed."""

    def make(noise_nt, sun_noise, seed, n=800):
        draw = np.random.default_rng(seed)
        steps = np.arange(n) / n
        b = Rotation.from_rotvec(np.outer(0.5 * steps, [0.6, 0.0, 0.8])).apply([25000.0, 15000.0, -20000.0])
        s = np.tile([0.6, -0.48, 0.64], (n, 1))
        turn = Rotation.from_rotvec(np.outer(steps, [0.48, -0.6, 0.64]))
        body, seen = turn.apply(b), turn.apply(s)
        seen = seen + np.cross(seen, sun_noise * draw.normal(size=(n, 3)))
        field = body @ np.linalg.inv(MATRIX).T + OFFSET + noise_nt * draw.normal(size=(n, 3))
        return FreeSamples(field, seen, b, s, noise_nt, sun_noise)

    return make


@pytest.fixture(scope="session")
def pulsed():
    """Makes a log of pulses over a slowly changing field: (response, delay in ticks, ...) -> samples."""

    def make(response, delay, noise_nt=0.0, pulses=6, every=40, levels=(0.0, 0.5, 2.0, 8.0), tick_hz=1):
        every *= tick_hz
        n = every * (pulses + 1)
        k = np.arange(n)
        coil, level = k % 3, np.zeros(n, dtype=int)
        for number in range(pulses):
            begin = every * (number + 1) - every // 2
            coil[begin : begin + 3 * tick_hz] = number % 3
            level[begin : begin + 3 * tick_hz] = 3 if number < 3 else -3
        driven = np.zeros((n, 3))
        driven[k, coil] = np.array(levels)[np.abs(level)] * np.sign(level)
        late, part = int(delay), delay - int(delay)
        shown = (1.0 - part) * np.roll(driven, late, axis=0) + part * np.roll(driven, late + 1, axis=0)
        t_s = k / tick_hz
        turn = 2.0 * np.pi * t_s / 700.0
        earth = np.column_stack([30000.0 * np.cos(turn), 30000.0 * np.sin(turn), 12000.0 + 5.0 * t_s])
        field = earth + shown @ response.T + noise_nt * np.random.default_rng(2).normal(size=(n, 3))
        sun = np.tile([0.6, -0.48, 0.64], (n, 1))
        return Samples(
            k, 1.0e9 + t_s, field, sun, coil.astype(np.int64), level.astype(np.int64), np.ones(n, bool)
        )

    return make
