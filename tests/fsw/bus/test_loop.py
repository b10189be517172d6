"""The loop bus through python-can."""

import asyncio
import time

import can
import pytest

from fsw.bus.open_bus import open_bus
from fsw.bus.python_can import frame_of
from fsw.wire.frame import Frame

PATIENCE_S = 10.0


@pytest.fixture
def buses(hub):
    pair = [can.Bus(interface="loop", channel=channel) for channel in (hub.port, str(hub.port))]
    yield pair
    for bus in pair:
        bus.shutdown()


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

    def test_a_notifier_hands_out_every_record_of_a_bulk_read(self, buses, numbered):
        reader = can.BufferedReader()
        notifier = can.Notifier(buses[1], [reader], timeout=0.1)
        buses[0].send_frames(numbered(5000))
        got = [frame_of(reader.get_message(PATIENCE_S)) for _ in range(5000)]
        notifier.stop()
        assert got == numbered(5000)

    def test_so_does_a_notifier_in_asyncio(self, buses, numbered):
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

    def test_both_ways_of_opening_meet_on_one_bus(self, hub, buses, numbered):
        ours = open_bus(f"loop:{hub.port}")
        ours.send(numbered(2))
        assert [frame_of(buses[0].recv(PATIENCE_S)) for _ in range(2)] == numbered(2)
        ours.close()
