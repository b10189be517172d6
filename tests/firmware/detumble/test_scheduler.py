"""The scheduler in C against ``fsw.core.actuation.pulses``: on given dipoles the same pulses and timers."""

import math
from random import Random

import pytest
from detumble_reference import pulse_gaps

from fsw.core.actuation import pulses
from fsw.core.algebra.vector import cross, norm, sub
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.table.config import flight_config
from sim.scenario.schema import flight_table, load, parse_settings

SETTINGS = {
    "as it ships": (),
    "per coil": ("coils.backoff='per_coil'",),
    "10 Hz": ("time.tick_hz=10",),
    "short": ("coils.pulse_s=1.5", "coils.backoff_s=7.3"),
    "products of inertia": ("body.inertia_kgm2=[[1.0,0.1,-0.05],[0.1,1.8,0.2],[-0.05,0.2,1.9]]",),
    "skew coils": ("flight.calibration.coils.matrix=[[0.98,0.05,0.0],[-0.04,1.03,0.02],[0.03,0.0,0.96]]",),
}
TICKS = 10_000
SINGLE = 1e-5
"""Of what is owed, in parts of what a pulse pays."""


def demands(random):
    """Dipoles and fields of a slow tumble, with pauses, in single precision: both get the same."""
    phase, rates = random.random(), [random.uniform(0.003, 0.03) for _ in range(3)]
    strength = 1.0
    for tick in range(TICKS):
        if tick % 500 == 0:
            strength = random.choice((0.0, 0.01, 0.1, 1.0, 10.0))
        b = [_single(2.5e-5 * math.sin(rate * tick + phase + axis)) for axis, rate in enumerate(rates)]
        m = [_single(strength * random.gauss(0.3, 1.0)) for _ in range(3)]
        yield tuple(m), tuple(b)


def _single(value):
    import numpy as np

    return float(np.float32(value))


@pytest.mark.long
@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
@pytest.mark.slow
def test_it_fires_the_same_pulses(firmware_of, settings):
    firmware = firmware_of("microsat", *settings)
    config = flight_config(flight_table(load("microsat", parse_settings(settings)))).coils.pulses
    state, fired, nearest = pulses.boot(0, config), 0, 1.0
    firmware.boot_scheduler()
    for tick, (m, b) in enumerate(demands(Random("scheduler"))):
        ours = firmware.schedule(m, b)
        torque = cross(m, b)
        pulses.owe(state, torque, b, config)
        due = pulses.due(state, torque, b, config)
        may_fire = [wait == 0 for wait in pulses.wait_ticks(state, tick)]
        pulse = pulses.choose(state, due, config.rate_metric, tick, b, config)
        if any(may_fire):
            nearest = min([nearest, *sorted(pulse_gaps(due, b, config, may_fire).values())[1:2]])
        if pulse is not None:
            pulses.fire(state, pulse, pulses.impulse(pulse, b, config), tick, config)
            fired += 1
        assert Pulse(ours.coil, ours.level) == (pulse or Pulse(0, 0)), (tick, nearest)
        waits = tuple(max(ready - tick, 0) for ready in state.ready_tick)
        assert (ours.wait_ticks, ours.busy_ticks) == (waits, max(state.busy_until - tick, 0))
        pays = config.pulse_s * config.levels_am2[2] * norm(b)
        assert norm(sub(ours.owed_nms, state.pending_impulse_body_nms)) < SINGLE * pays
    assert fired > TICKS / (config.pulse_ticks + config.backoff_ticks) / 2
