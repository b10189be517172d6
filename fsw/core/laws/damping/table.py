"""The laws that take the rate away, by name."""

from fsw.core.laws.damping.damping import SwitchedGains, bdot, bdot_switched, rate_damping
from fsw.core.laws.entry import Aim, LawEntry

LAWS: dict[str, LawEntry] = {
    "rate_damping": LawEntry(1, Aim.RATE, rate_damping, rate_damping),
    "bdot": LawEntry(2, Aim.RATE, bdot, bdot),
    "bdot_switched": LawEntry(10, Aim.RATE, bdot_switched, bdot_switched, SwitchedGains),
}
