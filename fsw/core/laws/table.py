"""The laws that fly, by name: far from the goal and near it."""

from typing import NamedTuple

from fsw.core.laws.damping import SwitchedGains, bdot, bdot_switched, rate_damping
from fsw.core.laws.dual_spin import DualSpinGains, dual_spin
from fsw.core.laws.field_tracking import (
    HandOverGains,
    field_tracking,
    pd_after_tracking,
    tracking_before_pd,
)
from fsw.core.laws.interface import Law
from fsw.core.laws.lqr import LqrGains, lqr, without_memory
from fsw.core.laws.mpc import MpcGains, mpc
from fsw.core.laws.output_feedback import FilterGains, output_feedback
from fsw.core.laws.pd import pd, pd_far
from fsw.core.laws.predictive import predictive
from fsw.core.laws.projection import (
    RegularGains,
    WeightGains,
    regularised,
    regularised_far,
    weighted,
    weighted_far,
)
from fsw.core.laws.sliding import SlidingGains, SlidingIntegralGains, sliding, sliding_integral
from fsw.core.laws.spin import SpinGains, nutation, spin_up, y_thomson
from fsw.core.laws.spin_axis import SpinAxisGains, ThreeTermGains, reorientation, spin_relay, three_term
from fsw.core.laws.sun_pointing import sun_pointing


class Row(NamedTuple):
    """A law: its number in telecommands, what ACQUIRE and POINT fly, and the class of its own parameters.

    That class is a frozen dataclass of floats with defaults, or None for a law with none.
    """

    number: int
    acquire: Law
    point: Law
    gains: type | None = None


LAWS: dict[str, Row] = {
    "pd": Row(0, pd_far, pd),
    "rate_damping": Row(1, rate_damping, rate_damping),
    "bdot": Row(2, bdot, bdot),
    "predictive": Row(3, predictive, predictive),
    "bdot_switched": Row(10, bdot_switched, bdot_switched, SwitchedGains),
    "nutation": Row(11, nutation, nutation, SpinGains),
    "spin_up": Row(12, spin_up, spin_up, SpinGains),
    "y_thomson": Row(13, y_thomson, y_thomson, SpinGains),
    "spin_relay": Row(14, spin_relay, spin_relay, SpinAxisGains),
    "reorientation": Row(15, reorientation, reorientation, SpinAxisGains),
    "three_term": Row(16, three_term, three_term, ThreeTermGains),
    "dual_spin": Row(20, dual_spin, dual_spin, DualSpinGains),
    "field_tracking": Row(21, field_tracking, field_tracking),
    "field_tracking_pd": Row(22, tracking_before_pd, pd_after_tracking, HandOverGains),
    "sun_pointing": Row(30, sun_pointing, sun_pointing),
    "lqr": Row(40, without_memory, lqr, LqrGains),
    "mpc": Row(41, without_memory, mpc, MpcGains),
    "pd_weighted": Row(50, weighted_far, weighted, WeightGains),
    "pd_regularised": Row(51, regularised_far, regularised, RegularGains),
    "output_feedback": Row(52, output_feedback, output_feedback, FilterGains),
    "sliding": Row(60, sliding, sliding, SlidingGains),
    "sliding_integral": Row(61, sliding_integral, sliding_integral, SlidingIntegralGains),
}
