"""The scheduler against the interlock, over whole flights: the one refuses nothing that the other asks.

Two implementations of the same limits, one in integer ticks and one in exact time, that share no code. They
must agree tick by tick on which coil is free, and what was asked must be what is driven. Half an orbit as a
rule; ``make differential`` gives a hundred.
"""

import os
from typing import NamedTuple

import pytest

from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.messages import CoilFire, CoilRefused, CoilStatus
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load, orbit_period_s

ORBITS = float(os.environ.get("TORQUER_DIFFERENTIAL_ORBITS", "0.5"))

FLIGHTS = {
    "microsat": ("microsat", {}, 1.0),
    "microsat, per coil, 10 Hz": (
        "microsat",
        {"time": {"tick_hz": 10}, "coils": {"backoff": "per_coil"}},
        0.05,
    ),
    "microsat, 3 Hz, odd limits": (
        "microsat",
        {"time": {"tick_hz": 3}, "coils": {"pulse_s": 2.9, "backoff_s": 20.3}},
        0.2,
    ),
    "cubesat3u, per coil": ("cubesat3u", {"coils": {"backoff": "per_coil"}}, 0.5),
    "posat1": ("posat1", {}, 0.5),
}
"""Scenario, overrides, and the part of the orbits that is flown."""


class Seen(NamedTuple):
    """What a flight showed."""

    asked: list
    driven: list
    refused: list
    disagreements: list


def fly(name, overrides, orbits):
    scenario = load(name, overrides)
    plant, node = Plant(plant_config(scenario, 11)), FlightNode(flight_config(flight_table(scenario)))
    seen, last = Seen([], [], [], []), 0
    for tick in range(round(orbits * orbit_period_s(scenario) * scenario.time.tick_hz)):
        sent = plant.begin_tick()
        ready = node.state.pulses.ready_tick
        answers = [answer for frame in sent for answer in node.receive(frame)]
        for frame in sent:
            if frame.can_id == CoilRefused.ID:
                seen.refused.append((tick, CoilRefused.decode(frame.data).reason))
            if frame.can_id == CoilStatus.ID:
                status = CoilStatus.decode(frame.data)
                if tick and (status.lockout_ms == 0) != (ready[status.coil] <= tick):
                    seen.disagreements.append(tick)
                if status.level and status.seq != last:
                    seen.driven.append((tick - 1, status.coil, status.level))
                    last = status.seq
        for frame in answers:
            plant.receive(frame)
            if frame.can_id == CoilFire.ID:
                fire = CoilFire.decode(frame.data)
                seen.asked.append((tick, fire.coil, fire.level))
        plant.end_tick()
    return seen


@pytest.mark.long
@pytest.mark.parametrize(("name", "overrides", "part"), FLIGHTS.values(), ids=FLIGHTS)
def test_nothing_is_refused_both_clocks_agree_and_what_is_asked_is_driven(
    name, overrides, part, record_testsuite_property
):
    seen = fly(name, overrides, part * ORBITS)
    record_testsuite_property(f"requests, {name} {overrides}", len(seen.asked))
    assert seen.refused == []
    assert seen.disagreements == []
    assert len(seen.asked) >= 2, "there was something to refuse"
    assert seen.driven == seen.asked[: len(seen.driven)]
    assert len(seen.asked) - len(seen.driven) <= 1, "but for one in the last tick"
