"""Claims: a wheel beside the coils that can be driven (section 2.4 of the review)."""

from dataclasses import replace
from math import inf, radians

import numpy as np

from fsw.core.laws.dual_spin import DualSpinGains
from fsw.core.laws.pitch_wheel import PitchWheelGains
from fsw.core.laws.two_coils import TwoCoilsGains, two_coils_and_wheel
from fsw.core.laws.wheel_allocation import affordable
from sim.campaign.claim import Study
from sim.campaign.flight import Order
from sim.campaign.study import Figure, Group, campaign, summary_value
from sim.plant.environment.orbit import Array
from sim.plant.rotation import Vec3
from sim.plant.wheel_config import WheelConfig
from sim.statistics.settling import settled_tick
from sim.validate.review.fifty_kg import INERTIA
from sim.validate.review.figures import FigureClaim
from sim.validate.review.law_flight import ConstantTorque, LawFlight, LawHistory, fly

REVIEW = "Ovchinnikov, Roldugin 2019, section 2.4"
WHEEL = WheelConfig((0.0, 0.0, 1.0), 2e-4, 2e-3, 0.12)
TORQUE_NM = 1e-6
"""About each axis, constant."""
DRAWN = 2000
"""Torques, fields and axes at random."""

HELD = LawFlight(
    "two_coils",
    INERTIA,
    near=True,
    rotation_rad=(radians(0.4), radians(-0.3), radians(0.3)),
    relative=True,
    orbits=0.8,
    most_am2=8.0,
    altitude_km=500.0,
    inclination_deg=51.6,
    extra=ConstantTorque((TORQUE_NM, -TORQUE_NM, TORQUE_NM)),
    wheel=WHEEL,
)
"""Held against a torque, the wheel along the orbit normal."""
TURNED = replace(HELD, extra=None, rotation_rad=(0.0, 0.0, radians(20.0)), orbits=0.5, k_w=1e7, k_a=4000.0)
"""20 deg off in pitch."""
BIAS_NMS = 0.05
BIASED = replace(WHEEL, momentum_nms=BIAS_NMS)


