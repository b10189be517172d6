"""A slow spin about the orbit normal from the magnetometer alone: B-dot, and two coils that drive it."""

from fsw.core.algebra.vector import Vec3, add, cross, scale
from fsw.core.laws.damping import bdot_dipole, difference_s
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.spin import AXES, SpinGains


def push_dipole(b_body_t: Vec3, axis: int, k_am2pt: float) -> Vec3:
    """The dipole m = K (e x b), K = diag(k, k, 0) for axis 3: the torque about e is -k |b across e|^2.

    With B-dot beside it, m = -k_w b x omega + k e x b = -k_w b x (omega + (k/k_w) e): B-dot about the spin
    w_ref = -k/k_w instead of about rest. The part of B-dot that follows the field along the orbit turns e to
    the normal.

    Args:
        b_body_t: field in body axes, T.
        axis: index of e, from zero.
        k_am2pt: k, A m^2 / T.

    Returns:
        Dipole in body axes, A m^2.

    Source: Jan, Tsai 2005, as in Ovchinnikov, Roldugin 2019, section 2.4 [59]: two coils, one axis without a
    fast spin. The review prints this term alone, which by itself spins up without end; B-dot beside it is
    this project's, after the paper's title, the first acquisition.
    """
    return scale(k_am2pt, cross(AXES[axis], b_body_t))


def slow_spin(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """B-dot with k_w from two field samples, and the push with k = -k_w w_ref, w_ref the setpoint's spin."""
    gains: SpinGains = config.gains["slow_spin"]
    interval_s = difference_s(inputs, config.tick_s)
    if interval_s == 0.0:
        return Demand()
    now = inputs.sample.b_body_t
    damping = bdot_dipole(now, inputs.before.b_body_t, interval_s, setpoint.k_w)
    push = push_dipole(now, gains.number, -setpoint.k_w * setpoint.spin_radps)
    return Demand(add(damping, push))


LAWS = {
    "slow_spin": LawEntry(32, Aim.SPIN, slow_spin, slow_spin, SpinGains),
}
