"""A bus in use is refused, whether its nodes send by themselves or only answer."""

import time

import pytest

from fsw.bus.interface import BusError
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilStatus,
    FswBoot,
    MagField,
    PlantBoot,
    Sync,
    TcClear,
    TickDone,
    WheelBoot,
)
from sim.flight import bus_in_use
from sim.flight.bus_in_use import FLIGHT_NODES, refuse_bus_in_use

BOOT = FswBoot(0, 1, 2).encode()
FIELD = MagField(1, 20000.0, 0.0, -30000.0).encode()


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(bus_in_use, "LISTEN_S", 0.02)
    monkeypatch.setattr(bus_in_use, "ASK_S", 0.02)


@pytest.mark.parametrize(
    ("frame", "named"),
    [
        (Sync(700, 1_427_424_417).encode(), r"SYNC \(180\) of tick 700"),
        (TickDone(700, 7).encode(), r"TICK_DONE \(280\) of tick 700"),
        (PlantBoot(0, 1, 0).encode(), r"PLANT_BOOT \(500\)"),
        (FIELD, r"MAG_FIELD \(110\)"),
    ],
)
def test_a_sender_is_identified_without_sending_to_it(frame, named, bus_of):
    bus = bus_of([Frame(0x7FF, b""), frame])
    with pytest.raises(BusError, match=rf"^vcan0 is in use: {named} was received before the flight began$"):
        refuse_bus_in_use(bus, "vcan0")
    assert bus.sent == []


@pytest.mark.parametrize("boot", [BOOT, CoilBoot(0, 1, 0).encode(), WheelBoot(0, 1, 0).encode()])
def test_who_waits_in_silence_is_asked(boot, bus_of):
    bus = bus_of(when_asked=[boot])
    with pytest.raises(BusError, match="_BOOT"):
        refuse_bus_in_use(bus, "vcan0")
    assert [frame.can_id for frame in bus.sent] == [PlantBoot.ID]


def test_noise_and_the_ground_take_no_bus(bus_of):
    noise = [
        Frame(0x7FF, b"\1"),
        FIELD.replace(data=b"\0" * 8),
        Frame(CoilStatus.ID, b""),
        TcClear().encode(),
    ]
    refuse_bus_in_use(bus_of(noise, noise), "vcan0")


def test_boards_may_be_there_where_they_are_wanted(bus_of):
    boards = [FIELD, CoilBoot(0, 1, 0).encode()]
    refuse_bus_in_use(bus_of(boards, boards), "vcan0", FLIGHT_NODES)
    with pytest.raises(BusError, match="FSW_BOOT"):
        refuse_bus_in_use(bus_of(boards, [*boards, BOOT]), "vcan0", FLIGHT_NODES)


def test_a_bus_that_babbles_is_listened_to_no_longer(bus_of):
    bus = bus_of()
    bus.receive = lambda timeout_s: Frame(0x7FF, b"")
    began = time.monotonic()
    refuse_bus_in_use(bus, "vcan0")
    assert time.monotonic() - began < 1.0
