"""The bounds of the hub: clients, memory, descriptors. A client that keeps up does not notice them."""

import resource
import select
import socket
import subprocess
import sys
import time
from errno import ENFILE
from pathlib import Path
from statistics import median

import pytest

from fsw.bus import can_frame
from fsw.bus import hub as hub_module
from fsw.bus.hub import MOST_CLIENTS, Hub
from fsw.bus.hub_listener import FULL, GREETING
from fsw.bus.interface import BusError
from fsw.bus.link import LoopLink
from fsw.wire.frame import Frame

PATIENCE_S = 10.0
MIB = 2**20
CONNECTS = 10_000
DESCRIPTORS = min(CONNECTS, resource.getrlimit(resource.RLIMIT_NOFILE)[1]) - 100

SERVE = """
import resource, sys
from fsw.bus.hub import Hub
descriptors = int(sys.argv[1])
if descriptors:
    resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))
hub = Hub()
hub.start()
print(hub.port, flush=True)
sys.stdin.read()
"""

CONNECT = """
import resource, socket, sys
port, connects, kept, says = *map(int, sys.argv[1:4]), bytes.fromhex(sys.argv[4])
hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
held = []
for number in range(connects):
    held.append(socket.create_connection(("127.0.0.1", port)))
    try:
        held[-1].sendall(says)
    except OSError:
        pass
    if len(held) > kept:
        held.pop(0).close()
print("done", flush=True)
sys.stdin.read()
"""
"""Connects so often, keeps the last so many, says something on each, never reads, not even the greeting."""


class Process:
    """A program in a process of its own, which lives until it is ended."""

    def __init__(self, program, *arguments):
        words = [sys.executable, "-c", program, *map(str, arguments)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        self.process = subprocess.Popen(words, text=True, **pipes)
        self._said = None

    def line(self):
        return self.process.stdout.readline().strip()

    def end(self):
        """End it; what it said on standard error."""
        if self._said is None:
            self.process.kill()
            self._said = self.process.communicate(timeout=PATIENCE_S)[1]
        return self._said

    def resident_bytes(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0]) * 1024

    def cpu_s(self):
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / 100


@pytest.fixture
def run():
    """Starts programs; all end with the test."""
    started = []

    def run_program(*words):
        started.append(Process(*words))
        return started[-1]

    yield run_program
    for process in started:
        process.end()


@pytest.fixture
def serve(run):
    """Starts a hub in a process of its own: the process and the hub's port."""

    def served(descriptors=0):
        process = run(SERVE, descriptors)
        return process, int(process.line())

    return served


@pytest.fixture
def messages():
    return []


@pytest.fixture
def hub(messages):
    """A hub that serves in a thread, and tells to a list."""
    served = Hub(report=messages.append)
    served.start()
    yield served
    served.close()


def come(port):
    """A client on the bus that can do anything: a plain socket."""
    connection = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
    assert take(connection, len(GREETING)) == GREETING
    return connection


def take(connection, size):
    """So many bytes, fewer if the hub has hung up."""
    taken = bytearray()
    while len(taken) < size and (received := connection.recv(size - len(taken))):
        taken += received
    return taken


def port_of(connection):
    return connection.getsockname()[1]


