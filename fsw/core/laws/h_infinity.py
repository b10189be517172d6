"""H-infinity and H2: the periodic regulator against the worst-case torque.

The gain M(u) over the argument of latitude u is that of the game in ``game``: whatever a torque w does, the
sum of |theta|^2 + rate |Omega / w0|^2 + effort |m|^2 stays under gamma^2 times that of |w|^2. The measure is
z = (E, 0; 0, E; sigma K) x of the review with sigma^2 the effort. A large gamma gives the regulator of least
H2 norm, which with the whole state known is ``lqr``, whatever the intensity of the noise. The momentum of a
wheel is a parameter of the model, so that one law serves a satellite with a wheel and without. A gamma below
the least attainable is doubled until there is a law.

Source: Lovera 2000; Calloni, Corti, Zanchettin, Lovera 2012; Wisniewski, Stoustrup 2001; Tregouet et al.
2011: Ovchinnikov, Roldugin 2019, sections 2.2 and 3.2, where the functional is damaged; its form follows from
the definition of the norm.
"""

from dataclasses import dataclass

import numpy as np

from fsw.core.algebra.vector import Mat3, Vec3
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import LqrGains, balanced_pd, by_schedule, orbit_problem, schedule
from fsw.core.laws.plan.game import game_periodic
from fsw.core.laws.plan.riccati import NotHeldError, Schedule

DOUBLINGS = 12
"""Of gamma at most; then the regulator itself is taken."""


@dataclass(frozen=True, slots=True)
class HInfinityGains(LqrGains):
    """Weights as for ``lqr``, and the bound of the game.

    Attributes:
        gamma: largest error for a torque of w0^2 J_mean, root mean squares over all time, rad.
    """

    gamma: float = 3.0

    def __post_init__(self) -> None:
        """Check what the equations need.

        Raises:
            ValueError: a weight or the bound out of range.
        """
        LqrGains.__post_init__(self)
        if not 1e-3 <= self.gamma <= 1e6:
            raise ValueError(f"gamma must be 1e-3 to 1e6 rad, not {self.gamma:g}")


def price(gamma_rad: float, inertia_kgm2: Mat3, orbit_rate_radps: float) -> float:
    """The weight of |w|^2 in the game, gamma^2 / (w0^2 J_mean)^2, per (N m)^2."""
    mean_kgm2 = (inertia_kgm2[0][0] + inertia_kgm2[1][1] + inertia_kgm2[2][2]) / 3.0
    factor = gamma_rad / (orbit_rate_radps**2 * mean_kgm2)
    return factor * factor


def robust_schedule(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    inclination_rad: float,
    field_t: float,
    gains: HInfinityGains,
) -> Schedule:
    """The periodic solution of the game on the direct dipole's field, arguments as of ``lqr.schedule``."""
    orbit = (inertia_kgm2, wheel_body_nms, orbit_rate_radps, inclination_rad, field_t)
    problem, b_orbit_t = orbit_problem(*orbit, gains)
    for doubling in range(DOUBLINGS):
        try:
            paid = price(gains.gamma * 2.0**doubling, inertia_kgm2, orbit_rate_radps)
            both, costs = game_periodic(problem, b_orbit_t, paid)
            return Schedule(problem, np.ascontiguousarray(both[:, :3]), costs)
        except NotHeldError:
            continue
    return schedule(*orbit, gains)


def h_infinity(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The dipole M(u) (Omega, theta, d), d the estimated torque and what rests on the nominal attitude."""
    return by_schedule(inputs, config.schedules.get("h_infinity"), config)


LAWS = {
    "h_infinity": LawEntry(43, Aim.THREE_AXIS, balanced_pd, h_infinity, HInfinityGains),
}
