"""The loop bus through python-can, and python-can's buses through ours."""

import asyncio
import os
import threading
import time

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.bus.can_message import frame_of, message_of
from fsw.bus.interface import BusClosed
from fsw.bus.open_bus import open_bus
from fsw.bus.slcan import PythonCan, open_slcan
from fsw.wire.frame import Frame

PATIENCE_S = 10.0

standard_ids = st.integers(0, 0x7FF)
data = st.binary(max_size=8)
frames = st.one_of(
    st.builds(Frame, standard_ids, data),
    st.builds(Frame, standard_ids.map(0x4000_0000.__or__), st.integers(0, 8).map(bytes)),
    st.builds(Frame, st.integers(0x8000_0000, 0x9FFF_FFFF), data),
    st.builds(Frame, st.integers(0xC000_0000, 0xDFFF_FFFF), st.integers(0, 8).map(bytes)),
    st.builds(Frame, st.integers(0x2000_0000, 0x2000_07FF), st.just(bytes(8))),
)


@given(frames)
def test_a_frame_survives_the_way_through_a_message(frame):
    assert frame_of(message_of(frame)) == frame


def test_a_message_bears_what_python_can_users_expect():
    message = message_of(Frame(0x9234_5678, b"\x01\x02"), 12.5, "loop")
    assert (message.arbitration_id, message.is_extended_id, message.timestamp) == (0x1234_5678, True, 12.5)
    assert (message.channel, message.dlc, bytes(message.data), message.is_rx) == (
        "loop",
        2,
        b"\x01\x02",
        True,
    )
    remote = message_of(Frame(0x4000_0123, bytes(5)))
    assert (remote.is_remote_frame, remote.dlc, bytes(remote.data)) == (True, 5, b"")


@pytest.fixture
def buses(hub):
    pair = [can.Bus(interface="loop", channel=channel) for channel in (hub.port, str(hub.port))]
    yield pair
    for bus in pair:
        bus.shutdown()


def numbered(count):
    return [Frame(0x123, number.to_bytes(4, "big")) for number in range(count)]


class TestBackend:
    def test_messages_pass(self, buses):
        sent = can.Message(arbitration_id=0x123, is_extended_id=False, data=b"abc")
        buses[0].send(sent)
        received = buses[1].recv(PATIENCE_S)
        assert received.equals(sent, timestamp_delta=None, check_channel=False)
        assert abs(received.timestamp - time.time()) < 5.0
        assert buses[0].recv(0.05) is None

    def test_filters_hold(self, buses):
        buses[1].set_filters([{"can_id": 0x200, "can_mask": 0x7FF}])
        buses[0].send_frames([Frame(0x100, b""), Frame(0x200, b"x"), Frame(0x300, b"")])
        assert frame_of(buses[1].recv(PATIENCE_S)) == Frame(0x200, b"x")
        assert buses[1].recv(0.05) is None

    def test_a_notifier_hands_out_every_record_of_a_bulk_read(self, buses):
        reader = can.BufferedReader()
        notifier = can.Notifier(buses[1], [reader], timeout=0.1)
        buses[0].send_frames(numbered(5000))
        got = [frame_of(reader.get_message(PATIENCE_S)) for _ in range(5000)]
        notifier.stop()
        assert got == numbered(5000)

    def test_so_does_a_notifier_in_asyncio(self, buses):
        async def listen():
            reader = can.AsyncBufferedReader()
            notifier = can.Notifier(buses[1], [reader], timeout=0.1, loop=asyncio.get_running_loop())
            buses[0].send_frames(numbered(1000))
            got = [frame_of(await asyncio.wait_for(reader.get_message(), PATIENCE_S)) for _ in range(1000)]
            await asyncio.to_thread(notifier.stop)
            return got

        assert asyncio.run(listen()) == numbered(1000)

    def test_can_fd_is_refused(self, buses):
        with pytest.raises(can.CanOperationError, match="classic CAN only"):
            buses[0].send(can.Message(arbitration_id=1, is_fd=True, data=bytes(12)))

    def test_the_end_of_the_hub_is_an_error_of_python_can(self, hub, buses):
        hub.close()
        with pytest.raises(can.CanOperationError, match="its hub is gone"):
            buses[1].recv(PATIENCE_S)

    def test_a_wrong_channel_is_an_error_of_python_can(self):
        with pytest.raises(can.CanInitializationError, match="names no TCP port"):
            can.Bus(interface="loop", channel="nowhere")

    def test_both_ways_of_opening_meet_on_one_bus(self, hub, buses):
        ours = open_bus(f"loop:{hub.port}")
        ours.send(numbered(2))
        assert [frame_of(buses[0].recv(PATIENCE_S)) for _ in range(2)] == numbered(2)
        ours.close()


class TestAdapter:
    """PythonCan, on python-can's in-process bus."""

    @pytest.fixture
    def pair(self):
        opened = [PythonCan(can.Bus(interface="virtual", channel="adapter"), "ttyX", "slcan:X") for _ in "ab"]
        yield opened
        for bus in opened:
            bus.close()

    def test_frames_pass_in_order(self, pair):
        sent = [*numbered(100), Frame(0x9FFF_FFFF, b"far"), Frame(0x4000_0010, bytes(4))]
        pair[0].send(sent)
        assert [pair[1].receive(PATIENCE_S) for _ in sent] == sent
        assert pair[1].receive(0.05) is None
        assert pair[0].receive(0) is None
        assert pair[0].receive(-1.0) is None

    def test_a_closed_end_says_so(self, pair):
        pair[0].close()
        with pytest.raises(BusClosed, match="has been closed"):
            pair[0].receive(0)
        with pytest.raises(BusClosed, match="has been closed"):
            pair[0].send(numbered(1))


def test_slcan_speaks_to_a_serial_adapter():
    pytest.importorskip("serial", reason="pyserial, which serial adapters need, is not installed")
    adapter, port = os.openpty()
    heard = bytearray()

    def listen():
        while b"t12321122\r" not in heard:
            heard.extend(os.read(adapter, 64))

    listener = threading.Thread(target=listen)
    listener.start()
    bus = open_slcan(os.ttyname(port))
    assert bus.name == os.path.basename(os.ttyname(port))
    bus.send([Frame(0x123, b"\x11\x22")])
    listener.join()
    assert b"S6\r" in heard  # 500 kbit/s
    os.write(adapter, b"t4563AABBCC\r")
    assert bus.receive(PATIENCE_S) == Frame(0x456, b"\xaa\xbb\xcc")
    bus.close()
    os.close(adapter)
    os.close(port)