def pass_on(sender, reader, size):
    """Send so many bytes of records and read them at the other end, in step."""
    chunk = can_frame.pack(Frame(0x123, b"12345678")) * (MIB // can_frame.SIZE)
    for _ in range(size // MIB):
        sender.sendall(chunk)
        assert take(reader, MIB) == chunk


def is_closed(connection):
    """Whether the hub has dropped it; what came before is read."""
    connection.settimeout(0.2)
    try:
        while connection.recv(MIB):
            pass
    except TimeoutError:
        return False
    except ConnectionError:
        return True
    return True


class TestMemory:
    @pytest.mark.long
    @pytest.mark.parametrize("idle", [20, MOST_CLIENTS - 2])
    def test_clients_that_never_read_share_what_is_kept_for_all(self, serve, idle):
        process, port = serve()
        sender, reader = come(port), come(port)
        clients = [come(port) for _ in range(idle)]
        before = process.resident_bytes()
        most = 0
        for _ in range(8):
            pass_on(sender, reader, 2 * MIB)
            most = max(most, process.resident_bytes())
        assert most - before < 1.5 * hub_module.BACKLOG_LIMIT
        dropped = [client for client in clients if is_closed(client)]
        assert 0 < len(dropped) < idle
        pass_on(sender, reader, MIB)
        reports = process.end().splitlines()
        assert len(reports) == len(dropped)
        for client in dropped:
            gone = f"hub: the client on port {port_of(client)} is dropped"
            assert [line.startswith(gone) for line in reports].count(True) == 1

    @pytest.mark.long
    def test_the_slowest_is_dropped_and_told(self, hub, messages, monkeypatch, wait_until):
        monkeypatch.setattr(hub_module, "BACKLOG_LIMIT", 48 * MIB)
        sender, reader, sleeper, late = (come(hub.port) for _ in range(4))
        pass_on(sender, reader, 20 * MIB)
        assert messages == []
        take(late, 16 * MIB)
        pass_on(sender, reader, 20 * MIB)
        wait_until(lambda: hub.clients == 3)
        assert len(messages) == 1
        assert messages[0].startswith(
            f"the client on port {port_of(sleeper)} is dropped from the loop bus on port {hub.port}: "
            "it reads too slowly, "
        )
        assert is_closed(sleeper)
        assert len(take(late, 24 * MIB)) == 24 * MIB
        for client in (sender, reader, sleeper, late):
            client.close()

    @pytest.mark.long
    def test_what_has_been_taken_is_forgotten(self, hub, messages, monkeypatch):
        monkeypatch.setattr(hub_module, "BACKLOG_LIMIT", 12 * MIB)
        sender, reader, late = (come(hub.port) for _ in range(3))
        for _ in range(5):
            pass_on(sender, reader, 8 * MIB)
            take(late, 8 * MIB)
        assert messages == []
        for client in (sender, reader, late):
            client.close()


class TestRoom:
    @pytest.fixture
    def full(self, hub, wait_until):
        clients = [come(hub.port) for _ in range(MOST_CLIENTS)]
        wait_until(lambda: hub.clients == MOST_CLIENTS)  # it greets before it counts
        yield clients
        for client in clients:
            client.close()

    def test_one_too_many_is_told_at_once(self, hub, full):
        began = time.monotonic()
        with pytest.raises(
            BusError, match=f"^the loop bus on port {hub.port} is full: its hub accepts no more clients$"
        ):
            LoopLink(hub.port)
        assert time.monotonic() - began < 1.0
        assert hub.clients == MOST_CLIENTS

    def test_who_leaves_makes_room(self, hub, full, wait_until):
        full.pop().close()
        wait_until(lambda: hub.clients == MOST_CLIENTS - 1)
        LoopLink(hub.port).close()

    def test_refusals_are_reported_ever_more_rarely(self, hub, messages, full):
        for _ in range(120):
            with socket.create_connection(("127.0.0.1", hub.port)) as refused:
                assert take(refused, len(FULL) + 1) == FULL
        why = "it has as many clients as it serves"
        refusal = f"the loop bus on port {hub.port} accepts no more clients ({why})"
        assert messages == [f"{refusal}: {count} refused" for count in (1, 10, 100)]

    @pytest.mark.long
    def test_a_stopped_standard_error_stops_no_client(self, serve):
        process, port = serve()
        process.process.stderr.close()
        clients = [come(port) for _ in range(MOST_CLIENTS)]
        for _ in range(20):
            with socket.create_connection(("127.0.0.1", port)) as refused:
                assert take(refused, len(FULL) + 1) == FULL
        pass_on(*clients[:2], MIB)
        process.process.stderr = None


class TestDescriptors:
    @pytest.mark.long
    def test_with_none_left_the_bus_goes_on_and_a_client_is_refused(self, serve):
        process, port = serve(descriptors=24)
        sender, reader = come(port), come(port)
        others, refused = [], 0
        while refused < 20:
            others.append(socket.create_connection(("127.0.0.1", port), PATIENCE_S))
            refused += take(others[-1], len(FULL)) == FULL
        assert len(others) - refused > 5
        with pytest.raises(BusError, match="is full"):
            LoopLink(port, may_host=False)
        pass_on(sender, reader, MIB)
        before = process.cpu_s()
        time.sleep(1.0)
        assert process.cpu_s() - before < 0.3
        assert "Too many open files" in process.end().splitlines()[0]

    @pytest.mark.long
    def test_a_door_that_cannot_be_answered_rests(self, monkeypatch, messages):
        """The whole machine can be out of descriptors, too: then not even a refusal is possible."""

        def fail(listener):
            raise OSError(ENFILE, "Too many open files in system")

        hub = Hub(report=messages.append)
        with hub.attach() as first, hub.attach() as second, monkeypatch.context() as patch:
            patch.setattr(socket.socket, "accept", fail)
            with socket.create_connection(("127.0.0.1", hub.port)) as waiting:
                began, polls = time.monotonic(), 0
                while time.monotonic() < began + 0.5:
                    hub.poll(None)
                    polls += 1
                assert polls < 20
                word = can_frame.pack(Frame(0x123, b"still"))
                first.sendall(word)
                hub.poll(1.0)
                assert second.recv(can_frame.SIZE) == word
                patch.undo()
                waiting.settimeout(0.0)
                deadline = time.monotonic() + PATIENCE_S
                while hub.clients < 3 and time.monotonic() < deadline:
                    hub.poll(0.2)
                assert waiting.recv(len(GREETING)) == GREETING
        hub.close()

    @pytest.mark.long
    def test_a_client_without_a_descriptor_says_so(self, serve, run):
        _, port = serve()
        opener = run(
            "import resource\n"
            "from fsw.bus.interface import BusError\n"
            "from fsw.bus.link import LoopLink\n"
            "resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))\n"
            f"try: LoopLink({port})\n"
            "except BusError as error: print(error, flush=True)\n"
        )
        assert opener.line() == f"the bus loop:{port} cannot be opened: Too many open files"


class TestRush:
    """10 000 connects do not hold up two that talk to each other."""

    @pytest.mark.long
    @pytest.mark.parametrize(
        ("kept", "says"),
        [(0, b""), (DESCRIPTORS, b"half a"), (DESCRIPTORS, b"GET / HTTP/1.1\r\n" * 4)],
        ids=["closed at once", "kept with half a record", "kept strangers"],
    )
    @pytest.mark.slow
    def test_of_connects(self, serve, run, kept, says):
        process, port = serve()
        here, there = LoopLink(port, may_host=False), LoopLink(port, may_host=False)
        before = process.resident_bytes()
        rush = run(CONNECT, port, CONNECTS, kept, says.hex())
        trips_s = []

        def go_there_and_back():
            frame = Frame(0x123, len(trips_s).to_bytes(4, "big"))
            began = time.monotonic()
            here.send([frame])
            assert there.receive(PATIENCE_S) == frame
            there.send([frame])
            while (heard := here.receive(PATIENCE_S)) != frame:
                assert heard is not None
            trips_s.append(time.monotonic() - began)

        while not select.select((rush.process.stdout,), (), (), 0.0)[0]:
            go_there_and_back()
        assert rush.line() == "done"
        for _ in range(200):
            go_there_and_back()
        assert max(trips_s) < 1.0
        assert median(trips_s[-200:]) < 0.02
        assert process.resident_bytes() - before < 1.5 * hub_module.BACKLOG_LIMIT
        here.close()
        there.close()


PATIENCE_S = 10.0
