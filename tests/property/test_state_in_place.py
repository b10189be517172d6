"""A step changes its state in place and nothing else, and nothing outside holds on to a part of it.

Satellites of every kind fly on a bus that loses, repeats and forges, under telecommands of all sorts.
"""

import pickle
from dataclasses import is_dataclass
from enum import Enum
from io import BytesIO
from random import Random

import numpy as np
import pytest
from sgp4.api import Satrec

from fsw.core.gate.readings import TELECOMMANDS
from fsw.core.packing import copy_state, field_names, pack
from fsw.core.state import Inbox
from fsw.core.step import boot, step
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.messages import Mode, Sync, TcClear, TcFreeze, TcLaw, TcMode, TcSpin
from fsw.wire.value import Value
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load

SATELLITES = ("microsat", "cubesat-cells", "microsat-wheel", "realsat", "kalman-50kg")
"""Pulsed coils and a Sun sensor, Sun cells, a driven wheel, elements from two lines, continuous coils."""
TICKS = 160
COMMANDS = (
    TcMode(Mode.SAFE),
    TcMode(Mode.POINT),
    TcClear(),
    TcLaw(2),
    TcSpin(0.01),
    TcFreeze(1),
    TcFreeze(0),
)


def table(name):
    return flight_config(flight_table(load(name)))


def disturbed(name, seed=3):
    """The frames that come in each tick, SYNC last, whatever is answered."""
    random, plant = Random(f"{name} {seed}"), Plant(plant_config(load(name), seed))
    counters = dict.fromkeys(TELECOMMANDS, 0)
    for tick in range(TICKS):
        *frames, sync = plant.begin_tick()
        frames = [frame for frame in frames if random.random() > 0.02]
        if random.random() < 0.1:
            command = random.choice(COMMANDS)
            counters[command.ID] = (counters[command.ID] + 1) & 0xF
            frames.append(command.replace(counter=counters[command.ID]).encode())
        if random.random() > 0.03:
            frames.append(sync)
        if random.random() < 0.03:
            frames.append(random.choice([sync, Sync(10**6 + tick, 0).encode()]))
        if tick in (100, 101):  # a restart of the plant, as it seems
            frames.append(Sync(7, 0).encode())
        yield frames
        plant.end_tick()


def inboxes(name):
    """What each SYNC of such a flight hands to a step."""
    waiting = []
    for frames in disturbed(name):
        for frame in frames:
            if frame.can_id == Sync.ID:
                sync = Sync.decode(frame.data)
                yield Inbox(sync.tick, sync.unix_time_s, tuple(waiting))
                waiting = []
            else:
                waiting.append(frame)


LASTING = (bool, int, float, str, bytes, Enum, type, range, np.ndarray, type(None))
"""Arrays too: they are shared, as no function changes one. That none does, the bytes show."""


def changeable(value, path=""):
    """All that can be changed in place in a value: pairs of its identity and the path to it."""
    if isinstance(value, LASTING):
        return
    if isinstance(value, tuple | list | frozenset):
        parts = {str(place): part for place, part in enumerate(value)}
    elif isinstance(value, dict):
        parts = {str(key): part for key, part in value.items()}
    elif is_dataclass(value) or isinstance(value, Value) or hasattr(type(value), "__slots__"):
        parts = {name: getattr(value, name) for name in field_names(type(value))}
    else:
        parts = {}
    lasting = isinstance(value, tuple | frozenset | Value) or callable(value)
    if not lasting and not (is_dataclass(value) and value.__dataclass_params__.frozen):
        yield id(value), path
    for name, part in parts.items():
        yield from changeable(part, f"{path}.{name}")


def test_the_walk_finds_what_can_be_changed():
    found = {path for _, path in changeable(boot(table("microsat-wheel")))}
    assert {"", ".sent", ".syncs", ".modes", ".modes.held_since", ".gate", ".events", ".health"} <= found
    assert [path for _, path in changeable(((1,), [2], {3: [4]}))] == [".1", ".2", ".2.3"]


@pytest.mark.long
@pytest.mark.parametrize("name", SATELLITES)
def test_a_step_of_a_copy_is_that_of_the_original(name):
    config = table(name)
    state = boot(config)
    for inbox in inboxes(name):
        before, copied = pack(state), copy_state(state)
        assert pack(copied) == before
        answer = step(copied, inbox, config)
        assert pack(state) == before
        assert step(state, inbox, config) == answer
        assert pack(state) == pack(copied)


@pytest.mark.long
@pytest.mark.parametrize("name", SATELLITES)
def test_what_can_be_changed_belongs_to_one_part_of_one_state(name):
    """Not to its copy, to the inbox, the answer or the tables, nor to another part."""
    config = table(name)
    of_tables, state = dict(changeable(config)), boot(config)
    for inbox in inboxes(name):
        answer = step(state, inbox, config)
        ours = dict(changeable(state))
        assert len(ours) == len(list(changeable(state)))
        for other in (copy_state(state), inbox, answer):
            assert [ours[one] for one, _ in changeable(other) if one in ours] == []
        assert [ours[one] for one in ours if one in of_tables] == []


class Tables(pickle.Pickler):
    """Tables as bytes, but for the work space of SGP4, which it fills anew at each call."""

    def reducer_override(self, value):
        return (str, ("Satrec",)) if isinstance(value, Satrec) else NotImplemented


def packed_tables(config):
    stream = BytesIO()
    Tables(stream).dump(config)
    return stream.getvalue()


@pytest.mark.parametrize("name", SATELLITES)
def test_the_tables_stay_as_they_were(name):
    config = table(name)
    state, before = boot(config), packed_tables(config)
    for inbox in inboxes(name):
        step(state, inbox, config)
    assert packed_tables(config) == before


@pytest.mark.parametrize("name", SATELLITES)
def test_two_nodes_with_the_same_tables_do_not_disturb_each_other(name):
    config = table(name)
    flights = [list(disturbed(name, seed)) for seed in (1, 2)]
    alone = []
    for flight in flights:
        node = FlightNode(config)
        alone.append([node.receive(frame) for frames in flight for frame in frames])
    nodes, together = [FlightNode(config), FlightNode(config)], [[], []]
    for tick in range(TICKS):
        for node, flight, answers in zip(nodes, flights, together, strict=True):
            answers += [node.receive(frame) for frame in flight[tick]]
    assert together == alone
