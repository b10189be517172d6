"""A loop bus, and nodes started on it by ``torquer``."""

import signal
import subprocess
import sys

import pytest

from fsw.bus.hub import Hub
from fsw.bus.link import LoopLink


@pytest.fixture
def bus():
    """One end of a loop bus."""
    hub = Hub()
    hub.start()
    link = LoopLink(hub.port, may_host=False)
    yield link
    link.close()
    hub.close()


class Node:
    """A node in a process of its own."""

    def __init__(self, *words):
        command = [sys.executable, "-m", "torquer", *words]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)

    def interrupt(self):
        """Ctrl-C."""
        self.process.send_signal(signal.SIGINT)

    def wait(self):
        """The exit code, and what it wrote to stderr."""
        stderr = self.process.communicate(timeout=20.0)[1]
        return self.process.returncode, stderr


@pytest.fixture
def start(bus):
    """Starts ``torquer WORDS... --bus`` on the bus; what still runs at the end of the test is ended."""
    nodes = []

    def start_node(*words):
        nodes.append(Node(*words, "--bus", bus.spec))
        return nodes[-1]

    yield start_node
    for node in nodes:
        node.process.kill()
        node.process.communicate()
