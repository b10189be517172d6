"""PD dipole law for inertial three-axis pointing.

    m = -k_w b x omega - k_a b x S,     S = (a23 - a32, a31 - a13, a12 - a21) of C(body from target),

omega the absolute rate, body axes, and the target an attitude fixed in ``eci``; far from it 4 qv stands for
S, as for ``pd``. In an orbit the field turns twice in the inertial frame, so that on average the coils reach
each axis. The gravity gradient is a disturbance, largest where the radius is 45 deg from two principal axes.

Gains are those of ``sim/design/inertial_gains.py``: averaging gives the ratio of k_a to k_w^2, Floquet
theory k_w.

Source: Ovchinnikov, Roldugin 2019, section 3.1, eq. 9, after Ovchinnikov, Roldugin, Penkov 2015 (Acta
Astronautica 110).
"""

from dataclasses import dataclass
from math import sqrt

from fsw.core.algebra.quaternion import Quaternion, conjugate, dcm, multiply
from fsw.core.algebra.vector import Vec3
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.pd import attitude_error, far_error, pd_dipole


@dataclass(frozen=True, slots=True)
class InertialGains:
    """The target, q_target_from_eci: vector part of a unit quaternion whose scalar part is not negative."""

    target_q1: float = 0.0
    target_q2: float = 0.0
    target_q3: float = 0.0

    def __post_init__(self) -> None:
        """Raises ValueError: longer than 1."""
        if self.target_q1**2 + self.target_q2**2 + self.target_q3**2 > 1.0:
            raise ValueError(
                "target_q1, target_q2 and target_q3 must be the vector part of a unit quaternion"
            )

    @property
    def q_target_from_eci(self) -> Quaternion:
        """The whole quaternion."""
        square = self.target_q1**2 + self.target_q2**2 + self.target_q3**2
        return (sqrt(1.0 - square), self.target_q1, self.target_q2, self.target_q3)


def from_target(q_body_from_eci: Quaternion, q_target_from_eci: Quaternion) -> Quaternion:
    """q_body_from_target, by the chain q_body_from_eci = q_target_from_eci (x) q_body_from_target."""
    return multiply(conjugate(q_target_from_eci), q_body_from_eci)


def inertial(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Near the target: by S."""
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    error = attitude_error(dcm(_q_body_from_target(moving.q_body_from_eci, config)))
    return _demand(inputs, moving.omega_body_radps, error, setpoint)


def inertial_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Far from it: by an error that does not vanish at 180 deg."""
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    error = far_error(_q_body_from_target(moving.q_body_from_eci, config))
    return _demand(inputs, moving.omega_body_radps, error, setpoint)


def _q_body_from_target(q_body_from_eci: Quaternion, config: ControlConfig) -> Quaternion:
    gains: InertialGains = config.gains["pd_inertial"]
    return from_target(q_body_from_eci, gains.q_target_from_eci)


def _demand(inputs: LawInput, omega_body_radps: Vec3, error: Vec3, setpoint: Setpoint) -> Demand:
    return Demand(pd_dipole(inputs.b_body_t, omega_body_radps, error, setpoint.k_w, setpoint.k_a))


LAWS = {
    "pd_inertial": LawEntry(53, Aim.INERTIAL, inertial_far, inertial, InertialGains),
}
