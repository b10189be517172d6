"""The PD dipole held over many ticks: computed once a cycle, after a time of measuring with the coils off.

    m = 0 for ``measure_s``, then for ``act_s``, with the values at its first tick,
    m = -(1 / share) b x (k_w Omega + k_a S),     share = act_s / (measure_s + act_s).

``pd_held`` has no time of measuring. ``pd_apart`` measures as long as it acts, by default, so that the field
of the coils has died away when b is taken. While it measures no pulse begins, none is owed, and the residual
dipole is not taken off; one that began before is driven to its end. On average a held dipole is half of
``act_s`` old. For each length of the cycle there are gains that are small enough
(``sim/design/pd_limits.py``).

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Celani 2016a (the dipole constant over a control
interval of several steps) and Celani 2016b (measuring and acting apart). The share, which keeps the mean
torque, is this project's.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import ZERO, Vec3, scale
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import acquisition_error, attitude_error, pd_dipole
from fsw.core.laws.plan.pulse_model import NO_PULSE


@dataclass(frozen=True, slots=True)
class HoldGains:
    """Length of the cycle, s."""

    hold_s: float = 60.0

    def __post_init__(self) -> None:
        """Raises ValueError: a length that is not greater than 0."""
        if self.hold_s <= 0.0:
            raise ValueError("hold_s must be greater than 0")


@dataclass(frozen=True, slots=True)
class ApartGains:
    """Lengths of measuring and of acting, s."""

    measure_s: float = 30.0
    act_s: float = 30.0

    def __post_init__(self) -> None:
        """Raises ValueError: a negative length, or no time to act."""
        if self.measure_s < 0.0 or self.act_s <= 0.0:
            raise ValueError("measure_s must not be less than 0, and act_s must be greater than 0")


def pd_held(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Near the goal, by S: one dipole for the whole cycle."""
    gains: HoldGains = config.gains["pd_held"]
    return _cycle(inputs, memory, setpoint, config, (0.0, gains.hold_s), near=True)


def pd_held_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same far from it, by the error that does not vanish upside down."""
    gains: HoldGains = config.gains["pd_held"]
    return _cycle(inputs, memory, setpoint, config, (0.0, gains.hold_s), near=False)


def pd_apart(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Near the goal, by S: measuring, then acting."""
    gains: ApartGains = config.gains["pd_apart"]
    return _cycle(inputs, memory, setpoint, config, (gains.measure_s, gains.act_s), near=True)


def pd_apart_far(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The same far from it, by the error that does not vanish upside down."""
    gains: ApartGains = config.gains["pd_apart"]
    return _cycle(inputs, memory, setpoint, config, (gains.measure_s, gains.act_s), near=False)


def _cycle(
    inputs: LawInput,
    memory: Memory,
    setpoint: Setpoint,
    config: ControlConfig,
    spans_s: tuple[float, float],
    *,
    near: bool,
) -> Demand:
    """One tick of the cycle; memory: its first tick, whether the dipole is computed (1 or 0), the dipole."""
    if not inputs.attitude.usable:
        return Demand()
    measure_s, act_s = spans_s
    begun, computed, held = float(inputs.tick), 0.0, ZERO
    if len(memory) == 5 and (inputs.tick - memory[0]) * config.tick_s < measure_s + act_s:
        begun, computed, held = memory[0], memory[1], (memory[2], memory[3], memory[4])
    if not computed and (inputs.tick - begun) * config.tick_s >= measure_s:
        computed, held = 1.0, scale((measure_s + act_s) / act_s, _pd(inputs, setpoint, config, near=near))
    now = (begun, computed, *held)
    return Demand(held, memory=now) if computed else Demand(memory=now, pulse=NO_PULSE)


def _pd(inputs: LawInput, setpoint: Setpoint, config: ControlConfig, *, near: bool) -> Vec3:
    q, omega = inputs.attitude.q_body_from_orbit, inputs.attitude.omega_body_orbit_radps
    error = attitude_error(dcm(q)) if near else acquisition_error(inputs, setpoint, config)
    return pd_dipole(inputs.b_body_t, omega, error, setpoint.k_w, setpoint.k_a)


LAWS = {
    "pd_held": LawEntry(55, Aim.THREE_AXIS, pd_held_far, pd_held, HoldGains),
    "pd_apart": LawEntry(56, Aim.THREE_AXIS, pd_apart_far, pd_apart, ApartGains),
}
