"""Linear predictive control over the period of the field: a plan for the orbit ahead, renewed often.

Orbit and field model give the field along the coming orbit: not the direct dipole's, which repeats each
orbit, but the one that the satellite will meet. The plan costs least along it, and at its end what the
periodic regulator (``lqr``) expects from there on. Its first steps are applied, by feedback; then it is made
anew. On the direct dipole's field it is the periodic regulator.

The plan has no bound of the dipole: the demand is shortened to what the coils can give in the mean. As for
``lqr`` it is the whole dipole, from which the residual one is taken off, after that bound: near it the body
points worse if the residual dipole is opposed in part only.

Source: Ovchinnikov, Roldugin 2019, section 3.3 (after Silani, Lovera 2005); equations: ``riccati``.
"""

from dataclasses import dataclass

from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.optimal.lqr import (
    STEPS,
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
_NUMBERS = 3 * 9
"""Of a gain."""


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
        check_weights("mpc", self.rate, self.effort)
        check_horizon("mpc", self.horizon_orbits, 0.1, 4.0)


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
    table = config.schedules.get("mpc")
    if not inputs.attitude.valid or inputs.reference is None or inputs.ephemeris is None or table is None:
        return Demand(memory=memory)
    step = _step(memory, inputs.tick, config.tick_s / table.problem.step_s)
    if step is None:
        steps = round(config.gains["mpc"].horizon_orbits * STEPS)
        model, step_s = inputs.ephemeris, table.problem.step_s
        unix_s = model.epoch_unix_s + inputs.tick * config.tick_s
        ahead = orbit_ahead(model, [unix_s + (k + 0.5) * step_s for k in range(steps)])
        if ahead is None:
            return Demand()
        end = node(latitude_argument(inputs.reference)) + steps
        gains = plan(table, ahead.b_orbit_t, end % STEPS)
        memory, step = (float(inputs.tick), *gains.ravel().tolist()), 0
    first = 1 + step * _NUMBERS
    wanted = dipole(memory[first : first + _NUMBERS], inputs.attitude, expected_torque(inputs, table))
    return Demand(within(wanted, config.mean_dipole_am2), memory=memory)


def _step(memory: Memory, tick: int, steps_per_tick: float) -> int | None:
    """The step of the plan in memory that this tick belongs to; None where there is none."""
    if len(memory) != 1 + APPLIED_STEPS * _NUMBERS or tick < memory[0]:
        return None
    step = int((tick - memory[0]) * steps_per_tick)
    return step if step < APPLIED_STEPS else None
