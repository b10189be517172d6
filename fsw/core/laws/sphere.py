"""Laws for a sphere, which has no gyroscopic torque: dOmega/dt = u but for the rotation of the orbital frame.

``sphere_vertical`` holds an axis a of the body to the local vertical r, the angle about it free. Full control

    M_ref = |b|^2 (2 k_a a x r - k_w Omega),     m = b x M_ref / |b|^2

lowers V = 1/2 J |Omega|^2 + 2 k_a |b|^2 (1 - a . r); the coils give its part normal to the field.

``sphere_output`` needs no rate: an observer with quaternion z and rate w follows the sphere's own equations.
With d = 2 vec(z^-1 q) and M the torque of the last tick's dipole, limited to what the coils can give:

    z' = 1/2 z (0, w + 2 a d),   w' = M / J + w0 w x e3 + a^2 d,   m = -k_w b x w - k_a b x E,   E = 4 qv.

Its error is critically damped, with bandwidth a, for any a and tick: a step takes the d of its end. As it
knows the torque it does not lag as the filter of ``output_feedback`` does; for a body that is not a sphere
the gyroscopic and gravity torques are its error.

Source: Ovchinnikov, Roldugin 2019, section 3.1: the vertical after Bushenkov, Ovchinnikov, Smirnov 2002; the
law without a rate after Reyhanoglu, Drakunov 2008 and Reyhanoglu, Ton, Drakunov 2009. The review prints no
equation; both are derived here from what it says of them. Smirnov's law to the field is ``field_direction``
with a target.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import (
    Quaternion,
    canonical,
    conjugate,
    from_small_rotation,
    multiply,
    normalise,
    rotate,
)
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, dot, scale, unit
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.output_feedback import MAX_BANDWIDTH_RADPS
from fsw.core.laws.pd import far_error, pd_dipole
from fsw.core.laws.projection import torque_dipole

RADIUS: Vec3 = (1.0, 0.0, 0.0)
"""Orbital axes."""
NORMAL: Vec3 = (0.0, 0.0, 1.0)
"""Of the orbit, orbital axes."""


@dataclass(frozen=True, slots=True)
class VerticalGains:
    """The axis a in body axes, of any length but zero."""

    axis_1: float = 1.0
    axis_2: float = 0.0
    axis_3: float = 0.0

    def __post_init__(self) -> None:
        """Raises ValueError: no direction."""
        if self.axis_body == ZERO:
            raise ValueError("axis_1, axis_2 and axis_3 must give a direction, neither zero nor immense")

    @property
    def axis_body(self) -> Vec3:
        """Unit vector."""
        return unit((self.axis_1, self.axis_2, self.axis_3))


@dataclass(frozen=True, slots=True)
class ObserverGains:
    """Bandwidth a of the observer, rad/s."""

    bandwidth_radps: float = 0.02

    def __post_init__(self) -> None:
        """Raises ValueError: an observer that does not follow."""
        if not 0.0 < self.bandwidth_radps <= MAX_BANDWIDTH_RADPS:
            raise ValueError(f"bandwidth_radps must be above 0 and at most {MAX_BANDWIDTH_RADPS:g}")


def vertical_torque(
    b_body_t: Vec3, omega_body_orbit_radps: Vec3, axis: Vec3, radius_body: Vec3, k_w: float, k_a: float
) -> Vec3:
    """M_ref = |b|^2 (2 k_a a x r - k_w Omega), body axes, N m.

    Args:
        b_body_t: field, T.
        omega_body_orbit_radps: Omega, rad/s.
        axis: a, unit vector.
        radius_body: r, unit vector, body axes.
        k_w: N m s / T^2.
        k_a: N m / T^2.
    """
    wanted = add(scale(2.0 * k_a, cross(axis, radius_body)), scale(-k_w, omega_body_orbit_radps))
    return scale(dot(b_body_t, b_body_t), wanted)


def sphere_vertical(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The axis held to the vertical, the rate about it damped."""
    if not inputs.attitude.usable:
        return Demand()
    gains: VerticalGains = config.gains["sphere_vertical"]
    radius = rotate(inputs.attitude.q_body_from_orbit, RADIUS)
    omega = inputs.attitude.omega_body_orbit_radps
    torque = vertical_torque(inputs.b_body_t, omega, gains.axis_body, radius, setpoint.k_w, setpoint.k_a)
    return Demand(torque_dipole(torque, inputs.b_body_t))


def observed(
    followed: Quaternion,
    rate_radps: Vec3,
    q_body_from_orbit: Quaternion,
    change_radps2: Vec3,
    bandwidth_radps: float,
    tick_s: float,
) -> tuple[Quaternion, Vec3]:
    """The observer's quaternion z and rate w one tick later, by an implicit step.

    With h the tick, y = z turned by h w and e = 2 vec(y^-1 q), d at the end of the tick is e / (1 + a h)^2:
    z is y turned by a h (2 + a h) d, and w changes by h (dOmega/dt + a^2 d). Both poles are 1 / (1 + a h).

    Args:
        followed: z.
        rate_radps: w, body axes.
        q_body_from_orbit: q, measured.
        change_radps2: dOmega/dt as expected.
        bandwidth_radps: a.
        tick_s: length of a tick.
    """
    part = bandwidth_radps * tick_s
    moved = multiply(followed, from_small_rotation(scale(tick_s, rate_radps)))
    _, e1, e2, e3 = canonical(multiply(conjugate(moved), q_body_from_orbit))
    d = scale(2.0 / (1.0 + part) ** 2, (e1, e2, e3))
    faster = scale(tick_s, add(change_radps2, scale(bandwidth_radps**2, d)))
    turned = multiply(moved, from_small_rotation(scale(part * (2.0 + part), d)))
    return normalise(turned), add(rate_radps, faster)


def sphere_output(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The PD law on the observer's rate; memory: z, w and what the coils gave of the dipole."""
    if not inputs.attitude.usable or inputs.reference is None:
        return Demand()
    gains: ObserverGains = config.gains["sphere_output"]
    q, w0 = inputs.attitude.q_body_from_orbit, inputs.reference.orbit_rate_radps
    z, w = q, ZERO
    if len(memory) == 10:
        z0, z1, z2, z3, w1, w2, w3, m1, m2, m3 = memory
        (j1, _, _), (_, j2, _), (_, _, j3) = config.inertia_kgm2
        pushed = scale(3.0 / (j1 + j2 + j3), cross((m1, m2, m3), inputs.b_body_t))
        turning = scale(w0, cross((w1, w2, w3), rotate(q, NORMAL)))
        change = add(pushed, turning)
        z, w = observed((z0, z1, z2, z3), (w1, w2, w3), q, change, gains.bandwidth_radps, config.tick_s)
    dipole = pd_dipole(inputs.b_body_t, w, far_error(q), setpoint.k_w, setpoint.k_a)
    return Demand(dipole, memory=(*z, *w, *_given(dipole, config.mean_dipole_am2)))


def _given(dipole_am2: Vec3, most_am2: float) -> Vec3:
    """What the coils give of a dipole: its direction, no component beyond their largest mean."""
    largest = max(map(abs, dipole_am2))
    return scale(most_am2 / largest, dipole_am2) if largest > most_am2 else dipole_am2


LAWS = {
    "sphere_vertical": LawEntry(59, Aim.VERTICAL, sphere_vertical, sphere_vertical, VerticalGains),
    "sphere_output": LawEntry(130, Aim.THREE_AXIS, sphere_output, sphere_output, ObserverGains),
}
