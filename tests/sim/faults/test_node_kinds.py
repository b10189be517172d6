"""Faults of the flight software's process, memory and clock: what each does with time, SYNC and state."""

from itertools import groupby
from random import Random
from typing import NamedTuple

import numpy as np
import pytest

from fsw.wire.messages import CoilFire, NavRate, Sync, intact
from sim.faults.fault import Condition
from sim.faults.kinds import make
from sim.faults.node_kinds import count_doubles, flip
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load

SYNC = Sync(5000, 1_700_000_077)


def fault(kind, seed=1, **parameters):
    return make(kind, parameters, Random(seed))


def synced(changing, tick=0, sync=SYNC):
    frames = changing.sync(tick, sync.encode())
    assert all(map(intact, frames))
    return [Sync.decode(frame.data) for frame in frames]


@pytest.mark.parametrize(
    ("kind", "condition"),
    [
        ("killed", Condition.DEAD),
        ("all_restart", Condition.DEAD),
        ("stopped", Condition.STOPPED),
        ("sync_lost", Condition.RUNNING),
    ],
)
def test_the_process_is_in_one_condition_for_as_long_as_the_fault_lasts(kind, condition):
    lasting = fault(kind)
    assert {lasting.condition(tick) for tick in range(20)} == {condition}


def test_a_storm_lets_it_run_and_keeps_it_dead_for_no_longer_than_it_says():
    storm = fault("storm", up=9.0, down=4.0)
    stretches = [
        (condition, len(list(ticks))) for condition, ticks in groupby(map(storm.condition, range(600)))
    ]
    lengths = {which: {n for one, n in stretches[:-1] if one is which} for which in Condition}
    assert stretches[0][0] is Condition.DEAD
    assert lengths[Condition.RUNNING] == set(range(1, 10))
    assert lengths[Condition.DEAD] == set(range(1, 5))
    assert lengths[Condition.STOPPED] == set()


@pytest.mark.parametrize("part", [0.0, 0.2, 1.0])
def test_sync_is_lost_as_often_as_it_says_and_nothing_else(part):
    lossy = fault("sync_lost", part=part)
    come = sum(len(synced(lossy, tick)) for tick in range(3000))
    assert come / 3000 == pytest.approx(1.0 - part, abs=0.03)
    assert lossy.from_boards(0, [SYNC.encode()]) == lossy.to_boards(0, [SYNC.encode()]) == [SYNC.encode()]


def test_sync_comes_again_once_to_as_often_as_it_says():
    repeated = fault("sync_repeated", times=3.0)
    come = [synced(repeated, tick) for tick in range(60)]
    assert {len(syncs) for syncs in come} == {2, 3, 4}
    assert all(sync == SYNC for syncs in come for sync in syncs)


@pytest.mark.parametrize(("kind", "repeats"), [("ticks_held", False), ("ticks_repeated", True)])
def test_after_a_request_so_many_ticks_follow_without_delay(kind, repeats):
    held = fault(kind, seconds=4.9, rushed=2.0)
    assert held.repeats_sync is repeats
    times_ms = []
    for tick in range(8):
        times_ms.append(held.held_ms(tick))
        answer = [NavRate(1, 0.0, 0.0, 0.0), *([CoilFire(3, 1, 1, tick, 3000)] if tick in (1, 5) else [])]
        frames = [message.encode() for message in answer]
        assert held.to_boards(tick, frames) == frames
    assert times_ms == [4900, 4900, 0, 0, 4900, 4900, 0, 0]


@pytest.mark.parametrize(
    ("parameters", "tick", "off_s"),
    [
        ({"ticks": 900.0}, 5900, 900),
        ({"ticks": 900.0, "with_time": 0.0}, 5900, 0),
        ({"ticks": -900.0}, 4100, -900),
        ({"ticks": -9000.0}, 0, -9000),
    ],
)
def test_a_tick_that_jumps_takes_its_time_along_unless_told_otherwise(parameters, tick, off_s):
    expected = Sync(tick, SYNC.unix_time_s + off_s)
    assert synced(fault("tick_jumps", **parameters)) == [expected]


@pytest.mark.parametrize(("ticks", "off_s"), [(25.0, 2), (-25.0, -3), (5.0, 0)])
def test_at_ten_ticks_a_second_its_time_jumps_by_a_tenth_of_the_ticks(ticks, off_s):
    jumps = fault("tick_jumps", ticks=ticks)
    jumps.begin(Plant(plant_config(load("microsat", {"time": {"tick_hz": 10}}), 1)))
    assert synced(jumps) == [Sync(SYNC.tick + int(ticks), SYNC.unix_time_s + off_s)]


@pytest.mark.parametrize("seconds", [3600.0, -7.0])
def test_a_time_that_jumps_leaves_the_tick(seconds):
    expected = Sync(SYNC.tick, SYNC.unix_time_s + round(seconds))
    assert synced(fault("time_jumps", seconds=seconds)) == [expected]


class State(NamedTuple):
    """A state of every kind of part."""

    matrix: np.ndarray
    flag: bool
    rates: tuple[float, ...]
    tick: int
    sigma: float


STATE = State(np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]), True, (7.0, 8.0), 9, 10.0)


def doubles(state):
    return [*state.matrix.flat, *state.rates, state.sigma]


def test_the_sign_of_each_double_flips_by_itself_and_the_state_before_stays():
    assert count_doubles(STATE) == 9
    before = doubles(STATE)
    for place in range(9):
        flipped = flip(STATE, place, 63)
        assert doubles(flipped) == [-v if i == place else v for i, v in enumerate(before)]
        assert (flipped.flag, flipped.tick) == (True, 9)
    assert doubles(STATE) == before


@pytest.mark.parametrize("seed", range(5))
def test_a_bit_flips_once(seed):
    upset = fault("bit_flip", seed)
    state = upset.upset(STATE)
    assert sum(a != b for a, b in zip(doubles(state), doubles(STATE), strict=True)) == 1
    assert upset.upset(state) is state
