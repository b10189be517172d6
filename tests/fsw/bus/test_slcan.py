"""python-can's buses through ours, a serial adapter among them."""

import os
import threading

import can
import pytest

from fsw.bus.interface import BusClosed
from fsw.bus.slcan import PythonCan, open_slcan
from fsw.wire.frame import Frame

PATIENCE_S = 10.0


class TestAdapter:
    """PythonCan, on python-can's in-process bus."""

    @pytest.fixture
    def pair(self):
        opened = [PythonCan(can.Bus(interface="virtual", channel="adapter"), "ttyX", "slcan:X") for _ in "ab"]
        yield opened
        for bus in opened:
            bus.close()

    def test_frames_pass_in_order(self, pair, numbered):
        sent = [*numbered(100), Frame(0x9FFF_FFFF, b"far"), Frame(0x4000_0010, bytes(4))]
        pair[0].send(sent)
        assert [pair[1].receive(PATIENCE_S) for _ in sent] == sent
        assert pair[1].receive(0.05) is None
        assert pair[0].receive(0) is None
        assert pair[0].receive(-1.0) is None

    def test_a_closed_end_says_so(self, pair, numbered):
        pair[0].close()
        with pytest.raises(BusClosed, match="has been closed"):
            pair[0].receive(0)
        with pytest.raises(BusClosed, match="has been closed"):
            pair[0].send(numbered(1))


def test_slcan_speaks_to_a_serial_adapter():
    pytest.importorskip("serial", reason="pyserial, which serial adapters need, is not installed")
    adapter, port = os.openpty()
    data = bytearray()

    def listen():
        while b"t12321122\r" not in data:
            data.extend(os.read(adapter, 64))

    listener = threading.Thread(target=listen)
    listener.start()
    bus = open_slcan(os.ttyname(port))
    assert bus.name == os.path.basename(os.ttyname(port))
    bus.send([Frame(0x123, b"\x11\x22")])
    listener.join()
    assert b"S6\r" in data  # 500 kbit/s
    os.write(adapter, b"t4563AABBCC\r")
    assert bus.receive(PATIENCE_S) == Frame(0x456, b"\xaa\xbb\xcc")
    bus.close()
    os.close(adapter)
    os.close(port)
