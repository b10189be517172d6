"""The laws that damp the rate, by name."""

from fsw.core.laws.damping.damping import SwitchedGains, bdot, bdot_switched, rate_damping
from fsw.core.laws.damping.held_torque import HeldGains, bdot_held
from fsw.core.laws.damping.matrix_gain import MatrixGains, rate_damping_matrix
from fsw.core.laws.damping.optimal import (
    EnergyGains,
    ModelGains,
    MomentumGains,
    least_energy,
    least_momentum,
    rate_model,
)
from fsw.core.laws.entry import Aim, LawEntry

LAWS: dict[str, LawEntry] = {
    "rate_damping": LawEntry(1, Aim.RATE, rate_damping, rate_damping),
    "bdot": LawEntry(2, Aim.RATE, bdot, bdot),
    "rate_damping_matrix": LawEntry(4, Aim.RATE, rate_damping_matrix, rate_damping_matrix, MatrixGains),
    "bdot_held": LawEntry(5, Aim.RATE, bdot_held, bdot_held, HeldGains),
    "least_momentum": LawEntry(6, Aim.RATE, least_momentum, least_momentum, MomentumGains),
    "least_energy": LawEntry(7, Aim.RATE, least_energy, least_energy, EnergyGains),
    "rate_model": LawEntry(8, Aim.RATE, rate_model, rate_model, ModelGains),
    "bdot_switched": LawEntry(10, Aim.RATE, bdot_switched, bdot_switched, SwitchedGains),
}
