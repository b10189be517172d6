"""The least error that any dipole leaves of a constant torque, on the orbit that is flown.

As ``sim/design/theory/feedforward.py``, which needs a field that repeats: here the field is the one met, the
dipole is held over steps, and the attitude at first and the dipoles are those with the least mean square of
theta over the part of the flight that counts. The motion is that of ``linear_flight``. No law does better: it
would have to know the field of all orbits to come, and have coils that give any dipole at any time.
"""

from collections.abc import Sequence
from math import degrees

import numpy as np

from fsw.core.algebra.vector import Vec3, add
from fsw.core.config import FlightConfig
from fsw.core.laws.plan.riccati import free_step, resting_torque, skews
from sim.design.limits.linear_flight import COUNTED, Passed, orbit_rate_radps
from sim.value_types import Array

HELD_S = 60.0
PARTS = 2
"""Of the time for which a dipole is held: after each theta counts."""
TOLERANCE = 1e-6
"""Dipoles with less than this part of the effect of the most effective one are not used."""


def least_deg(config: FlightConfig, torque_nm: Vec3, met: Sequence[Passed]) -> float:
    """The RMS of the least error, deg; a residual dipole costs nothing, since its opposite is a dipole.

    Args:
        config: the body, and the length of a tick.
        torque_nm: constant torque, body axes, beside that on the nominal attitude.
        met: the orbit flown.
    """
    held = round(HELD_S * config.tick_hz)
    counted = met[len(met) - round(COUNTED * len(met)) :]
    middles = counted[held // 2 : len(counted) // held * held : held]
    rows = _theta_by_choice(config, torque_nm, middles)
    chosen = np.linalg.lstsq(rows[:, :-1], -rows[:, -1], rcond=TOLERANCE)[0]
    theta = (rows[:, :-1] @ chosen + rows[:, -1]).reshape(-1, 3)
    return degrees(np.sqrt(np.mean(np.sum(theta**2, axis=1))))


def _theta_by_choice(config: FlightConfig, torque_nm: Vec3, middles: Sequence[Passed]) -> Array:
    """Theta after each part of a step by state at first, dipoles of the n steps, and 1: (.., 6 + 3 n + 1)."""
    control, rate_radps, h = config.control, orbit_rate_radps(config), HELD_S / PARTS
    free = free_step(control.inertia_kgm2, control.wheel_body_nms, rate_radps, h)
    constant = add(torque_nm, resting_torque(control.inertia_kgm2, control.wheel_body_nms, rate_radps))
    pushes = -free[:, 6:] @ skews(np.array([passed.b_orbit_t for passed in middles]))
    state, rows = np.hstack([np.eye(6), np.zeros((6, 3 * len(middles) + 1))]), []
    for step, passed in enumerate(middles):
        for _ in range(PARTS):
            state = free[:, :6] @ state
            state[:, 6 + 3 * step : 9 + 3 * step] += pushes[step]
            state[:, -1] += free[:, 6:] @ constant
            state[[2, 5], -1] -= passed.rate_change_radps2 * h * np.array([1.0, 0.5 * h])
            rows.append(state[3:].copy())
    return np.concatenate(rows)
