"""The laws of a satellite with a momentum wheel, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.wheel.dual_spin import DualSpinGains, dual_spin

LAWS: dict[str, LawEntry] = {
    "dual_spin": LawEntry(20, Aim.AXIS, dual_spin, dual_spin, DualSpinGains),
}
