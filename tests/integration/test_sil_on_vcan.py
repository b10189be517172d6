"""The same flight on a real CAN interface: plant and flight software over vcan0, candump beside them."""

import json
import shutil
import subprocess
import sys
import time

import pytest

from fsw.wire.messages import SENDERS, FswBoot, PlantBoot
from sim.report import conclude

FLIGHT = ("microsat", "--seed", "5", "--orbits", "0.02")
"""121 ticks: the first pulse is among them."""

PLENTY = "8388608"
"""Bytes of candump's receive buffer: the default one drops frames of a log that is played at full speed."""


@pytest.fixture(autouse=True)
def no_report(monkeypatch):
    """A report takes longer to draw in the guest than the flight."""
    monkeypatch.setattr(conclude, "write_report", lambda path, *rest: path.write_text(""))


def tool(name):
    """The path of a program of can-utils."""
    path = shutil.which(name)
    assert path is not None, f"{name} is missing: install can-utils"
    return path


class Candump:
    """candump on an interface, its log kept in a file."""

    def __init__(self, interface, log):
        self.log = log
        with log.open("w") as file:
            words = [tool("candump"), "-r", PLENTY, "-L", interface]
            self.process = subprocess.Popen(words, stdout=file, stdin=subprocess.DEVNULL)
        time.sleep(0.5)  # until its socket is bound

    def end(self):
        """Its log, once it has written what it has heard: in a guest that may take a while."""
        size = -1
        while size != (size := self.log.stat().st_size):
            time.sleep(1.0)
        self.process.terminate()
        self.process.wait(10)
        return self.log


@pytest.fixture(scope="session")
def on_can(vcan0, sil_run, tmp_path_factory):
    """(run directory, candump's own log) of one flight on vcan0."""
    listener = Candump(vcan0, tmp_path_factory.mktemp("candump") / "candump.log")
    try:
        run = sil_run(*FLIGHT, "--bus", f"socketcan:{vcan0}")
    finally:
        log = listener.end()
    return run, log


def by_node(frames):
    """The frames of each node, in its order."""
    nodes = {}
    for frame in frames:
        nodes.setdefault(SENDERS[frame.can_id], []).append(frame)
    return nodes


def test_candump_keeps_the_same_frames_as_we_do(on_can, vcan0, bus):
    run, log = on_can
    received, sent = bus(log).frames, bus(run).frames
    # candump also hears plant and flight software look for each other before the run begins;
    # the plant may ask once more while FSW_BOOT is on its way
    boot, *flight = sent
    begin = len(received) - len(flight)
    assert received[begin:] == flight
    assert boot.can_id == FswBoot.ID
    assert boot in received[:begin]
    assert {frame.can_id for frame in received[:begin]} <= {PlantBoot.ID, FswBoot.ID}
    assert json.loads((run / "run.json").read_text())["bus"] == "socketcan"
    assert (run / "bus.log").read_text().split("\n")[0].split(" ")[1] == vcan0


def test_it_carries_the_frames_of_the_virtual_bus(on_can, sil_run, bus):
    here, virtual = [by_node(bus(run).frames) for run in (on_can[0], sil_run(*FLIGHT, "--bus", "virtual"))]
    assert here == virtual
    assert set(here) == {"PLANT", "FSW", "COIL", "MAG", "SUN"}


def test_a_run_on_can_replays_bit_for_bit_and_keeps_the_limits(on_can, torquer):
    assert torquer("replay", on_can[0]).code == 0
    assert torquer("check", on_can[0]).code == 0


def test_what_candump_has_kept_replays_too(on_can, torquer):
    done = torquer("replay", on_can[1], "--scenario", "microsat")
    assert (done.code, done.out.partition(":")[0]) == (0, "bit-exact")


def test_auto_takes_vcan0_and_says_so(torquer, vcan0, tmp_path):
    outcome = torquer("sil", "microsat", "--orbits", "0.002", "--out", tmp_path / "run")
    assert outcome.code == 0
    assert "socketcan" in outcome.err
    assert json.loads((tmp_path / "run" / "run.json").read_text())["bus"] == "socketcan"


def test_canplayer_plays_our_log_back(sil_run, vcan0, bus, tmp_path):
    run = sil_run(*FLIGHT, "--bus", "virtual")
    log = tmp_path / "as-vcan0.log"
    log.write_text((run / "bus.log").read_text().replace(" virtual ", f" {vcan0} "))
    listener = Candump(vcan0, tmp_path / "candump.log")
    try:
        subprocess.run([tool("canplayer"), "-t", "-g", "1", "-I", str(log)], check=True, timeout=60)
    finally:
        log = listener.end()
    assert bus(log).frames == bus(run).frames


@pytest.mark.parametrize("first", ["plant", "fsw"])
def test_two_terminals_in_either_order(first, vcan0, start, wait_for, bus, sil_run, tmp_path):
    run, spec = tmp_path / "run", f"socketcan:{vcan0}"
    words = {
        "plant": (*FLIGHT, "--bus", spec, "--out", run),
        "fsw": ("microsat", "--bus", spec),
    }
    second = {"plant": "fsw", "fsw": "plant"}[first]
    nodes = {first: start("torquer", first, *words[first])}
    wait_for(nodes[first], f"{first} on {spec}")
    time.sleep(1.0)  # whatever it says now, the other one misses
    nodes[second] = start("torquer", second, *words[second])
    assert nodes["plant"].wait().code == 0
    assert nodes["fsw"].wait().code == 0
    assert bus(run).frames == bus(sil_run(*FLIGHT, "--bus", "virtual")).frames


def test_strangers_on_the_bus_do_not_end_a_run(torquer, vcan0, bus, tmp_path):
    babble = (
        "import socket, struct, sys, time\n"
        "bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)\n"
        "bus.bind((sys.argv[1],))\n"
        "strange = {0x110: '00', 0x7FF: 'DEADBEEF', 0x080: '0011223344556677',\n"
        "           0x92345678: '0102', 0x40000100: ''}  # extended, remote\n"
        "while True:\n"
        "    for can_id, data in strange.items():\n"
        "        bus.send(struct.pack('=IB3x8s', can_id, len(data) // 2, bytes.fromhex(data)))\n"
        "    time.sleep(0.05)\n"
    )
    run = tmp_path / "run"
    stranger = subprocess.Popen([sys.executable, "-c", babble, vcan0])
    try:
        assert torquer("sil", *FLIGHT, "--bus", f"socketcan:{vcan0}", "--out", run).code == 0
    finally:
        stranger.kill()
        stranger.wait()
    assert any(frame.can_id == 0x7FF for frame in bus(run).frames)
    assert torquer("check", run).code == 0
