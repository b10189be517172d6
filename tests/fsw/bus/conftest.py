"""Frames by number, links that are read to the end, and nodes in processes of their own."""

import subprocess
import sys
import time

import pytest

from fsw.bus.interface import BusClosed
from fsw.wire.frame import Frame

PATIENCE_S = 10.0


@pytest.fixture(scope="session")
def numbered():
    """Makes so many frames of one identifier, each with its number."""
    return lambda count, can_id=0x123: [Frame(can_id, number.to_bytes(4, "big")) for number in range(count)]


@pytest.fixture(scope="session")
def take():
    """Receives the next ``count`` frames, fewer if the bus falls silent."""

    def take_from(bus, count):
        frames = []
        while len(frames) < count and (frame := bus.receive(PATIENCE_S)) is not None:
            frames.append(frame)
        return frames

    return take_from


@pytest.fixture(scope="session")
def take_until_closed():
    """Receives all frames up to the end of the bus."""

    def take_from(link):
        frames = []
        try:
            while (frame := link.receive(PATIENCE_S)) is not None:
                frames.append(frame)
        except BusClosed:
            return frames
        pytest.fail(f"the bus fell silent after {len(frames)} frames, but did not close")

    return take_from


@pytest.fixture(scope="session")
def wait_until():
    """Waits until something holds, and fails if it never does."""

    def wait(holds):
        deadline = time.monotonic() + PATIENCE_S
        while not holds():
            assert time.monotonic() < deadline, "it never came true"
            time.sleep(0.005)

    return wait


@pytest.fixture(scope="session")
def run_node():
    """Starts a process that opens the loop bus of a port and does ``deeds``."""

    def run(port, deeds):
        program = (
            "from fsw.bus.open_bus import open_bus\n"
            "from fsw.wire.frame import Frame\n"
            "numbered = lambda count: [Frame(0x123, n.to_bytes(4, 'big')) for n in range(count)]\n"
            f"bus = open_bus('loop:{port}')\n"
            f"{deeds}\n"
        )
        return subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)

    return run
