"""Spin axis to the orbit normal by its roll angle alone: what a horizon sensor and a magnetometer show.

The paper writes the orbital frame with the normal as axis 2 and the dipole m2; here the normal is axis 3, the
radius axis 1, and the spin may be about any body axis e.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Vec3, add, dot, norm, scale
from fsw.core.laws.damping import difference_s
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.spin import AXES, SpinGains, nutation_dipole


@dataclass(frozen=True, slots=True)
class RollGains(SpinGains):
    """The body axis that spins, and the gain of the roll.

    Attributes:
        k_h: 1 / (T^2 s): the roll error decays at about k_h |b|^2.

    Raises:
        ValueError: another axis than 1, 2 or 3, or a gain that is not positive.
    """

    k_h: float = 1.0e6

    def __post_init__(self) -> None:
        SpinGains.__post_init__(self)
        if not self.k_h > 0.0:
            raise ValueError(f"k_h of roll_precession must be positive, not {self.k_h:g}")


def roll_dipole(
    b_body_t: Vec3, radius_body: Vec3, ahead_body: Vec3, momentum_nms: float, axis: int, k_h: float
) -> Vec3:
    """The dipole m = k_h |h| (e . r)(b . v) e, r the radius and v the direction ahead.

    With the momentum along the normal n up to small angles the torque on it is normal to n, and reduces the
    roll: along r it is -k_h |h| (b . v)^2 of it. The yaw, which is not measured, becomes roll a quarter of an
    orbit later.

    Args:
        b_body_t: field in body axes, T.
        radius_body: r, body axes.
        ahead_body: v, body axes.
        momentum_nms: |h|; the momentum may be along e or against it.
        axis: index of e, from zero.
        k_h: gain, 1 / (T^2 s).

    Returns:
        Dipole in body axes, A m^2.

    Source: Alfriend 1975, as in Ovchinnikov, Roldugin 2019, eq. 4: m2 = k1 b1 psi - k2 db2/dt; the scan has
    lost the dot, which eq. 6, named its linear form, shows. The second term is ``nutation_dipole``.
    """
    roll = radius_body[axis]
    return scale(k_h * momentum_nms * roll * dot(b_body_t, ahead_body), AXES[axis])


def roll_precession(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Precession by the roll angle, nutation by db/dt of the coil along e, with k_w."""
    gains: RollGains = config.gains["roll_precession"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    q, axis = inputs.attitude.q_body_from_orbit, gains.number
    radius, ahead = rotate(q, (1.0, 0.0, 0.0)), rotate(q, (0.0, 1.0, 0.0))
    size = norm(moving.momentum_body_nms)
    turning = roll_dipole(inputs.b_body_t, radius, ahead, size, axis, gains.k_h)
    interval_s = difference_s(inputs, config.tick_s)
    if interval_s == 0.0:
        return Demand(turning)
    now, before = inputs.sample.b_body_t, inputs.before.b_body_t
    return Demand(add(turning, nutation_dipole(now, before, interval_s, axis, setpoint.k_w)))


LAWS = {
    "roll_precession": LawEntry(17, Aim.SPIN, roll_precession, roll_precession, RollGains),
}
