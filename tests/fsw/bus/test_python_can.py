"""python-can's buses through ours, a serial adapter among them."""

import os
import threading

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.bus.interface import BusClosed, BusError
from fsw.bus.open_bus import open_bus, resolve
from fsw.bus.python_can import PythonCan, frame_of, message_of, open_slcan
from fsw.wire.frame import Frame

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


# --- python-can's buses through ours, a serial adapter among them

PATIENCE_S = 10.0
FD = can.CanProtocol.CAN_FD


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

    def test_no_frame_of_can_fd_is_a_frame(self):
        sender, bus = (can.Bus(interface="virtual", channel="fd", protocol=FD) for _ in "ab")
        receiver = PythonCan(bus, "fd", "can:virtual:fd")
        with sender:
            sender.send(can.Message(arbitration_id=1, is_fd=True, data=bytes(64)))
            sender.send(can.Message(arbitration_id=2, is_extended_id=False, data=b"two"))
            assert receiver.receive(PATIENCE_S) == Frame(2, b"two")
            sender.send(can.Message(arbitration_id=1, is_fd=True, data=bytes(64)))
            assert receiver.receive(0.05) is None
        receiver.close()


class TestConfiguration:
    """What a spec leaves out is as python-can's files and environment say."""

    @pytest.fixture(autouse=True)
    def home(self, tmp_path, monkeypatch):
        for name in ("CAN_INTERFACE", "CAN_CHANNEL", "CAN_BITRATE", "CAN_CONFIG"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setenv("HOME", str(tmp_path))
        return tmp_path

    def test_a_spec_says_all(self):
        assert resolve("can:pcan:PCAN_USBBUS1") == "can:pcan:PCAN_USBBUS1"
        assert resolve("can:udp_multicast:ff15::6") == "can:udp_multicast:ff15::6"
        assert resolve("can:udp_multicast") == "can:udp_multicast"

    def test_the_environment_says_the_rest(self, monkeypatch):
        monkeypatch.setenv("CAN_INTERFACE", "udp_multicast")
        monkeypatch.setenv("CAN_CHANNEL", "239.74.163.3")
        assert resolve("can") == "can:udp_multicast:239.74.163.3"
        assert resolve("can::239.74.163.4") == "can:udp_multicast:239.74.163.4"
        assert resolve("can:loop") == "can:loop:239.74.163.3"

    def test_a_file_says_the_rest(self, home):
        (home / ".canrc").write_text("[default]\ninterface = slcan\nchannel = /dev/ttyACM7\n")
        assert resolve("can") == "can:slcan:/dev/ttyACM7"

    def test_no_option_gives_a_node_its_own_frames(self, home, monkeypatch):
        (home / ".canrc").write_text("[default]\nreceive_own_messages = True\n")
        drivers = can.Bus
        monkeypatch.setattr(can, "Bus", lambda **given: drivers(**given | {"interface": "virtual"}))
        bus = open_bus("can:pcan:PCAN_USBBUS1")
        bus.send([Frame(0x123, b"abc")])
        assert bus.receive(0.0) is None
        bus.close()

    @pytest.mark.parametrize(
        ("channel", "name"),
        [
            ("/dev/ttyACM0", "ttyACM0"),
            ("ff15::6", "ff15::6"),
            ("Kanal é 1", "Kanal___1"),
            ("", "pcan"),
            (99 * "x", 64 * "x"),
        ],
    )
    def test_the_name_of_a_bus_is_one_word_of_ascii(self, monkeypatch, channel, name):
        driver = can.Bus(interface="virtual")
        monkeypatch.setattr(can, "Bus", lambda **given: driver)
        bus = open_bus(f"can:pcan:{channel}")
        bus.close()
        assert bus.name == name

    def test_frames_pass_and_the_channel_names_the_bus(self, hub):
        opened = [open_bus(f"can:loop:{hub.port}") for _ in "ab"]
        opened[0].send([Frame(0x123, b"abc")])
        assert opened[1].receive(PATIENCE_S) == Frame(0x123, b"abc")
        assert opened[0].receive(0.05) is None
        assert [bus.name for bus in opened] == [str(hub.port)] * 2
        for bus in opened:
            bus.close()

    @pytest.mark.parametrize(
        ("spec", "says"),
        [
            ("can", "bus 'can': Unknown interface type"),
            ("can:", "bus 'can': Unknown interface type"),
            ("can:nonsense:x", "bus 'can:nonsense:x': Unknown interface type \"nonsense\""),
            ("can:virtual:x", "joins nodes of one process"),
            ("can:udp_multicast:127.0.0.1", "bus 'can:udp_multicast:127.0.0.1' cannot be opened"),
            ("can:serial:/dev/nowhere", "bus 'can:serial:/dev/nowhere' cannot be opened"),
            ("can:canalystii:0", "No module named 'canalystii'"),
            ("can:kvaser:0", "bus 'can:kvaser:0' cannot be opened"),
            ("can:loop:99999", "names no TCP port"),
        ],
    )
    def test_a_bus_that_does_not_open_is_one_sentence(self, spec, says):
        with pytest.raises(BusError) as refused:
            open_bus(spec)
        assert says in str(refused.value)
        assert "\n" not in str(refused.value)

    def test_a_file_that_cannot_be_read_is_one_sentence(self, home, monkeypatch):
        monkeypatch.setenv("CAN_CONFIG", "{no json")
        with pytest.raises(BusError, match="bus 'can:loop:1': "):
            resolve("can:loop:1")


class TestEchoes:
    """An interface that gives a node its own frames too."""

    @pytest.fixture
    def echoing(self):
        """A bus that echoes, and what stands behind it: python-can's bus and another node's."""
        own, other = (
            can.Bus(interface="virtual", channel="echo", receive_own_messages=own) for own in (1, 0)
        )
        yield PythonCan(own, "echo", "can:virtual:echo", echoes=True), own, other
        own.shutdown()
        other.shutdown()

    def test_its_own_frames_do_not_come_back(self, echoing, numbered):
        bus, _, other = echoing
        bus.send(numbered(5))
        other.send(can.Message(arbitration_id=9, is_extended_id=False, data=b"other"))
        bus.send(numbered(3))
        assert bus.receive(PATIENCE_S) == Frame(9, b"other")
        assert bus.receive(0.0) is None

    def test_one_that_another_sends_as_well_is_received(self, echoing):
        bus, _, other = echoing
        bus.send([Frame(5, b"same")])
        other.send(can.Message(arbitration_id=5, is_extended_id=False, data=b"same"))
        assert bus.receive(PATIENCE_S) == Frame(5, b"same")
        assert bus.receive(0.0) is None

    def test_echoes_that_are_lost_are_forgotten_with_the_next(self, echoing, numbered):
        bus, own, other = echoing
        lost, come = numbered(2)
        bus.send([lost])
        assert own.recv(PATIENCE_S) is not None
        bus.send([come])
        assert bus.receive(0.0) is None
        other.send(can.Message(arbitration_id=lost.can_id, is_extended_id=False, data=lost.data))
        assert bus.receive(PATIENCE_S) == lost


@pytest.mark.long
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
