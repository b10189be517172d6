"""Sun pointing from the currents of solar panels alone: their difference, and which one has the most."""

from dataclasses import dataclass

from fsw.core.algebra.vector import ZERO, Vec3, add, cross, dot, scale
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion
from fsw.core.laws.projection import torque_dipole
from fsw.core.laws.spin import AXES, SpinGains


@dataclass(frozen=True, slots=True)
class PanelGains(SpinGains):
    """The body axis to the Sun: 1, 2 or 3, and the share of the difference.

    Attributes:
        difference: gain of the difference of currents, in units of k_a.

    Raises:
        ValueError: another axis, or a share that is not positive.
    """

    difference: float = 1.0

    def __post_init__(self) -> None:
        SpinGains.__post_init__(self)
        if not self.difference > 0.0:
            raise ValueError(f"difference of sun_panels must be positive, not {self.difference:g}")


def panel_currents(sun_body: Vec3) -> tuple[float, ...]:
    """Of panels on +1, -1, +2, -2, +3, -3, in units of full sunlight: the cosine of incidence, or zero."""
    return tuple(max(0.0, sign * part) for part in sun_body for sign in (1.0, -1.0))


def panel_torque(currents: tuple[float, ...], axis: int, k_difference: float, k_most: float) -> Vec3:
    """M_ref = k1 delta e_v + k2 e x s_max.

    delta is the difference of the currents of panels +-u, in full sunlight, and s_max the normal of the panel
    with the most; e, u, v are in cyclic order. For e = 1 that is k1 delta e3 + k2 e1 x s_max. The first term
    removes the Sun's component along u, the second turns e to the panel that sees most. Nothing removes the
    component along v once the panel on e sees most: there the Sun may stand 45 deg off.

    Args:
        currents: of ``panel_currents``.
        axis: index of e, from zero.
        k_difference: k1, N m.
        k_most: k2, N m.

    Returns:
        M_ref, body axes, N m.

    Source: Kim, Worrall 2013 (UKube-1), as in Ovchinnikov, Roldugin 2019, section 2.4 [60]. Which pair drives
    which axis follows from the sense of the torque: about e x u it turns e to u.
    """
    u, v = (axis + 1) % 3, (axis + 2) % 3
    delta = currents[2 * u] - currents[2 * u + 1]
    most = max(range(6), key=lambda panel: currents[panel])
    normal = scale(-1.0 if most % 2 else 1.0, AXES[most // 2])
    return add(scale(k_difference * delta, AXES[v]), scale(k_most, cross(AXES[axis], normal)))


def sun_panels(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The panels' torque with k2 = k_a |b|^2 and damping -k_w |b|^2 omega, projected; nothing in the dark.

    The damping, of which the review says nothing, is that of its eq. 1.
    """
    gains: PanelGains = config.gains["sun_panels"]
    moving, sun = motion(inputs, config), inputs.sun_body
    if moving is None or sun is None:
        return Demand()
    square = dot(inputs.b_body_t, inputs.b_body_t)
    k_most = setpoint.k_a * square
    turning = panel_torque(panel_currents(sun), gains.number, gains.difference * k_most, k_most)
    damping = scale(-setpoint.k_w * square, moving.omega_body_radps)
    torque = add(turning, damping)
    return Demand(torque_dipole(torque, inputs.b_body_t)) if torque != ZERO else Demand()


LAWS = {
    "sun_panels": LawEntry(33, Aim.SUN, sun_panels, sun_panels, PanelGains),
}
