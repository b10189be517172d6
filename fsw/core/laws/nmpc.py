"""Nonlinear predictive damping of a tumbling satellite, with a rule that stops the search early.

``nmpc_damping`` plans the dipoles of the next minute with least energy at its end and along it
(``tumbling``), gives the first one, and plans anew from the rest of the old plan. The search stops as soon as

    J(t) < J(t - dt) - gamma |omega|^2,

which is enough for the rate to go to zero, long before the plan is the best one. ``nmpc_reference`` weighs,
in place of the energy, the dipole g that the damping law would give, and begins its search at the course that
this law would take. No step of a plan is longer than half a turn of the body, nor shorter than a tick: a body
that turns further in a tick cannot be damped by a dipole that is held, and nothing is demanded.

Source: Ahmed, Kerrigan 2014 (the rule), Boehm, Merk, Fichter, Allgoewer 2009 (the reference), as in
Ovchinnikov, Roldugin 2019, section 3.3. The gravity torque is left out: these are laws for a tumbling body.
"""

from dataclasses import dataclass, replace
from math import inf, pi

import numpy as np

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import dot, norm
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import InertialMotion, motion
from fsw.core.laws.plan.riccati import Array
from fsw.core.laws.plan.tumbling import Tumbling, damping_course, descend
from fsw.core.orbit.ephemeris import Reference

STEPS = 12
"""Of a plan."""


@dataclass(frozen=True, slots=True)
class NmpcGains:
    """Horizon and weights of the plan.

    Attributes:
        horizon_s: how far it looks at most, or twelve ticks, s; the dipole is held over a twelfth of that.
        weight: of the energy along the plan, relative to that at its end.
        effort: of |m|^2, J / (A m^2)^2.
        gamma: of |omega|^2 in the rule, J s^2, relative to the mean moment of inertia; negative: no rule.
        iterations: largest number of steps of a search.
    """

    horizon_s: float = 60.0
    weight: float = 1.0
    effort: float = 1e-9
    gamma: float = 1e-3
    iterations: float = 10.0

    def __post_init__(self) -> None:
        """Check what a plan needs.

        Raises:
            ValueError: a number out of range.
        """
        if not (1.0 <= self.horizon_s <= 600.0 and 1.0 <= self.iterations <= 100.0):
            raise ValueError(
                "horizon_s must be 1 to 600 and iterations 1 to 100, "
                f"not {self.horizon_s:g} and {self.iterations:g}"
            )
        if not (0.0 <= self.weight <= 1e6 and 0.0 <= self.effort <= 1e6):
            raise ValueError(f"weight and effort must be 0 to 1e6, not {self.weight:g} and {self.effort:g}")


@dataclass(frozen=True, slots=True)
class NmpcReferenceGains(NmpcGains):
    """The same, the weight being of |g|^2, J / (A m^2)^2, and the damping law's steepness.

    Attributes:
        steepness: K of g = (2 m_max / pi) arctan(K b x omega), s / T.

    Raises:
        ValueError: it is negative, or what ``NmpcGains`` refuses.
    """

    weight: float = 1e-4
    steepness: float = 3e6

    def __post_init__(self) -> None:
        NmpcGains.__post_init__(self)
        if not self.steepness >= 0.0:
            raise ValueError(f"steepness must not be negative, not {self.steepness:g}")


def nmpc_damping(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The plan of least energy; memory: tick of its start, its cost, its dipoles."""
    gains: NmpcGains = config.gains["nmpc_damping"]
    return _planned(inputs, memory, gains, None, config)


def nmpc_reference(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The plan near the damping law's course; memory as for ``nmpc_damping``."""
    gains: NmpcReferenceGains = config.gains["nmpc_reference"]
    return _planned(inputs, memory, gains, gains.steepness, config)


def _planned(
    inputs: LawInput, memory: Memory, gains: NmpcGains, steepness: float | None, config: ControlConfig
) -> Demand:
    """The dipole of the plan in memory while its first step lasts, otherwise that of a new one."""
    moving, reference = motion(inputs, config), inputs.reference
    if moving is None or reference is None or norm(reference.b_eci_t) == 0.0:
        return Demand()
    rate_radps = norm(moving.omega_body_radps)
    if rate_radps * config.tick_s > pi:
        return Demand()
    horizon_s = gains.horizon_s
    if rate_radps * horizon_s > STEPS * pi:
        horizon_s = STEPS * (pi / rate_radps)
    horizon_s = max(horizon_s, STEPS * config.tick_s)
    step_s = horizon_s / STEPS
    known = len(memory) == 2 + 3 * STEPS
    age_s = (inputs.tick - memory[0]) * config.tick_s if known else inf
    if 0.0 <= age_s < step_s:
        return Demand((memory[2], memory[3], memory[4]), memory=memory)
    case = replace(case_of(moving, reference, gains, steepness, config), horizon_s=horizon_s)
    going_on = known and 0.0 <= age_s < 2.0 * step_s
    old = np.array(memory[2:]).reshape(STEPS, 3) if going_on else np.zeros((STEPS, 3))
    start = np.concatenate([old[1:], old[-1:]]) if steepness is None else damping_course(case)
    fall = gains.gamma * sum((config.inertia_kgm2[k][k] for k in range(3)), 0.0) / 3.0
    enough = -inf
    if going_on and gains.gamma >= 0.0:
        enough = memory[1] - fall * dot(moving.omega_body_radps, moving.omega_body_radps)
    plan, cost, _ = descend(case, start, enough, round(gains.iterations))
    m1, m2, m3 = plan[0].tolist()
    return Demand((m1, m2, m3), memory=(float(inputs.tick), cost, *plan.ravel().tolist()))


def case_of(
    moving: InertialMotion,
    reference: Reference,
    gains: NmpcGains,
    steepness: float | None,
    config: ControlConfig,
) -> Tumbling:
    """What is planned for."""

    def array(values: object) -> Array:
        return np.asarray(values, dtype=np.float64)

    return Tumbling(
        inertia_kgm2=array(config.inertia_kgm2),
        wheel_body_nms=array(moving.wheel_body_nms),
        omega_body_radps=array(moving.omega_body_radps),
        c_body_from_eci=array(dcm(moving.q_body_from_eci)),
        b_eci_t=array(reference.b_eci_t),
        b_rate_eci_tps=array(reference.b_rate_eci_tps),
        horizon_s=gains.horizon_s,
        steps=STEPS,
        most_am2=config.mean_dipole_am2,
        weight=gains.weight,
        effort=gains.effort,
        steepness=steepness,
    )


LAWS = {
    "nmpc_damping": LawEntry(163, Aim.RATE, nmpc_damping, nmpc_damping, NmpcGains),
    "nmpc_reference": LawEntry(164, Aim.RATE, nmpc_reference, nmpc_reference, NmpcReferenceGains),
}
