"""Sun pointing: the rate across the Sun line is damped; momentum and axis of largest inertia turn to it."""

from fsw.core.algebra.vector import Vec3, cross, dot, norm, scale, sub, unit
from fsw.core.laws.damping import MAX_DIFFERENCE_S
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import motion


def sun_dipole(sun_change_radps: Vec3, cos_alpha: float, k: float) -> Vec3:
    """The dipole m = k cos(alpha) (omega x s) = -k cos(alpha) ds/dt, s the Sun, alpha its angle to the field.

    The torque is k cos(alpha) (s (omega . b) - omega (s . b)): across the Sun it is a drag on omega, never
    a push, for s . b has the sign of cos(alpha); about the Sun it has no mean.

    Args:
        sun_change_radps: ds/dt seen from the body, s x omega, 1/s.
        cos_alpha: cosine of the angle between Sun and field.
        k: gain, A m^2 s.

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, section 2.4.
    """
    return scale(-k * cos_alpha, sun_change_radps)


def sun_pointing(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The Sun law with k = k_w |b|, alpha by the models; without a Sun vector, nothing.

    ds/dt by the estimated rate where there is one, otherwise by the change of the Sun vector itself. Memory:
    the tick and the Sun vector then.
    """
    sun, reference = inputs.sun_body, inputs.reference
    if sun is None or reference is None:
        return Demand()
    memory_now = (float(inputs.tick), *sun)
    change_radps = _sun_change(inputs, sun, memory, config)
    if change_radps is None:
        return Demand(memory=memory_now)
    field_t = norm(reference.b_eci_t)
    cos_alpha = dot(reference.sun_eci, unit(reference.b_eci_t))
    return Demand(sun_dipole(change_radps, cos_alpha, setpoint.k_w * field_t), memory=memory_now)


def _sun_change(inputs: LawInput, sun: Vec3, memory: Memory, config: ControlConfig) -> Vec3 | None:
    """The ds/dt of the law, 1/s; None without a rate or an earlier vector."""
    moving = motion(inputs, config)
    if moving is not None:
        return cross(sun, moving.omega_body_radps)
    if not memory:
        return None
    interval_s = (inputs.tick - memory[0]) * config.tick_s
    if interval_s > MAX_DIFFERENCE_S:
        return None
    return scale(1.0 / interval_s, sub(sun, (memory[1], memory[2], memory[3])))


LAWS = {
    "sun_pointing": LawEntry(30, Aim.SUN, sun_pointing, sun_pointing),
}
