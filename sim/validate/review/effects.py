"""Claims: what helps the coils where the field leaves an axis without torque (section 2.4 of the review)."""

from functools import partial
from math import cos, radians, sin

import numpy as np

from sim.campaign.claim import Claim, Study
from sim.design.theory.bodies import BODIES
from sim.design.thruster_allocation import Demands, demands, given, pairs, propellant
from sim.effects.fluid_ring import FluidRing
from sim.effects.lorentz import lorentz_torque, velocity_in_field
from sim.effects.solar_flaps import SUNLIGHT_PA, SolarFlaps
from sim.plant.config import OrbitConfig
from sim.plant.dynamics import torques
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.environment.field import DirectDipole
from sim.plant.environment.orbit import Array, CircularOrbit
from sim.plant.environment.surroundings import Surroundings
from sim.plant.own_effects import Moment
from sim.plant.rotation import Quaternion, Vec3, matrix
from sim.validate.review.figures import one_figure
from sim.value_types import vec3

REVIEW = "Ovchinnikov, Roldugin 2019, section 2.4"
ALTITUDE_M = 800e3
PERIOD_S = 6052.0
INERTIA = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
COIL_AM2, THRUSTER_NM, TORQUE_NM, DEMANDS = 2.0, 1e-3, 2e-5, 120
SUN_OUT_DEG = 23.4
"""The Sun's largest angle from an equatorial orbit."""


def studies() -> list[Study]:
    """Lorentz force, light on flaps, ring of fluid, thrusters."""
    return [
        one_figure(
            Claim(
                "review.one_axis.lorentz",
                "Least torque of a charge along the field over an equatorial orbit, of P v b",
                f"{REVIEW} [65]: the Lorentz force beside the coils",
                "1",
                low=0.9,
                wide="one but for rounding",
            ),
            partial(charge_along_field, 0.0),
        ),
        one_figure(
            Claim(
                "review.one_axis.lorentz_polar",
                "The same over a polar orbit, where the velocity comes to lie along the field",
                f"{REVIEW} [65]",
                "1",
                high=0.1,
            ),
            partial(charge_along_field, 90.0),
        ),
        one_figure(
            Claim(
                "review.one_axis.coils_pitch",
                "Largest torque of coils about the normal of an equatorial orbit, of m b",
                f"{REVIEW} [66]: near the equator the field lies along the normal",
                "1",
                high=1e-12,
                wide="zero but for rounding",
            ),
            coils_about_normal,
        ),
        one_figure(
            Claim(
                "review.one_axis.solar_flaps",
                "Largest torque of two flaps about that normal, the Sun 23.4 deg out of the plane, of P A L",
                f"{REVIEW} [66]: light gives what the field does not",
                "1",
                low=0.3,
                high=1.0,
            ),
            flaps_about_normal,
        ),
        one_figure(
            Claim(
                "review.one_axis.fluid_ring",
                "Momentum of body and fluid over 600 s with the pump on: relative change in space",
                f"{REVIEW} [67]: a ring of conducting fluid",
                "1",
                high=1e-6,
                wide="of the integration's step",
            ),
            ring_momentum_change,
        ),
        one_figure(
            Claim(
                "review.one_axis.thrusters",
                "Propellant for 2e-5 N m to all sides, shared with coils of 2 A m^2, over thrusters alone",
                f"{REVIEW} [55]: the torque is shared under limits",
                "1",
                high=0.5,
            ),
            propellant_left,
        ),
        one_figure(
            Claim(
                "review.one_axis.thrusters_normal",
                "Of these torques what coils and one pair of thrusters about the orbit normal can give",
                f"{REVIEW} [55]: the torque along the field may not be had",
                "1",
                high=0.6,
            ),
            partial(given_by_pair, 2),
        ),
        one_figure(
            Claim(
                "review.one_axis.thrusters_radial",
                "The same with the pair about the vertical",
                f"{REVIEW} [55]",
                "1",
                low=0.8,
            ),
            partial(given_by_pair, 0),
        ),
    ]


