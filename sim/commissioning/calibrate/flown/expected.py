"""What the models expect along the orbit of an onboard table, at many times at once."""

from dataclasses import dataclass
from datetime import UTC, datetime
from math import radians

import numpy as np

from fsw.table.table import FlightTable
from sim.errors import HarnessError
from sim.plant.config import FieldConfig, OrbitConfig
from sim.plant.environment.field import make_field
from sim.plant.environment.orbit import make_orbit
from sim.plant.environment.sun import sun_eci_m
from sim.value_types import Array

NODE_S = 10.0


@dataclass(frozen=True, slots=True)
class Expected:
    """Position [m], field [nT] and direction of the Sun, ``eci``, a row a time."""

    r_eci_m: Array
    b_eci_nt: Array
    sun_eci: Array


def expected(table: FlightTable, unix_s: Array) -> Expected:
    """Orbit of the table, IGRF to degree 13 (or the table's simpler field), almanac Sun.

    Computed every 10 s and interpolated by a cubic; the error is below 1 nT.

    Raises:
        HarnessError: orbit or field do not reach one of the times, which are those of a log.
    """
    epoch = table.epoch_unix_s
    t_s = unix_s - epoch
    nodes_s = np.arange(t_s[0] - 2.0 * NODE_S, t_s[-1] + 3.0 * NODE_S, NODE_S)
    try:
        r_m, _ = make_orbit(_orbit(table), epoch).at(nodes_s)
        b_nt = 1e9 * make_field(FieldConfig(table.field.model, 13), epoch).at(nodes_s, r_m)
    except ValueError as error:
        begin, end = (f"{datetime.fromtimestamp(t, UTC):%Y-%m-%d %H:%M:%S}" for t in unix_s[[0, -1]].tolist())
        raise HarnessError(f"the log is of {begin} to {end} UTC: {error}") from None
    to_sun = sun_eci_m(epoch, nodes_s) - r_m
    rows = np.hstack([r_m, b_nt, to_sun / np.linalg.norm(to_sun, axis=1)[:, None]])
    at = _cubic(nodes_s, rows, t_s)
    return Expected(at[:, 0:3], at[:, 3:6], at[:, 6:9])


def _orbit(table: FlightTable) -> OrbitConfig:
    orbit = table.orbit
    if orbit.tle is not None:
        return OrbitConfig(tle=orbit.tle)
    return OrbitConfig(
        altitude_m=1000.0 * (orbit.altitude_km or 0.0),
        inclination_rad=radians(orbit.inclination_deg),
        raan_rad=radians(orbit.raan_deg),
        u0_rad=radians(orbit.u0_deg),
    )


def _cubic(nodes_s: Array, rows: Array, t_s: Array) -> Array:
    """The cubic through the two nodes before and the two after each time."""
    place = (t_s - nodes_s[0]) / NODE_S
    left = np.clip(np.floor(place).astype(int), 1, len(nodes_s) - 3)
    x = (place - left)[:, None]
    weights = (
        x * (x - 1.0) * (x - 2.0) / -6.0,
        (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
        (x + 1.0) * x * (x - 2.0) / -2.0,
        (x + 1.0) * x * (x - 1.0) / 6.0,
    )
    total: Array = sum(
        (weight * rows[left + shift] for shift, weight in zip((-1, 0, 1, 2), weights, strict=True)),
        start=np.zeros((len(t_s), rows.shape[1])),
    )
    return total
