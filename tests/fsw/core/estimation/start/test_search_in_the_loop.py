"""The search from tick to tick of the flight loop: what ends it, and what it does not heed."""

import numpy as np
import pytest
from changed import changed
from flight_states import altered, stepped

from fsw.core.estimation.estimator import restart
from fsw.core.estimation.start.batch import SampleBatch
from fsw.core.packing import copy_state, pack
from fsw.core.restart import begin_count
from fsw.core.state import Inbox
from fsw.core.state_bytes import checksum
from fsw.core.step import boot
from fsw.table.config import flight_config
from fsw.wire.messages import Mode, Sync, TcMode
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load


@pytest.fixture(scope="module")
def searching():
    """The table of a satellite with Sun cells, a state in the middle of its first search, and what comes."""
    scenario = load("cubesat-cells")
    config, plant = flight_config(flight_table(scenario)), Plant(plant_config(scenario, 2))
    state = boot(config)
    while state.estimator.batch.search is None or state.estimator.batch.search.steps < 3:
        assert state.tick < 600
        state, outbox = stepped(state, inbox_of(plant), config)
        for frame in outbox:
            plant.receive(frame)
        plant.end_tick()
    return config, state, inbox_of(plant)


def inbox_of(plant):
    """Begins the next tick."""
    *frames, sync = plant.begin_tick()
    sync = Sync.decode(sync.data)
    return Inbox(sync.tick, sync.unix_time_s, tuple(frames))


@pytest.mark.long
def test_it_goes_on_by_a_few_samples_in_each_tick(searching):
    config, state, inbox = searching
    after, _ = stepped(state, inbox, config)
    before, search = state.estimator.batch.search, after.estimator.batch.search
    assert (search.steps, search.at) != (before.steps, before.at)
    assert checksum(after) != checksum(altered(after, estimator=state.estimator))


def test_a_change_of_mode_does_not_touch_it(searching):
    config, state, inbox = searching
    mode = Mode.SAFE if state.modes.mode is not Mode.SAFE else Mode.DETUMBLE
    told = inbox.replace(frames=(TcMode(mode).encode(), *inbox.frames))
    quiet, commanded = stepped(state, inbox, config)[0], stepped(state, told, config)[0]
    assert commanded.modes.mode is mode is not quiet.modes.mode
    assert pack(commanded.estimator.batch) == pack(quiet.estimator.batch)


def test_without_a_sample_it_goes_on_all_the_same(searching):
    config, state, inbox = searching
    silent, _ = stepped(state, inbox.replace(frames=()), config)
    usual, _ = stepped(state, inbox, config)
    assert pack(silent.estimator.batch) == pack(usual.estimator.batch)


def test_a_new_count_of_ticks_and_a_restart_of_the_filter_end_it(searching):
    config, state, _ = searching
    again = copy_state(state)
    begin_count(again, 7, config)
    assert again.estimator.batch == SampleBatch()
    assert changed(state.estimator, restart).batch == SampleBatch()


def test_the_step_is_pure(searching):
    config, state, inbox = searching
    before = pack(state.estimator.batch)
    first, second = stepped(state, inbox, config), stepped(state, inbox, config)
    assert checksum(first[0]) == checksum(second[0])
    assert pack(state.estimator.batch) == before
    np.testing.assert_array_equal(*(one.estimator.batch.search.q for one, _ in (first, second)))
