"""Claims: gravity gradient, Sun, drag and other help (sections 2.3, 2.4 of the review)."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import inf, sqrt

import numpy as np

from fsw.core.laws.field_tracking import HandOverGains
from fsw.core.laws.pd_when_slow import SlowGains
from fsw.core.laws.spin import SpinGains
from fsw.core.laws.sun_critical import CriticalGains
from fsw.core.laws.sun_panels import PanelGains
from sim.campaign.claim import Claim, Study
from sim.design.field_tracking_stability import best_tracking
from sim.design.theory.bodies import Body
from sim.plant.config import PlateConfig
from sim.plant.dynamics.surfaces import drag
from sim.plant.rotation import Mat3, Vec3, transform
from sim.validate.review import effects
from sim.validate.review.fifty_kg import INERTIA
from sim.validate.review.figures import FlownClaim, one_figure
from sim.validate.review.law_flight import LawFlight, LawHistory, angle_deg, fly

# --- A 3U satellite with feathers, which the air holds by one axis

FEATHER, REAR_M = 0.5, 0.35
"""Sine of the angle by which a feather stands out to the flow, and its distance behind the mass centre."""


@dataclass(frozen=True, slots=True)
class Feathers:
    """Drag of four panels that stand out behind, in air of one density."""

    density_kgpm3: float = 4e-12

    def __call__(self, c_body_from_eci: Mat3, velocity_eci_mps: Vec3) -> Vec3:
        """The torque, body axes, N m; the air at rest in space."""
        return drag(_PLATES, transform(c_body_from_eci, velocity_eci_mps), self.density_kgpm3)


_OUT = sqrt(1.0 - FEATHER**2)
_PLATES = tuple(
    PlateConfig(0.03, (x * _OUT, FEATHER, z * _OUT), (0.05 * x, -REAR_M, 0.05 * z))
    for x, z in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
)

SHUTTLECOCK = LawFlight(
    "direction_tracking",
    ((0.040, 0.0, 0.0), (0.0, 0.012, 0.0), (0.0, 0.0, 0.042)),
    k_w=1e5,
    k_a=20.0,
    rotation_rad=(0.2, 0.5, -0.3),
    relative=True,
    omega_body_radps=(0.001, 0.001, -0.001),
    orbits=4.0,
    altitude_km=400.0,
    inclination_deg=80.0,
    extra=Feathers(),
    attitude_known=False,
)
"""A 3U satellite with four feathers, its long axis 2 ahead."""


# --- The claims

REVIEW = "Ovchinnikov, Roldugin 2019, section"
FIRM = ((0.3, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.2))
"""A body with a boom along the vertical, kg m^2."""
SUN = (0.2 / sqrt(0.78), -0.7 / sqrt(0.78), 0.5 / sqrt(0.78))
TURNED = (1.0, 0.5, -1.0)
SHARES = HandOverGains(0.3, 0.5)
TRACKED = LawFlight(
    "field_tracking_pd",
    FIRM,
    k_w=4e6,
    k_a=1600.0,
    gains=SHARES,
    rotation_rad=(2.6, 0.0, 0.0),
    relative=True,
    hand_over_orbits=3.5,
    orbits=6.0,
    step_s=8.0,
)
"""From 150 deg."""
SUNNED = LawFlight(
    "sun_pointing",
    ((1.0, 0.0, 0.0), (0.0, 1.2, 0.0), (0.0, 0.0, 2.0)),
    k_w=1e7,
    omega_body_radps=(0.01, 0.03, 0.04),
    gravity=False,
    step_s=2.5,
    sun_eci=SUN,
)
CRITICAL = LawFlight(
    "sun_critical",
    INERTIA,
    gains=CriticalGains(2.0, 0.001),
    omega_body_radps=(0.01, -0.01, 0.01),
    rotation_rad=TURNED,
    orbits=4.0,
    sun_eci=SUN,
)
"""From 100 deg. Of a torque the field leaves at least a third about any axis, on average over an orbit: four
orbits are xi t = 24, and exp(-24 / 3) of 100 deg is 0.03 deg."""


FIGURES: dict[str, Callable[[LawHistory], float]] = {
    "angle_deg": lambda flown: flown.angle_deg[-1],
    "least_angle_deg": lambda flown: flown.angle_deg[flown.orbits > flown.orbits[-1] - 1.0].min(),
    "vertical_deg": lambda flown: 90.0 - abs(flown.orbit_axis_deg(0, 0)[-1] - 90.0),
    "normal_deg": lambda flown: flown.orbit_axis_deg(2, 2)[-1],
    "sun_1_deg": lambda flown: flown.axis_deg(0, SUN)[-1],
    "sun_2_deg": lambda flown: flown.axis_deg(1, SUN)[-1],
    "sun_momentum_deg": lambda flown: angle_deg(flown.momentum_eci_nms, SUN)[-1],
    "orbit_rates": lambda flown: float(np.linalg.norm(flown.omega_body_radps[-1])) / flown.orbit_rate_radps,
}
"""At the end of a flight."""

ROWS: tuple[FlownClaim, ...] = (
    FlownClaim(
        "gravity_damping",
        "A body with a boom, damping alone: the boom from the local vertical after four orbits",
        "2.3 [52]: the gravity gradient made asymptotically stable by damping",
        "deg",
        -inf,
        1.0,
        LawFlight(
            "rate_damping",
            FIRM,
            k_w=2e6,
            omega_body_radps=(0.002, -0.003, 0.001),
            rotation_rad=(0.6, -0.4, 0.5),
            relative=True,
            orbits=4.0,
            step_s=8.0,
        ),
        "vertical_deg",
    ),
    FlownClaim(
        "hand_over",
        "A body with a boom from 150 deg, field tracking for 3.5 orbits, then PD: angle after six",
        "2.3 [43, 53]: (7) in the transient, then handed over to (8)",
        "deg",
        -inf,
        0.1,
        TRACKED,
        "angle_deg",
        "PD goes on to nothing",
    ),
    FlownClaim(
        "pd_when_slow",
        "A tumble of 2.5 deg/s, damped, then PD under 4 mrad/s: angle after five orbits",
        "2.3 [54]: stable at small rates; else damping alone",
        "deg",
        -inf,
        1.0,
        LawFlight(
            "pd_when_slow",
            INERTIA,
            k_w=6e6,
            k_a=1615.0,
            gains=SlowGains(),
            omega_body_radps=(0.02, -0.03, 0.025),
            rotation_rad=TURNED,
            orbits=5.0,
            most_am2=5.0,
        ),
        "angle_deg",
        "it comes nearer with each orbit",
    ),
    FlownClaim(
        "slow_spin",
        "Two coils along K (e3 x b) and B-dot: the axis from the orbit normal after four orbits",
        "2.4 [59]: one axis without a fast spin",
        "deg",
        -inf,
        5.0,
        LawFlight(
            "slow_spin",
            INERTIA,
            k_w=6e6,
            spin_radps=0.004,
            gains=SpinGains(3.0),
            omega_body_radps=(0.01, -0.01, 0.01),
            rotation_rad=TURNED,
            orbits=4.0,
        ),
        "normal_deg",
    ),
    FlownClaim(
        "sun_panels",
        "Currents of panels and rate alone: axis 1 from the Sun after four orbits",
        "2.4 [60]: the difference of two panels, and the panel with the most",
        "deg",
        -inf,
        20.0,
        LawFlight(
            "sun_panels",
            INERTIA,
            k_w=6e6,
            k_a=2000.0,
            gains=PanelGains(1.0),
            omega_body_radps=(0.01, -0.01, 0.01),
            rotation_rad=TURNED,
            orbits=4.0,
            gravity=False,
            sun_eci=SUN,
        ),
        "sun_1_deg",
    ),
    FlownClaim(
        "sun_pointing",
        "Sun sensor alone: momentum from the Sun after 0.8 of an orbit",
        "2.4 [61, 62]: the momentum turns to the Sun",
        "deg",
        -inf,
        0.1,
        replace(SUNNED, orbits=0.8),
        "sun_momentum_deg",
        "it comes nearer with each orbit",
    ),
    FlownClaim(
        "sun_critical",
        "Critical damping, xi an orbital rate, gravity gradient on: axis 2 from the Sun after four orbits",
        "2.4 [63]",
        "deg",
        -inf,
        15.0,
        CRITICAL,
        "sun_2_deg",
    ),
    FlownClaim(
        "sun_critical_fast",
        "The same with four times that xi: rate that is left, where the projected torque no longer damps",
        "2.4 [63]",
        "w0",
        1.0,
        inf,
        replace(CRITICAL, gains=CriticalGains(2.0, 0.004)),
        "orbit_rates",
    ),
    FlownClaim(
        "sun_critical_free",
        "Critical damping without gravity gradient: as fast as the double root of a third of the torque",
        "2.4 [63]: critical damping",
        "deg",
        -inf,
        0.04,
        replace(CRITICAL, gravity=False),
        "sun_2_deg",
    ),
    FlownClaim(
        "aerodynamic",
        "A 3U satellite with four feathers at 400 km, magnetometer and orbit alone: angle after four orbits",
        "2.4 [64]: the air gives one axis, the field the other: three axes",
        "deg",
        -inf,
        1.0,
        SHUTTLECOCK,
        "angle_deg",
    ),
    FlownClaim(
        "aerodynamic_without_air",
        "The same without air: least angle in the fourth orbit",
        "2.4 [64]",
        "deg",
        20.0,
        inf,
        replace(SHUTTLECOCK, extra=None),
        "least_angle_deg",
    ),
)


def studies() -> list[Study]:
    """All of these sections."""
    return [
        *(row.study("one_axis", REVIEW, flown_figure) for row in ROWS),
        _tracking("boom", FIRM, -inf, -0.2),
        _tracking("microsat", INERTIA, -0.01, -0.003),
        *effects.studies(),
    ]


def _tracking(name: str, inertia: Mat3, low: float, high: float) -> Study:
    """How well field tracking stabilises a body."""
    body = Body(name, inertia, 800.0, 98.6)
    claim = Claim(
        f"review.one_axis.field_tracking_{name}",
        f"Field tracking alone: best degree of stability of {body.name}, over a grid of gains",
        f"{REVIEW} 2.3 [43]: for a body that the gravity gradient holds",
        "1/rad",
        low=low,
        high=high,
    )
    return one_figure(claim, partial(best_degree, body))


def best_degree(body: Body) -> float:
    """Of field tracking."""
    return best_tracking(body).degree


def flown_figure(case: LawFlight, figure: str) -> float:
    """The figure of that name at the end of a flight."""
    return float(FIGURES[figure](fly(case)))
