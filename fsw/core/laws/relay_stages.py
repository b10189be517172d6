"""Nutation, spin and direction one after the other, each by its relay and its switching function."""

from dataclasses import dataclass
from enum import Enum
from math import atan2, degrees

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, dot, norm, scale, sub
from fsw.core.laws.damping import difference_s
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import InertialMotion, motion
from fsw.core.laws.spin import AXES
from fsw.core.laws.spin_axis import TargetGains


@dataclass(frozen=True, slots=True)
class StageGains(TargetGains):
    """Axis and target, and when each stage is done.

    Attributes:
        nutation_deg: angle of the momentum from the axis, above which nutation is damped.
        spin_band_radps: rate missing, above which the spin is built up.
        dead: fraction of the field below which a switching function leaves its coil off.

    Raises:
        ValueError: one of them is not positive, or what ``TargetGains`` refuses.
    """

    nutation_deg: float = 3.0
    spin_band_radps: float = 0.003
    dead: float = 0.02

    def __post_init__(self) -> None:
        TargetGains.__post_init__(self)
        if not (self.nutation_deg > 0.0 and self.spin_band_radps > 0.0 and self.dead > 0.0):
            raise ValueError("nutation_deg, spin_band_radps and dead of relay_stages must be positive")


class SpinStage(Enum):
    """What is done now."""

    NUTATION = "nutation"
    SPIN = "spin"
    DIRECTION = "direction"


def nutation_switch(b_dot_tps: Vec3, axis: int) -> float:
    """-db_e/dt: m_e with its sign damps the rate across e, the power being m_e (b x omega)_e."""
    return -b_dot_tps[axis]


def spin_switches(b_body_t: Vec3, lacking_radps: float, axis: int) -> tuple[float, float]:
    """For coils u and v, (b_v, -b_u) with the sign of the lacking rate; the torque is m_u b_v - m_v b_u."""
    sign = (lacking_radps > 0.0) - (lacking_radps < 0.0)
    return sign * b_body_t[(axis + 2) % 3], -sign * b_body_t[(axis + 1) % 3]


def direction_switch(b_body_t: Vec3, target_body: Vec3, axis: int) -> float:
    """b_u t_v - b_v t_u: m_e with its sign gives the torque m_e e x b a component along the target t."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    return b_body_t[u] * target_body[v] - b_body_t[v] * target_body[u]


def stage(nutation_deg: float, lacking_radps: float, gains: StageGains) -> SpinStage:
    """Nutation first, then spin, then direction."""
    if nutation_deg > gains.nutation_deg:
        return SpinStage.NUTATION
    return SpinStage.SPIN if abs(lacking_radps) > gains.spin_band_radps else SpinStage.DIRECTION


def relay(switch: float, dead: float, m_am2: float) -> float:
    """m0 with the sign of the switching function; off within +-dead."""
    return m_am2 * ((switch > dead) - (switch < -dead))


def relay_stages(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The stage of this tick, its coils fully on: a dipole m0 of each coil of the stage.

    Source: Shigehara 1972, as in Ovchinnikov, Roldugin 2019, section 2.1 [29], which names three stages, a
    relay and switching functions. The functions are derived from the power and the torque that each stage
    needs.
    """
    gains: StageGains = config.gains["relay_stages"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    b, axis, m0 = inputs.b_body_t, gains.number, config.mean_dipole_am2
    lacking = setpoint.spin_radps - moving.omega_body_radps[axis]
    now, dead_t = stage(_nutation_deg(moving, axis), lacking, gains), gains.dead * norm(b)
    if now is SpinStage.NUTATION:
        return Demand(scale(_nutation_am2(inputs, moving, axis, gains.dead, config), AXES[axis]))
    if now is SpinStage.SPIN:
        switch_u, switch_v = spin_switches(b, lacking, axis)
        m = [0.0, 0.0, 0.0]
        m[(axis + 1) % 3], m[(axis + 2) % 3] = relay(switch_u, dead_t, m0), relay(switch_v, dead_t, m0)
        return Demand((m[0], m[1], m[2]))
    target = rotate(moving.q_body_from_eci, gains.target_eci)
    return Demand(scale(relay(direction_switch(b, target, axis), dead_t, m0), AXES[axis]))


def _nutation_am2(
    inputs: LawInput, moving: InertialMotion, axis: int, dead: float, config: ControlConfig
) -> float:
    interval_s = difference_s(inputs, config.tick_s)
    if interval_s == 0.0:
        return 0.0
    b_dot = scale(1.0 / interval_s, sub(inputs.sample.b_body_t, inputs.before.b_body_t))
    across = norm(_across(moving.omega_body_radps, axis))
    dead_tps = dead * norm(inputs.b_body_t) * across
    return relay(nutation_switch(b_dot, axis), dead_tps, config.mean_dipole_am2)


def _nutation_deg(moving: InertialMotion, axis: int) -> float:
    """Angle between the line of the axis and the momentum, 0 to 90 deg."""
    h = moving.momentum_body_nms
    return degrees(atan2(norm(_across(h, axis)), abs(h[axis]))) if h != ZERO else 0.0


def _across(v: Vec3, axis: int) -> Vec3:
    return sub(v, scale(dot(v, AXES[axis]), AXES[axis]))


LAWS = {
    "relay_stages": LawEntry(19, Aim.SPIN, relay_stages, relay_stages, StageGains),
}
