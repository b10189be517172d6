"""The laws that minimise the cost of a linear model, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.optimal.averaged import AveragedGains, lqr_averaged
from fsw.core.laws.optimal.boxed import boxed, boxed_far
from fsw.core.laws.optimal.disturbed import DisturbedGains, lqr_disturbed
from fsw.core.laws.optimal.field_only import FieldOnlyGains, lqg_field
from fsw.core.laws.optimal.h_infinity import HInfinityGains, h_infinity
from fsw.core.laws.optimal.lqr import LqrGains, lqr, without_memory
from fsw.core.laws.optimal.sdre import SdreGains, sdre

LAWS: dict[str, LawEntry] = {
    "lqr": LawEntry(40, Aim.THREE_AXIS, without_memory, lqr, LqrGains),
    "h_infinity": LawEntry(43, Aim.THREE_AXIS, without_memory, h_infinity, HInfinityGains),
    "lqr_averaged": LawEntry(44, Aim.THREE_AXIS, without_memory, lqr_averaged, AveragedGains),
    "lqr_disturbed": LawEntry(45, Aim.THREE_AXIS, without_memory, lqr_disturbed, DisturbedGains),
    "sdre": LawEntry(46, Aim.THREE_AXIS, sdre, sdre, SdreGains),
    "lqg_field": LawEntry(47, Aim.THREE_AXIS, lqg_field, lqg_field, FieldOnlyGains),
    "pd_boxed": LawEntry(48, Aim.THREE_AXIS, boxed_far, boxed),
}
