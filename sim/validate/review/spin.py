"""Claims: stabilisation by spin (section 2.1 of the review)."""

from collections.abc import Callable
from dataclasses import replace
from math import cos, inf, radians, sin

import numpy as np

from fsw.core.laws.relay_stages import StageGains
from fsw.core.laws.roll_precession import RollGains
from fsw.core.laws.spin import SpinGains
from fsw.core.laws.spin_axis import SpinAxisGains, TargetGains, ThreeTermGains
from fsw.core.laws.stepped_precession import StepGains
from fsw.core.laws.target_precession import PrecessionGains
from sim.campaign.claim import Claim, Study
from sim.design import roll_precession_gain
from sim.plant.environment.orbit import EARTH_RADIUS_M, MU_M3PS2, Array
from sim.validate.review.fifty_kg import BODY
from sim.validate.review.figures import FlownClaim, one_figure
from sim.validate.review.law_flight import LawFlight, LawHistory, angle_deg, fly

REVIEW = "Ovchinnikov, Roldugin 2019, section 2.1"
INERTIA = ((1.2, 0.0, 0.0), (0.0, 1.2, 0.0), (0.0, 0.0, 2.0))
TARGET = (0.3, -0.5, 0.8)
INCLINATION_DEG, ALTITUDE_KM = 98.6, 800.0
NORMAL = (0.0, -sin(radians(INCLINATION_DEG)), cos(radians(INCLINATION_DEG)))
RADIUS_M = EARTH_RADIUS_M + 1e3 * ALTITUDE_KM
RATE_RADPS = float(np.sqrt(MU_M3PS2 / RADIUS_M**3))
SPIN_RADPS = 0.1
TILT_RAD = (0.35, 0.26, 0.0)
GAIN_C = 0.4
"""Gain of the precession by roll, without unit; see ``sim.design.roll_precession_gain``."""

SPINNING = LawFlight(
    "nutation",
    INERTIA,
    k_w=3e6,
    spin_radps=SPIN_RADPS,
    rotation_rad=TILT_RAD,
    omega_body_radps=(0.0, 0.0, SPIN_RADPS),
    gravity=False,
    step_s=4.0,
    most_am2=5.0,
)
"""Pure spin about axis 3, its axis 25 deg from the orbit normal, 80 deg and more from the target."""
TUMBLING = replace(SPINNING, omega_body_radps=(0.03, -0.02, 0.03))


def _across(flown: LawHistory) -> Array:
    across: Array = np.linalg.norm(flown.omega_body_radps[:, :2], axis=1)
    return across


def _spin(flown: LawHistory) -> Array:
    return flown.omega_body_radps[:, 2]


FIGURES: dict[str, Callable[[LawHistory, LawFlight], float]] = {
    "across_share": lambda flown, case: _across(flown)[-1] / _across(flown)[0],
    "spin_change": lambda flown, case: abs(_spin(flown)[-1] / _spin(flown)[0] - 1.0),
    "across_spin": lambda flown, case: _across(flown)[-1] / case.spin_radps,
    "spin_share": lambda flown, case: _spin(flown)[-1] / case.spin_radps,
    "target_deg": lambda flown, case: angle_deg(flown.momentum_eci_nms, TARGET)[-1],
    "momentum_normal_deg": lambda flown, case: angle_deg(flown.momentum_eci_nms, NORMAL)[-1],
    "normal_deg": lambda flown, case: flown.orbit_axis_deg(2, 2)[-1],
}
"""Figures at the end of a flight."""

THOMSON = replace(
    SPINNING,
    law="y_thomson",
    gains=SpinGains(3.0),
    spin_radps=0.02,
    omega_body_radps=(0.0, 0.0, 0.03),
    k_w=6e6,
    orbits=4.0,
)
RELAY = replace(TUMBLING, law="spin_relay", gains=TargetGains(3.0, *TARGET), orbits=2.5, most_am2=1.0)
THREE_TERM = replace(TUMBLING, law="three_term", gains=ThreeTermGains(3.0, *TARGET), orbits=2.0)
STAGES = replace(TUMBLING, law="relay_stages", gains=StageGains(3.0, *TARGET), orbits=4.0, most_am2=3.0)


