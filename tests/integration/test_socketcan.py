"""SocketCAN on a real kernel interface."""

import subprocess
import time
from contextlib import closing

import can
import pytest

from fsw.bus.interface import BusClosed, BusError
from fsw.bus.open_bus import open_bus, resolve
from fsw.wire.frame import Frame

PATIENCE_S = 10.0


def numbered(count, can_id=0x123):
    return [Frame(can_id, number.to_bytes(4, "big")) for number in range(count)]


def take(bus, count):
    frames = []
    while len(frames) < count and (frame := bus.receive(PATIENCE_S)) is not None:
        frames.append(frame)
    return frames


def ip_link(*words):
    subprocess.run(["ip", "link", *words], check=True)


@pytest.fixture
def pair(own_interface):
    """Two ends on an interface of their own."""
    ends = [open_bus(f"socketcan:{own_interface}") for _ in range(2)]
    yield ends
    for end in ends:
        end.close()


def test_auto_takes_vcan0(vcan0):
    assert resolve("auto") == "socketcan:vcan0"
    with closing(open_bus("auto")) as bus:
        assert (bus.name, bus.spec) == ("vcan0", "socketcan:vcan0")


def test_a_burst_waits_for_a_reader_that_wakes_late(pair):
    sender, reader = pair
    sender.send(numbered(5000))  # the default buffer of the kernel would have kept 278
    assert take(reader, 5000) == numbered(5000)
    assert reader.receive(0) is None


def test_own_frames_do_not_come_back(pair):
    sender, reader = pair
    sender.send(numbered(3))
    assert take(reader, 3) == numbered(3)
    assert sender.receive(0.1) is None


def test_frames_that_are_not_ours_bear_their_flags(pair):
    sender, reader = pair
    foreign = [Frame(0x9FFF_FFFF, b"far"), Frame(0x4000_0123, bytes(5)), Frame(0x2000_0004, bytes(8))]
    sender.send(foreign)
    assert take(reader, 3) == foreign


def test_timeouts_are_kept(pair):
    began = time.monotonic()
    assert pair[0].receive(0) is None
    assert pair[0].receive(-1.0) is None
    assert time.monotonic() - began < 0.1
    assert pair[0].receive(0.2) is None
    assert 0.2 <= time.monotonic() - began < 1.0


def test_a_slow_link_delays_but_loses_nothing(own_interface, pair):
    """A transmit queue of 10 frames, each on its way for 5 ms: the kernel answers ENOBUFS again and again."""
    slow = ["tc", "qdisc", "add", "dev", own_interface, "root", "netem", "delay", "5ms", "limit", "10"]
    subprocess.run(slow, check=True)
    sender, reader = pair
    began = time.monotonic()
    sender.send(numbered(200))
    assert time.monotonic() - began > 0.05, "the queue was never full"
    assert take(reader, 200) == numbered(200)


def test_a_jammed_link_is_given_up(own_interface, pair):
    jam = ["tc", "qdisc", "add", "dev", own_interface, "root", "netem", "delay", "60s", "limit", "10"]
    subprocess.run(jam, check=True)
    began = time.monotonic()
    with pytest.raises(BusError, match=f"the transmit queue of {own_interface} stayed full"):
        pair[0].send(numbered(20))
    assert time.monotonic() - began < 5.0


def test_down_is_told_and_up_again_works(own_interface, pair):
    sender, reader = pair
    ip_link("set", own_interface, "down")
    with pytest.raises(BusError, match=f"{own_interface} is down"):
        sender.send(numbered(1))
    with pytest.raises(BusError, match=f"{own_interface} is down"):
        reader.receive(PATIENCE_S)
    with pytest.raises(BusError, match=f"ip link set {own_interface} up"):
        open_bus(f"socketcan:{own_interface}")
    ip_link("set", own_interface, "up")
    sender.send(numbered(1))
    assert reader.receive(PATIENCE_S) == numbered(1)[0]


def test_an_interface_taken_away_closes_the_bus(own_interface, pair):
    sender, reader = pair
    ip_link("delete", own_interface)
    with pytest.raises(BusClosed, match="is gone"):
        sender.send(numbered(1))
    with pytest.raises(BusClosed, match="is gone"):
        reader.receive(PATIENCE_S)


def test_a_closed_end_says_so(pair):
    pair[0].close()
    with pytest.raises(BusClosed):
        pair[0].receive(PATIENCE_S)
    with pytest.raises(BusClosed):
        pair[0].send(numbered(1))


def test_python_can_hears_and_is_heard(vcan0):
    with (
        closing(open_bus(f"socketcan:{vcan0}")) as ours,
        can.Bus(interface="socketcan", channel=vcan0) as theirs,
    ):
        ours.send([Frame(0x321, b"\x01\x02")])
        received = theirs.recv(PATIENCE_S)
        assert (received.arbitration_id, received.is_extended_id, bytes(received.data)) == (
            0x321,
            False,
            b"\x01\x02",
        )
        theirs.send(can.Message(arbitration_id=0x1234567, data=b"abc"))
        assert ours.receive(PATIENCE_S) == Frame(0x8123_4567, b"abc")


def test_cansend_and_candump_hear_and_are_heard(vcan0):
    with closing(open_bus(f"socketcan:{vcan0}")) as ours:
        subprocess.run(["cansend", vcan0, "123#DEADBEEF"], check=True)
        assert ours.receive(PATIENCE_S) == Frame(0x123, b"\xde\xad\xbe\xef")
        candump = subprocess.Popen(["candump", "-L", "-n", "1", vcan0], stdout=subprocess.PIPE, text=True)
        while candump.poll() is None:
            ours.send([Frame(0x700, b"\x2a")])
            time.sleep(0.05)
        assert candump.stdout.read().split()[1:3] == ["vcan0", "700#2A"]
