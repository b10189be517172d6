"""The laws of a satellite with a momentum wheel, by name."""

from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.wheel.allocation import AllocationGains, wheel_allocation
from fsw.core.laws.wheel.dual_spin import DualSpinGains, dual_spin
from fsw.core.laws.wheel.horizon_roll import HorizonRollGains, horizon_roll
from fsw.core.laws.wheel.pitch_wheel import PitchWheelGains, pitch_wheel
from fsw.core.laws.wheel.six_gain import SixGainGains, six_gain
from fsw.core.laws.wheel.two_coils import TwoCoilsGains, two_coils, two_coils_far
from fsw.core.laws.wheel.wheel_integral import wheel_integral, wheel_integral_far
from fsw.core.laws.wheel.wheel_relay import WheelRelayGains, wheel_relay

LAWS: dict[str, LawEntry] = {
    "dual_spin": LawEntry(20, Aim.AXIS, dual_spin, dual_spin, DualSpinGains, needs=Need.MOMENTUM),
    "horizon_roll": LawEntry(23, Aim.AXIS, horizon_roll, horizon_roll, HorizonRollGains, needs=Need.MOMENTUM),
    "six_gain": LawEntry(24, Aim.AXIS, six_gain, six_gain, SixGainGains, needs=Need.MOMENTUM),
    "wheel_integral": LawEntry(25, Aim.AXIS, wheel_integral_far, wheel_integral, needs=Need.MOMENTUM),
    "wheel_relay": LawEntry(26, Aim.AXIS, wheel_relay, wheel_relay, WheelRelayGains, needs=Need.MOMENTUM),
    "two_coils": LawEntry(
        120, Aim.THREE_AXIS, two_coils_far, two_coils, TwoCoilsGains, needs=Need.DRIVEN_WHEEL
    ),
    "wheel_allocation": LawEntry(
        121, Aim.THREE_AXIS, wheel_allocation, wheel_allocation, AllocationGains, needs=Need.DRIVEN_WHEEL
    ),
    "pitch_wheel": LawEntry(
        122, Aim.THREE_AXIS, pitch_wheel, pitch_wheel, PitchWheelGains, needs=Need.PITCH_WHEEL
    ),
}
