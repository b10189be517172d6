"""From attitude to the torque asked for: which law each mode flies."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from fsw.core.attitude import Attitude
from fsw.core.laws.damping import bdot_dipole, rate_damping_dipole
from fsw.core.laws.pd import attitude_error, pd_dipole
from fsw.core.quaternion import dcm
from fsw.core.vector import ZERO, Vec3
from fsw.wire.messages import Mode


@dataclass(frozen=True, slots=True)
class ControlConfig:
    """The pointing law and its gains: ``k_w`` in N m s / T^2, ``k_a`` in N m / T^2.

    ``spin_radps`` is the rate about body axis 1, relative to the orbital frame, that rate damping holds.
    """

    law: str
    k_w: float
    k_a: float
    spin_radps: float
    tick_s: float


@dataclass(frozen=True, slots=True)
class FieldSample:
    """The last usable field sample, body axes, and its tick (-1: none)."""

    b_body_t: Vec3 = ZERO
    tick: int = -1


class Seen(NamedTuple):
    """What a law may look at: attitude, field in body axes, and the last two field samples."""

    attitude: Attitude
    b_body_t: Vec3
    sample: FieldSample
    before: FieldSample


Law = Callable[[Seen, ControlConfig], Vec3]
"""Gives a dipole in body axes, A m^2."""

MAX_DIFFERENCE_S = 10.0
"""Field samples further apart than this tell nothing of the rate."""


def idle(seen: Seen, config: ControlConfig) -> Vec3:
    """No dipole."""
    return ZERO


def pd(seen: Seen, config: ControlConfig) -> Vec3:
    """PD law about the orbital frame."""
    if not seen.attitude.valid:
        return ZERO
    error = attitude_error(dcm(seen.attitude.q_body_from_orbit))
    return pd_dipole(seen.b_body_t, seen.attitude.omega_body_orbit_radps, error, config.k_w, config.k_a)


def rate_damping(seen: Seen, config: ControlConfig) -> Vec3:
    """Damping of the rate relative to the orbital frame, down to the spin that is wanted."""
    if not seen.attitude.valid:
        return ZERO
    w1, w2, w3 = seen.attitude.omega_body_orbit_radps
    return rate_damping_dipole(seen.b_body_t, (w1 - config.spin_radps, w2, w3), config.k_w)


def bdot(seen: Seen, config: ControlConfig) -> Vec3:
    """B-dot from the last two usable field samples."""
    interval_s = (seen.sample.tick - seen.before.tick) * config.tick_s
    if seen.before.tick < 0 or not 0.0 < interval_s <= MAX_DIFFERENCE_S:
        return ZERO
    return bdot_dipole(seen.sample.b_body_t, seen.before.b_body_t, interval_s, config.k_w)


def detumble(seen: Seen, config: ControlConfig) -> Vec3:
    """Damping by the estimated rate where it is known, else B-dot."""
    return rate_damping(seen, config) if seen.attitude.valid else bdot(seen, config)


POINTING_LAWS: dict[str, Law] = {"pd": pd, "rate_damping": rate_damping}

MODE_LAWS: dict[Mode, Law | None] = {
    Mode.SAFE: idle,
    Mode.DETUMBLE: detumble,
    Mode.ACQUIRE: None,
    Mode.POINT: None,
}
"""The law of each mode; None stands for the pointing law of the table."""


def dipole(mode: Mode, seen: Seen, config: ControlConfig) -> Vec3:
    """The dipole that the law of this mode asks for, body axes, A m^2."""
    law = MODE_LAWS[mode] or POINTING_LAWS[config.law]
    return law(seen, config)
