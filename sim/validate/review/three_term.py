"""A claim on the gain of the spin in the law of three terms (section 2.1 of the review)."""

from dataclasses import replace

import numpy as np

from fsw.core.laws.spin_axis import ThreeTermGains
from sim.campaign.claim import Claim, Study
from sim.validate.review.fifty_kg import BODY
from sim.validate.review.figures import one_figure
from sim.validate.review.law_flight import LawFlight, fly

SPIN_RADPS = 0.1
NORMAL = (
    0.0,
    -float(np.sin(np.radians(BODY.inclination_deg))),
    float(np.cos(np.radians(BODY.inclination_deg))),
)
"""Of the orbit, eci."""
SLOW = LawFlight(
    "three_term",
    ((1.2, 0.0, 0.0), (0.0, 1.2, 0.0), (0.0, 0.0, 2.0)),
    k_w=3e6,
    spin_radps=SPIN_RADPS,
    gains=ThreeTermGains(3.0, *NORMAL),
    omega_body_radps=(0.0, 0.0, 0.5 * SPIN_RADPS),
    gravity=False,
    step_s=4.0,
    most_am2=5.0,
    orbits=0.1,
)
"""Along its target already, and lacking half of the spin."""


def study() -> Study:
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
    return one_figure(claim, decay_ratio)


def decay_ratio() -> float:
    """With the term of the spin over without it."""
    without = replace(SLOW, gains=ThreeTermGains(3.0, *NORMAL, k_spin=0.0))
    return decay(SLOW) / decay(without)


def decay(case: LawFlight) -> float:
    """The logarithm of the lacking spin at the start over that at the end."""
    lacking = case.spin_radps - fly(case).omega_body_radps[:, 2]
    return float(np.log(lacking[0] / lacking[-1]))
