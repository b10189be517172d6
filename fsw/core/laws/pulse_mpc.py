"""Optimal pulses: at each opportunity the first pulse of the best sequence of the opportunities to come.

Unlike ``mpc``, whose mean dipole the actuator then turns into pulses, this law plans with the pulses that
the coils can give: their levels, one coil at a time, and their back-off. Torque and residual dipole are those
that the filter estimates. After the opportunities searched, the terminal cost is what a dipole with no limit
would leave along the field to come. A sequence is flown for one pulse, and then made anew.

Source: as for ``pulse_plan``.

The pulses to come: a search among what pulsed coils can do, one choice at each opportunity.

At an opportunity one coil fires at one of three levels with either sign, or none does: 19 choices. A pulse
changes the rate at once, and the body then moves freely until the next opportunity, as in ``riccati``:

    x+ = F (x + (J^-1 (T_p m x b), 0)) + G (d + m_r x b) - (w0' h, w0' h^2 / 2) e3

d the constant torque, m_r the residual dipole, w0' the change of the rate of a non-circular orbit, h the time
between opportunities. The sequence sought has the least sum of rate |Omega / w0|^2 + |theta|^2 plus, after
its end, what a dipole without limits would leave, x^T P x + 2 x^T (S d + s); by beam search: only the
sequences with the least cost so far and to go continue from an opportunity. No sum and no choice depends on
how a processor orders its work.

Source: the choice among 18 pulses and none: Tavares et al. (ConSat, PoSAT-1); the horizon: Ovchinnikov,
Roldugin 2019, section 3.3; beam search: Lowerre 1976. Their combination is this project's.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Vec3
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    balanced_pd,
    check_weights,
    expected_torque,
    latitude_argument,
    node,
    orbital_state,
)
from fsw.core.laws.plan.cost_to_go import cost_to_go, times
from fsw.core.laws.plan.orbit_ahead import OrbitAhead, check_horizon, interpolated_orbit
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE, Pulse, PulseModel, kicks
from fsw.core.laws.plan.riccati import Array, Problem, Schedule
from fsw.core.orbit.ephemeris import EphemerisModel, Reference

SEQUENCES = 32
"""How many continue from one opportunity to the next."""
BARRED = 1_000_000
"""Wait, in opportunities, of a coil that may never be fired: longer than any search."""

Numbers = NDArray[np.int64]


class Opportunity(NamedTuple):
    """What is known of one, in orbital axes.

    ``kicks`` are the changes of rate by each choice, rad/s, shape (19, 3), ``drift`` is what is known to be
    added to the state until the next one, shape (6,), and ``cost`` is (P S s) at the next one, shape (6, 10).
    """

    kicks: Array
    drift: Array
    cost: Array


def first_pulse(
    state: Sequence[float],
    ahead: Sequence[Opportunity],
    model: PulseModel,
    waits: tuple[int, int, int],
) -> Pulse:
    """The first choice of the best sequence; none if nothing is ahead.

    Args:
        state: x and d, orbital axes, nine numbers.
        ahead: the opportunities to come.
        model: the choices at each, and the motion from one to the next.
        waits: by coil, opportunities that pass before it may be fired.
    """
    problem, pulses = model.problem, model.pulses
    f, g, by_coil = problem.free[:, :6], problem.free[:, 6:], len(pulses) // 3
    x, torque_nm = np.array(state[:6]).reshape(6, 1), np.array(state[6:]).reshape(3, 1)
    known = np.array([*state[6:], 1.0]).reshape(4, 1)
    spent, waiting = np.zeros(1), np.array(waits).reshape(3, 1)
    first, best = np.zeros(0, dtype=np.int64), 0
    for opportunity in ahead:
        p, s = opportunity.cost[:, :6], opportunity.cost[:, 6:]
        spent = spent + np.add.reduce(problem.cost[:, None] * x * x, axis=0)
        drifted = times(f, x) + (times(g, torque_nm) + opportunity.drift[:, None])
        pushes = times(f[:, :3], opportunity.kicks.T)
        total = spent[:, None] + _to_go(drifted, pushes, p, times(s, known))
        total[:, 1:][np.repeat(waiting.T > 0, by_coil, axis=1)] = np.inf
        sequence, choice = np.divmod(_least(total.ravel()), len(pulses))
        best = int(np.argmin(total[sequence, choice]))
        first = first[sequence] if len(first) else choice
        x, spent = drifted[:, sequence] + pushes[:, choice], spent[sequence]
        waiting = np.maximum(waiting[:, sequence] - 1, 0)
        fired = np.flatnonzero(choice)
        waiting[(choice[fired] - 1) // by_coil, fired] = model.rest - 1
    return pulses[int(first[best])] if len(first) else NO_PULSE


def _to_go(states: Array, pushes: Array, p: Array, slope: Array) -> Array:
    """(x + u)^T P (x + u) + 2 (x + u)^T s for each state x and each push u, shape (states, pushes)."""
    weighted = times(p, states)
    of_state = np.add.reduce(states * (weighted + 2.0 * slope), axis=0)
    of_push = np.add.reduce(pushes * times(p, pushes), axis=0)
    both = times((2.0 * (weighted + slope)).T, pushes)
    total: Array = of_state[:, None] + of_push[None, :] + both
    return total


def _least(costs: Array) -> Numbers:
    """The places of the least costs that are finite; of equal ones the first."""
    finite = np.flatnonzero(costs < np.inf)
    if len(finite) <= SEQUENCES:
        return finite
    bound = np.partition(costs, SEQUENCES - 1)[SEQUENCES - 1]
    below, at = np.flatnonzero(costs < bound), np.flatnonzero(costs == bound)
    return np.concatenate([below, at[: SEQUENCES - len(below)]])


REPORTED_TICKS = 3
"""The board reports the lockout of one coil a tick: a coil that is ready is soon known to be."""
RETRY = 8
"""After 1 / RETRY of the time between opportunities it is checked again whether a pulse helps."""


@dataclass(frozen=True, slots=True)
class PulseMpcGains:
    """Weights as for ``lqr``, and how far the field is considered beyond the pulses searched, in orbits.

    The effort is that of a dipole without limits, which stands in for the pulses after those searched.
    """

    rate: float = 0.0
    effort: float = 0.001
    horizon_orbits: float = 0.25

    def __post_init__(self) -> None:
        """Check what the equations need, and that a plan is soon made.

        Raises:
            ValueError: a weight or the horizon out of range.
        """
        check_weights(self.rate, self.effort)
        check_horizon(self.horizon_orbits, 0.05, 1.0)


def pulse_mpc(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The pulse to fire in answer to this tick; memory is the tick from which one may be demanded."""
    pulses, schedule = config.pulse_model, config.schedules.get("pulse_mpc")
    known = inputs.attitude.usable and inputs.reference is not None and inputs.ephemeris is not None
    if not known or pulses is None or schedule is None:
        return Demand(memory=memory)
    if 0 not in inputs.wait_ticks:
        return Demand(memory=memory, pulse=NO_PULSE)
    begin = memory[0] if len(memory) == 1 and memory[0] - inputs.tick <= pulses.step_ticks else inputs.tick
    late = inputs.tick - begin
    if late < 0 or (late < REPORTED_TICKS and any(0 < wait <= REPORTED_TICKS for wait in inputs.wait_ticks)):
        return Demand(memory=(float(begin),), pulse=NO_PULSE)
    pulse = _planned(inputs, pulses, schedule, config)
    pause = pulses.step_ticks if pulse.level else -(-pulses.step_ticks // RETRY)
    return Demand(memory=(float(inputs.tick + pause),), pulse=pulse)


def _planned(inputs: LawInput, pulses: PulseModel, schedule: Schedule, config: ControlConfig) -> Pulse:
    """The first pulse of the best sequence; none where the orbit has no position."""
    reference, model = inputs.reference, inputs.ephemeris
    if reference is None or model is None:
        return NO_PULSE
    ahead = _ahead(inputs, reference, model, pulses, schedule, config)
    state = orbital_state(inputs.attitude, expected_torque(inputs, schedule))
    a, b, c = (BARRED if ticks == NEVER else -(-ticks // pulses.step_ticks) for ticks in inputs.wait_ticks)
    return first_pulse(state, ahead, pulses, (a, b, c))


def _ahead(
    inputs: LawInput,
    reference: Reference,
    model: EphemerisModel,
    pulses: PulseModel,
    schedule: Schedule,
    config: ControlConfig,
) -> list[Opportunity]:
    """The opportunities searched; none where the orbit has no position.

    The field of each is that in the middle of its pulse. At the first the attitude is the estimated one, at
    the others nearly the nominal one.
    """
    now_s = model.epoch_unix_s + inputs.tick * config.tick_s
    ahead = interpolated_orbit(model, now_s + 0.5 * config.horizon_s, pulses.sight)
    if ahead is None:
        return []
    count, problem = pulses.searched, pulses.problem
    between, later = (
        OrbitAhead(*(part[steps] for part in ahead))
        for steps in (slice(count, 2 * count), slice(2 * count, None))
    )
    u_rad = latitude_argument(reference) + reference.orbit_rate_radps * count * problem.step_s
    end = np.hstack([schedule.costs[(node(u_rad) + len(later.b_orbit_t)) % STEPS], np.zeros((6, 1))])
    after = _costs(schedule.problem, later, inputs.dipole_body_am2, end)[1][0]
    drifts, costs = _costs(
        problem, between, inputs.dipole_body_am2, after * (schedule.problem.step_s / problem.step_s)
    )
    turned = kicks(pulses, ahead.b_orbit_t[:count])
    turned[0] = times(
        kicks(pulses, np.array(inputs.b_body_t)), np.array(dcm(inputs.attitude.q_body_from_orbit))
    )
    return [Opportunity(*known) for known in zip(turned, drifts, costs[1:], strict=True)]


def _costs(problem: Problem, ahead: OrbitAhead, dipole_am2: Vec3, last: Array) -> tuple[Array, list[Array]]:
    """The known drift of each step, and (P S s) from the beginning of the first to the end of the last."""
    h, torque_nm = problem.step_s, np.cross(np.array(dipole_am2), ahead.b_orbit_t)
    drifts, rate_changes_radps2 = times(torque_nm, problem.free[:, 6:].T), np.gradient(ahead.rate_radps, h)
    drifts[:, 2] -= h * rate_changes_radps2
    drifts[:, 5] -= 0.5 * h * h * rate_changes_radps2
    return drifts, [*cost_to_go(problem, ahead.b_orbit_t, drifts, last), last]


LAWS = {
    "pulse_mpc": LawEntry(42, Aim.THREE_AXIS, balanced_pd, pulse_mpc, PulseMpcGains, needs=Need.PULSES),
}
