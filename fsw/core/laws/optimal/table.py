"""The laws with the least cost of a linear model, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.optimal.lqr import LqrGains, lqr, without_memory

LAWS: dict[str, LawEntry] = {
    "lqr": LawEntry(40, Aim.THREE_AXIS, without_memory, lqr, LqrGains),
}
