"""Sliding control: a surface in rate and attitude on which the attitude error decays, and a torque to it.

On the surface s = J Omega + K q = 0 (10) the attitude decays by itself; the torque demanded is parallel to
s, M_ref = -c s, and the coils give its projection normal to the field. With integrals,

    s = J Omega + K q + K_i (integral of q) + (integral of b b^T M_ref / |b|^2),

the first holds the mean error and so counters a constant torque; the second is the impulse that the coils
could not give: with it ds/dt is that under full control, so that the coils can reach the surface. In
simulation it delays convergence, and a constant torque winds it up: its fraction is zero by default.

Source: Ovchinnikov, Roldugin 2019, eq. 10 and the surface with integrals after it. The scan damages the
latter: the second integral is one of b b^T alone there. What it integrates is derived here, from the lost
torque dropping out of ds/dt.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import canonical
from fsw.core.algebra.vector import ZERO, Vec3, add, dot, norm, scale, transform
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.projection import torque_dipole

LEAST_REACH = 1e-6


def _check(reach: float, slope: float) -> None:
    if reach < LEAST_REACH:
        raise ValueError(f"reach must be at least {LEAST_REACH:g}")
    if not slope > 0.0:
        raise ValueError("slope must be greater than 0")


@dataclass(frozen=True, slots=True)
class SlidingGains:
    """In units of the orbital rate w0 and the mean moment J: c = reach w0, K = slope w0 J."""

    reach: float = 3.0
    slope: float = 0.5

    def __post_init__(self) -> None:
        """Raises ValueError: no way to the surface, or one on which the attitude does not decay."""
        _check(self.reach, self.slope)


@dataclass(frozen=True, slots=True)
class SlidingIntegralGains:
    """As for ``SlidingGains``; K_i = integral w0^2 J, and the fraction of the lost impulse integrated."""

    reach: float = 3.0
    slope: float = 0.5
    integral: float = 0.1
    lost: float = 0.0

    def __post_init__(self) -> None:
        """Raises ValueError: as for ``SlidingGains``, on which the bounds depend, or a negative integral."""
        _check(self.reach, self.slope)
        if not (self.integral >= 0.0 and self.lost >= 0.0):
            raise ValueError("integral and lost must not be less than 0")


def surface(momentum_nms: Vec3, attitude: Vec3, stiffness_nms: float) -> Vec3:
    """The surface s = J Omega + K q, body axes, N m s.

    Args:
        momentum_nms: J Omega, body axes.
        attitude: q, vector part of the quaternion for a scalar part >= 0.
        stiffness_nms: K.
    """
    return add(momentum_nms, scale(stiffness_nms, attitude))


def lost_torque(torque_body_nm: Vec3, b_body_t: Vec3) -> Vec3:
    """The part of a torque along b, b b^T M / |b|^2, N m: what no dipole can give."""
    square = dot(b_body_t, b_body_t)
    return scale(dot(b_body_t, torque_body_nm) / square, b_body_t) if square > 0.0 else torque_body_nm


def sliding(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """M_ref = -c s on the surface without integrals, projected."""
    if not inputs.attitude.usable or inputs.reference is None:
        return Demand()
    gains: SlidingGains = config.gains["sliding"]
    w0 = inputs.reference.orbit_rate_radps
    s = _surface(inputs, gains.slope * w0, config)
    return Demand(torque_dipole(scale(-gains.reach * w0, s), inputs.b_body_t))


def sliding_integral(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same with both integrals; memory: K_i times the first, and the second, N m s each.

    Each is bounded where it alone would demand more than the coils can give on average.
    """
    held = _held(memory)
    if not inputs.attitude.usable or inputs.reference is None:
        return Demand(memory=(*held[0], *held[1]))
    gains: SlidingIntegralGains = config.gains["sliding_integral"]
    w0 = inputs.reference.orbit_rate_radps
    reach = gains.reach * w0
    most = config.mean_dipole_am2 * norm(inputs.b_body_t) / reach
    grown = scale(gains.integral * w0**2 * mean_moment(config) * config.tick_s, _attitude(inputs))
    mean = _bounded(add(held[0], grown), most)
    s = add(_surface(inputs, gains.slope * w0, config), add(mean, held[1]))
    wanted = scale(-reach, s)
    lost = scale(gains.lost * config.tick_s, lost_torque(wanted, inputs.b_body_t))
    missed = _bounded(add(held[1], lost), most)
    return Demand(torque_dipole(wanted, inputs.b_body_t), memory=(*mean, *missed))


def mean_moment(config: ControlConfig) -> float:
    """A third of the trace of J, kg m^2."""
    (j1, _, _), (_, j2, _), (_, _, j3) = config.inertia_kgm2
    return (j1 + j2 + j3) / 3.0


def _surface(inputs: LawInput, slope_radps: float, config: ControlConfig) -> Vec3:
    momentum = transform(config.inertia_kgm2, inputs.attitude.omega_body_orbit_radps)
    return surface(momentum, _attitude(inputs), slope_radps * mean_moment(config))


def _attitude(inputs: LawInput) -> Vec3:
    _, q1, q2, q3 = canonical(inputs.attitude.q_body_from_orbit)
    return (q1, q2, q3)


def _bounded(impulse_nms: Vec3, most_nms: float) -> Vec3:
    size = norm(impulse_nms)
    return scale(most_nms / size, impulse_nms) if size > most_nms else impulse_nms


def _held(memory: Memory) -> tuple[Vec3, Vec3]:
    if len(memory) != 6:
        return ZERO, ZERO
    a1, a2, a3, b1, b2, b3 = memory
    return (a1, a2, a3), (b1, b2, b3)


LAWS = {
    "sliding": LawEntry(60, Aim.THREE_AXIS, sliding, sliding, SlidingGains),
    "sliding_integral": LawEntry(
        61, Aim.THREE_AXIS, sliding_integral, sliding_integral, SlidingIntegralGains
    ),
}
