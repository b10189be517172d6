"""Optimal pulses: at each opportunity the first pulse of the best sequence of the opportunities to come.

Unlike ``mpc``, whose mean dipole the actuator then turns into pulses, this law plans with the pulses that
the coils can give: their levels, one coil at a time, and their back-off. Torque and residual dipole are those
that the filter estimates. After the opportunities searched, the terminal cost is what a dipole with no limit
would leave along the field to come. A sequence is flown for one pulse, and then made anew.

Source: as for ``pulse_plan``.
"""

from dataclasses import dataclass

import numpy as np

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Vec3
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    check_weights,
    expected_torque,
    latitude_argument,
    node,
    orbital_state,
    without_memory,
)
from fsw.core.laws.plan.cost_to_go import cost_to_go, times
from fsw.core.laws.plan.orbit_ahead import OrbitAhead, check_horizon, seen
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE, Pulse, PulseModel, kicks
from fsw.core.laws.plan.pulse_plan import BARRED, Opportunity, first_pulse
from fsw.core.laws.plan.riccati import Array, Problem, Schedule
from fsw.core.orbit.ephemeris import EphemerisModel, Reference

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
    known = inputs.attitude.valid and inputs.reference is not None and inputs.ephemeris is not None
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
    ahead = seen(model, now_s + 0.5 * config.horizon_s, pulses.sight)
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
    "pulse_mpc": LawEntry(42, Aim.THREE_AXIS, without_memory, pulse_mpc, PulseMpcGains, needs=Need.PULSES),
}
