"""One end of the loop bus: it loses nothing, keeps order, and ends loudly."""

import signal
import socket
import threading
import time
from collections import Counter
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fsw.bus import can_frame
from fsw.bus import link as link_module
from fsw.bus.hub import Hub
from fsw.bus.hub_listener import GREETING, listen
from fsw.bus.interface import BusClosed, BusError
from fsw.bus.link import HostLink, LoopLink
from fsw.bus.open_bus import host_bus, join_bus, open_bus
from fsw.wire.frame import Frame

PATIENCE_S = 10.0


class TestDelivery:
    @pytest.mark.long
    def test_a_frame_goes_to_all_but_its_sender(self, open_link, take):
        sender, first, second = open_link(), open_link(), open_link()
        frame = Frame(0x7FF, b"\x01\x02\x03\x04\x05\x06\x07\x08")
        sender.send([frame])
        assert take(first, 1) == take(second, 1) == [frame]
        assert [bus.receive(0.05) for bus in (sender, first, second)] == [None, None, None]

    def test_flags_of_frames_that_are_not_ours_pass(self, open_link, take):
        sender, reader = open_link(), open_link()
        foreign = [
            Frame(0x9FFF_FFFF, b"x"),
            Frame(0x4000_0123, bytes(3)),
            Frame(0x2000_0004, bytes(8)),
            Frame(0, b""),
        ]
        sender.send(foreign)
        assert take(reader, 4) == foreign

    def test_what_is_sent_right_after_opening_is_not_missed(self, open_link, numbered):
        sender = open_link()
        for frame in numbered(100):
            reader = open_link()
            sender.send([frame])
            assert reader.receive(PATIENCE_S) == frame
            reader.close()

    @pytest.mark.long
    @settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
    @given(
        bursts=st.lists(st.tuples(st.integers(0, 2), st.integers(0, 3000)), max_size=20),
        seed=st.integers(0, 2**32),
    )
    def test_bursts_arrive_whole_and_in_order(self, open_link, bursts, seed, take):
        random = Random(seed)
        reader, senders = open_link(), [open_link() for _ in range(3)]
        sent = [[], [], []]
        for sender, length in bursts:
            burst = [Frame(sender, random.randbytes(random.randrange(9))) for _ in range(length)]
            senders[sender].send(burst)
            sent[sender] += burst
        got = take(reader, sum(map(len, sent)))
        assert [[frame for frame in got if frame.can_id == sender] for sender in range(3)] == sent
        assert reader.receive(0) is None
        for link in (reader, *senders):
            link.close()

    @pytest.mark.long
    def test_a_reader_that_wakes_late_gets_all(self, open_link, numbered, take):
        sender, late, prompt = open_link(), open_link(), open_link()
        flood = numbered(10_000)
        count = 60
        counter = threading.Thread(target=lambda: take(prompt, count * len(flood)))
        counter.start()
        for _ in range(count):  # more than the buffers of the kernel hold
            sender.send(flood)
        counter.join()
        for _ in range(count):
            assert take(late, len(flood)) == flood
        assert late.receive(0.05) is None

    @pytest.mark.long
    def test_all_talk_at_once_and_all_hear_all(self, open_link, numbered, take):
        links = [open_link() for _ in range(6)]
        mine = [numbered(2000, can_id) for can_id in range(6)]
        received = [[] for _ in links]

        def talk(index):
            for start in range(0, 2000, 50):
                links[index].send(mine[index][start : start + 50])
            received[index] = take(links[index], 5 * 2000)

        threads = [threading.Thread(target=talk, args=(index,)) for index in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for index, frames in enumerate(received):
            for other in set(range(6)) - {index}:
                assert [frame for frame in frames if frame.can_id == other] == mine[other]

    def test_records_are_never_torn_apart_by_another_sender(self, hub, open_link, numbered, take):
        reader, other = open_link(), open_link()
        with socket.create_connection(("127.0.0.1", hub.port)) as slow:
            assert slow.recv(len(GREETING), socket.MSG_WAITALL) == GREETING
            halves = can_frame.pack(Frame(0x111, b"halves"))
            slow.sendall(halves[:7])
            other.send(numbered(3))
            assert take(reader, 3) == numbered(3)
            slow.sendall(halves[7:])
            assert take(reader, 1) == [Frame(0x111, b"halves")]

    def test_a_frame_too_long_is_refused_and_nothing_sent(self, open_link):
        sender, reader = open_link(), open_link()
        with pytest.raises(ValueError, match="at most 8"):
            sender.send([Frame(1, b"ok"), Frame(2, bytes(9))])
        assert reader.receive(0.05) is None


class TestWaiting:
    @pytest.mark.parametrize("timeout_s", [0, 0.0, -0.001, -5])
    def test_zero_or_a_deadline_passed_does_not_wait(self, open_link, timeout_s):
        link = open_link()
        began = time.monotonic()
        assert link.receive(timeout_s) is None
        assert time.monotonic() - began < 0.05

    def test_a_timeout_is_kept(self, open_link):
        link = open_link()
        began = time.monotonic()
        assert link.receive(0.1) is None
        assert 0.1 <= time.monotonic() - began < 0.5

    def test_none_waits_until_a_frame_comes(self, open_link, numbered):
        link, other = open_link(), open_link()
        later = threading.Timer(0.1, other.send, [numbered(1)])
        later.start()
        assert link.receive(None) == numbered(1)[0]
        later.join()

    def test_half_a_record_does_not_end_the_wait_early(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            halves = can_frame.pack(Frame(0x123, b"whole"))

            def serve():
                connection, _ = server.accept()
                connection.sendall(GREETING + halves[:5])
                time.sleep(0.1)
                connection.sendall(halves[5:])
                connection.recv(1)
                connection.close()

            thread = threading.Thread(target=serve)
            thread.start()
            link = LoopLink(server.getsockname()[1], may_host=False)
            assert link.receive(0.01) is None
            assert link.receive(PATIENCE_S) == Frame(0x123, b"whole")
            link.close()
            thread.join()


class TestEnding:
    def test_what_came_before_the_end_is_handed_out_first(self, hub, open_link, numbered, take):
        sender, reader = open_link(), open_link()
        sender.send(numbered(1000))
        hub.close()
        assert take(reader, 1000) == numbered(1000)
        for timeout_s in (0, 0.1, None):
            with pytest.raises(BusClosed, match="its hub is gone"):
                reader.receive(timeout_s)

    def test_sending_after_the_end_is_told(self, hub, open_link, numbered):
        link = open_link()
        hub.close()

        def send_for_long():
            for _ in range(1000):
                link.send(numbered(1))
                time.sleep(0.001)

        with pytest.raises(BusClosed):
            send_for_long()

    def test_a_closed_end_says_so(self, open_link, numbered):
        link = open_link()
        link.close()
        link.close()
        with pytest.raises(BusClosed, match="this end has been closed"):
            link.receive(None)
        with pytest.raises(BusClosed, match="this end has been closed"):
            link.send(numbered(1))

    def test_one_end_leaving_does_not_disturb_the_others(self, hub, open_link, numbered, take, wait_until):
        first, second, leaver = open_link(), open_link(), open_link()
        second.send(numbered(100))
        leaver.send(numbered(100, 0x7))
        leaver.close()  # with frames unread
        assert Counter(take(first, 200)) == Counter(numbered(100) + numbered(100, 0x7))
        wait_until(lambda: hub.clients == 2)
        first.send(numbered(5))
        assert take(second, 105)[-5:] == numbered(5)

    @pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGTERM])
    def test_a_killed_host_is_noticed_at_once(self, free_port, ending, numbered, take, run_node):
        host = run_node(free_port, "bus.receive(None); bus.send(numbered(10)); bus.receive(None)")
        link = LoopLink(free_port, may_host=False)
        link.send([Frame(0x1, b"go")])
        assert take(link, 10) == numbered(10)
        host.send_signal(ending)
        host.wait()
        began = time.monotonic()
        with pytest.raises(BusClosed, match="its hub is gone"):
            link.receive(None)
        assert time.monotonic() - began < 1.0
        link.close()


