"""Claims: the laws that were flown on Gurwin, a satellite with a pitch wheel (section 2.2 of the review)."""

from dataclasses import replace
from functools import partial
from math import inf, radians

import numpy as np

from fsw.core.laws.lqr import LqrGains, schedule
from sim.campaign.claim import Study
from sim.design.theory.bodies import Body, diagonal
from sim.design.torque_harmonics import fit, orbit
from sim.plant.config import OrbitConfig
from sim.plant.environment.field import RotatingIgrf
from sim.plant.environment.orbit import CircularOrbit
from sim.validate.review.fifty_kg import last_orbit_deg
from sim.validate.review.figures import FigureClaim
from sim.validate.review.law_flight import DEGREE, EPOCH_UNIX_S, LawFlight

REVIEW = "Ovchinnikov, Roldugin 2019, section 2.2"
BODY = Body("Gurwin", diagonal((1.9, 1.95, 2.0)), 800.0, 98.6, (0.0, 0.0, 0.05))
"""Of its size; moments and wheel are assumed."""

WEIGHTS = LqrGains(effort=0.01)
"""A wheel is stiff beside the body: the default effort is too dear for it."""

FAILED = LawFlight(
    "field_tracking",
    BODY.inertia_kgm2,
    k_w=1e7,
    k_a=2000.0,
    wheel_body_nms=BODY.wheel_nms,
    rotation_rad=(1.7, 1.7, 1.5),
    omega_body_radps=(0.01, -0.008, 0.012),
    relative=True,
    orbits=6.0,
    step_s=8.0,
    most_am2=5.0,
    attitude_known=False,
)
"""It tumbles, and nothing is known but the field and the orbit."""
POINTED = replace(
    FAILED,
    law="lqr",
    rotation_rad=(0.2, -0.2, 0.2),
    omega_body_radps=(0.0, 0.0, 0.0),
    orbits=3.0,
    attitude_known=True,
    near=True,
    igrf=True,
    gains=WEIGHTS,
)
DIPOLE_AM2 = (0.3, -0.5, 0.8)
"""Residual; only its direction counts."""


def regulated_deg() -> float:
    """The largest error in the last orbit, gains from the linear model in the direct dipole's field."""
    table = schedule(
        BODY.inertia_kgm2,
        BODY.wheel_nms,
        BODY.rate_radps,
        radians(BODY.inclination_deg),
        BODY.field_t,
        WEIGHTS,
    )
    return last_orbit_deg(replace(POINTED, schedules={"lqr": table}))


def share_left(count: int) -> float:
    """What ``count`` functions of latitude leave of d x B on the nominal attitude, by root mean squares."""
    u_rad = orbit()
    t_s = u_rad / BODY.rate_radps
    inclination = radians(BODY.inclination_deg)
    r_m, v_mps = CircularOrbit(OrbitConfig(None, 1e3 * BODY.altitude_km, inclination, 0.0, 0.0)).at(t_s)
    b_eci_t = RotatingIgrf(DEGREE, EPOCH_UNIX_S).at(t_s, r_m)
    radius, normal = r_m, np.cross(r_m, v_mps)
    axes = np.stack([radius, np.cross(normal, radius), normal], axis=1)
    axes /= np.linalg.norm(axes, axis=2, keepdims=True)
    return fit(u_rad, np.cross(DIPOLE_AM2, np.einsum("tij,tj->ti", axes, b_eci_t)), count).left


ROWS: tuple[FigureClaim, ...] = (
    FigureClaim(
        "recovery",
        "Field tracking (7) by the magnetometer alone: sixth orbit's error after a tumble of 1 deg/s",
        "eq. 7 [42]: flown on Gurwin",
        "deg",
        -inf,
        1.0,
        partial(last_orbit_deg, FAILED),
    ),
    FigureClaim(
        "lqr",
        "LQR of linear model and direct dipole, flown in the true field: third orbit's error from 20 deg",
        "[44]: the simplified design serves the fuller model",
        "deg",
        -inf,
        0.3,
        regulated_deg,
    ),
    FigureClaim(
        "constant",
        "Torque of a residual dipole in the true field: share that a constant leaves",
        "[44]: disturbances as periodic functions",
        "1",
        0.9,
        1.0,
        partial(share_left, 1),
    ),
    FigureClaim(
        "harmonics",
        "The same: share that one and two times the orbital rate leave",
        "[44]: disturbances at once and twice the orbital rate",
        "1",
        -inf,
        0.15,
        partial(share_left, 5),
    ),
)


def studies() -> list[Study]:
    """Recovery, pointing, and the shape of a disturbance."""
    return [row.study("wheel.gurwin", REVIEW) for row in ROWS]
