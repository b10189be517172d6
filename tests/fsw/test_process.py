"""The flight software as a process: what it says and how it exits when its bus is gone."""

import pytest

from fsw import process
from fsw.bus.interface import BusClosed, BusError
from fsw.process import Disarmed
from fsw.table.table import load_flight_table
from fsw.wire.messages import NAMES, CoilDipole, CoilFire, TickDone


class Wire:
    name = "wire"

    def __init__(self):
        self.sent, self.closed = [], False

    def send(self, frames):
        self.sent += frames

    def receive(self, timeout_s):
        return timeout_s

    def close(self):
        self.closed = True


def test_requests_stay_off_the_bus_and_nothing_else_does():
    wire = Wire()
    bus = Disarmed(wire)
    done = TickDone(1, 2).encode()
    bus.send([CoilFire(3, 0, 1, 0, 3000).encode(), done, CoilDipole(0.5, 0.5, 0.5).encode()])
    assert wire.sent == [done]
    bus.send([done.replace(can_id=can_id) for can_id in NAMES])
    assert {NAMES[can_id] for can_id in NAMES} - {NAMES[frame.can_id] for frame in wire.sent} == {
        "COIL_FIRE",
        "COIL_DIPOLE",
        "WHEEL_TORQUE",
    }


def test_it_is_the_bus_otherwise():
    wire = Wire()
    bus = Disarmed(wire)
    assert (bus.name, bus.receive(0.25)) == ("wire", 0.25)
    bus.close()
    assert wire.closed


# --- The flight software as a process: what it says and how it exits when its bus is gone


class FailingBus:
    """A bus on which everything fails."""

    def __init__(self, error):
        self.error = error
        self.is_open = True

    def send(self, frames):
        raise self.error

    def receive(self, timeout_s):
        raise self.error

    def close(self):
        self.is_open = False


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (BusClosed("its hub is gone"), 0, ""),
        (BusError("the bus accepts no more data"), 1, "fsw: the bus accepts no more data\n"),
    ],
    ids=["gone", "failed"],
)
def test_a_bus_that_is_gone_ends_a_run_in_silence_and_one_that_fails_does_not(
    error, code, words, monkeypatch, capsys
):
    bus = FailingBus(error)
    monkeypatch.setattr(process, "open_bus", lambda spec: bus)
    assert process.fly(load_flight_table(None), "loop:1", quiet=True) == code
    assert capsys.readouterr().err == words
    assert not bus.is_open
