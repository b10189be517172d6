"""The laws that feed attitude and rate back, by name."""

from fsw.core.laws.entry import Aim, LawEntry
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

LAWS: dict[str, LawEntry] = {
    "pd": LawEntry(0, Aim.THREE_AXIS, pd_far, pd),
    "pd_weighted": LawEntry(50, Aim.THREE_AXIS, weighted_far, weighted, WeightGains),
    "pd_regularised": LawEntry(51, Aim.THREE_AXIS, regularised_far, regularised, RegularGains),
    "output_feedback": LawEntry(52, Aim.THREE_AXIS, output_feedback, output_feedback, FilterGains),
}