def _last_half(values: Array) -> Array:
    return values[len(values) // 2 :]


def _dipole_am2(flown: LawHistory) -> float:
    return float(np.sqrt(np.mean(np.sum(_last_half(flown.m_body_am2) ** 2, axis=1))))


def given_share() -> float:
    """The largest part of a torque that two coils and a wheel lack, for any torque, field and axis.

    Where the dipole is large, of the torques that cancel in it.
    """
    random, shares = np.random.default_rng(56), []
    for _ in range(DRAWN):
        torque, field, axis = (_unit(random) for _ in range(3))
        effort = two_coils_and_wheel(torque, field, axis)
        assert effort is not None
        given = np.cross(effort.m_body_am2, field) - effort.wheel_torque_nm * np.array(axis)
        size = np.maximum(1.0, np.linalg.norm(effort.m_body_am2))
        shares.append(np.linalg.norm(given - torque) / size)
    return float(np.max(shares))


def _unit(random: np.random.Generator) -> Vec3:
    x, y, z = random.standard_normal(3)
    size = float(np.sqrt(x * x + y * y + z * z))
    return (float(x) / size, float(y) / size, float(z) / size)


def held_off_spring_deg() -> float:
    """The largest difference from the angle at which spring and gravity gradient balance the torque.

    T_i = (J_i w_n^2 + w0^2 g_i) theta_i, g = (C - B, 4 (C - A), 3 (B - A)), w_n the spring's frequency.
    """
    flown, moments = fly(HELD), np.diag(np.array(INERTIA))
    a, b, c = moments
    gravity = flown.orbit_rate_radps**2 * np.array([c - b, 4.0 * (c - a), 3.0 * (b - a)])
    turns = TORQUE_NM / (moments * TwoCoilsGains().frequency_radps ** 2 + gravity)
    return float(np.abs(_last_half(flown.angle_deg) - np.degrees(np.linalg.norm(turns))).max())


def dipole_growth() -> float:
    """The dipole at 80 deg inclination over that at the equator, times the cosine."""
    steep, flat = (fly(replace(HELD, inclination_deg=inclination)) for inclination in (80.0, 0.0))
    return _dipole_am2(steep) / _dipole_am2(flat) * float(np.cos(radians(80.0)))


def polar_growth() -> float:
    """The dipole over the poles, where the field has no component along the wheel, over that at 51.6 deg."""
    return _dipole_am2(fly(replace(HELD, inclination_deg=90.0))) / _dipole_am2(fly(HELD))


def effort_share() -> float:
    """The dipole of the allocation over that of two coils, held against the same torque."""
    return _dipole_am2(fly(replace(HELD, law="wheel_allocation"))) / _dipole_am2(fly(HELD))


def beyond_limits() -> float:
    """The largest effort of the allocation, in parts of what coils and wheel can give, for any torque."""
    random, efforts = np.random.default_rng(57), []
    for _ in range(DRAWN):
        torque, field, axis = (_unit(random) for _ in range(3))
        size = float(10.0 ** random.uniform(-7.0, -2.0))
        asked = (size * torque[0], size * torque[1], size * torque[2])
        effort = affordable(asked, (3e-5 * field[0], 3e-5 * field[1], 3e-5 * field[2]), axis, 8.0, 2e-3)
        assert effort is not None
        m = float(np.linalg.norm(effort.m_body_am2)) / 8.0
        efforts.append((m, abs(effort.wheel_torque_nm) / 2e-3))
    return float(np.max(efforts))


def pitch_speed() -> float:
    """Time under 1 deg from 20 deg in pitch by the wheel's speed, over that by the coils of dual spin."""
    by_wheel = replace(TURNED, law="pitch_wheel", gains=PitchWheelGains(bias_nms=BIAS_NMS), wheel=BIASED)
    by_coils = replace(
        TURNED, law="dual_spin", gains=DualSpinGains(), wheel=None, wheel_body_nms=(0.0, 0.0, BIAS_NMS)
    )
    return _settled_s(fly(by_wheel)) / _settled_s(fly(replace(by_coils, orbits=4.0)))


def _settled_s(flown: LawHistory) -> float:
    """The time at which the angle has settled under 1 deg; infinite where it has not."""
    row = settled_tick(flown.angle_deg < 1.0, 1.0 / float(flown.t_s[1] - flown.t_s[0]))
    return inf if row is None else float(flown.t_s[row])


def momentum_left() -> float:
    """Of 0.03 N m s above the bias, what is left after an orbit."""
    begun = replace(WHEEL, momentum_nms=0.08)
    gains = PitchWheelGains(bias_nms=BIAS_NMS)
    case = replace(TURNED, law="pitch_wheel", gains=gains, wheel=begun, inclination_deg=80.0, orbits=1.0)
    return float(abs(fly(case).wheel_nms[-1] - BIAS_NMS) / 0.03)


ROWS: tuple[FigureClaim, ...] = (
    FigureClaim(
        "two_coils",
        "Two coils and one wheel: largest part of the torque wanted that they lack, any field and axis",
        "[56]: any torque wanted is given in full",
        "1",
        -inf,
        1e-12,
        given_share,
        "rounding alone",
    ),
    FigureClaim(
        "two_coils_held",
        "1e-6 N m held at 51.6 deg inclination: difference from the angle of the spring asked for",
        "[56]: any torque wanted is given in full",
        "deg",
        -inf,
        0.005,
        held_off_spring_deg,
    ),
    FigureClaim(
        "two_coils_growth",
        "Its dipole at 80 deg inclination over that at the equator, times the cosine of 80 deg",
        "[56]: the matrix has b along the wheel for its pivots; direct dipole",
        "1",
        0.8,
        1.25,
        dipole_growth,
    ),
    FigureClaim(
        "two_coils_polar",
        "The same torque in a polar orbit, the field normal to the wheel: dipole over that at 51.6 deg",
        "[56]: the matrix is singular there",
        "1",
        20.0,
        inf,
        polar_growth,
    ),
    FigureClaim(
        "allocation_effort",
        "Three coils and the wheel with the least effort: dipole over that of two coils, 51.6 deg",
        "[57]: the torque is shared among coils and wheels",
        "1",
        -inf,
        0.9,
        effort_share,
    ),
    FigureClaim(
        "allocation_limits",
        "Largest effort that the sharing asks for, of what coils and wheel can give, any torque",
        "[57]",
        "1",
        0.99,
        1.0 + 1e-9,
        beyond_limits,
    ),
    FigureClaim(
        "pitch_speed",
        "Pitch by the wheel's speed: time under 1 deg from 20 deg, of that by the coils of dual spin",
        "[58]: a pitch wheel whose speed can be controlled",
        "1",
        -inf,
        0.2,
        pitch_speed,
    ),
    FigureClaim(
        "pitch_momentum",
        "The coils bring its momentum back: part of 0.03 N m s left after an orbit at 80 deg inclination",
        "[58]",
        "1",
        -inf,
        0.2,
        momentum_left,
    ),
)


def studies() -> list[Study]:
    """All of this section."""
    return [*(row.study("wheel", REVIEW) for row in ROWS), flown()]


def flown() -> Study:
    """The whole chain in the loop: filter, frames, boards, friction and lag of the motor."""
    figures = (
        Figure(
            "final",
            "From 40 deg, filter, boards and a real motor in the loop: error after a quarter of an orbit",
            "deg",
            summary_value("pointing_deg.final"),
            high=1.5,
        ),
        Figure(
            "honest",
            "Part of the time in which the estimate is inside its 3 sigma, the wheel running",
            "1",
            summary_value("estimate_deg.within_3sigma"),
            low=0.99,
            wide="0.992 by an honest filter",
        ),
    )
    orders = (Order("microsat-wheel", {}, seed=1, orbits=0.25),)
    return campaign("review.wheel.flight", f"{REVIEW}, [56-58]", (Group("", orders),), figures)
