"""The laws that predict what each choice will lead to, by name."""

from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.optimal.lqr import without_memory
from fsw.core.laws.predictive.mpc import MpcGains, mpc
from fsw.core.laws.predictive.mpc_box import BoxGains, mpc_box
from fsw.core.laws.predictive.nmpc import NmpcGains, NmpcReferenceGains, nmpc_damping, nmpc_reference
from fsw.core.laws.predictive.predictive import predictive
from fsw.core.laws.predictive.pulse_mpc import PulseMpcGains, pulse_mpc
from fsw.core.laws.predictive.simple_field import FittedGains, HeldFieldGains, mpc_fitted, mpc_held

LAWS: dict[str, LawEntry] = {
    "predictive": LawEntry(3, Aim.RATE, predictive, predictive),
    "mpc": LawEntry(41, Aim.THREE_AXIS, without_memory, mpc, MpcGains),
    "pulse_mpc": LawEntry(42, Aim.THREE_AXIS, without_memory, pulse_mpc, PulseMpcGains, needs=Need.PULSES),
    "mpc_box": LawEntry(160, Aim.THREE_AXIS, without_memory, mpc_box, BoxGains),
    "mpc_fitted": LawEntry(161, Aim.THREE_AXIS, without_memory, mpc_fitted, FittedGains),
    "mpc_held": LawEntry(162, Aim.THREE_AXIS, without_memory, mpc_held, HeldFieldGains),
    "nmpc_damping": LawEntry(163, Aim.RATE, nmpc_damping, nmpc_damping, NmpcGains),
    "nmpc_reference": LawEntry(164, Aim.RATE, nmpc_reference, nmpc_reference, NmpcReferenceGains),
}
