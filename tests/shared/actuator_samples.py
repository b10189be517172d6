"""A scheduler whose timers ran out long ago, over a board on which all coils are free."""

from copy import deepcopy
from dataclasses import replace

from gate_samples import measured

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, actuate
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.laws.interface import Demand
from fsw.wire.messages import CoilRefused, CoilRefusedReason, CoilStatus

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
UNEVEN = ((9.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
ZERO = (0.0, 0.0, 0.0)
TICK = 10_000

B_BODY_T = (0.0, 0.0, 2e-5)
"""Along axis 3: coil 0 turns about axis 2, coil 1 about axis 1, coil 2 does nothing."""

OWED_FOR = {0: (0.0, -3.0 * 8.0 * 2e-5, 0.0), 1: (3.0 * 8.0 * 2e-5, 0.0, 0.0)}
"""Impulses that the highest level of that coil pays in full."""


def make_config(shared=True, tick_hz=1):
    pulse_ticks, backoff_ticks, duration_ms = pulses.pulse_timing(tick_hz, 3000, 100_000)
    return PulseConfig(
        pulse_ticks=pulse_ticks,
        backoff_ticks=backoff_ticks,
        duration_ms=duration_ms,
        shared=shared,
        levels_am2=(0.5, 2.0, 8.0),
        pulse_s=3.0,
        tick_s=1.0 / tick_hz,
        leak_s=300.0,
        rate_metric=IDENTITY,
        energy_metric=UNEVEN,
    )


CONFIG = make_config()
COILS = ActuatorConfig(CONFIG, dipoles=None)


def ready(owed=OWED_FOR[0]):
    """All own timers ran out long ago."""
    return replace(pulses.boot(0, CONFIG), ready_tick=(0, 0, 0), pending_impulse_body_nms=owed)


def status(coil, lockout_ms=0, level=0, seq=0):
    return CoilStatus(level, coil, 0, 0, lockout_ms, seq)


ALL_FREE = CoilView(lockout_ms=(0, 0, 0))


BOARD_IS_THERE = measured(coil=status(0))


def then(change, state, *arguments):
    """The state after a change in place; the one before stays as it was."""
    changed = deepcopy(state)
    change(changed, *arguments)
    return changed


def answered(state, view, *rest):
    """State and view after ``actuate``, and the request; those before stay as they were."""
    state, view = deepcopy((state, view))
    request = actuate(state, view, *rest)
    return state, view, request


def run(state=None, view=ALL_FREE, demand=None, readings=BOARD_IS_THERE, tick=TICK, config=CONFIG):
    """Under a law that asks for nothing more, unless told otherwise."""
    asked = Demand() if demand is None else demand
    coils = ActuatorConfig(config, dipoles=None)
    return answered(ready() if state is None else state, view, asked, B_BODY_T, readings, tick, coils)


def run_safe(state, view, readings=BOARD_IS_THERE, tick=TICK):
    """While no law flies."""
    return answered(state, view, None, B_BODY_T, readings, tick, COILS)


def refusal(tick):
    return CoilRefused(0, 9, CoilRefusedReason.LOCKOUT, tick & 0xFF)
