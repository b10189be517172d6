"""A bit flips in any double of the flight state: no exception, every SYNC answered, nothing acts on a NaN.

Flips are taken at even distances over all doubles and all of their bits; ``make fuzz`` takes every one.
"""

import os
from math import isfinite

import pytest
from flight_states import stepped

from fsw.core.state import Inbox
from fsw.core.step import boot
from fsw.table.config import flight_config
from fsw.wire.messages import CLASSES, CoilFire, Sync, TickDone
from sim.fault_rig.record import finite
from sim.faults.node_kinds import count_doubles, flip
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load

EVERY_ONE = int(os.environ.get("TORQUER_FUZZ_FRAMES", "10000")) >= 1_000_000
STRIDE = 1 if EVERY_ONE else 97
BITS = 64
FOLLOWED = 3
"""Ticks flown after the flip."""


@pytest.fixture(scope="module")
def flight():
    """The onboard table, and the state before each tick with what came in it."""
    scenario = load("microsat")
    config, plant = flight_config(flight_table(scenario)), Plant(plant_config(scenario, 1))
    state, ticks = boot(config), []
    for _ in range(330):
        *frames, last = plant.begin_tick()
        sync = Sync.decode(last.data)
        inbox = Inbox(sync.tick, sync.unix_time_s, tuple(frames))
        ticks.append((state, inbox))
        state, outbox = stepped(state, inbox, config)
        for frame in outbox:
            plant.receive(frame)
        plant.end_tick()
    return config, ticks


def moments(ticks):
    """A tick while a coil is on, and one long after the pulse, both with an estimate."""
    on = [at for at, (state, _) in enumerate(ticks) if at > 200 and state.coil.driven_level]
    return on[0], on[0] + 60


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_flip_is_detected_or_harmless(flight):
    config, ticks = flight
    taken = 0
    for at in moments(ticks):
        sound, _ = ticks[at]
        assert sound.estimator.estimate is not None
        for number in range(taken % STRIDE, BITS * count_doubles(sound), STRIDE):
            state = flip(sound, *divmod(number, BITS))
            for _, inbox in ticks[at : at + FOLLOWED]:
                state, outbox = stepped(state, inbox, config)
                assert outbox[-1].can_id == TickDone.ID
                assert finite(state)
                for frame in outbox:
                    judge(CLASSES[frame.can_id].decode(frame.data))
            taken += 1
    assert taken > BITS * 4


def judge(message):
    """What is said is numbers, and what is asked for is within the limits."""
    assert all(isfinite(value) for value in message.values())
    if isinstance(message, CoilFire):
        assert 1 <= abs(message.level) <= 3
        assert message.coil in (0, 1, 2)
        assert message.duration_ms == 3000


def test_every_double_and_bit_is_a_different_flip(flight):
    _, ticks = flight
    sound, _ = ticks[250]
    count = count_doubles(sound)
    assert count > 200
    with pytest.raises(IndexError):
        flip(sound, count, 0)
