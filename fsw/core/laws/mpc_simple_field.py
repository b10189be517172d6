"""Predictive control along a field that is cheaper to obtain: fitted by five functions, or held constant.

``mpc_fitted``: the model's field at few points of the coming orbit is fitted by least squares,

    B(u) = b0 + b1 cos u + b2 sin u + b3 cos 2u + b4 sin 2u,   u the orbit angle from now on,

in orbital axes, and the plan is made along the fit. ``mpc_held``: the present field, in orbital axes, is
held over a short horizon with the disturbance, and no model of the field ahead is needed; the plan is renewed
at each step. Both end in the cost of the periodic regulator; equations and feedback are those of ``mpc``.

Source: Silani, Lovera 2005; Calloni, Corti, Zanchettin, Lovera 2012 (the fit); Wood, Chen 2008 (held), as in
Ovchinnikov, Roldugin 2019, section 3.3.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import transform, transpose
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import STEPS, balanced_pd, check_weights
from fsw.core.laws.mpc import MpcGains, by_plan
from fsw.core.laws.plan.orbit_ahead import check_horizon, orbit_ahead
from fsw.core.laws.plan.riccati import Array

POINTS = 12
"""Points at which the model's field is evaluated for a fit, over one orbit."""


@dataclass(frozen=True, slots=True)
class FittedGains(MpcGains):
    """Weights and horizon as for ``mpc``."""


@dataclass(frozen=True, slots=True)
class HeldFieldGains:
    """Weights as for ``lqr``, and a short horizon, in orbits."""

    rate: float = 0.0
    effort: float = 0.05
    horizon_orbits: float = 0.04

    def __post_init__(self) -> None:
        """Check what the equations need.

        Raises:
            ValueError: a weight or the horizon out of range.
        """
        check_weights(self.rate, self.effort)
        check_horizon(self.horizon_orbits, 0.03, 0.5)


def fitted(angles_rad: Array, b_orbit_t: Array, wanted_rad: Array) -> Array:
    """The field at the angles wanted, by the least-squares fit of five functions to the one given.

    Args:
        angles_rad: where it is given, shape (n,), n at least 5, over most of a turn.
        b_orbit_t: there, orbital axes, T, shape (n, 3).
        wanted_rad: shape (k,).

    Returns:
        Orbital axes, T, shape (k, 3).
    """
    coefficients = np.linalg.lstsq(harmonics(angles_rad), b_orbit_t, rcond=None)[0]
    found: Array = harmonics(wanted_rad) @ coefficients
    return found


def harmonics(u_rad: Array) -> Array:
    """1, cos u, sin u, cos 2u, sin 2u, shape (n, 5)."""
    return np.stack(
        [np.ones_like(u_rad), np.cos(u_rad), np.sin(u_rad), np.cos(2.0 * u_rad), np.sin(2.0 * u_rad)], axis=1
    )


def _fitted_field(inputs: LawInput, steps: int, step_s: float, config: ControlConfig) -> Array | None:
    model = inputs.ephemeris
    if model is None:
        return None
    unix_s, orbit_s = model.epoch_unix_s + inputs.tick * config.tick_s, STEPS * step_s
    parts = (np.arange(POINTS, dtype=np.float64) + 0.5) / POINTS
    ahead = orbit_ahead(model, [unix_s + part * orbit_s for part in parts.tolist()])
    if ahead is None:
        return None
    return fitted(
        2.0 * pi * parts, ahead.b_orbit_t, 2.0 * pi / STEPS * (np.arange(steps, dtype=np.float64) + 0.5)
    )


def _held_field(inputs: LawInput, steps: int, step_s: float, config: ControlConfig) -> Array | None:
    b_orbit = transform(transpose(dcm(inputs.attitude.q_body_from_orbit)), inputs.b_body_t)
    return np.tile(np.array(b_orbit), (steps, 1))


def mpc_fitted(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The plan along the fitted field."""
    if inputs.ephemeris is None:
        return Demand(memory=memory)
    return by_plan("mpc_fitted", _fitted_field, inputs, memory, config)


def mpc_held(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The plan along the field as it is now."""
    return by_plan("mpc_held", _held_field, inputs, memory, config, applied=1)


LAWS = {
    "mpc_fitted": LawEntry(161, Aim.THREE_AXIS, balanced_pd, mpc_fitted, FittedGains),
    "mpc_held": LawEntry(162, Aim.THREE_AXIS, balanced_pd, mpc_held, HeldFieldGains),
}
