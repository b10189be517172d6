"""The law of six gains: what the earlier laws of a satellite with a pitch wheel have in common."""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, add
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.roll_yaw import RollYaw, can_hold, pitch_holding_dipole, roll_yaw


@dataclass(frozen=True, slots=True)
class SixGainGains:
    """The gains besides k1 = 2 k_a and k3 = k_w, all dimensionless.

    Attributes:
        k2: of yaw, relative to roll.
        k4: of the yaw rate, relative to the roll rate.
        k5: of the springs, relative to k1.
        k6: of yaw in the springs, relative to roll.
    """

    k2: float = 1.0
    k4: float = 1.0
    k5: float = 0.0
    k6: float = 1.0

    def __post_init__(self) -> None:
        """Check the ranges.

        Raises:
            ValueError: a gain out of range.
        """
        for name in ("k2", "k4", "k5", "k6"):
            value = getattr(self, name)
            if not -10.0 <= value <= 10.0:
                raise ValueError(f"{name} must be -10 to 10, not {value:g}")


def six_gain_dipole(b_body_t: Vec3, motion: RollYaw, k1: float, k3: float, gains: SixGainGains) -> Vec3:
    """Dipole of the coil along the wheel.

        m3 = k1 (b2 roll + k2 b1 yaw) - k3 (b1 roll' - k4 b2 yaw') - k1 k5 (b1 roll - k6 b2 yaw)

    The first part turns the momentum back, the second takes energy away, the third is a spring: with k6 = 1
    its torque has a potential. k2 = k5 = 0, k4 = 1 is that of ``dual_spin`` at pitch zero. For yaw unknown,
    as with a horizon sensor alone, k2 = k6 = 0.

    Args:
        b_body_t: field in body axes, T.
        motion: roll and yaw with their rates.
        k1: N m / T^2.
        k3: N m s / T^2.
        gains: the other four.

    Returns:
        Dipole in body axes, A m^2.

    Source: Hablani 1995 (Comparative stability analysis), as in Ovchinnikov, Roldugin 2019, section 2.2, with
    its axes 1, 2, 3 as 2, 3, 1 here. The scan lost signs and dots; they follow from the two laws that the
    text says are contained, and from the torque. k5 is relative to k1 here.
    """
    b1, b2, _ = b_body_t
    roll, yaw, roll_rate, yaw_rate = motion
    turning = b2 * roll + gains.k2 * b1 * yaw - gains.k5 * (b1 * roll - gains.k6 * b2 * yaw)
    return (0.0, 0.0, k1 * turning - k3 * (b1 * roll_rate - gains.k4 * b2 * yaw_rate))


def six_gain(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The wheel held to the orbit normal by six gains, the pitch by the other two coils."""
    if not can_hold(inputs, config):
        return Demand()
    gains: SixGainGains = config.gains["six_gain"]
    holding = six_gain_dipole(inputs.b_body_t, roll_yaw(inputs), 2.0 * setpoint.k_a, setpoint.k_w, gains)
    return Demand(add(holding, pitch_holding_dipole(inputs, setpoint)))


LAWS = {
    "six_gain": LawEntry(24, Aim.AXIS, six_gain, six_gain, SixGainGains, needs=Need.MOMENTUM),
}
