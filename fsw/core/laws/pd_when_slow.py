"""PD with the gravity gradient: attitude only while the body is slow, damping alone while it is fast."""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import ZERO, Vec3, norm
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import attitude_error, far_error, pd_dipole


@dataclass(frozen=True, slots=True)
class SlowGains:
    """The rate up to which the attitude counts.

    Raises:
        ValueError: it is not positive.
    """

    slow_radps: float = 0.004

    def __post_init__(self) -> None:
        if not self.slow_radps > 0.0:
            raise ValueError(f"slow_radps of pd_when_slow must be positive, not {self.slow_radps:g}")


def error_when_slow(error: Vec3, omega_body_orbit_radps: Vec3, slow_radps: float) -> Vec3:
    """The attitude error while |Omega| <= slow, otherwise zero.

    With the PD torque M_ref = -(k_a S + k_w Omega) and the gravity gradient, the motion is stable where the
    rate is small; a body that tumbles passes through all attitudes, and the attitude term adds as much energy
    as it takes. Damping alone never adds any.

    Args:
        error: S or E of ``pd``.
        omega_body_orbit_radps: rate relative to the orbital frame, body axes.
        slow_radps: largest rate.

    Source: Lovera, Astolfi 2006, as in Ovchinnikov, Roldugin 2019, section 2.3 [54]: eq. 8 with the gravity
    torque, stable at small rates; otherwise only its damping part.
    """
    return error if norm(omega_body_orbit_radps) <= slow_radps else ZERO


def slow_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Far from the goal, by the error that does not vanish upside down."""
    if not inputs.attitude.usable:
        return Demand()
    return _demand(inputs, far_error(inputs.attitude.q_body_from_orbit), setpoint, config)


def slow_near(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Near the goal, by S."""
    if not inputs.attitude.usable:
        return Demand()
    return _demand(inputs, attitude_error(dcm(inputs.attitude.q_body_from_orbit)), setpoint, config)


def _demand(inputs: LawInput, error: Vec3, setpoint: Setpoint, config: ControlConfig) -> Demand:
    gains: SlowGains = config.gains["pd_when_slow"]
    rate = inputs.attitude.omega_body_orbit_radps
    held = error_when_slow(error, rate, gains.slow_radps)
    return Demand(pd_dipole(inputs.b_body_t, rate, held, setpoint.k_w, setpoint.k_a))


LAWS = {
    "pd_when_slow": LawEntry(31, Aim.THREE_AXIS, slow_far, slow_near, SlowGains),
}
