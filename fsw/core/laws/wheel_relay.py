"""Sliding relay control of the wheel's axis on a polar orbit, with a layer in which the coil is off."""

from dataclasses import dataclass
from math import sqrt

from fsw.core.algebra.vector import Vec3, add
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.roll_yaw import RollYaw, can_hold, pitch_holding_dipole, roll_yaw


@dataclass(frozen=True, slots=True)
class WheelRelayGains:
    """Relay and surface.

    Attributes:
        dipole_am2: of the coil along the wheel when it is on, A m^2.
        lead: the surface keeps the lean at an angle of tangent -lead / (1 + rate_s w0) from the field.
        rate_s: weight of the rates, s.
        layer_rad: angle from the surface within which the coil is off, rad.
    """

    dipole_am2: float = 1.0
    lead: float = 0.2
    rate_s: float = 100.0
    layer_rad: float = 0.01

    def __post_init__(self) -> None:
        """Check the ranges.

        Raises:
            ValueError: a gain out of range.
        """
        if not (0.0 < self.dipole_am2 <= 1e4 and 0.0 <= self.lead <= 10.0):
            raise ValueError(
                "dipole_am2 must be above 0 and at most 1e4 and lead 0 to 10, "
                f"not {self.dipole_am2:g} and {self.lead:g}"
            )
        if not (0.0 <= self.rate_s <= 1e6 and 0.0 <= self.layer_rad <= 1.0):
            raise ValueError(
                f"rate_s must be 0 to 1e6 and layer_rad 0 to 1, not {self.rate_s:g} and {self.layer_rad:g}"
            )


def surface(b_body_t: Vec3, motion: RollYaw, lead: float, rate_s: float) -> float:
    """S = k1 roll' + k2 yaw' + k3 roll + k4 yaw, rad, with p = |(b1, b2)|, the field across the wheel.

        k1 = rate_s b1 / p,    k2 = -rate_s b2 / p,    k3 = (lead b1 - b2) / p,    k4 = -(b1 + lead b2) / p

    The momentum leans by (roll, -yaw). The precession's rates are w0 (-yaw, roll), so that on S = 0 the lean
    keeps an angle to the field whose tangent is -t, t = lead / (1 + rate_s w0). Coil 3 moves it only across
    the field, hence d|lean|/du = -t |lean| dbeta/du, beta the field's direction in inertial axes. In an orbit
    beta makes two turns, and the lean falls by exp(-4 pi t). With lead = 0 only the layer reduces it: the
    turning field carries S to that edge of the layer which does. The rates damp the nutation.

    Args:
        b_body_t: field in body axes, T, with a component across axis 3.
        motion: roll and yaw with their rates.
        lead: 1.
        rate_s: s.

    Source: Wang, Shtessel 1999, as in Ovchinnikov, Roldugin 2019, section 2.2, where S has this form with
    gains that vary with the field but are not given; they are derived here.
    """
    b1, b2, _ = b_body_t
    roll, yaw, roll_rate, yaw_rate = motion
    whole = rate_s * (b1 * roll_rate - b2 * yaw_rate) + (lead * b1 - b2) * roll - (b1 + lead * b2) * yaw
    return whole / sqrt(b1 * b1 + b2 * b2)


def relay_dipole(s_rad: float, dipole_am2: float, layer_rad: float) -> Vec3:
    """m3 = -m0 for S >= eps, 0 for -eps < S < eps, m0 for S <= -eps: dS/dt rises with m3.

    Source: as for ``surface``; the sign is that of dS/dt.
    """
    if abs(s_rad) < layer_rad or s_rad == 0.0:
        return (0.0, 0.0, 0.0)
    return (0.0, 0.0, -dipole_am2 if s_rad > 0.0 else dipole_am2)


def wheel_relay(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The wheel's axis by the relay; the pitch by the other coils, which over the poles do not disturb it."""
    b1, b2, _ = inputs.b_body_t
    if not can_hold(inputs, config) or (b1 == 0.0 and b2 == 0.0):
        return Demand()
    gains: WheelRelayGains = config.gains["wheel_relay"]
    s_rad = surface(inputs.b_body_t, roll_yaw(inputs), gains.lead, gains.rate_s)
    holding = relay_dipole(s_rad, gains.dipole_am2, gains.layer_rad)
    return Demand(add(holding, pitch_holding_dipole(inputs, setpoint)))


LAWS = {
    "wheel_relay": LawEntry(26, Aim.AXIS, wheel_relay, wheel_relay, WheelRelayGains, needs=Need.MOMENTUM),
}
