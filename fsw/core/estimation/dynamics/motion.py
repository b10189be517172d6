"""How a rigid satellite moves over a tick: acceleration, rotation, rate."""

from typing import final

from fsw.core.algebra.quaternion import Quaternion, from_small_rotation, multiply, rotate
from fsw.core.algebra.vector import Vec3, add, cross, dot, scale, sub, transform
from fsw.core.estimation.parameters import Matrix3x3, Rotor

MIDPOINT_RAD = 0.03
"""Up to this rotation in a tick the motion at its middle suffices: to 2e-6 rad, 3e-8 rad a tick."""


@final
class BodyFields:
    """What acts at one attitude, body axes: the radius direction e1, the field b, T, and 3 mu/r^3, 1/s^2."""

    __slots__ = ("b_t", "e1", "gravity_per_s2")

    def __init__(self, e1: Vec3, b_t: Vec3, gravity_per_s2: float) -> None:
        self.e1 = e1
        self.b_t = b_t
        self.gravity_per_s2 = gravity_per_s2

    def pull(self) -> Matrix3x3:
        """The dyad 3 mu/r^3 e1 e1^T by rows, 1/s^2."""
        return outer(scale(self.gravity_per_s2, self.e1), self.e1)


def acceleration(omega: Vec3, around: BodyFields, m: Vec3, torque: Vec3, rotor: Rotor) -> Vec3:
    """J domega/dt = m x b + 3 mu/r^3 e1 x J e1 - omega x (J omega + h) + torque, all in body axes."""
    j = rotor.inertia_kgm2
    gravity = scale(around.gravity_per_s2, cross(around.e1, transform(j, around.e1)))
    gyroscopic = cross(omega, add(transform(j, omega), rotor.wheel_body_nms))
    return transform(rotor.inertia_inverse, sub(add(add(cross(m, around.b_t), gravity), torque), gyroscopic))


@final
class Acting:
    """What acts on the satellite over a tick, and its inertia.

    Radius direction and field, T, inertial axes; 3 mu/r^3, 1/s^2; dipole, A m^2, and torque, N m, body axes.
    """

    __slots__ = ("b_eci_t", "e1_eci", "gravity_per_s2", "m_am2", "rotor", "torque_nm")

    def __init__(
        self,
        e1_eci: Vec3,
        b_eci_t: Vec3,
        gravity_per_s2: float,
        m_am2: Vec3,
        torque_nm: Vec3,
        rotor: Rotor,
    ) -> None:
        self.e1_eci = e1_eci
        self.b_eci_t = b_eci_t
        self.gravity_per_s2 = gravity_per_s2
        self.m_am2 = m_am2
        self.torque_nm = torque_nm
        self.rotor = rotor

    def around(self, q_body_from_eci: Quaternion) -> BodyFields:
        """Radius direction and field at an attitude."""
        e1, b = rotate(q_body_from_eci, self.e1_eci), rotate(q_body_from_eci, self.b_eci_t)
        return BodyFields(e1, b, self.gravity_per_s2)

    def acceleration(self, omega: Vec3, around: BodyFields) -> Vec3:
        """The derivative of the rate, body axes, rad/s^2."""
        return acceleration(omega, around, self.m_am2, self.torque_nm, self.rotor)


@final
class BodyMotion:
    """How the satellite turns: rate, rad/s, its derivative, rad/s^2, and the dipole that acts, A m^2."""

    __slots__ = ("alpha", "m_am2", "omega")

    def __init__(self, omega: Vec3, alpha: Vec3, m_am2: Vec3) -> None:
        self.omega = omega
        self.alpha = alpha
        self.m_am2 = m_am2


def middle(q: Quaternion, omega: Vec3, acting: Acting, h: float) -> tuple[BodyFields, BodyMotion]:
    """What acts in the middle of a tick of length h, and how the satellite turns there."""
    omega_mid = add(omega, scale(0.5 * h, acting.acceleration(omega, acting.around(q))))
    around = acting.around(multiply(q, from_small_rotation(scale(0.5 * h, omega))))
    return around, BodyMotion(omega_mid, acting.acceleration(omega_mid, around), acting.m_am2)


def advanced(q: Quaternion, omega: Vec3, motion: BodyMotion, acting: Acting, h: float) -> tuple[Vec3, Vec3]:
    """The rotation over a tick of length h, rad, and the rate after it, by ``motion`` in its middle.

    In a fast turn to fourth order in h: the rate by the Runge-Kutta method, the rotation by Simpson's rule
    plus the term that the rotation of the axis adds (Magnus 1954).
    """
    rotation = scale(h, motion.omega)
    if dot(rotation, rotation) < MIDPOINT_RAD**2:
        return rotation, add(omega, scale(h, motion.alpha))
    q_mid = multiply(q, from_small_rotation(scale(0.5 * h, omega)))
    around_mid = acting.around(q_mid)
    k1, k2 = acting.acceleration(omega, acting.around(q)), motion.alpha
    k3 = acting.acceleration(add(omega, scale(0.5 * h, k2)), around_mid)
    k4 = acting.acceleration(add(omega, scale(h, k3)), acting.around(multiply(q, turn(rotation))))
    after = add(omega, scale(h / 6.0, add(add(k1, k4), scale(2.0, add(k2, k3)))))
    halfway = add(scale(0.5, add(omega, after)), scale(h / 8.0, sub(k1, k4)))
    mean = scale(1.0 / 6.0, add(add(omega, after), scale(4.0, halfway)))
    return add(scale(h, mean), scale(h * h / 12.0, cross(omega, after))), after


def turn(rotation_rad: Vec3) -> Quaternion:
    """The quaternion of a rotation vector by the series of sine and cosine: 2e-8 rad off at 0.5 rad."""
    r1, r2, r3 = rotation_rad
    square = 0.25 * (r1 * r1 + r2 * r2 + r3 * r3)
    half_sinc = 0.5 - square * (1.0 / 12.0 - square / 240.0)
    cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square / 720.0))
    return (cosine, half_sinc * r1, half_sinc * r2, half_sinc * r3)


def outer(a: Vec3, b: Vec3) -> Matrix3x3:
    """The dyad a b^T by rows."""
    a1, a2, a3 = a
    b1, b2, b3 = b
    return (a1 * b1, a1 * b2, a1 * b3, a2 * b1, a2 * b2, a2 * b3, a3 * b1, a3 * b2, a3 * b3)