def _spun(name: str, source: str, case: LawFlight, spin_off: float, across: float) -> tuple[FlownClaim, ...]:
    """Of a law that is to give spin and direction at once, what its direction alone does not show."""
    return (
        FlownClaim(
            f"{name}_spin",
            "The same: spin at the end, of the wanted",
            source,
            "1",
            1.0 - spin_off,
            1.0 + spin_off,
            case,
            "spin_share",
        ),
        FlownClaim(
            f"{name}_nutation",
            "The same: rate across the axis at the end, of the spin wanted",
            source,
            "1",
            -inf,
            across,
            case,
            "across_spin",
        ),
    )


ROWS: tuple[FlownClaim, ...] = (
    FlownClaim(
        "nutation",
        "Nutation damping by one coil: rate across the axis after an orbit, of that at the start",
        "[31-33]: nutation is damped",
        "1",
        -inf,
        0.02,
        replace(TUMBLING, gains=SpinGains(3.0)),
        "across_share",
    ),
    FlownClaim(
        "nutation_spin",
        "The same: change of the spin of a body that is symmetric about it, of the spin",
        "[31, 33]: the rate along the axis of symmetry is not damped",
        "1",
        -inf,
        1e-9,
        replace(TUMBLING, gains=SpinGains(3.0)),
        "spin_change",
        "rounding alone",
    ),
    FlownClaim(
        "spin_up",
        "Spin-up: spin after two orbits, of the wanted",
        "[31, 32]",
        "1",
        0.95,
        1.01,
        replace(TUMBLING, law="spin_up", gains=SpinGains(3.0), orbits=2.0),
        "spin_share",
    ),
    FlownClaim(
        "y_thomson",
        "Y-Thomson: angle of the axis from the orbit normal after four orbits from 25, spun half too fast",
        "[34]: spin about the axis normal to the orbit",
        "deg",
        -inf,
        2.0,
        THOMSON,
        "normal_deg",
    ),
    FlownClaim(
        "y_thomson_spin",
        "The same: spin at the end, of the wanted",
        "[34]: spin about the axis normal to the orbit",
        "1",
        0.99,
        1.01,
        THOMSON,
        "spin_share",
    ),
    FlownClaim(
        "relay",
        "Relay law on both momentum errors (1 A m^2): momentum from the target after 2.5 orbits of a tumble",
        "eq. 3 [30, 35]: spin and direction at once",
        "deg",
        -inf,
        5.0,
        RELAY,
        "target_deg",
    ),
    *_spun("relay", "eq. 3 [30, 35]: spin and direction at once", RELAY, 0.1, 0.02),
    FlownClaim(
        "reorientation",
        "Reorientation by one coil: momentum from the target after two orbits",
        "[31, 32]",
        "deg",
        -inf,
        6.0,
        replace(SPINNING, law="reorientation", gains=SpinAxisGains(3.0, *TARGET, 3e6), orbits=2.0),
        "target_deg",
    ),
    FlownClaim(
        "three_term",
        "Three terms at once: momentum from the target after two orbits of a tumble",
        "[36]: nutation, spin and direction by one law",
        "deg",
        -inf,
        0.3,
        THREE_TERM,
        "target_deg",
    ),
    *_spun("three_term", "[36]: nutation, spin and direction by one law", THREE_TERM, 0.01, 3e-5),
    FlownClaim(
        "relay_stages",
        "Three stages by relays (3 A m^2): momentum from the target after four orbits of a tumble",
        "[29]: nutation, spin and direction, each by its switching function",
        "deg",
        -inf,
        3.0,
        STAGES,
        "target_deg",
    ),
    *_spun(
        "relay_stages",
        "[29]: nutation, spin and direction, each by its switching function",
        STAGES,
        0.1,
        0.2,
    ),
    FlownClaim(
        "target_precession",
        "Precession with f(x) cut at 0.3: momentum from the target after two orbits",
        "eq. 5 [38]: any f with x f(x) > 0 serves",
        "deg",
        -inf,
        12.0,
        replace(
            SPINNING,
            law="target_precession",
            gains=PrecessionGains(3.0, *TARGET, 1e6, 0.3),
            orbits=2.0,
            most_am2=20.0,
        ),
        "target_deg",
    ),
    FlownClaim(
        "stepped_precession",
        "Steps of 120 s at three levels (2 A m^2): momentum from the normal after two orbits, from 25 deg",
        "[39]: piecewise constant",
        "deg",
        -inf,
        3.0,
        replace(SPINNING, law="stepped_precession", gains=StepGains(3.0), orbits=2.0, most_am2=2.0),
        "momentum_normal_deg",
    ),
)


