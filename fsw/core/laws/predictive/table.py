"""The laws that look at what each choice will lead to, by name."""

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.optimal.lqr import without_memory
from fsw.core.laws.predictive.mpc import MpcGains, mpc
from fsw.core.laws.predictive.predictive import predictive
from fsw.core.laws.predictive.pulse_mpc import PulseMpcGains, pulse_mpc

LAWS: dict[str, LawEntry] = {
    "predictive": LawEntry(3, Aim.RATE, predictive, predictive),
    "mpc": LawEntry(41, Aim.THREE_AXIS, without_memory, mpc, MpcGains),
    "pulse_mpc": LawEntry(42, Aim.THREE_AXIS, without_memory, pulse_mpc, PulseMpcGains, plans_pulses=True),
}
