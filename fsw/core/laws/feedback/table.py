"""The laws that feed attitude and rate back, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.feedback.delayed import DelayGains, delayed
from fsw.core.laws.feedback.field_direction import FieldDirectionGains, field_direction
from fsw.core.laws.feedback.held import (
    ApartGains,
    HoldGains,
    pd_apart,
    pd_apart_far,
    pd_held,
    pd_held_far,
)
from fsw.core.laws.feedback.inertial import InertialGains, inertial, inertial_far
from fsw.core.laws.feedback.neural import NeuralGains, neural
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
from fsw.core.laws.feedback.sphere import ObserverGains, VerticalGains, sphere_output, sphere_vertical
from fsw.core.laws.feedback.two_step import TwoStepGains, two_step

LAWS: dict[str, LawEntry] = {
    "pd": LawEntry(0, Aim.THREE_AXIS, pd_far, pd),
    "pd_weighted": LawEntry(50, Aim.THREE_AXIS, weighted_far, weighted, WeightGains),
    "pd_regularised": LawEntry(51, Aim.THREE_AXIS, regularised_far, regularised, RegularGains),
    "output_feedback": LawEntry(52, Aim.THREE_AXIS, output_feedback, output_feedback, FilterGains),
    "pd_inertial": LawEntry(53, Aim.INERTIAL, inertial_far, inertial, InertialGains),
    "field_direction": LawEntry(54, Aim.THREE_AXIS, field_direction, field_direction, FieldDirectionGains),
    "pd_held": LawEntry(55, Aim.THREE_AXIS, pd_held_far, pd_held, HoldGains),
    "pd_apart": LawEntry(56, Aim.THREE_AXIS, pd_apart_far, pd_apart, ApartGains),
    "pd_delayed": LawEntry(57, Aim.THREE_AXIS, delayed, delayed, DelayGains),
    "two_step": LawEntry(58, Aim.THREE_AXIS, two_step, two_step, TwoStepGains),
    "sphere_vertical": LawEntry(59, Aim.VERTICAL, sphere_vertical, sphere_vertical, VerticalGains),
    "sphere_output": LawEntry(130, Aim.THREE_AXIS, sphere_output, sphere_output, ObserverGains),
    "pd_neural": LawEntry(131, Aim.THREE_AXIS, neural, neural, NeuralGains),
}
