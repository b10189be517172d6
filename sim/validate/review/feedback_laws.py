"""Claims: laws of simple feedback (section 3.1), flown with nothing unknown."""

from collections.abc import Sequence
from functools import partial
from math import radians
from typing import Any

import numpy as np

from fsw.core.laws.field_direction import FieldDirectionGains
from fsw.core.laws.pd_held import ApartGains, HoldGains
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.inertial_gains import best_on_line
from sim.plant.config import OrbitConfig
from sim.plant.environment.field import DirectDipole
from sim.plant.environment.orbit import Array, CircularOrbit
from sim.plant.rotation import Vec3
from sim.validate.review.fifty_kg import BODY, INERTIA, PD, SPHERE, flight, last_orbit_deg
from sim.validate.review.figures import judged
from sim.validate.review.law_flight import LawFlight, LawHistory, angle_deg, fly

SECTION = "Ovchinnikov, Roldugin 2019, section 3.1"
OFF_DEG = 40.0
"""From its target at the start of inertial pointing."""


def studies() -> list[Study]:
    """All of this module."""
    return [inertial(), held(), delayed(), direction(), sphere(), two_step()]


def inertial() -> Study:
    """Inertial pointing."""
    source = f"{SECTION}, after Ovchinnikov, Roldugin, Penkov 2015 [71]"
    claims = (
        Claim(
            "review.feedback.inertial.pointing",
            "Error of pd_inertial from its target in the fourth orbit, scheme's gains, no gravity gradient",
            source,
            "deg",
            high=0.01,
        ),
        Claim(
            "review.feedback.inertial.gravity",
            "The same with the gravity gradient, which is a disturbance there",
            source,
            "deg",
            high=20.0,
        ),
    )
    tasks = (partial(inertial_error_deg, False), partial(inertial_error_deg, True))
    return Study("review.feedback.inertial", tasks, partial(judged, claims))


def held() -> Study:
    """Dipoles held over many steps, without and with a time of measuring before."""
    source = f"{SECTION}, after Celani 2016 [78], [79]"
    claims = (
        Claim(
            "review.feedback.held.long",
            "Pointing error of pd_held in the fifth orbit, each dipole held for 200 s, from 20 deg",
            source,
            "deg",
            high=0.2,
        ),
        Claim(
            "review.feedback.held.too_long",
            "The same held for 600 s: with these gains it drives away",
            source,
            "deg",
            low=90.0,
        ),
        Claim(
            "review.feedback.held.apart",
            "Pointing error of pd_apart in the fifth orbit, 120 s measuring and 120 s acting, from 20 deg",
            source,
            "deg",
            high=0.5,
        ),
    )
    tasks = (
        partial(last_orbit_deg, flight("pd_held", 20.0, gains=HoldGains(200.0), **PD)),
        partial(last_orbit_deg, flight("pd_held", 20.0, gains=HoldGains(600.0), **PD)),
        partial(last_orbit_deg, flight("pd_apart", 20.0, gains=ApartGains(120.0, 120.0), **PD)),
    )
    return Study("review.feedback.held", tasks, partial(judged, claims))


def delayed() -> Study:
    """The delayed attitude in place of the rate."""
    source = f"{SECTION}, after Xu, Luo, Yang 2017 [80]"
    claims = (
        Claim(
            "review.feedback.delayed",
            "Pointing error of pd_delayed in the fifth orbit without a rate, delays of 60 to 120 s, from "
            "20 deg",
            source,
            "deg",
            high=0.3,
        ),
        Claim(
            "review.feedback.delayed.pd",
            "Its largest angle from the flight of pd, which is told the rate; in 60 s an orbit turns 3.6 deg",
            source,
            "deg",
            high=2.0,
        ),
    )
    return Study(
        "review.feedback.delayed", (partial(beside_pd, "pd_delayed"),), lambda found: judged(claims, found[0])
    )


def direction() -> Study:
    """Directions held to the field."""
    source = f"{SECTION}, after Gulmammadov et al. 2010 [84]"
    claims = (
        Claim(
            "review.feedback.direction.attitude",
            "Pointing error of field_direction in the fourth orbit, magnetometer alone, wheel of 0.05 N m s",
            source,
            "deg",
            high=1.0,
        ),
        Claim(
            "review.feedback.direction.axis",
            "Angle of a body axis from the field in the second orbit, a sphere, magnetometer alone",
            f"{SECTION}, after Smirnov 2001 [88]",
            "deg",
            high=20.0,
        ),
    )
    tasks = (partial(last_orbit_deg, wheel_flight()), field_axis_deg)
    return Study("review.feedback.direction", tasks, partial(judged, claims))


