"""Sliding control of a sphere: a relay of the coils on a surface in the rate alone.

The surface is s = Omega + K q, as in ``rate_surface``. For a sphere of moment J the coils change
V = 1/2 J |s|^2 at s . (m x b) = m . (b x s), which is least with each coil against its component of b x s:

    m_j = -m_0 sat((b x s)_j / (|b| layer)).

For unequal moments, V = 1/2 |s|^2, the coils' part is s . J^-1 (m x b), whose sign is not certain.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Wang, Shtessel 1998: the rate alone in the surface,
shown to be asymptotically stable for a sphere. The review prints no equation; surface and relay are derived.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import canonical
from fsw.core.algebra.vector import Vec3, cross, norm
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.sliding_rate import rate_surface


@dataclass(frozen=True, slots=True)
class SphereSlidingGains:
    """In units of the orbital rate w0: K = slope w0, layer = layer w0; m_0 is ``part`` of the mean dipole."""

    slope: float = 0.5
    layer: float = 0.5
    part: float = 0.02

    def __post_init__(self) -> None:
        """Raises ValueError: one that is not greater than 0, or more than the whole dipole."""
        if min(self.slope, self.layer) <= 0.0 or not 0.0 < self.part <= 1.0:
            raise ValueError("slope and layer must be greater than 0, and part between 0 and 1")


def relay_dipole(s_radps: Vec3, b_body_t: Vec3, m0_am2: float, layer_radps: float) -> Vec3:
    """m_j = -m_0 sat((b x s)_j / (|b| layer)), body axes, A m^2; zero without a field."""
    size = norm(b_body_t) * layer_radps
    if size <= 0.0:
        return (0.0, 0.0, 0.0)
    m1, m2, m3 = (-m0_am2 * max(-1.0, min(1.0, part / size)) for part in cross(b_body_t, s_radps))
    return (m1, m2, m3)


def sliding_sphere(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The relay on the surface in the rate."""
    if not inputs.attitude.usable or inputs.reference is None:
        return Demand()
    gains: SphereSlidingGains = config.gains["sliding_sphere"]
    w0 = inputs.reference.orbit_rate_radps
    _, q1, q2, q3 = canonical(inputs.attitude.q_body_from_orbit)
    s = rate_surface(inputs.attitude.omega_body_orbit_radps, (q1, q2, q3), gains.slope * w0)
    m0 = gains.part * config.mean_dipole_am2
    return Demand(relay_dipole(s, inputs.b_body_t, m0, gains.layer * w0))


LAWS = {
    "sliding_sphere": LawEntry(66, Aim.THREE_AXIS, sliding_sphere, sliding_sphere, SphereSlidingGains),
}
