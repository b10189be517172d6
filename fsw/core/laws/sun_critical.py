"""Sun pointing with critical damping about each axis, its torque projected."""

from dataclasses import dataclass

from fsw.core.algebra.vector import Vec3, add, cross, scale, transform
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.projection import torque_dipole
from fsw.core.laws.spin import AXES, SpinGains


@dataclass(frozen=True, slots=True)
class CriticalGains(SpinGains):
    """The body axis to the Sun: 1, 2 or 3, and how fast.

    Attributes:
        xi_radps: double root of each axis under the full torque, rad/s; a few orbital rates at most.

    Raises:
        ValueError: another axis, or a root that is not positive.
    """

    axis: float = 2.0
    xi_radps: float = 0.002

    def __post_init__(self) -> None:
        SpinGains.__post_init__(self)
        if not self.xi_radps > 0.0:
            raise ValueError(f"xi_radps of sun_critical must be positive, not {self.xi_radps:g}")


def critical_acceleration(omega_body_radps: Vec3, sun_body: Vec3, axis: int, xi_radps: float) -> Vec3:
    """The acceleration a = -2 xi omega + xi^2 e x s: theta about each axis across e has the double root -xi.

    For e = 2 it is (-2 xi w1 + xi^2 s3, -2 xi w2, -2 xi w3 - xi^2 s1), and J a over A, with L = A/C and
    mu = (B - C)/A, is the paper's

        m1 = -2 xi w1 + xi^2 s3,  m2 = -2 xi (1 + L mu) w2 / L,  m3 = -(2 xi w3 + xi^2 s1) / L,

    since (1 + L mu) / L = B/A and 1 / L = C/A.

    Args:
        omega_body_radps: absolute rate.
        sun_body: s, unit vector.
        axis: index of e, from zero.
        xi_radps: xi.

    Returns:
        Angular acceleration wanted, body axes, rad/s^2.

    Source: Ignatov, Sazonov 2018, as in Ovchinnikov, Roldugin 2019, section 2.4 [63]; the scan has lost the
    Sun's components and an index, which follow from the double root.
    """
    turning = scale(xi_radps * xi_radps, cross(AXES[axis], sun_body))
    return add(scale(-2.0 * xi_radps, omega_body_radps), turning)


def sun_critical(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The torque J a, projected; without a Sun vector, nothing."""
    gains: CriticalGains = config.gains["sun_critical"]
    moving, sun = motion(inputs, config), inputs.sun_body
    if moving is None or sun is None:
        return Demand()
    wanted = critical_acceleration(moving.omega_body_radps, sun, gains.number, gains.xi_radps)
    return Demand(torque_dipole(transform(config.inertia_kgm2, wanted), inputs.b_body_t))


LAWS = {
    "sun_critical": LawEntry(34, Aim.SUN, sun_critical, sun_critical, CriticalGains),
}
