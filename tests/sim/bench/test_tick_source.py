"""The plant with a coil board on the bus: it moves as with its own."""

import pytest

from fsw.wire.messages import (
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilStatus,
    MagField,
    SunCells,
    SunVector,
    Sync,
)
from hil_stub.coils.coil_driver import CoilDriver
from hil_stub.coils.dipole_driver import DipoleDriver
from sim.bench.tick_source import PlantTicks, SyncOnly
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load

PULSED = {"time": {"tick_hz": 2}, "coils": {"backoff_s": 5.0}}
CONTINUOUS = {"coils": {"driver": "continuous", "max_dipole_am2": 5.0, "on_fraction": 0.8}}


def requests(tick):
    """Pulses that end with a tick and within one; each as soon as the board may take it."""
    duration_ms = (3000, 2250, 300)[tick // 20 % 3]
    return [CoilFire((-2, 3, 1)[tick % 3], tick % 3, tick & 0xFF, tick & 0xFF, duration_ms).encode()]


def dipoles(tick):
    return [CoilDipole(0.5, -0.25, 0.125 * (tick % 5)).encode()] if tick % 4 else []


def test_cells_are_shown_all_of_their_currents():
    config = plant_config(load("cubesat-cells"), seed=7)
    own, lines = Plant(config), []
    source = PlantTicks(config, {"cells": lines.append})
    for tick in range(20):
        frames = {frame.can_id: frame for frame in own.begin_tick()}
        assert source.frames()[-1] == frames[Sync.ID]
        sample = SunCells.decode(frames[SunCells.ID].data)
        number, *currents, valid = lines[-1].split()
        assert (int(number), int(valid)) == (tick, sample.valid)
        assert tuple(map(float, currents)) == sample.values()[1:7]
        assert sum(current > 0.2 for current in sample.values()[1:7]) >= 2
        own.end_tick()
        source.advance()


@pytest.mark.parametrize(
    ("changes", "frames_of"), [(PULSED, requests), (CONTINUOUS, dipoles)], ids=["pulsed", "continuous"]
)
def test_what_a_board_reports_drives_the_plant_as_its_own_board_does(changes, frames_of):
    config = plant_config(load("microsat", changes), seed=7)
    own = Plant(config)
    lines = {"magnetometer": [], "sun": []}
    source = PlantTicks(config, {name: of.append for name, of in lines.items()})
    limits, continuous = config.limits, config.coils.continuous
    board = DipoleDriver(config.tick_hz, continuous.on_fraction) if continuous else CoilDriver(limits)
    board.begin_tick(0, 0.0)
    driven = 0
    for tick in range(120):
        frames = {frame.can_id: frame for frame in own.begin_tick()}
        assert source.frames()[-1] == frames[Sync.ID]
        for name, message in (("magnetometer", MagField), ("sun", SunVector)):
            valid, x, y, z, _ = message.decode(frames[message.ID].data).values()
            assert lines[name][-1] == f"{tick} {x!r} {y!r} {z!r} {valid}\n".encode()
        for request in frames_of(tick):
            own.receive(request)
            board.receive(request)
            assert not source.receive(request)
        own.end_tick()
        driven += any(own.coil_drive.current_a)
        board.drive()
        reported = [source.receive(frame) for frame in board.begin_tick(tick + 1, 0.0)]
        assert reported.count(True) == 1
        source.advance()
        assert source._plant.motion == own.motion, f"they differ in tick {tick}"
    assert driven > 20


def test_without_a_status_nothing_was_driven():
    config = plant_config(load("microsat", PULSED), seed=7)
    source, quiet = PlantTicks(config, {}), Plant(config)
    source.receive(CoilStatus(3, 0, 1500, 300, 9000, 1).encode())
    for _ in range(3):
        quiet.end_tick()
        source.advance()
    assert source._plant.motion != quiet.motion, "the first tick was driven"
    other = PlantTicks(config, {})
    for _ in range(3):
        other.advance()
    assert other._plant.motion == quiet.motion


@pytest.mark.parametrize("level", [-8, 7, 4])
def test_a_level_that_does_not_exist_drives_nothing(level):
    source = PlantTicks(plant_config(load("microsat", PULSED), seed=7), {})
    assert source.receive(CoilStatus(level, 3, 1500, 300, 9000, 1).encode())
    assert not any(source._drive.drive().current_a)


def test_the_status_of_the_other_kind_of_board_is_ignored():
    source = PlantTicks(plant_config(load("microsat", PULSED), seed=7), {})
    assert not source.receive(CoilDipoleStatus(0.5, 0.5, 0.5).encode())
    broken = CoilStatus(3, 0, 1500, 300, 9000, 1).encode()
    assert not source.receive(broken.replace(data=broken.data[:-1] + b"\0"))


def test_sync_alone_counts_ticks_and_seconds():
    source, sent = SyncOnly(1000, 2), []
    for _ in range(5):
        (frame,) = source.frames()
        sent.append(Sync.decode(frame.data).values())
        assert not source.receive(frame)
        source.advance()
    assert sent == [(0, 1000), (1, 1000), (2, 1001), (3, 1001), (4, 1002)]
