"""Spin about a body axis: nutation damping, spin-up, and the Y-Thomson spin about the orbit normal.

The review writes these laws for the third axis, Y-Thomson's for the second; here they hold for any body axis
e, with e, u, v in cyclic order. The rate wanted is the spin of the setpoint, absolute.
"""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, add, cross, dot, scale
from fsw.core.laws.damping import difference_s
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion

AXES: tuple[Vec3, Vec3, Vec3] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, slots=True)
class SpinGains:
    """The body axis that spins: 1, 2 or 3.

    Raises:
        ValueError: another number.
    """

    axis: float = 1.0

    def __post_init__(self) -> None:
        if self.axis not in (1.0, 2.0, 3.0):
            raise ValueError(f"the spin axis is body axis 1, 2 or 3, not {self.axis:g}")

    @property
    def number(self) -> int:
        """Index of the axis, from zero."""
        return int(self.axis) - 1


def nutation_dipole(
    b_body_t: Vec3, b_previous_body_t: Vec3, interval_s: float, axis: int, k_w: float
) -> Vec3:
    """The dipole m = -k_w (db/dt . e) e: B-dot of the coil along the spin axis alone.

    Its torque is normal to e, so the spin stays and the rate across it is damped.

    Args:
        b_body_t: field now, body axes, T.
        b_previous_body_t: field ``interval_s`` earlier, body axes then, T.
        interval_s: time between the two samples, s, positive.
        axis: index of e, from zero.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, section 2.1: m3 = -k db3/dt.
    """
    return scale(-k_w * (b_body_t[axis] - b_previous_body_t[axis]) / interval_s, AXES[axis])


def spin_up_dipole(b_body_t: Vec3, axis: int, k: float) -> Vec3:
    """The dipole m = k b x e, for axis 3 k (b2, -b1, 0): the torque about e is k (|b|^2 - (b . e)^2).

    Args:
        b_body_t: field in body axes, T.
        axis: index of e, from zero.
        k: gain, A m^2 / T; positive spins up, negative down.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, section 2.1.
    """
    return scale(k, cross(b_body_t, AXES[axis]))


def y_thomson_dipole(
    b_body_t: Vec3, spin_body_radps: float, wanted_radps: float, axis: int, k_w: float
) -> Vec3:
    """m_v = k (w_e - w_ref) sign b_u: one coil holds the spin, by a torque -k (w_e - w_ref) |b_u| about e.

    For the second axis (e, u, v = 2, 3, 1) that is m1 = k (w2 - w2ref) sign b3. The dipole does not grow with
    the field; k = k_w |b| keeps the unit of the gain.

    Args:
        b_body_t: field in body axes, T.
        spin_body_radps: rate about e, rad/s.
        wanted_radps: rate wanted, rad/s.
        axis: index of e, from zero.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2; none where b_u is zero.

    Source: Thomson 1962, as in Ovchinnikov, Roldugin 2019, section 2.1; signs checked by the torque.
    """
    b_u = b_body_t[(axis + 1) % 3]
    sign = (b_u > 0.0) - (b_u < 0.0)
    size_t = dot(b_body_t, b_body_t) ** 0.5
    return scale(k_w * size_t * (spin_body_radps - wanted_radps) * sign, AXES[(axis + 2) % 3])


def nutation(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Nutation damping from the last two usable field samples."""
    gains: SpinGains = config.gains["nutation"]
    return Demand(_nutation(inputs, setpoint.k_w, gains.number, config.tick_s))


def spin_up(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Spin-up with k = k_w (w_ref - w_e), which ends by itself; nutation damping by the coil along e."""
    gains: SpinGains = config.gains["spin_up"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    lacking_radps = setpoint.spin_radps - moving.omega_body_radps[gains.number]
    spinning = spin_up_dipole(inputs.b_body_t, gains.number, setpoint.k_w * lacking_radps)
    return Demand(add(spinning, _nutation(inputs, setpoint.k_w, gains.number, config.tick_s)))


def y_thomson(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The spin held by one coil; B-dot of the coil along the axis, which turns it to the orbit normal."""
    gains: SpinGains = config.gains["y_thomson"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    holding = y_thomson_dipole(
        inputs.b_body_t,
        moving.omega_body_radps[gains.number],
        setpoint.spin_radps,
        gains.number,
        setpoint.k_w,
    )
    return Demand(add(holding, _nutation(inputs, setpoint.k_w, gains.number, config.tick_s)))


def _nutation(inputs: LawInput, k_w: float, axis: int, tick_s: float) -> Vec3:
    interval_s = difference_s(inputs, tick_s)
    if interval_s == 0.0:
        return (0.0, 0.0, 0.0)
    return nutation_dipole(inputs.sample.b_body_t, inputs.before.b_body_t, interval_s, axis, k_w)


LAWS = {
    "nutation": LawEntry(11, Aim.SPIN, nutation, nutation, SpinGains),
    "spin_up": LawEntry(12, Aim.SPIN, spin_up, spin_up, SpinGains),
    "y_thomson": LawEntry(13, Aim.SPIN, y_thomson, y_thomson, SpinGains),
}
