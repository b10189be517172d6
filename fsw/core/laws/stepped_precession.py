"""Spin axis to the orbit normal by steps: the coil along it is held at one of three levels for a while."""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, dot, norm, scale, unit
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.spin import AXES, SpinGains


@dataclass(frozen=True, slots=True)
class StepGains(SpinGains):
    """The body axis that spins, the length of a step, and what is small enough.

    Attributes:
        hold_s: how long a level is held, s.
        dead: error, in rad, below which the coil stays off.

    Raises:
        ValueError: one of them is not positive, or another axis than 1, 2 or 3.
    """

    hold_s: float = 120.0
    dead: float = 0.01

    def __post_init__(self) -> None:
        SpinGains.__post_init__(self)
        if not (self.hold_s > 0.0 and self.dead > 0.0):
            raise ValueError("hold_s and dead of stepped_precession must be positive")


def step_level(b_radius_t: float, b_ahead_t: float, roll: float, yaw: float, dead_t: float) -> float:
    """The level -1, 0 or 1: the sign of b_v roll - b_r yaw, off within a dead zone.

    For a momentum along the normal the dipole m along it gives the torque m (-b_v, b_r) in radius and ahead,
    so that a level of this sign reduces roll^2 + yaw^2. Seen from the orbital frame a momentum at rest in
    space has roll' = w0 yaw: the yaw is the rate of the roll.

    Args:
        b_radius_t: b_r, field along the radius, T.
        b_ahead_t: b_v, field ahead, T.
        roll: of the momentum's direction, its component along the radius.
        yaw: its component ahead.
        dead_t: half the dead zone, T.

    Source: Ergin, Wheeler 1965, as in Ovchinnikov, Roldugin 2019, section 2.1 [39]: piecewise constant, from
    simple errors of angles and rates. The review prints no equation; this one is derived from the torque.
    """
    error = b_ahead_t * roll - b_radius_t * yaw
    return float((error > dead_t) - (error < -dead_t))


def stepped_precession(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The level, times the mean dipole. Memory: the tick at which the step began, and its level."""
    gains: StepGains = config.gains["stepped_precession"]
    moving = motion(inputs, config)
    if moving is None or moving.momentum_body_nms == ZERO:
        return Demand()
    if not memory or (inputs.tick - memory[0]) * config.tick_s >= gains.hold_s:
        memory = (float(inputs.tick), _level(inputs, unit(moving.momentum_body_nms), gains))
    return Demand(scale(memory[1] * config.mean_dipole_am2, AXES[gains.number]), memory=memory)


def _level(inputs: LawInput, along_body: Vec3, gains: StepGains) -> float:
    """The level along e, of a momentum along e or against it."""
    q, b = inputs.attitude.q_body_from_orbit, inputs.b_body_t
    radius, ahead = rotate(q, (1.0, 0.0, 0.0)), rotate(q, (0.0, 1.0, 0.0))
    sign = 1.0 if along_body[gains.number] >= 0.0 else -1.0
    roll, yaw = dot(along_body, radius), dot(along_body, ahead)
    return sign * step_level(dot(b, radius), dot(b, ahead), roll, yaw, gains.dead * norm(b))


LAWS = {
    "stepped_precession": LawEntry(100, Aim.SPIN, stepped_precession, stepped_precession, StepGains),
}
