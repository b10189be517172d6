"""A pitch wheel: roll and yaw under the law of six gains, its choices compared, and rate damping.

Sources: Hablani 1995, twice; Ovchinnikov, Penkov, Roldugin, Varatharajoo, Ryabikov 2017, as in Ovchinnikov,
Roldugin 2019, section 2.2.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from fsw.core.laws.roll_yaw import RollYaw
from fsw.core.laws.six_gain import SixGainGains, six_gain_dipole
from fsw.core.laws.wheel_integral import BOTH_ANGLES
from sim.design.theory.bodies import Body
from sim.design.theory.floquet import monodromy
from sim.design.theory.linear import System
from sim.value_types import Array

# --- Roll and yaw on an elliptic orbit, under the law of six gains

STEPS = 384
"""Steps an orbit, which follow the nutation."""


@dataclass(frozen=True, slots=True)
class Ellipse:
    """An orbit with the semi-major axis of the body's circle.

    Attributes:
        eccentricity: e.
        perigee_deg: argument of perigee.
    """

    eccentricity: float
    perigee_deg: float = 0.0

    def __post_init__(self) -> None:
        """Check the range.

        Raises:
            ValueError: the orbit is no ellipse.
        """
        if not 0.0 <= self.eccentricity < 1.0:
            raise ValueError(f"the eccentricity must be 0 to below 1, not {self.eccentricity:g}")


@dataclass(frozen=True, slots=True)
class WheelLaw:
    """The law's gains: k1 in N m / T^2, k3 in N m s / T^2, and the other four."""

    k1: float
    k3: float
    others: SixGainGains = BOTH_ANGLES


def roll_yaw_motion(body: Body, ellipse: Ellipse, law: WheelLaw) -> System:
    """The matrix of (yaw, roll, omega1 / n, omega2 / n) over the true anomaly, (k, 4, 4) for nu of (k,).

    Over the true anomaly nu, the pitch held by the other coils, with w = n (1 + e cos nu)^2 / (1 - e^2)^(3/2)
    the orbital rate and omega1, omega2 the inertial rates across the wheel:

        yaw' = omega1 + w roll,   roll' = omega2 - w yaw
        A omega1' = -(h + (C - B) w) omega2 - m3 b2
        B omega2' =  (h + (C - A) w) omega1 - 3 mu / r^3 (C - A) roll + m3 b1

    the field that of the direct dipole at the argument of latitude nu + (argument of perigee). Beside the
    circle the magnetic torque goes with 1 / r^6, and the precession is no longer even.

    Source: Hablani 1995 (Magnetic precession and product-of-inertia nutation damping), of whom Ovchinnikov,
    Roldugin 2019, section 2.2, says that nutation is damped on an elliptic orbit; the equations are derived
    here. The product of inertia acts through a wheel that is driven, the coils through the law of
    ``six_gain``.
    """
    (a, _, _), (_, b, _), (_, _, c) = body.inertia_kgm2
    n, h = body.rate_radps, body.wheel_nms[2]

    def matrix(nu: Array) -> Array:
        near = (1.0 + ellipse.eccentricity * np.cos(nu)) / (1.0 - ellipse.eccentricity**2)
        w = n * near**2 * np.sqrt(1.0 - ellipse.eccentricity**2)
        b1, b2 = _field(body, nu + radians(ellipse.perigee_deg), near)
        # each quantity below is a row: how it goes with the four states
        yaw, roll, first, second = np.eye(4)[:, None, :]
        yaw_rate = n * first + w[:, None] * roll
        roll_rate = n * second - w[:, None] * yaw
        by_roll, by_yaw, by_roll_rate, by_yaw_rate = _feedback(b1, b2, law).T[..., None]
        m3 = by_roll * roll + by_yaw * yaw + by_roll_rate * roll_rate + by_yaw_rate * yaw_rate
        gravity = 3.0 * (n * near**1.5)[:, None] ** 2 * (c - a)
        turn1 = (-(h + (c - b) * w)[:, None] * n * second - m3 * b2[:, None]) / a
        turn2 = ((h + (c - a) * w)[:, None] * n * first - gravity * roll + m3 * b1[:, None]) / b
        rows: Array = np.stack([yaw_rate, roll_rate, turn1 / n, turn2 / n], axis=1) / w[:, None, None]
        return rows

    return matrix


def decays(body: Body, ellipse: Ellipse, law: WheelLaw) -> tuple[float, float]:
    """Decay of precession and of nutation, per radian of anomaly on the mean; negative: they decay.

    The nutation's is the pair whose motion is mostly of the rates.
    """
    values, vectors = np.linalg.eig(monodromy(roll_yaw_motion(body, ellipse, law), STEPS))
    degrees = np.log(np.abs(values)) / (2.0 * pi)
    of_rates = np.linalg.norm(vectors[2:], axis=0) / np.linalg.norm(vectors[:2], axis=0)
    order = np.argsort(of_rates)
    return float(degrees[order[:2]].max()), float(degrees[order[2:]].max())


def _feedback(b1: Array, b2: Array, law: WheelLaw) -> Array:
    """The dipole m3 of the flown law for one of roll, yaw, roll' and yaw', (k, 4)."""
    motions = [RollYaw(*row) for row in np.eye(4).tolist()]
    fields = zip(b1.tolist(), b2.tolist(), strict=True)
    return np.array(
        [
            [six_gain_dipole((x, y, 0.0), motion, law.k1, law.k3, law.others)[2] for motion in motions]
            for x, y in fields
        ]
    )


def _field(body: Body, u: Array, near: Array) -> tuple[Array, Array]:
    """Its components along radius and track, T."""
    size = body.field_t * near**3 * sin(radians(body.inclination_deg))
    return -2.0 * size * np.sin(u), size * np.cos(u)


