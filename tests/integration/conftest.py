"""Flights by the command line; CAN interfaces. Where there are none: ``tests/with-vcan pytest -m vcan``."""

import contextlib
import hashlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import pytest

from fsw.bus.socketcan import interface_is_up
from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import CLASSES, Sync
from sim.record.candump import read_log
from sim.record.log_index import LogIndex
from sim.report import conclude
from torquer.cli.main import main

CAN_FIXTURES = {"vcan0", "own_interface"}
TINY = ("microsat", "--seed", "7", "--orbits", "0.005", "--bus", "virtual")
"""A flight of 30 ticks."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    for item in items:
        if CAN_FIXTURES & set(getattr(item, "fixturenames", ())):
            item.add_marker("vcan")


def missing(what):
    if os.environ.get("TORQUER_REQUIRE_VCAN") == "1":
        pytest.fail(f"{what}, but TORQUER_REQUIRE_VCAN=1 requires it")
    pytest.skip(f"{what}: make test-vcan runs this test where there is one")


@pytest.fixture(scope="session")
def vcan0():
    """The name of an interface that is up, and that others may be talking on."""
    if not interface_is_up("vcan0"):
        missing("there is no CAN interface vcan0 here")
    return "vcan0"


@pytest.fixture
def own_interface():
    """The name of a fresh vcan interface that the test may torment."""
    name = f"vcan{os.getpid() % 100_000 + 1}"
    made = subprocess.run(["ip", "link", "add", name, "type", "vcan"], check=False, capture_output=True)
    if made.returncode:
        missing("no CAN interface can be made here")
    subprocess.run(["ip", "link", "set", name, "up"], check=True)
    yield name
    subprocess.run(["ip", "link", "delete", name], check=False, capture_output=True)


@pytest.fixture
def port():
    """A TCP port of the loop bus that nobody uses."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


class Outcome(NamedTuple):
    """What a command ended with."""

    code: int
    out: str
    err: str

    @property
    def sentence(self):
        """The one line on stderr that is no warning; it is no traceback."""
        lines = [line for line in self.err.splitlines() if not line.startswith("torquer: warning: ")]
        assert len(lines) == 1, self.err
        assert self.err.endswith("\n")
        assert "Error" not in self.err
        return lines[0].strip()


def run_torquer(arguments):
    """The command line in this process; the processes that it starts are real."""
    with pytest.raises(SystemExit) as ended:
        main.main([str(argument) for argument in arguments], prog_name="torquer")
    return ended.value.code or 0


@pytest.fixture
def torquer(capfd):
    """Runs ``torquer ARGUMENTS...`` and returns its exit code and all output."""

    def run(*arguments):
        capfd.readouterr()
        code = run_torquer(arguments)
        return Outcome(code, *capfd.readouterr())

    return run


@pytest.fixture(scope="session")
def sil_run(tmp_path_factory):
    """The directory of the run of ``torquer sil ARGUMENTS...``; for reading only.

    Its report is left blank: drawing it takes longer than the flight.
    """
    runs = {}

    def fly(*arguments):
        if arguments not in runs:
            path = tmp_path_factory.mktemp("sil") / "run"
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(conclude, "write_report", lambda path, *rest: path.write_text(""))
                assert run_torquer(("sil", *arguments, "--out", path)) == 0
            runs[arguments] = path
        return runs[arguments]

    return fly


@pytest.fixture
def run(sil_run, tmp_path):
    """A copy of a run of 30 ticks, to be altered; no digest tells of that before the file is read."""
    folder = tmp_path / "run"
    folder.mkdir()
    for file in sil_run(*TINY).iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    run_json = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**run_json, "digests": {}}))
    return folder


class Bus(NamedTuple):
    """What a log says was on the bus."""

    times_us: list
    frames: list


def bus_of(run_or_log):
    """Times and frames of a log, all of them or an error."""
    log = Path(run_or_log)
    entries = list(read_log(log / "bus.log" if log.is_dir() else log))
    return Bus([entry.timestamp_us for entry in entries], [entry.frame for entry in entries])


