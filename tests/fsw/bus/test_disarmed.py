"""A bench that is not armed: no request gets on the bus, and all else does."""

from fsw.bus.disarmed import Disarmed
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
