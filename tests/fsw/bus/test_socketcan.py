"""SocketCAN without a CAN interface: how a full or failing transmit queue is met. The rest needs vcan0."""

import errno
import time

import pytest

from fsw.bus import can_frame, socketcan
from fsw.bus.interface import BusClosed, BusError
from fsw.wire.frame import Frame

FRAMES = [Frame(0x123, bytes([number])) for number in range(4)]


class Queue:
    """The sending half of a CAN socket that answers the next calls with ``refusals``."""

    def __init__(self, refusals):
        self.refusals = list(refusals)
        self.sent = b""

    def send(self, packed):
        if self.refusals and (code := self.refusals.pop(0)):
            raise OSError(code, "refused")
        self.sent += packed
        return len(packed)


@pytest.fixture
def bus_on(monkeypatch):
    def build(queue):
        monkeypatch.setattr(socketcan, "_open", lambda name: queue)
        return socketcan.SocketCan("can7")

    return build


def test_a_full_queue_is_waited_for_and_the_order_kept(bus_on):
    queue = Queue([0, errno.ENOBUFS, errno.ENOBUFS, 0, errno.ENOBUFS])
    bus_on(queue).send(FRAMES)
    assert list(can_frame.unpack(queue.sent)) == FRAMES


def test_but_not_for_ever(bus_on, monkeypatch):
    monkeypatch.setattr(socketcan, "SEND_PATIENCE_S", 0.1)
    queue = Queue([0] + [errno.ENOBUFS] * 100_000)
    began = time.monotonic()
    with pytest.raises(BusError, match=r"transmit queue of can7 stayed full for 0\.1 s"):
        bus_on(queue).send(FRAMES)
    assert 0.1 <= time.monotonic() - began < 1.0
    assert list(can_frame.unpack(queue.sent)) == FRAMES[:1]
    assert 10 < 100_000 - len(queue.refusals) < 1000, "it neither gave up early nor span"


@pytest.mark.parametrize(
    ("code", "kind", "says"),
    [
        (errno.ENETDOWN, BusError, "can7 is down"),
        (errno.ENODEV, BusClosed, "can7 is gone"),
        (errno.EBADF, BusClosed, "can7 is gone"),
        (errno.EIO, BusError, "can7 failed"),
    ],
)
def test_other_failures_are_told_at_once(bus_on, code, kind, says):
    queue = Queue([code])
    with pytest.raises(BusError, match=says) as failure:
        bus_on(queue).send(FRAMES)
    assert type(failure.value) is kind
    assert queue.sent == b""


def test_an_interface_that_is_not_there_is_not_up():
    assert not socketcan.interface_is_up("nocan7")


@pytest.mark.skipif("sys.platform != 'linux'", reason="only Linux has the interface lo")
def test_lo_is_up_but_no_can_interface():
    assert socketcan.interface_is_up("lo")
    with pytest.raises(BusError, match=r"no CAN interface 'lo'|no SocketCAN"):
        socketcan.SocketCan("lo")
