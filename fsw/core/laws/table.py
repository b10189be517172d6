"""The control laws by name, each far from the goal and near it.

Of the estimated disturbances ``predictive`` and ``pulse_mpc`` use torque and dipole, ``lqr`` and ``mpc`` the
torque. From the dipole that any law demands ``by_mode`` takes the residual one off. The other laws have no
use for the torque: coils can oppose only its part normal to the field, which gains little at once; ``pd`` and
``sliding_integral`` answer its mean by their integral.
"""

from enum import StrEnum
from typing import NamedTuple

from fsw.core.laws.damping.damping import SwitchedGains, bdot, bdot_switched, rate_damping
from fsw.core.laws.feedback.output_feedback import FilterGains, output_feedback
from fsw.core.laws.feedback.pd import pd, pd_far
from fsw.core.laws.feedback.projection import (
    RegularGains,
    WeightGains,
    regularised,
    regularised_far,
    weighted,
    weighted_far,
)
from fsw.core.laws.interface import Law, Setpoint
from fsw.core.laws.one_axis.field_tracking import (
    HandOverGains,
    field_tracking,
    pd_after_tracking,
    tracking_before_pd,
)
from fsw.core.laws.one_axis.sun_pointing import sun_pointing
from fsw.core.laws.optimal.lqr import LqrGains, lqr, without_memory
from fsw.core.laws.phasing import PhasingGains, phasing
from fsw.core.laws.predictive.mpc import MpcGains, mpc
from fsw.core.laws.predictive.predictive import predictive
from fsw.core.laws.predictive.pulse_mpc import PulseMpcGains, pulse_mpc
from fsw.core.laws.sliding.sliding import SlidingGains, SlidingIntegralGains, sliding, sliding_integral
from fsw.core.laws.spin.spin import SpinGains, nutation, spin_up, y_thomson
from fsw.core.laws.spin.spin_axis import SpinAxisGains, ThreeTermGains, reorientation, spin_relay, three_term
from fsw.core.laws.wheel.dual_spin import DualSpinGains, dual_spin


class Aim(StrEnum):
    """What a law is for; laws of one aim can be compared."""

    THREE_AXIS = "three_axis"
    """The whole attitude is held to the orbital frame."""
    AXIS = "axis"
    """A body axis with a wheel is held to its direction, the body turned about it."""
    RATE = "rate"
    """The rate is damped, to zero or to the spin of the setpoint."""
    SPIN = "spin"
    """A spin is built up, or the axis of one is turned."""
    SUN = "sun"
    """An axis is turned to the Sun."""
    CHECK = "check"
    """Nothing is held: it shows what coils and sensors do."""


class LawEntry(NamedTuple):
    """A law: its number in telecommands, its aim, its forms in ACQUIRE and POINT, and its own parameters.

    The parameters are a class, a frozen dataclass of floats with defaults, or None for a law with none. A law
    that plans pulses has no use for a continuous driver. One that is ``open_loop`` is flown in DETUMBLE too.
    """

    number: int
    aim: Aim
    acquire: Law
    point: Law
    gains: type | None = None
    plans_pulses: bool = False
    open_loop: bool = False


OWN_NUMBER = 255
"""The number of a law that is not in this table."""

LAWS: dict[str, LawEntry] = {
    "pd": LawEntry(0, Aim.THREE_AXIS, pd_far, pd),
    "rate_damping": LawEntry(1, Aim.RATE, rate_damping, rate_damping),
    "bdot": LawEntry(2, Aim.RATE, bdot, bdot),
    "predictive": LawEntry(3, Aim.RATE, predictive, predictive),
    "bdot_switched": LawEntry(10, Aim.RATE, bdot_switched, bdot_switched, SwitchedGains),
    "nutation": LawEntry(11, Aim.SPIN, nutation, nutation, SpinGains),
    "spin_up": LawEntry(12, Aim.SPIN, spin_up, spin_up, SpinGains),
    "y_thomson": LawEntry(13, Aim.SPIN, y_thomson, y_thomson, SpinGains),
    "spin_relay": LawEntry(14, Aim.SPIN, spin_relay, spin_relay, SpinAxisGains),
    "reorientation": LawEntry(15, Aim.SPIN, reorientation, reorientation, SpinAxisGains),
    "three_term": LawEntry(16, Aim.SPIN, three_term, three_term, ThreeTermGains),
    "dual_spin": LawEntry(20, Aim.AXIS, dual_spin, dual_spin, DualSpinGains),
    "field_tracking": LawEntry(21, Aim.THREE_AXIS, field_tracking, field_tracking),
    "field_tracking_pd": LawEntry(22, Aim.THREE_AXIS, tracking_before_pd, pd_after_tracking, HandOverGains),
    "sun_pointing": LawEntry(30, Aim.SUN, sun_pointing, sun_pointing),
    "lqr": LawEntry(40, Aim.THREE_AXIS, without_memory, lqr, LqrGains),
    "mpc": LawEntry(41, Aim.THREE_AXIS, without_memory, mpc, MpcGains),
    "pulse_mpc": LawEntry(42, Aim.THREE_AXIS, without_memory, pulse_mpc, PulseMpcGains, plans_pulses=True),
    "pd_weighted": LawEntry(50, Aim.THREE_AXIS, weighted_far, weighted, WeightGains),
    "pd_regularised": LawEntry(51, Aim.THREE_AXIS, regularised_far, regularised, RegularGains),
    "output_feedback": LawEntry(52, Aim.THREE_AXIS, output_feedback, output_feedback, FilterGains),
    "sliding": LawEntry(60, Aim.THREE_AXIS, sliding, sliding, SlidingGains),
    "sliding_integral": LawEntry(
        61, Aim.THREE_AXIS, sliding_integral, sliding_integral, SlidingIntegralGains
    ),
    "phasing": LawEntry(70, Aim.CHECK, phasing, phasing, PhasingGains, plans_pulses=True, open_loop=True),
}


def open_loop(setpoint: Setpoint) -> bool:
    """Whether the law of the setpoint acts without looking."""
    return setpoint.law in LAWS and LAWS[setpoint.law].open_loop


def number_of(law: str) -> int:
    """The number of a law by its name."""
    return LAWS[law].number if law in LAWS else OWN_NUMBER
