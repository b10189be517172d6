"""Roll and yaw of a satellite with a pitch wheel on an elliptic orbit, under the law of six gains.

Over the true anomaly nu, the pitch held by the other coils, with w = n (1 + e cos nu)^2 / (1 - e^2)^(3/2) the
orbital rate and omega1, omega2 the inertial rates across the wheel:

    yaw' = omega1 + w roll,   roll' = omega2 - w yaw
    A omega1' = -(h + (C - B) w) omega2 - m3 b2
    B omega2' =  (h + (C - A) w) omega1 - 3 mu / r^3 (C - A) roll + m3 b1

the field that of the direct dipole at the argument of latitude nu + (argument of perigee). Beside the circle
the magnetic torque goes with 1 / r^6, and the precession is no longer even.

Source: Hablani 1995 (Magnetic precession and product-of-inertia nutation damping), of whom Ovchinnikov,
Roldugin 2019, section 2.2, says that nutation is damped on an elliptic orbit; the equations are derived here.
The product of inertia acts through a wheel that is driven, the coils through the law of ``six_gain``.
"""

from dataclasses import dataclass
from math import pi, radians, sin

import numpy as np

from fsw.core.laws.roll_yaw import RollYaw
from fsw.core.laws.six_gain import SixGainGains, six_gain_dipole
from fsw.core.laws.wheel_integral import BOTH_ANGLES
from sim.design.theory.bodies import Body
from sim.design.theory.floquet import monodromy
from sim.design.theory.linear import System
from sim.value_types import Array

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
    """The matrix of (yaw, roll, omega1 / n, omega2 / n) over the true anomaly, (k, 4, 4) for nu of (k,)."""
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