def charge_along_field(inclination_deg: float) -> float:
    """The least over an orbit of the best P's torque along the field, |v x b| / (|v| |b|)."""
    shares = []
    for r, v, b in zip(*_orbit(inclination_deg), strict=True):
        velocity, field_t = velocity_in_field(vec3(r), vec3(v)), vec3(b)
        along = b / np.linalg.norm(b)
        best = np.cross(np.cross(velocity, field_t), along)
        best = best / np.maximum(np.linalg.norm(best), 1e-300)
        torque = np.array(lorentz_torque(vec3(best), velocity, field_t)) @ along
        shares.append(abs(float(torque)) / float(np.linalg.norm(velocity) * np.linalg.norm(b)))
    return float(np.min(shares))


def coils_about_normal() -> float:
    """The largest over an orbit and over unit dipoles along the axes, of |b|."""
    _, _, fields = _orbit(0.0)
    shares = [
        torques.magnetic(vec3(m), vec3(b))[2] / float(np.linalg.norm(b)) for b in fields for m in np.eye(3)
    ]
    return float(np.max(np.abs(shares)))


def flaps_about_normal() -> float:
    """The largest over an orbit of a satellite whose axis 3 is the normal, in units of P A L."""
    flaps, out = SolarFlaps(area_m2=0.1, arm_m=1.0), radians(SUN_OUT_DEG)
    suns = [(cos(u) * cos(out), -sin(u) * cos(out), sin(out)) for u in np.linspace(0.0, 2.0 * np.pi, 181)]
    torques_nm = [flaps.torque_body_nm(Moment(sun_body=sun))[2] for sun in suns]
    return float(np.max(np.abs(torques_nm))) / (SUNLIGHT_PA * 0.1)


def ring_momentum_change() -> float:
    """Of J omega + h in space, the body turning freely."""
    ring, rigid, step_s = FluidRing(), RigidBody(INERTIA), 0.5
    around = Surroundings((1.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0))
    motion = Motion((1.0, 0.0, 0.0, 0.0), (0.01, -0.02, 0.015))
    first = _momentum(motion, ring, 0.0)
    for step in range(1200):
        middle_s = (step + 0.5) * step_s

        def torque(q: Quaternion, omega: Vec3, _: Surroundings, t_s: float = middle_s) -> Vec3:
            return ring.torque_body_nm(Moment(t_s, q, omega))

        motion = rigid.step(motion, torques.TorqueFunction(torque), step_s, around, around, around)
    last = _momentum(motion, ring, 1200 * step_s)
    return float(np.linalg.norm(last - first) / np.linalg.norm(first))


def propellant_left() -> float:
    """With coils over without."""
    wanted, thrusters = _demands(), pairs(THRUSTER_NM, (0, 1, 2))
    return propellant(wanted, thrusters, COIL_AM2) / propellant(wanted, thrusters, 0.0)


def given_by_pair(axis: int) -> float:
    """The share of the torques."""
    return given(_demands(), pairs(THRUSTER_NM, (axis,)), COIL_AM2)


def _demands() -> Demands:
    return demands(BODIES[2], TORQUE_NM, DEMANDS, 3)


def _momentum(motion: Motion, ring: FluidRing, t_s: float) -> Array:
    body = np.array(INERTIA) @ motion.omega_body_radps + np.array([0.0, 0.0, ring.momentum_nms(t_s)])
    momentum: Array = np.array(matrix(motion.q_body_from_eci)).T @ body
    return momentum


def _orbit(inclination_deg: float) -> tuple[Array, Array, Array]:
    """Position, velocity and field at 180 places of an orbit, eci."""
    times = np.linspace(0.0, PERIOD_S, 180, endpoint=False)
    r_m, v_mps = CircularOrbit(OrbitConfig(None, ALTITUDE_M, radians(inclination_deg), 0.0, 0.0)).at(times)
    return r_m, v_mps, DirectDipole().at(times, r_m)
