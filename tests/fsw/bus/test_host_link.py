"""The end of the loop bus that serves it: one bus for all, while its process sends or receives."""

import socket
import threading
import time

import pytest

from fsw.bus import can_frame
from fsw.bus.host_link import HostLink
from fsw.bus.hub_listener import listen
from fsw.bus.interface import BusClosed
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import host_bus, join_bus, open_bus
from fsw.wire.frame import Frame

PATIENCE_S = 10.0


@pytest.fixture
def bus():
    """The host, in use, and a node that is on its bus from the start."""
    listener = listen(0)
    ours, theirs = socket.socketpair()
    host = HostLink(listener, [ours])
    node = LoopLink(int(host.spec.removeprefix("loop:")), end=theirs)
    assert host.receive(0.0) is None
    yield host, node
    host.close()
    node.close()


@pytest.fixture
def guest(bus):
    """Opens the bus by its port, as any tool does, which the host must serve meanwhile."""
    host, opened = bus[0], []

    def open_one():
        opener = threading.Thread(target=lambda: opened.append(open_bus(host.spec)))
        opener.start()
        while opener.is_alive():
            assert host.receive(0.001) is None
        return opened[-1]

    yield open_one
    host.close()
    for link in opened:
        link.close()


class TestDelivery:
    def test_what_one_sends_all_others_receive_in_order(self, bus, guest, numbered, take):
        host, node = bus
        tool = guest()
        host.send(numbered(5, 1))
        assert take(node, 5) == take(tool, 5) == numbered(5, 1)
        node.send(numbered(5, 2))
        assert take(host, 5) == numbered(5, 2)
        assert take(tool, 5) == numbered(5, 2)
        tool.send(numbered(5, 3))
        assert take(host, 5) == numbered(5, 3)
        assert take(node, 5) == numbered(5, 3)
        assert [link.receive(0.02) for link in (host, node, tool)] == [None, None, None]

    def test_all_nodes_receive_what_the_host_has_received_before_what_it_sends(self, bus, numbered, take):
        host, node = bus
        ours, theirs = socket.socketpair()
        host._hub.admit(ours, "another")
        with theirs:
            theirs.sendall(can_frame.pack_all(numbered(2, 7)))
            assert host.receive(PATIENCE_S) == numbered(1, 7)[0]
            host.send(numbered(1, 8))
            assert take(node, 3) == [*numbered(2, 7), *numbered(1, 8)]
            assert host.receive(0.0) == numbered(2, 7)[1]

    def test_what_was_sent_before_the_first_use_is_for_the_others_alone(self, numbered):
        """A boot, say, from long before the plant asks for it."""
        (ours, theirs), (other, end) = socket.socketpair(), socket.socketpair()
        with theirs, end:
            theirs.sendall(can_frame.pack_all(numbered(2)))
            host = HostLink(listen(0), [ours, other])
            theirs.sendall(can_frame.pack_all(numbered(1)))
            host.send([])
            assert host.receive(0.02) is None
            assert end.recv(1000) == can_frame.pack_all([*numbered(2), *numbered(1)])
            theirs.sendall(can_frame.pack_all(numbered(1)))
            assert host.receive(PATIENCE_S) == numbered(1)[0]
            host.close()

    def test_half_a_record_does_not_end_the_wait_early(self, bus):
        host, _ = bus
        ours, theirs = socket.socketpair()
        host._hub.admit(ours, "slow")
        whole = can_frame.pack(Frame(0x123, b"whole"))
        theirs.sendall(whole[:7])
        later = threading.Timer(0.1, theirs.sendall, [whole[7:]])
        later.start()
        assert host.receive(PATIENCE_S) == Frame(0x123, b"whole")
        later.join()
        theirs.close()

    def test_a_frame_too_long_is_refused_and_nothing_sent(self, bus):
        host, node = bus
        with pytest.raises(ValueError, match="at most 8"):
            host.send([Frame(1, b"ok"), Frame(2, bytes(9))])
        assert node.receive(0.02) is None


class TestWaiting:
    @pytest.mark.parametrize("timeout_s", [0, 0.0, -0.001, -5])
    def test_zero_or_a_deadline_passed_does_not_wait(self, bus, timeout_s):
        began = time.monotonic()
        assert bus[0].receive(timeout_s) is None
        assert time.monotonic() - began < 0.05

    @pytest.mark.parametrize("timeout_s", [0, -5])
    def test_but_takes_what_is_there(self, bus, numbered, timeout_s):
        host, node = bus
        node.send(numbered(2))
        assert [host.receive(timeout_s) for _ in range(3)] == [*numbered(2), None]

    def test_a_timeout_is_kept(self, bus):
        began = time.monotonic()
        assert bus[0].receive(0.1) is None
        assert 0.1 <= time.monotonic() - began < 0.5

    def test_none_waits_until_a_frame_comes(self, bus, numbered):
        host, node = bus
        later = threading.Timer(0.1, node.send, [numbered(1)])
        later.start()
        assert host.receive(None) == numbered(1)[0]
        later.join()


class TestEnd:
    def test_what_was_sent_still_reaches_the_others(self, bus, guest, numbered, take_until_closed):
        host, node = bus
        tool = guest()
        host.send(numbered(3))
        host.close()
        assert take_until_closed(node) == take_until_closed(tool) == numbered(3)

    def test_the_bus_is_over_with_its_host(self, bus):
        host, node = bus
        host.close()
        host.close()
        with pytest.raises(BusClosed):
            node.receive(PATIENCE_S)
        for use in (lambda: host.receive(0.0), lambda: host.send([])):
            with pytest.raises(BusClosed, match="this end has been closed"):
                use()

    def test_a_node_that_leaves_does_not_end_it(self, bus, guest, numbered, take):
        host, node = bus
        tool = guest()
        leaver = threading.Thread(target=node.close)
        leaver.start()
        while leaver.is_alive():
            assert host.receive(0.001) is None
        host.send(numbered(3))
        assert take(tool, 3) == numbered(3)


def test_processes_inherit_it_by_descriptors(numbered, take):
    listener, (ours, theirs) = listen(0), socket.socketpair()
    host = host_bus(listener.detach(), ours.detach())
    node = join_bus("loop:1", theirs.detach())
    assert (node.name, node.spec) == (host.name, "loop:1")
    assert host.receive(0.0) is None
    node.send(numbered(3))
    assert take(host, 3) == numbered(3)
    host.close()
    node.close()