class TestLastWords:
    """A node that sends and leaves at once is heard, also when it hosts the bus and does not close it."""

    @pytest.mark.parametrize("leaving", ["bus.close()", "", "raise SystemExit(3)"])
    def test_of_the_host(self, free_port, leaving, numbered, take_until_closed, run_node):
        host = run_node(free_port, f"bus.receive(None); bus.send(numbered(5000)); {leaving}")
        link = LoopLink(free_port, may_host=False)
        link.send([Frame(0x1, b"go")])
        assert take_until_closed(link) == numbered(5000)
        assert host.wait() in (0, 3)
        link.close()

    @pytest.mark.parametrize("leaving", ["bus.close()", ""])
    def test_of_a_guest(self, hub, open_link, leaving, numbered, take, wait_until, run_node):
        link = open_link()
        guest = run_node(hub.port, f"bus.receive(None); bus.send(numbered(5000)); {leaving}")
        wait_until(lambda: hub.clients == 2)
        link.send([Frame(0x1, b"go"), *numbered(500)])  # some of it stays unread
        assert take(link, 5000) == numbered(5000)
        assert guest.wait() == 0


class TestOpening:
    def test_the_first_to_come_hosts(self, free_port, numbered, take):
        first, second = open_bus(f"loop:{free_port}"), open_bus(f"loop:{free_port}")
        second.send(numbered(3))
        assert take(first, 3) == numbered(3)
        assert first.name == "loop"
        second.close()
        first.close()

    def test_after_the_host_has_left_the_next_hosts(self, free_port):
        for _ in range(3):
            first, second = open_bus(f"loop:{free_port}"), open_bus(f"loop:{free_port}")
            first.close()
            with pytest.raises(BusClosed):
                second.receive(PATIENCE_S)
            second.close()

    def test_many_openers_at_once_meet_on_one_bus(self, free_port, numbered, take):
        start = threading.Barrier(8)
        links = []

        def opener():
            start.wait()
            links.append(LoopLink(free_port))

        threads = [threading.Thread(target=opener) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(links) == 8
        links[0].send(numbered(10))
        assert [take(link, 10) for link in links[1:]] == [numbered(10)] * 7
        for link in links:
            link.close()

    def test_two_processes_racing_meet(self, free_port, run_node):
        deeds = "print('open', flush=True); print(bus.receive(10).can_id, flush=True); bus.receive(None)"
        nodes = [run_node(free_port, deeds) for _ in range(2)]
        link = LoopLink(free_port)
        try:
            assert [node.stdout.readline() for node in nodes] == ["open\n"] * 2
            link.send([Frame(0x123, b"")])
            assert [node.stdout.readline() for node in nodes] == [f"{0x123}\n"] * 2
        finally:
            for node in nodes:
                node.kill()
                node.wait()
            link.close()

    @pytest.mark.long
    def test_a_guest_waits_for_its_hub(self, free_port):
        hubs = []
        later = threading.Timer(0.2, lambda: hubs.append(Hub(free_port)) or hubs[0].start())
        later.start()
        link = LoopLink(free_port, may_host=False)
        link.close()
        hubs[0].close()

    def test_but_not_for_ever(self, free_port):
        with pytest.raises(BusError, match=f"no hub answers on port {free_port}"):
            LoopLink(free_port, timeout_s=0.1, may_host=False)

    def test_a_port_of_another_program_is_refused(self):
        with socket.create_server(("127.0.0.1", 0)) as server:

            def greet_wrongly():
                connection, _ = server.accept()
                with connection:
                    connection.sendall(b"220 mail.example.org ESMTP\r\n")

            thread = threading.Thread(target=greet_wrongly)
            thread.start()
            with pytest.raises(BusError, match="taken by another program"):
                LoopLink(server.getsockname()[1], timeout_s=1.0)
            thread.join()

    @pytest.mark.long
    def test_a_port_of_a_silent_program_is_given_up(self):
        with (
            socket.create_server(("127.0.0.1", 0)) as server,
            pytest.raises(BusError, match="no hub answers"),
        ):
            LoopLink(server.getsockname()[1], timeout_s=0.2)

    def test_a_guest_never_comes_before_its_host(self, numbered):
        """Else the first words of a guest that was waiting for the port would be lost on its host."""
        hub = Hub()
        guests = []

        def come_and_talk():
            guests.append(LoopLink(hub.port))
            guests[0].send(numbered(1))

        thread = threading.Thread(target=come_and_talk)
        thread.start()
        time.sleep(0.1)  # the guest stands at the door
        with hub.attach() as host:
            hub.start()
            thread.join()
            assert host.recv(can_frame.SIZE) == can_frame.pack(numbered(1)[0])
        guests[0].close()
        hub.close()


@pytest.mark.long
def test_a_hub_that_stands_still_is_not_waited_for_for_ever(monkeypatch, numbered):
    """It has greeted, and then takes nothing."""
    monkeypatch.setattr(link_module, "SEND_PATIENCE_S", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as server:
        taken = []

        def greet():
            taken.append(server.accept()[0])
            taken[0].sendall(GREETING)

        greeter = threading.Thread(target=greet)
        greeter.start()
        link = LoopLink(server.getsockname()[1], may_host=False)
        greeter.join()
        with pytest.raises(BusError, match="accepts no more data: its hub stands still"):
            link.send(numbered(1_000_000))
        taken[0].close()
        link.close()


# --- The end of the loop bus that serves it: one bus for all, while its process sends or receives


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


class TestHostDelivery:
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


class TestHostWaiting:
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


class TestHostEnd:
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
