"""The attitude as control and telemetry use it."""

from typing import NamedTuple

from fsw.core.algebra.vector import ZERO, Vec3


class Attitude(NamedTuple):
    """Attitude and rate of the body relative to the orbital frame, with 3 sigma of each."""

    q_body_from_orbit: tuple[float, float, float, float]
    omega_body_orbit_radps: Vec3
    sigma3_attitude_rad: float
    sigma3_rate_radps: float
    valid: bool


UNKNOWN = Attitude((1.0, 0.0, 0.0, 0.0), ZERO, 4.0, 1.0, False)

RATE_LIMIT_RADPS = 0.5
"""About each axis: no satellite is to turn as fast."""


def rate_bounded(attitude: Attitude) -> bool:
    """Whether the rate is one that the satellite may have."""
    return max(map(abs, attitude.omega_body_orbit_radps)) < RATE_LIMIT_RADPS
