"""Any torque from two coils and one wheel: the inverse of their matrix.

The review has the wheel along its second axis and coils along the first and third; here the wheel is along
any unit vector w, and the dipole lies in the plane normal to it.
"""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, cross, dot, scale
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint, Wheel
from fsw.core.laws.wheel_allocation import affordable
from fsw.core.laws.wheel_effort import Effort, check_frequency, compensated_torque, shortened


@dataclass(frozen=True, slots=True)
class TwoCoilsGains:
    """How fast the attitude is restored.

    Attributes:
        frequency_radps: natural frequency, rad/s.
        damping: damping ratio.
    """

    frequency_radps: float = 0.01
    damping: float = 1.0

    def __post_init__(self) -> None:
        """Check them.

        Raises:
            ValueError: one is out of range.
        """
        check_frequency(self.frequency_radps, self.damping)


def two_coils_and_wheel(torque_body_nm: Vec3, b_body_t: Vec3, axis_body: Vec3) -> Effort | None:
    """The dipole normal to w and the torque tau on the wheel with m x b - tau w = T; None where b . w = 0.

    With w along axis 3 the three unknowns are m_1, m_2 and the torque p = -tau of the wheel on the body:

        | T_1 |   |  0    b_3  0 | | m_1 |
        | T_2 | = | -b_3  0    0 | | m_2 |      p = (b . T) / b_3,  m_1 = -T_2 / b_3,  m_2 = T_1 / b_3
        | T_3 |   |  b_2 -b_1  1 | | p   |

    and for any w, by a change of axes, m = (w x T) / (b . w): only the wheel can give the component of T
    along b. Both grow without bound as the field becomes normal to w.

    Args:
        torque_body_nm: T, body axes.
        b_body_t: b, body axes, T.
        axis_body: w, unit, body axes.

    Source: Desouky, Prabhu, Abdelkhalik 2018, as in Ovchinnikov, Roldugin 2019, section 2.4 [56]; the scan
    lost signs and the inverse, which follow from m x b.
    """
    along = dot(b_body_t, axis_body)
    if along == 0.0:
        return None
    by_wheel_nm = dot(b_body_t, torque_body_nm) / along
    return Effort(scale(1.0 / along, cross(axis_body, torque_body_nm)), -by_wheel_nm)


def two_coils(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The whole torque wanted, by two coils and the wheel; scaled down, its direction kept, if too large.

    Without a wheel whose momentum is known, or with the field normal to it, nothing.
    """
    wheel = config.wheel
    if wheel is None or inputs.wheel_nms is None or not inputs.attitude.usable:
        return Demand()
    effort = two_coils_and_wheel(_wanted(inputs, config), inputs.b_body_t, wheel.axis_body)
    return _demand(None if effort is None else shortened(effort, *_limits(config, wheel)))


def two_coils_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Far from the goal, where the wheel may be normal to the field: all three coils, the least effort."""
    wheel = config.wheel
    if wheel is None or inputs.wheel_nms is None or not inputs.attitude.usable:
        return Demand()
    wanted, limits = _wanted(inputs, config), _limits(config, wheel)
    return _demand(affordable(wanted, inputs.b_body_t, wheel.axis_body, *limits))


def _wanted(inputs: LawInput, config: ControlConfig) -> Vec3:
    gains: TwoCoilsGains = config.gains["two_coils"]
    return compensated_torque(inputs, config, gains.frequency_radps, gains.damping)


def _limits(config: ControlConfig, wheel: Wheel) -> tuple[float, float]:
    """What the coils give, A m^2, and the wheel, N m."""
    return config.mean_dipole_am2, wheel.max_torque_nm


def _demand(effort: Effort | None) -> Demand:
    return Demand() if effort is None else Demand(effort.m_body_am2, wheel_torque_nm=effort.wheel_torque_nm)


LAWS = {
    "two_coils": LawEntry(
        120, Aim.THREE_AXIS, two_coils_far, two_coils, TwoCoilsGains, needs=Need.DRIVEN_WHEEL
    ),
}