def sphere() -> Study:
    """Laws for a sphere."""
    claims = (
        Claim(
            "review.feedback.sphere.vertical",
            "Angle of axis 1 from the vertical in the fifth orbit, a sphere from 60 deg",
            f"{SECTION}, after Bushenkov, Ovchinnikov, Smirnov 2002 [87]",
            "deg",
            high=0.01,
        ),
        Claim(
            "review.feedback.sphere.output",
            "Pointing error of sphere_output in the fifth orbit without a rate, a sphere from 20 deg",
            f"{SECTION}, after Reyhanoglu, Drakunov 2008 [85, 86]",
            "deg",
            high=1.0,
        ),
        Claim(
            "review.feedback.sphere.pd",
            "Its largest angle from the flight of pd, which is told the rate: the observer knows the torque",
            f"{SECTION}, after Reyhanoglu, Drakunov 2008 [85, 86]",
            "deg",
            high=1.0,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        return judged(claims, (found[0], *found[1]))

    return Study(
        "review.feedback.sphere",
        (vertical_deg, partial(beside_pd, "sphere_output", inertia_kgm2=SPHERE)),
        conclude,
    )


def two_step() -> Study:
    """Two turns across a field that does not turn, beside the PD law."""
    source = f"{SECTION}, after Inamori et al. 2016 [89]"
    claims = (
        Claim(
            "review.feedback.two_step.equator",
            "Pointing error of two_step in the third orbit, a sphere from 40 deg, over the magnetic equator",
            source,
            "deg",
            high=3.0,
        ),
        Claim(
            "review.feedback.two_step.pd",
            "The same of pd, which has no torque about the field",
            source,
            "deg",
            low=30.0,
        ),
        Claim(
            "review.feedback.two_step.inclined",
            "The same of two_step at 5 deg inclination, where the field turns between the turns: it fails",
            source,
            "deg",
            low=30.0,
        ),
    )
    tasks = (
        partial(last_orbit_deg, equator_flight("two_step", 0.0)),
        partial(last_orbit_deg, equator_flight("pd", 0.0)),
        partial(last_orbit_deg, equator_flight("two_step", 5.0)),
    )
    return Study("review.feedback.two_step", tasks, partial(judged, claims))


def inertial_error_deg(gravity: bool) -> float:
    """The largest angle from eci in the last orbit, the target there, from 40 deg."""
    gains, _ = best_on_line(BODY)
    rotation: Vec3 = (-radians(BODY.inclination_deg - OFF_DEG), 0.0, 0.0)
    case = LawFlight(
        "pd_inertial",
        INERTIA,
        k_w=float(np.asarray(gains.k_w)),
        k_a=float(np.asarray(gains.k_a)),
        near=True,
        rotation_rad=rotation,
        orbits=4.0,
        step_s=10.0,
        most_am2=5.0,
        gravity=gravity,
    )
    flown = fly(case)
    cosines = 0.5 * (np.trace(flown.c_body_from_eci, axis1=1, axis2=2) - 1.0)
    off = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return float(off[flown.orbits > 3.0].max())


def wheel_flight() -> LawFlight:
    """A nearly even body with a wheel along the orbit normal."""
    even = ((1.9, 0.0, 0.0), (0.0, 1.95, 0.0), (0.0, 0.0, 2.0))
    rest: dict[str, Any] = {
        "wheel_body_nms": (0.0, 0.0, 0.05),
        "step_s": 5.0,
        "orbits": 4.0,
        "attitude_known": False,
    }
    return flight("field_direction", 20.0, inertia_kgm2=even, k_w=1e7, k_a=2000.0, **rest)


def field_axis_deg() -> float:
    """The largest angle of a body axis from the field in the second orbit."""
    own = FieldDirectionGains(0.0, 2.0, 1.0)
    rest: dict[str, Any] = {"k_w": 1e7, "k_a": 2e4, "step_s": 5.0, "orbits": 2.0, "attitude_known": False}
    flown = fly(flight("field_direction", 20.0, inertia_kgm2=SPHERE, gains=own, **rest))
    axis = angle_deg(fields_in_body(flown), (0.0, 2.0, 1.0))
    return float(axis[flown.orbits > 1.0].max())


def fields_in_body(flown: LawHistory) -> Array:
    """The field at each step, body axes, T; the orbit is that of every flight here."""
    orbit = OrbitConfig(None, 1e3 * BODY.altitude_km, radians(BODY.inclination_deg), 0.0, 0.0)
    r_m, _ = CircularOrbit(orbit).at(flown.t_s)
    b_eci_t = DirectDipole().at(flown.t_s, r_m)
    b_body_t: Array = (flown.c_body_from_eci @ b_eci_t[:, :, None])[:, :, 0]
    return b_body_t


def beside_pd(law: str, **changed: object) -> tuple[float, float]:
    """Of a law without a rate: error in the last orbit, and largest angle from pd, which has it; deg."""
    told, untold = (fly(flight(one, 20.0, **(PD | {"near": False} | changed))) for one in ("pd", law))
    return untold.last_orbit_deg, apart_deg(untold, told)


def apart_deg(first: LawHistory, second: LawHistory) -> float:
    """The largest angle between the attitudes of two flights at the same time."""
    cosines = np.abs(np.sum(first.q_body_from_orbit * second.q_body_from_orbit, axis=1))
    return float(np.degrees(2.0 * np.arccos(np.clip(cosines, 0.0, 1.0))).max())


def vertical_deg() -> float:
    """The largest angle of axis 1 from the vertical in the last orbit."""
    flown = fly(flight("sphere_vertical", 60.0, inertia_kgm2=SPHERE, **PD))
    return float(flown.orbit_axis_deg(0, 0)[flown.orbits > 4.0].max())


def equator_flight(law: str, inclination_deg: float) -> LawFlight:
    """A sphere turned mostly about the field."""
    rest: dict[str, Any] = {"near": False, "orbits": 3.0, "inclination_deg": inclination_deg}
    rest["rotation_rad"] = tuple((radians(40.0) * np.array([0.2, 0.1, 1.0]) / np.sqrt(1.05)).tolist())
    return flight(law, 40.0, inertia_kgm2=SPHERE, **PD, **rest)