@pytest.fixture
def bus():
    """Reads the bus log of a run."""
    return bus_of


class Copy:
    """A copy of a run that may be altered: ``entries`` is its log, one (time, channel, frame) a line."""

    def __init__(self, run, folder):
        self.folder = Path(shutil.copytree(run, folder))
        self.log = self.folder / "bus.log"
        self.entries = [[entry.timestamp_us, entry.channel, entry.frame] for entry in read_log(self.log)]
        assert self.text() == self.log.read_text()

    def text(self):
        return "".join(format_line(format_time(us), name, frame) for us, name, frame in self.entries)

    def write(self):
        """Write the altered log, vouched for and bound anew: what is in it must give it away."""
        self.log.write_text(self.text())
        index = LogIndex(self.log)
        index.add(self.text().encode(), len(self.entries))
        index.close(ended=True)
        run = json.loads((self.folder / "run.json").read_text())
        run["digests"]["bus.log"] = hashlib.sha256(self.log.read_bytes()).hexdigest()
        (self.folder / "run.json").write_text(json.dumps(run))
        return self.folder

    def where(self, message, **values):
        """Indices of the entries that hold such a message with such values."""
        return [
            index
            for index, (_, _, frame) in enumerate(self.entries)
            if frame.can_id == message.ID and values.items() <= message.decode(frame.data).by_name().items()
        ]

    def in_tick(self, tick, message):
        """Index of the message of that kind in a tick."""
        ends = self.where(Sync, tick=tick)[0]
        return max(index for index in self.where(message) if index < ends)

    def change(self, index, **values):
        """Give a message other values, sealed anew."""
        message = CLASSES[self.entries[index][2].can_id]
        self.entries[index][2] = message.decode(self.entries[index][2].data).replace(**values).encode()


@pytest.fixture
def copy_of(tmp_path):
    """Copies a run that is then altered."""
    return lambda run: Copy(run, tmp_path / f"copy{len(list(tmp_path.iterdir()))}")


class Node:
    """A process that the test started, and its children."""

    def __init__(self, words, folder, **options):
        self.stdout, self.stderr = folder / "stdout", folder / "stderr"
        with self.stdout.open("w") as out, self.stderr.open("w") as err:
            self.process = subprocess.Popen(words, cwd=folder, stdout=out, stderr=err, **options)
        self._leads_a_group = options.get("start_new_session", False)

    def wait(self, timeout_s=150):
        """How it ended."""
        code = self.process.wait(timeout_s)
        return Outcome(code, self.stdout.read_text(), self.stderr.read_text())

    def end(self):
        """Kill it if it still runs, and what it left behind: on an interface it would disturb other tests."""
        if self._leads_a_group:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
        self.process.kill()
        self.process.wait()


@pytest.fixture(scope="session")
def is_alive():
    """Whether a process runs: it is there, and no zombie."""

    def alive(pid):
        try:
            return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
        except OSError:
            return False

    return alive


@pytest.fixture
def start(tmp_path):
    """Starts ``python -m MODULE ARGUMENTS...``; what still runs at the end of the test is ended."""
    nodes = []

    def start_module(module, *arguments, **options):
        folder = tmp_path / f"process{len(nodes)}"
        folder.mkdir()
        words = [sys.executable, "-m", module, *map(str, arguments)]
        nodes.append(Node(words, folder, **options))
        return nodes[-1]

    yield start_module
    for node in nodes:
        node.end()


@pytest.fixture
def wait_for():
    """Waits until a process has said something on stderr."""

    def wait(node, text):
        deadline = time.monotonic() + 120.0
        while text not in node.stderr.read_text():
            assert node.process.poll() is None, node.stderr.read_text()
            assert time.monotonic() < deadline, f"it never said '{text}'"
            time.sleep(0.02)

    return wait
