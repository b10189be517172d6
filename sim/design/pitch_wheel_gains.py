"""The laws of a pitch wheel beside each other, as choices of six gains with the same k1 and k3.

The degree of stability of roll and yaw on a circular orbit says which measurements pay. With roll and yaw
weighted alike the two parts of the precession decay by 9/8 and 11/8 of one quantity, as precession and square
of the field keep step; a spring, of either sign, takes them out of step, and both decay by 10/8.

Source: Hablani 1995 (Comparative stability analysis) compares the laws, as Ovchinnikov, Roldugin 2019,
section 2.2, says; the figures are this project's.
"""

from fsw.core.laws.six_gain import SixGainGains
from sim.design.pitch_wheel_ellipse import Ellipse, WheelLaw, decays
from sim.design.theory.bodies import Body

LAWS: dict[str, SixGainGains] = {
    "roll and its rate": SixGainGains(k2=0.0, k4=0.0),
    "roll, both rates": SixGainGains(k2=0.0),
    "roll and yaw": SixGainGains(),
    "roll and yaw, springs": SixGainGains(k5=0.5),
    "roll and yaw, springs reversed": SixGainGains(k5=-0.5),
}
"""What each measures: of a horizon sensor; eq. 6 of the review; eq. 5 of it; with springs."""


def slowest(body: Body, k1: float, k3: float) -> dict[str, float]:
    """By law, the degree of stability per radian of u: that of the slowest mode; negative: stable.

    Args:
        body: with a wheel along axis 3.
        k1: N m / T^2.
        k3: N m s / T^2.
    """
    return {name: max(decays(body, Ellipse(0.0), WheelLaw(k1, k3, gains))) for name, gains in LAWS.items()}
