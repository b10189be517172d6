"""A satellite with its boards around the flight software: real frames, nothing zero, no two axes alike."""

import socket
from enum import Enum
from math import nextafter

import numpy as np
import pytest
from flight_states import stepped

from fsw.bus.hub import Hub
from fsw.bus.link import LoopLink
from fsw.core.packing import field_names, pack
from fsw.core.state import Inbox
from fsw.core.step import boot
from fsw.input.schema import merge
from fsw.table.config import flight_config
from fsw.table.table import load_flight_table
from fsw.wire.messages import CLASSES, Sync
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load

UNEVEN = {
    "body": {"inertia_kgm2": [[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]},
    "initial": {"axis": [0.5, -0.7, 0.4], "angle_deg": 25.0, "rate_degps": [0.05, -0.07, 0.04]},
    "sensors": {
        "magnetometer": {"bias_nt": [150.0, -250.0, 100.0], "misalignment_deg": [0.1, -0.2, 0.15]},
        "sun": {"misalignment_deg": [0.1, 0.05, -0.1]},
    },
    "disturbance": {"torque_nm": [3e-8, -2e-8, 1e-8], "residual_dipole_am2": [0.003, 0.002, -0.004]},
    "flight": {
        "modes": {"recover_s": 5.0, "settle_s": 20.0, "hold_s": 40.0, "lose_s": 30.0},
        "uncertainty": {
            "residual_dipole_am2": 0.005,
            "magnetometer_misalignment_deg": 0.4,
            "sun_misalignment_deg": 0.3,
        },
    },
}
"""The table knows what the satellite differs from it by, within bounds."""


class World:
    """What the boards say at each tick, and what is answered them."""

    def __init__(self, settings, seed):
        scenario = load("microsat", merge(UNEVEN, settings))
        self.config = flight_config(flight_table(scenario))
        self.plant = Plant(plant_config(scenario, seed))
        self.state = boot(self.config)

    def inbox(self):
        """Begins the next tick."""
        *frames, sync = self.plant.begin_tick()
        sync = Sync.decode(sync.data)
        return Inbox(sync.tick, sync.unix_time_s, tuple(frames))

    def step(self, change=lambda inbox: inbox):
        """One tick, with what is changed between the boards and the flight software; its messages."""
        self.state, outbox = stepped(self.state, change(self.inbox()), self.config)
        for frame in outbox:
            self.plant.receive(frame)
        self.plant.end_tick()
        return [CLASSES[frame.can_id].decode(frame.data) for frame in outbox]

    def fly_until_valid(self, most=400):
        """Until the attitude is proven; the number of ticks flown."""
        for flown in range(most):
            if self.state.attitude.valid:
                return flown
            self.step()
        pytest.fail(f"the attitude is not valid after {most} ticks")

    def fly(self, ticks, change=lambda inbox: inbox):
        """All messages of so many ticks, a list a tick."""
        return [self.step(change) for _ in range(ticks)]


@pytest.fixture(scope="session")
def config():
    """The flight software by the onboard table that ships with it."""
    return flight_config(load_flight_table(None))


@pytest.fixture(scope="session")
def make_world():
    """Makes a satellite; keywords are sections laid over the scenario."""

    def make(seed=3, **settings):
        return World(settings, seed)

    return make


@pytest.fixture(scope="session")
def without():
    """Makes a change of inboxes that drops messages of some classes."""

    def dropper(*classes):
        ids = {message.ID for message in classes}
        return lambda inbox: inbox.replace(frames=tuple(f for f in inbox.frames if f.can_id not in ids))

    return dropper


def leaves_of(value, path="state"):
    """(path, leaf, rebuild) for every number in nested objects, tuples, lists and arrays.

    ``rebuild(other)`` is the whole with that leaf replaced.
    """
    if value is None or isinstance(value, bool | int | float | str | Enum):
        yield path, value, lambda new: new
    elif isinstance(value, np.ndarray):
        for index in np.ndindex(value.shape):

            def with_element(new, i=index):
                changed = value.copy()
                changed[i] = new
                return changed

            yield f"{path}{list(index)}", float(value[index]), with_element
    elif type(value) in (tuple, list):
        for index, part in enumerate(value):
            for name, leaf, rebuild in leaves_of(part, f"{path}.{index}"):

                def with_item(new, i=index, r=rebuild):
                    return type(value)([*value[:i], r(new), *value[i + 1 :]])

                yield name, leaf, with_item
    else:
        parts = {name: getattr(value, name) for name in field_names(type(value))}
        assert parts, f"{path} is a {type(value)}"
        for field, part in parts.items():
            for name, leaf, rebuild in leaves_of(part, f"{path}.{field}"):
                yield name, leaf, lambda new, f=field, r=rebuild: type(value)(**{**parts, f: r(new)})


def nearest_other(leaf):
    """The value that differs least: the last bit of a float, the next integer, the other truth."""
    if isinstance(leaf, bool):
        return not leaf
    if isinstance(leaf, str):
        return leaf + "a"
    if isinstance(leaf, Enum):
        return next(member for member in type(leaf) if member is not leaf)
    if leaf is None:
        return 0
    return nextafter(leaf, 1e300) if isinstance(leaf, float) else leaf + 1


@pytest.fixture(scope="session")
def blind_places():
    """The paths of those leaves whose change does not change what is packed, or written by another function.

    Where that one takes a part or None, it takes no other number for None.
    """

    def find(value, write=pack):
        before = write(value)
        return [
            path
            for path, leaf, rebuild in leaves_of(value)
            if (leaf is not None or write is pack) and write(rebuild(nearest_other(leaf))) == before
        ]

    return find


@pytest.fixture(scope="session")
def leaves():
    """Every number in a nested value, with a way to replace it."""
    return leaves_of


@pytest.fixture(scope="session")
def snapshot():
    """Every number in a nested value by its path: compares what == cannot, arrays and nan included."""
    return lambda value: {path: repr(leaf) for path, leaf, _ in leaves_of(value)}


@pytest.fixture
def hub():
    """A hub that serves in a thread."""
    served = Hub()
    served.start()
    yield served
    served.close()


@pytest.fixture
def open_link(hub):
    """Opens one more end of the hub's bus at each call."""
    links = []

    def open_one():
        links.append(LoopLink(hub.port, may_host=False))
        return links[-1]

    yield open_one
    for link in links:
        link.close()


@pytest.fixture
def free_port():
    """A TCP port on which nobody listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
