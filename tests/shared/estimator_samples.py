"""What the tests of the estimator fly: a satellite at rest in a known field, its filter, and its samples."""

from dataclasses import replace
from math import radians

import numpy as np
from gate_samples import measured

from fsw.core.algebra.quaternion import conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import add, norm, scale, unit
from fsw.core.estimation.dynamics.error_dynamics import NOT_DRIVEN
from fsw.core.estimation.estimator import (
    EstimatorConfig,
    predict,
    update,
)
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.estimation.start.first import StartLimits
from fsw.core.orbit.ephemeris import Reference
from fsw.wire.messages import CoilStatus, MagField, SunVector

INERTIA = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))


def tuned(
    *,
    attitude_sigma_deg=5.0,
    rate_sigma_degps=2.0,
    torque_noise_nm_rts=1e-7,
    gate_nis=16.27,
    **priors,
):
    """A filter that estimates these parameters besides attitude and rate."""
    return mekf_config(
        INERTIA,
        1.0,
        priors,
        magnetometer_sigma_t=2e-7,
        sun_sigma_rad=radians(0.5),
        attitude_sigma_rad=radians(attitude_sigma_deg),
        rate_sigma_radps=radians(rate_sigma_degps),
        torque_noise_nm_rts=torque_noise_nm_rts,
        gate_nis=gate_nis,
    )


MEKF = tuned(
    mag_bias_t=Prior((3e-7,) * 3, (1e-10,) * 3),
    torque_body_nm=Prior((1e-7,) * 3, (3e-10,) * 3),
    dipole_body_am2=Prior((0.02, 0.03, 0.025), (1e-6,) * 3, mean=(0.001, -0.002, 0.003)),
)
SIZE = MEKF.layout.size
CONFIG = EstimatorConfig(
    mekf=MEKF,
    perfect=False,
    start=StartLimits(3e-6, radians(5.0), radians(15.0)),
    restart_after_rejections=6,
    valid_sigma_rad=radians(5.0),
    usable_sigma_rad=radians(5.0),
    fastest_valid_radps=0.1,
)
AGED = replace(CONFIG, mekf=tuned(delay_s=Prior((0.3, 0.3), (0.0, 0.0), mean=(0.5, 0.5))))
"""Where the age of the samples is not known."""
REFERENCE = Reference(
    r_eci_m=(4.0e6, -5.0e6, 3.0e6),
    radius_m=norm((4.0e6, -5.0e6, 3.0e6)),
    b_eci_t=(1.7e-5, -2.3e-5, 3.1e-5),
    sun_eci=unit((-0.8, 0.35, 0.4)),
    lit=True,
    q_orbit_from_eci=normalise((0.3, 0.5, -0.7, 0.4)),
    orbit_rate_radps=1.04e-3,
)
Q_BODY_FROM_ECI = normalise((0.6, -0.4, 0.5, 0.3))
IDLE = CoilStatus(0, 2, 0, 0, 98000, 0)


def field_message(b_body_t, valid=1):
    return MagField(valid, *(c * 1e9 for c in b_body_t))


def seen_from(q_body_from_eci=Q_BODY_FROM_ECI, reference=REFERENCE, **changes):
    """What ideal sensors of a body in this attitude say, with changes."""
    sound = {
        "field": field_message(rotate(q_body_from_eci, reference.b_eci_t)),
        "sun": SunVector(1, *rotate(q_body_from_eci, reference.sun_eci)),
        "coil": IDLE,
    }
    return measured(**(sound | changes))


def step(state, readings, reference=REFERENCE, driven=(NOT_DRIVEN,), config=CONFIG):
    """The state after a tick, and what was taken in it; the one before stays as it is."""
    after = state.copy()
    predict(after, reference, driven, config)
    return after, update(after, readings, reference, config)


def angle_rad(p, q):
    turn = multiply(conjugate(p), q)
    return 2.0 * np.arctan2(norm(turn[1:]), abs(turn[0]))


OFF_SUN = SunVector(1, *unit(rotate(Q_BODY_FROM_ECI, add(REFERENCE.sun_eci, scale(9e3, REFERENCE.b_eci_t)))))
"""About 20 deg nearer to the field than it should be."""
OFF_FIELD = field_message(scale(1.3, rotate(Q_BODY_FROM_ECI, REFERENCE.b_eci_t)))
