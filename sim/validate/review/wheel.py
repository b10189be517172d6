"""Claims: a wheel beside the coils (section 2.2 of the review)."""

from dataclasses import replace
from functools import partial
from math import inf

import numpy as np

from fsw.core.laws.horizon_roll import HorizonRollGains
from fsw.core.laws.six_gain import SixGainGains
from fsw.core.laws.wheel_relay import WheelRelayGains
from sim.campaign.claim import Study
from sim.design.pitch_wheel import Ellipse, WheelLaw, convergence, decays, slowest
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.floquet import monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop
from sim.plant.environment.orbit import Array
from sim.plant.rotation import Vec3
from sim.validate.review import gurwin
from sim.validate.review.figures import FigureClaim
from sim.validate.review.law_flight import ConstantTorque, LawFlight, LawHistory, fly

REVIEW = "Ovchinnikov, Roldugin 2019, section 2.2"
WHEEL_NMS: Vec3 = (0.0, 0.0, 0.05)

WHEELED = LawFlight(
    "six_gain",
    diagonal((1.9, 1.95, 2.0)),
    k_w=1e7,
    k_a=4000.0,
    gains=SixGainGains(),
    rotation_rad=(0.12, 0.12, 0.04),
    relative=True,
    wheel_body_nms=WHEEL_NMS,
    orbits=2.0,
    step_s=8.0,
    near=True,
)
"""The wheel 10 deg from the orbit normal."""
ROLL_ALONE = replace(WHEELED, gains=SixGainGains(k2=0.0))
LEAD, RATE_S = 0.1, 100.0
POLAR = replace(
    WHEELED,
    law="wheel_relay",
    gains=WheelRelayGains(dipole_am2=2.0, lead=LEAD, rate_s=RATE_S, layer_rad=0.003),
    inclination_deg=90.0,
    step_s=4.0,
    orbits=1.5,
)
EQUATOR = replace(
    WHEELED,
    law="horizon_roll",
    gains=HorizonRollGains(),
    k_a=4e4,
    inclination_deg=5.0,
    rotation_rad=(0.17, 0.0, 0.0),
)
"""All of it yaw, which the law does not see."""
PUSHED = replace(
    WHEELED,
    law="wheel_integral",
    gains=None,
    rotation_rad=(0.0, 0.0, 0.0),
    extra=ConstantTorque((1e-6, -1.5e-6, 1e-6)),
    orbits=6.0,
    step_s=12.0,
)
K_I = 3.0
"""The mean torque of the coil along the wheel, -2 k_i (b2^2 I1, b1^2 I2), takes yaw and roll down by
2 k_i (b2^2, b1^2) / (h w0): by a part in 6.6 and 1.65 orbits."""
WEAK_K_W = 2e4
"""So weak that the expressions to first order hold."""
STUDIED = Body("wheeled", diagonal((1.4, 1.6, 1.9)), 2100.0, 75.0, WHEEL_NMS)
"""Its ellipse has a perigee of 400 km."""
LAW = WheelLaw(8000.0, 3e6)
MOST_ECCENTRIC = 0.2
COMPARED = Body("compared", WHEELED.inertia_kgm2, 800.0, 98.6, WHEEL_NMS)


def studies() -> list[Study]:
    """All of this section."""
    return [*(row.study("wheel", REVIEW) for row in ROWS), *gurwin.studies()]


def last_lean_deg(case: LawFlight) -> float:
    """Angle of the wheel's axis from the orbit normal at the end of a flight."""
    return float(_lean_deg(fly(case))[-1])


def lean_share(case: LawFlight, other: LawFlight) -> float:
    """Last lean of a flight, of that of another."""
    return last_lean_deg(case) / last_lean_deg(other)


def orbit_share(case: LawFlight) -> float:
    """Lean an orbit after a half of one, of the lean then."""
    flown = fly(case)
    lean, orbits = _lean_deg(flown), flown.orbits
    return float(lean[-1] / lean[np.searchsorted(orbits, orbits[-1] - 1.0)])


def mean_share(case: LawFlight, k_i: float, axis: int) -> float:
    """Mean turn about a body axis, from 0, in the last orbit with an integral part, of that without."""
    with_it, without = (_mean_turn(fly(replace(case, k_i=value)), axis) for value in (k_i, 0.0))
    return abs(with_it / without)


def worst_decay() -> float:
    """Largest relative difference between closed expressions and Floquet exponents, over three wheels."""
    wheels_nms = (0.003, 0.01, 0.03)
    return float(np.max([_decay_error(replace(STUDIED, wheel_nms=(0.0, 0.0, h))) for h in wheels_nms]))


def precession_ratio() -> float:
    """Floquet exponents of the precession with a wheel, over those with one twice as strong."""
    one, two = (_exponents(replace(STUDIED, wheel_nms=(0.0, 0.0, h)))[-1] for h in (0.1, 0.2))
    return float(one / two)