def studies() -> list[Study]:
    """All of this section."""
    return [
        *(row.study("spin", f"{REVIEW},", flown_figure) for row in ROWS),
        three_term_gain(),
        one_figure(
            Claim(
                "review.spin.roll_floquet",
                "Precession by roll: decay by Floquet theory, of k_h B0^2 sin^2 i / 8 by averaging, c = 0.4",
                f"{REVIEW}, eq. 4 [37]: stable by the gains; Floquet theory",
                "1",
                low=0.99,
                high=1.01,
            ),
            floquet_share,
        ),
        one_figure(
            Claim(
                "review.spin.roll_precession",
                "Its angle from the normal in the plant, five orbits on, in decays of the slower exponent",
                f"{REVIEW}, eq. 4 [37]: asymptotically stable",
                "1",
                low=0.9,
                high=2.0,
            ),
            roll_decays,
        ),
    ]


def flown_figure(case: LawFlight, figure: str) -> float:
    """The figure of that name at the end of a flight."""
    return float(FIGURES[figure](fly(case), case))


def floquet_share() -> float:
    """Floquet theory over averaging."""
    return roll_precession_gain.degree(GAIN_C) / roll_precession_gain.averaged(GAIN_C)[0]


def roll_decays() -> float:
    """Logarithm of the angle lost in five orbits, of what the slower exponent loses."""
    k_h = roll_precession_gain.gain_of(GAIN_C, RATE_RADPS, RADIUS_M, radians(INCLINATION_DEG))
    case = replace(SPINNING, law="roll_precession", gains=RollGains(3.0, k_h), most_am2=20.0, orbits=5.0)
    angle = angle_deg(fly(case).momentum_eci_nms, NORMAL)
    return float(np.log(angle[0] / angle[-1]) / (-roll_precession_gain.degree(GAIN_C) * 10.0 * np.pi))


# --- The gain of the spin in the law of three terms

FIFTY_NORMAL = (
    0.0,
    -float(np.sin(np.radians(BODY.inclination_deg))),
    float(np.cos(np.radians(BODY.inclination_deg))),
)
"""Of the orbit, eci."""
LACKING = LawFlight(
    "three_term",
    ((1.2, 0.0, 0.0), (0.0, 1.2, 0.0), (0.0, 0.0, 2.0)),
    k_w=3e6,
    spin_radps=SPIN_RADPS,
    gains=ThreeTermGains(3.0, *FIFTY_NORMAL),
    omega_body_radps=(0.0, 0.0, 0.5 * SPIN_RADPS),
    gravity=False,
    step_s=4.0,
    most_am2=5.0,
    orbits=0.1,
)
"""Along its target already, and lacking half of the spin."""


def three_term_gain() -> Study:
    """The momentum that lacks along the target is an error of the spin and of the momentum alike.

    The torque about the axis is (k_spin + k_h) times it and the square of the field across the axis.
    """
    gains = ThreeTermGains()
    claim = Claim(
        "review.spin.three_term_gain",
        "Three terms, the momentum along its target: decay of the spin that lacks, over that without k_spin; "
        f"(k_spin + k_h) / k_h = {(gains.k_spin + gains.k_h) / gains.k_h:g}",
        "Ovchinnikov, Roldugin 2019, section 2.1, [36]: nutation, spin and direction by one law",
        "1",
        low=1.9,
        high=2.1,
    )
    return one_figure(claim, three_term_ratio)


def three_term_ratio() -> float:
    """With the term of the spin over without it."""
    without = replace(LACKING, gains=ThreeTermGains(3.0, *FIFTY_NORMAL, k_spin=0.0))
    return lacking_decay(LACKING) / lacking_decay(without)


def lacking_decay(case: LawFlight) -> float:
    """The logarithm of the lacking spin at the start over that at the end."""
    lacking = case.spin_radps - fly(case).omega_body_radps[:, 2]
    return float(np.log(lacking[0] / lacking[-1]))
