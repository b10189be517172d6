"""Fixtures of the plant's tests: a plant in which no number is zero, one, or equal to its neighbour."""

import csv
from math import radians
from typing import NamedTuple

import numpy as np
import pytest

from fsw.core.orbit.tle import tle_epoch_unix_s
from hil_stub.coils.coil_driver import CoilLimits
from sim.plant.config import (
    BodyConfig,
    CoilConfig,
    DisturbanceConfig,
    FieldConfig,
    InitialConfig,
    OrbitConfig,
    PlantConfig,
)
from sim.plant.plant import Plant
from sim.plant.rotation import from_vector
from sim.plant.sensor_config import MagnetometerConfig, SunSensorConfig
from sim.validate.reference.reference_table import DATA


class Reference(NamedTuple):
    """One file of reference data: its comment lines, and its columns by name."""

    comments: list[str]
    rows: list[dict[str, str]]

    def column(self, name):
        return np.array([float(row[name]) for row in self.rows])

    def columns(self, *names):
        return np.stack([self.column(name) for name in names], axis=1)

    def header(self, start):
        """The numbers after ``=`` in the comment that starts with ``start``."""
        (line,) = (line for line in self.comments if line.startswith(start))
        return [float(word) for word in line.split(" = ")[1].split()]


@pytest.fixture(scope="session")
def reference():
    def read(name):
        lines = (DATA / name).read_text().splitlines()
        comments = [line.removeprefix("# ") for line in lines if line.startswith("#")]
        return Reference(comments, list(csv.DictReader(line for line in lines if not line.startswith("#"))))

    return read


@pytest.fixture(scope="session")
def elements():
    """Two-line elements by name."""
    lines = [line for line in (DATA / "tle.txt").read_text().splitlines() if not line.startswith("#")]
    return {lines[i]: (lines[i + 1], lines[i + 2]) for i in range(0, len(lines), 3)}


@pytest.fixture(scope="session")
def itamsat(elements):
    return elements["ITAMSAT"]


@pytest.fixture(scope="session")
def make_config(itamsat):
    """A plant with every effect in it; keywords replace parts, the first three reach the board too."""

    def make(tick_hz=1, pulse_ms=3000, backoff_ms=4000, **parts):
        inertia = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
        defaults = {
            "epoch_unix_s": tle_epoch_unix_s(*itamsat),
            "tick_hz": tick_hz,
            "seed": 7,
            "orbit": OrbitConfig(tle=itamsat),
            "field": FieldConfig(),
            "body": BodyConfig(inertia),
            "initial": InitialConfig(from_vector((0.4, -0.3, 0.5)), (1e-3, -7e-4, 5e-4)),
            "disturbance": DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03)),
            "magnetometer": MagnetometerConfig(
                noise_t=2e-7,
                bias_t=(3e-7, -2e-7, 1e-7),
                scale=(1.01, 0.99, 1.02),
                misalignment_rad=(0.01, -0.02, 0.015),
                quantum_t=1e-8,
                coil_coupling_t_per_am2=((2e-5, 1e-6, 2e-6), (3e-6, -1e-5, 4e-6), (5e-6, 6e-6, -1.5e-5)),
            ),
            "sun_sensor": SunSensorConfig(radians(0.5), (0.01, 0.005, -0.01), 1e-3),
            "coils": CoilConfig((0.5, 2.0, 8.0), 11.0, 0.01, (0.97, 1.02, 1.05)),
            "limits": CoilLimits(tick_hz, pulse_ms, backoff_ms),
        }
        return PlantConfig(**{**defaults, **parts})

    return make


@pytest.fixture(scope="session")
def make_plant(make_config):
    def make(**parts):
        return Plant(make_config(**parts))

    return make


@pytest.fixture(scope="session")
def rotation_angle():
    """Angle [rad] of the rotation between attitudes, arrays (..., 4)."""

    def angle(p, q):
        p, q = np.asarray(p), np.asarray(q)
        scalar = (p * q).sum(axis=-1)
        vector = p[..., :1] * q[..., 1:] - q[..., :1] * p[..., 1:] - np.cross(p[..., 1:], q[..., 1:])
        return 2.0 * np.arctan2(np.linalg.norm(vector, axis=-1), np.abs(scalar))

    return angle
