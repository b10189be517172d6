"""Momentum to a direction in space: relay law, reorientation by one coil, and the three-term law.

Two errors of a satellite that is to spin about body axis e, its momentum along an inertial direction t:

    L1 = |h_ref| t - h    the momentum, which only torques change in space,
    L2 = h_ref e - h      the momentum in the body: spin, and the nutation across it,

h = J omega + h_wheel and h_ref = e . (J e w_ref + h_wheel). Where h_ref < 0, as with a negative spin, the
momentum is to be along t all the same, and e ends against it. The relay law reduces both together: for a body
symmetric about e, d/dt (|L1|^2 + |L2|^2) / 2 = -(L1 + L2) . M.

Source of the errors: Avanzini, de Angelis, Giulietti 2014, as in Ovchinnikov, Roldugin 2019, section 2.1.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Vec3, add, cross, dot, norm, scale, sub, transform, unit
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import InertialMotion, motion
from fsw.core.laws.spin import AXES, SpinGains


@dataclass(frozen=True, slots=True)
class TargetGains(SpinGains):
    """The body axis that spins, and the direction wanted of the momentum, in eci, of any length.

    Attributes:
        target_1: first component of the direction; the next two follow.
    """

    target_1: float = 0.0
    target_2: float = 0.0
    target_3: float = 1.0

    def __post_init__(self) -> None:
        SpinGains.__post_init__(self)
        if self.target_eci == (0.0, 0.0, 0.0):
            raise ValueError("the target direction of the momentum is a zero vector")

    @property
    def target_eci(self) -> Vec3:
        """Unit vector."""
        return unit((self.target_1, self.target_2, self.target_3))


@dataclass(frozen=True, slots=True)
class SpinAxisGains(TargetGains):
    """The same, and the gain of momentum errors.

    Attributes:
        k_h: 1 / (T^2 s): the error decays at about k_h |b|^2.

    Raises:
        ValueError: a gain that is not positive, or what ``TargetGains`` refuses.
    """

    k_h: float = 1.0e6

    def __post_init__(self) -> None:
        TargetGains.__post_init__(self)
        if not self.k_h > 0.0:
            raise ValueError(f"k_h must be positive, not {self.k_h:g}")


@dataclass(frozen=True, slots=True)
class ThreeTermGains(SpinAxisGains):
    """The same, and the gain of the spin alone.

    Attributes:
        k_spin: gain of the momentum about the axis, 1 / (T^2 s).

    Raises:
        ValueError: it is negative, or what ``SpinAxisGains`` refuses.
    """

    k_spin: float = 1.0e6

    def __post_init__(self) -> None:
        SpinAxisGains.__post_init__(self)
        if not self.k_spin >= 0.0:
            raise ValueError(f"k_spin of three_term must not be negative, not {self.k_spin:g}")


def relay_dipole(b_body_t: Vec3, error_body_nms: Vec3, m_am2: float) -> Vec3:
    """m_j = m0 sign(dh . (e_j x b)): each coil fully on, with the sign that reduces the error.

    Args:
        b_body_t: field in body axes, T.
        error_body_nms: dh, momentum wanted less momentum, body axes.
        m_am2: m0, dipole of each coil.

    Returns:
        Dipole in body axes, A m^2; a coil that can do nothing is off.

    Source: Ovchinnikov, Roldugin 2019, eq. 3. The scan prints +m0 for h . (e_j x b) > 0; with h the momentum
    itself the power of that torque is positive, so the h of the equation is the error.
    """
    s1, s2, s3 = cross(b_body_t, error_body_nms)
    return (m_am2 * _sign(s1), m_am2 * _sign(s2), m_am2 * _sign(s3))


def reorientation_dipole(b_body_t: Vec3, error_body_nms: Vec3, axis: int, k_h: float) -> Vec3:
    """The dipole m = k_h (dh . (e x b)) e: the coil along e turns the momentum and leaves the spin.

    Args:
        b_body_t: field in body axes, T.
        error_body_nms: dh, momentum wanted less momentum, body axes.
        axis: index of e, from zero.
        k_h: gain, 1 / (T^2 s).

    Returns:
        Dipole in body axes, A m^2.

    Source: Ovchinnikov, Roldugin 2019, section 2.1: m3 = k dh . (e3 x b).
    """
    return scale(k_h * dot(error_body_nms, cross(AXES[axis], b_body_t)), AXES[axis])


def three_term_dipole(
    b_body_t: Vec3,
    omega_body_radps: Vec3,
    spin_error_nms: float,
    error_body_nms: Vec3,
    axis: int,
    k_w: float,
    k_spin: float,
    k_h: float,
) -> Vec3:
    """The dipole m = b x (-k_w omega_across + k_spin (h_ref - h_e) e + k_h dh): nutation, spin, direction.

    The torque m x b is the component normal to the field of what is in brackets, times |b|^2.

    Args:
        b_body_t: field in body axes, T.
        omega_body_radps: absolute rate, body axes.
        spin_error_nms: h_ref - h_e, momentum about the spin axis wanted less the present one.
        error_body_nms: dh, momentum wanted less momentum, body axes.
        axis: index of e, from zero.
        k_w: gain of the rate across e, N m s / T^2.
        k_spin: gain of the spin, 1 / (T^2 s).
        k_h: gain of the direction, 1 / (T^2 s).

    Returns:
        Dipole in body axes, A m^2.

    Source: de Ruiter 2011, as in Ovchinnikov, Roldugin 2019, section 2.1, where the signs are lost: the scan
    reads b x [k1 (w1, w2, 0) + k2 (0, 0, h3 - h3ref) + k3 dh]. These are the ones that reduce the errors.
    """
    e = AXES[axis]
    across = sub(omega_body_radps, scale(omega_body_radps[axis], e))
    wanted = add(scale(-k_w, across), add(scale(k_spin * spin_error_nms, e), scale(k_h, error_body_nms)))
    return cross(b_body_t, wanted)


def spin_relay(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The relay law on L1 + L2, each coil at the mean dipole it can give."""
    gains: TargetGains = config.gains["spin_relay"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    wanted_nms = _wanted_spin_nms(moving, setpoint, gains, config)
    direction, body = _errors(moving, wanted_nms, gains)
    return Demand(relay_dipole(inputs.b_body_t, add(direction, body), config.mean_dipole_am2))


def reorientation(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Turns the momentum to its target and leaves its size."""
    gains: SpinAxisGains = config.gains["reorientation"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    direction, _ = _errors(moving, norm(moving.momentum_body_nms), gains)
    return Demand(reorientation_dipole(inputs.b_body_t, direction, gains.number, gains.k_h))


def three_term(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Damps nutation, holds the spin and turns the momentum at once."""
    gains: ThreeTermGains = config.gains["three_term"]
    moving = motion(inputs, config)
    if moving is None:
        return Demand()
    direction, body = _errors(moving, _wanted_spin_nms(moving, setpoint, gains, config), gains)
    return Demand(
        three_term_dipole(
            inputs.b_body_t,
            moving.omega_body_radps,
            body[gains.number],
            direction,
            gains.number,
            setpoint.k_w,
            gains.k_spin,
            gains.k_h,
        )
    )


def _wanted_spin_nms(
    moving: InertialMotion, setpoint: Setpoint, gains: TargetGains, config: ControlConfig
) -> float:
    """h_ref = e . (J e w_ref + h_wheel)."""
    e = AXES[gains.number]
    spinning = scale(setpoint.spin_radps, transform(config.inertia_kgm2, e))
    return dot(e, add(spinning, moving.wheel_body_nms))


def _errors(moving: InertialMotion, wanted_nms: float, gains: TargetGains) -> tuple[Vec3, Vec3]:
    """L1 and L2, body axes."""
    target_body = rotate(moving.q_body_from_eci, gains.target_eci)
    direction = sub(scale(abs(wanted_nms), target_body), moving.momentum_body_nms)
    body = sub(scale(wanted_nms, AXES[gains.number]), moving.momentum_body_nms)
    return direction, body


def _sign(value: float) -> float:
    return float((value > 0.0) - (value < 0.0))


LAWS = {
    "spin_relay": LawEntry(14, Aim.SPIN, spin_relay, spin_relay, TargetGains),
    "reorientation": LawEntry(15, Aim.SPIN, reorientation, reorientation, SpinAxisGains),
    "three_term": LawEntry(16, Aim.SPIN, three_term, three_term, ThreeTermGains),
}
