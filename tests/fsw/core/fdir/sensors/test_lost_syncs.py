"""Sensors on a bus that loses a SYNC now and then: judged all the same."""

from itertools import count
from math import acos, degrees
from random import Random

import pytest

from fsw.core.fdir.evidence import BLIND_S
from fsw.core.fdir.faults import SensorFault
from fsw.core.gate.sync_watch import FEW_TICKS
from fsw.wire.messages import MagField, SunVector

pytestmark = pytest.mark.long

WITHOUT_LOSS_S = 30
"""Until a magnetometer that is off by 15 uT is named where no SYNC is lost."""


def offset(inbox):
    """The inbox with the magnetometer off by 15 uT."""

    def change(frame):
        if frame.can_id != MagField.ID:
            return frame
        said = MagField.decode(frame.data)
        return said.replace(b_x=said.b_x + 15000.0).encode()

    return inbox.replace(frames=tuple(map(change, inbox.frames)))


def regularly():
    """One SYNC in 55."""
    ticks = count(1)
    return lambda: next(ticks) % 55 == 0


def at_random(part):
    random = Random(7)
    return lambda: random.random() < part


class Flight:
    """A flight of which SYNCs are lost: whether the attitude is valid in each tick, and how wrong it is."""

    def __init__(self, world, lost):
        self.world, self.lost = world, lost
        self.valid, self.errors_deg = [], []

    def fly(self, ticks, change):
        for _ in range(ticks):
            q = self.world.plant.truth().q_body_from_orbit
            if self.lost():
                self.world.inbox()
                self.world.plant.end_tick()
                continue
            self.world.step(change)
            known = self.world.state.attitude
            cosine = abs(sum(a * b for a, b in zip(q, known.q_body_from_orbit, strict=True)))
            self.valid.append(known.valid)
            self.errors_deg.append(2.0 * degrees(acos(min(1.0, cosine))))


@pytest.mark.parametrize(
    "loss",
    [regularly, lambda: at_random(0.01), lambda: at_random(0.05)],
    ids=["one in 55", "1 %", "5 %"],
)
def test_a_wrong_magnetometer_is_named_nearly_as_soon(make_world, loss):
    world = make_world()
    world.fly(300)
    flight = Flight(world, loss())
    flight.fly(60, lambda inbox: inbox)
    assert all(flight.valid)
    flight.fly(2 * WITHOUT_LOSS_S, offset)
    assert world.state.health.sensors.field.fault == SensorFault.REFUSED
    flight.fly(200, offset)
    assert max(error for error, valid in zip(flight.errors_deg, flight.valid, strict=True) if valid) < 3.0


def test_without_both_sensors_the_attitude_is_not_valid_after_two_minutes(make_world, without):
    world = make_world()
    world.fly(300)
    flight = Flight(world, regularly())
    flight.fly(int(BLIND_S) + 10, without(MagField, SunVector))
    assert flight.valid[100]
    assert not flight.valid[-1]


@pytest.mark.parametrize("change", [lambda inbox: inbox, offset], ids=["sound", "wrong"])
def test_where_many_are_lost_in_a_row_no_sensor_is_named_and_nothing_stays_valid(make_world, change):
    """After each long skip field and Sun may be those of another time."""
    world = make_world()
    world.fly(300)
    ticks = count()
    flight = Flight(world, lambda: next(ticks) % 55 < FEW_TICKS + 1)
    flight.fly(400, change)
    assert world.state.health.sensors.field.fault == 0
    assert world.state.health.sensors.sun.fault == 0
    assert not any(flight.valid[-200:])