# --- The laws beside each other, as choices of six gains with the same k1 and k3

LAWS: dict[str, SixGainGains] = {
    "roll and its rate": SixGainGains(k2=0.0, k4=0.0),
    "roll, both rates": SixGainGains(k2=0.0),
    "roll and yaw": SixGainGains(),
    "roll and yaw, springs": SixGainGains(k5=0.5),
    "roll and yaw, springs reversed": SixGainGains(k5=-0.5),
}
"""What each measures: of a horizon sensor; eq. 6 of the review; eq. 5 of it; with springs."""


def slowest(body: Body, k1: float, k3: float) -> dict[str, float]:
    """By law, the degree of stability per radian of u: that of the slowest mode; negative: stable.

    The degree of stability of roll and yaw on a circular orbit says which measurements pay. With roll and yaw
    weighted alike the two parts of the precession decay by 9/8 and 11/8 of one quantity, as precession and
    square of the field keep step; a spring, of either sign, takes them out of step, and both decay by 10/8.

    Source: Hablani 1995 (Comparative stability analysis) compares the laws, as Ovchinnikov, Roldugin 2019,
    section 2.2, says; the figures are this project's.

    Args:
        body: with a wheel along axis 3.
        k1: N m / T^2.
        k3: N m s / T^2.
    """
    return {name: max(decays(body, Ellipse(0.0), WheelLaw(k1, k3, gains))) for name, gains in LAWS.items()}


# --- How fast rate damping brings the satellite to rest, in closed form


class ModeDecays(NamedTuple):
    """Degrees of stability of the three modes, per radian of u; negative: it decays."""

    pitch: float
    precession: float
    nutation: float


def convergence(body: Body, k_w: float) -> ModeDecays:
    """The decay of each mode under rate damping.

    The dipole is m = -k_w b x Omega on a circular orbit in the direct dipole's field, the principal moments
    are A, B, C along the axes 1, 2, 3, and a wheel h is along axis 3. Over an orbit the mean torque is -k w0
    diag(d1, d2, d3) Omega,

        k = k_w B0^2 / w0,   d1 = sin^2 i / 2 + cos^2 i,   d2 = 2 sin^2 i + cos^2 i,   d3 = 5/2 sin^2 i,

    with i the inclination: no products are left on the mean. With eta = h / w0 + C the motion over the
    argument of latitude u is, apart from it,

        pitch:     C pitch'' + 3 (B - A) pitch = 0
        yaw, roll: A yaw'' + g roll' + a yaw = 0,   B roll'' - g yaw' + c roll = 0
                   g = eta - A - B,   a = eta - B,   c = eta - A + 3 (C - A)

    whose frequencies n are the roots of A B n^4 - (A c + B a + g^2) n^2 + a c = 0: precession, near one for a
    strong wheel, and nutation. To first order in k each mode decays by

        pitch:  -k d3 / (2 C)
        others: -k [d1 (c - B n^2) + d2 (a - A n^2)] / [2 (A c + B a + g^2) - 4 A B n^2]        per rad of u.

    A strong wheel makes the precession slow, -k (d1 + d2) / (2 eta), and leaves the nutation at
    -k (d1 / A + d2 / B) / 2. This holds where no frequency is one: the torque changes with 2 u.

    Source: Ovchinnikov, Penkov, Roldugin, Varatharajoo, Ryabikov 2017 gives such expressions, as Ovchinnikov,
    Roldugin 2019, section 2.2, says without printing them; these are derived here by averaging.

    Args:
        body: principal axes along the body's, wheel along axis 3, or none.
        k_w: N m s / T^2.

    Raises:
        ValueError: the body axes are not principal, the wheel is not along axis 3, or a mode does not swing.
    """
    moments = np.diag(np.asarray(body.inertia_kgm2))
    if np.any(np.asarray(body.inertia_kgm2) != np.diag(moments)):
        raise ValueError(f"{body.name}: the body axes must be principal")
    if body.wheel_nms[0] != 0.0 or body.wheel_nms[1] != 0.0:
        raise ValueError(f"{body.name}: the wheel must be along axis 3")
    a_moment, b_moment, c_moment = map(float, moments)
    k = float(k_w * body.field_t**2 / body.rate_radps)
    d1, d2, d3 = _mean_damping(body.inclination_deg)
    eta = body.wheel_nms[2] / body.rate_radps + c_moment
    g, yaw, roll = eta - a_moment - b_moment, eta - b_moment, eta - a_moment + 3.0 * (c_moment - a_moment)
    total, product = a_moment * roll + b_moment * yaw + g * g, a_moment * b_moment
    discriminant = total * total - 4.0 * product * yaw * roll
    if not (b_moment > a_moment and yaw * roll > 0.0 and total > 0.0 and discriminant > 0.0):
        raise ValueError(f"{body.name}: the motion without coils is not stable")

    def decay(square: float) -> float:
        driven = d1 * (roll - b_moment * square) + d2 * (yaw - a_moment * square)
        return -k * driven / (2.0 * total - 4.0 * product * square)

    fast = (total + sqrt(discriminant)) / (2.0 * product)
    return ModeDecays(-k * d3 / (2.0 * c_moment), decay(yaw * roll / (product * fast)), decay(fast))


def _mean_damping(inclination_deg: float) -> tuple[float, float, float]:
    """The diagonal of the mean of |B|^2 E - B B^T, in units of B0^2."""
    across, along = sin(radians(inclination_deg)) ** 2, cos(radians(inclination_deg)) ** 2
    return 0.5 * across + along, 2.0 * across + along, 2.5 * across