def spring_ratio() -> float:
    """Slowest decay with springs, over that without."""
    compared = slowest(COMPARED, WHEELED.k_a * 2.0, WHEELED.k_w)
    return compared["roll and yaw, springs"] / compared["roll and yaw"]


def slowest_decay() -> float:
    """The largest exponent of precession and nutation on the ellipse of ``MOST_ECCENTRIC``."""
    return float(np.max(decays(STUDIED, Ellipse(MOST_ECCENTRIC), LAW)))


def nutation_gain() -> float:
    """Decay of the nutation on that ellipse, over that on the circle of its size."""
    ellipse, circle = (decays(STUDIED, Ellipse(e), LAW)[1] for e in (MOST_ECCENTRIC, 0.0))
    return ellipse / circle


ROWS: tuple[FigureClaim, ...] = (
    FigureClaim(
        "six_gain.lean",
        "Six gains: the wheel's axis from the orbit normal after two orbits, from 10 deg",
        "[45]",
        "deg",
        -inf,
        1.2,
        partial(last_lean_deg, WHEELED),
    ),
    FigureClaim(
        "six_gain.yaw",
        "The same: what roll alone leaves after two orbits, over what roll and yaw leave",
        "[18, 45]: the laws compared",
        "1",
        2.0,
        inf,
        partial(lean_share, ROLL_ALONE, WHEELED),
    ),
    FigureClaim(
        "six_gain.springs",
        "The same: slowest decay with springs of half the stiffness, over that without; averaging says 10/9",
        "[45]: the laws compared",
        "1",
        1.07,
        1.13,
        spring_ratio,
    ),
    FigureClaim(
        "wheel_relay",
        "Sliding relay on a polar orbit: lean left by an orbit; its surface alone leaves exp(-4 pi t) = 0.32",
        "[51]",
        "1",
        -inf,
        0.34,
        partial(orbit_share, POLAR),
    ),
    FigureClaim(
        "horizon_roll",
        "Horizon sensor at 5 deg of inclination: lean after two orbits from 10 deg of yaw, which is not seen",
        "[41]",
        "deg",
        -inf,
        0.3,
        partial(last_lean_deg, EQUATOR),
    ),
    FigureClaim(
        "wheel_integral",
        "Integral part: mean roll that a constant torque leaves in the sixth orbit, of that without the part",
        "[47]",
        "1",
        -inf,
        0.1,
        partial(mean_share, PUSHED, K_I, 1),
    ),
    FigureClaim(
        "wheel_integral_yaw",
        "The same of the yaw; its mean torque alone would leave exp(-5.5 / 6.6) = 0.43",
        "[47]",
        "1",
        -inf,
        0.5,
        partial(mean_share, PUSHED, K_I, 0),
    ),
    FigureClaim(
        "wheel_integral_pitch",
        "The same of the pitch, which falls by k_i / k_a, 4.5 times an orbit",
        "[47]",
        "1",
        -inf,
        0.01,
        partial(mean_share, PUSHED, K_I, 2),
        "it goes on to nothing",
    ),
    FigureClaim(
        "convergence",
        "Closed expressions for the decay of pitch, precession, nutation: error beside Floquet exponents",
        "[40]: closed expressions for the speed",
        "1",
        -inf,
        5e-4,
        worst_decay,
    ),
    FigureClaim(
        "strong_wheel",
        "Decay of the precession by rate damping with a wheel, over that with one twice as strong",
        "[40], closing remark: a large momentum changes slowly",
        "1",
        1.9,
        2.1,
        precession_ratio,
    ),
    FigureClaim(
        "elliptic.slowest",
        "Eccentricity 0.2: slowest decay of precession and nutation by the law of six gains",
        "[46]: nutation is damped on an elliptic orbit",
        "1/rad",
        -inf,
        -0.01,
        slowest_decay,
    ),
    FigureClaim(
        "elliptic.nutation",
        "Decay of the nutation at eccentricity 0.2, over that on the circle of its size",
        "[46]",
        "1",
        1.0,
        inf,
        nutation_gain,
    ),
)


def _lean_deg(flown: LawHistory) -> Array:
    return flown.orbit_axis_deg(2, 2)


def _mean_turn(flown: LawHistory, axis: int) -> float:
    """Half of S about an axis on the mean of the last orbit, rad."""
    c = flown.c_body_from_orbit[flown.orbits > flown.orbits[-1] - 1.0]
    u, v = (axis + 1) % 3, (axis + 2) % 3
    return float(0.5 * (c[:, u, v] - c[:, v, u]).mean())


def _decay_error(body: Body) -> float:
    ours = np.sort(convergence(body, WEAK_K_W))
    return float(np.abs(ours / _exponents(body) - 1.0).max())


def _exponents(body: Body) -> Array:
    """Of the three modes under rate damping, the fastest first, per rad of u."""
    values: Array = np.log(np.abs(multipliers(monodromy(closed_loop(body, Gains(WEAK_K_W, 0.0)), 512))))
    exponents: Array = np.sort(values)[::2] / (2.0 * np.pi)
    return exponents
