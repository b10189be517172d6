"""Linear predictive control over the period of the field: a plan for the orbit ahead, renewed often.

Orbit and field model give the field along the coming orbit: not the direct dipole's, which repeats each
orbit, but the one that the satellite will meet. The plan minimises the cost along it; its terminal cost is
what the periodic regulator (``lqr``) expects from there on. Its first steps are applied, by feedback; then it
is made anew. On the direct dipole's field it is the periodic regulator.

The plan has no bound on the dipole: the demand is scaled down to what the coils can give on average. As for
``lqr`` it is the total dipole, from which the residual one is subtracted after that bound: near it the body
points worse if the residual dipole is opposed only in part.

Source: Ovchinnikov, Roldugin 2019, section 3.3 (after Silani, Lovera 2005); equations: ``riccati``.
"""

from collections.abc import Callable
from dataclasses import dataclass

from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    balanced_pd,
    check_weights,
    dipole,
    expected_torque,
    latitude_argument,
    node,
    within,
)
from fsw.core.laws.plan.orbit_ahead import check_horizon, orbit_ahead
from fsw.core.laws.plan.riccati import Array, Schedule, backward

APPLIED_STEPS = 5
"""Steps of a plan that are applied."""
FieldAhead = Callable[[LawInput, int, float, ControlConfig], Array | None]
_NUMBERS = 3 * 9
"""Numbers of a gain."""


@dataclass(frozen=True, slots=True)
class MpcGains:
    """Weights as for ``lqr``, and how far the plan reaches, in orbits."""

    rate: float = 0.0
    effort: float = 0.05
    horizon_orbits: float = 1.0

    def __post_init__(self) -> None:
        """Check what the equations need, and that a plan is soon made.

        Raises:
            ValueError: a weight or the horizon out of range.
        """
        check_weights(self.rate, self.effort)
        check_horizon(self.horizon_orbits, 0.1, 4.0)


def plan(table: Schedule, b_orbit_t: Array, end_node: int) -> Array:
    """Gains of the first steps, shape (APPLIED_STEPS, 3, 9), of a plan that ends in the regulator's cost.

    Args:
        table: the periodic regulator.
        b_orbit_t: field in the middle of each step of the plan, orbital axes, T, shape (steps, 3).
        end_node: step of the table in which the plan ends.
    """
    gains, _ = backward(table.problem, b_orbit_t, table.costs[end_node])
    return gains[:APPLIED_STEPS]


def mpc(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The step of the plan in memory (tick of its start, its gains); a new plan where it has ended."""
    if inputs.ephemeris is None:
        return Demand(memory=memory)
    return by_plan("mpc", _model_field, inputs, memory, config)


def _model_field(inputs: LawInput, steps: int, step_s: float, config: ControlConfig) -> Array | None:
    """The field of the model in the middle of each step."""
    model = inputs.ephemeris
    if model is None:
        return None
    unix_s = model.epoch_unix_s + inputs.tick * config.tick_s
    ahead = orbit_ahead(model, [unix_s + (k + 0.5) * step_s for k in range(steps)])
    return None if ahead is None else ahead.b_orbit_t


def by_plan(
    law: str,
    field_ahead: FieldAhead,
    inputs: LawInput,
    memory: Memory,
    config: ControlConfig,
    applied: int = APPLIED_STEPS,
) -> Demand:
    """The step of the plan in memory, or the first of a new one along the field that ``field_ahead`` gives.

    Args:
        law: the one whose schedule and horizon are used.
        field_ahead: from the inputs, a number of steps, their length and the configuration, gives the field
            in the middle of each, orbital axes, T, shape (steps, 3); None where there is none.
        inputs: as for the law, like the next two.
        memory: tick of the plan's start, and its gains.
        config: the configuration.
        applied: steps of a plan that are applied, at most as many as it has.
    """
    table = config.schedules.get(law)
    if not inputs.attitude.usable or inputs.reference is None or table is None:
        return Demand(memory=memory)
    step = _step(memory, inputs.tick, config.tick_s / table.problem.step_s, applied)
    if step is None:
        steps = round(config.gains[law].horizon_orbits * STEPS)
        b_orbit_t = field_ahead(inputs, steps, table.problem.step_s, config)
        if b_orbit_t is None:
            return Demand()
        end = node(latitude_argument(inputs.reference)) + steps
        gains = plan(table, b_orbit_t, end % STEPS)[:applied]
        memory, step = (float(inputs.tick), *gains.ravel().tolist()), 0
    first = 1 + step * _NUMBERS
    wanted = dipole(memory[first : first + _NUMBERS], inputs.attitude, expected_torque(inputs, table))
    return Demand(within(wanted, config.mean_dipole_am2), memory=memory)


def _step(memory: Memory, tick: int, steps_per_tick: float, applied: int) -> int | None:
    """The step of the plan in memory that this tick belongs to; None where there is none."""
    if len(memory) != 1 + applied * _NUMBERS or tick < memory[0]:
        return None
    step = int((tick - memory[0]) * steps_per_tick)
    return step if step < applied else None


LAWS = {
    "mpc": LawEntry(41, Aim.THREE_AXIS, balanced_pd, mpc, MpcGains),
}
