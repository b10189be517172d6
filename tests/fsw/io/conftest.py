import socket

import pytest

from fsw.io.hub import Hub
from fsw.io.link import LoopLink


@pytest.fixture
def hub():
    """A hub that serves in a thread."""
    served = Hub()
    served.start()
    yield served
    served.close()


@pytest.fixture
def open_link(hub):
    """Opens one more end of the hub's bus at each call."""
    links = []

    def open_one():
        links.append(LoopLink(hub.port, may_host=False))
        return links[-1]

    yield open_one
    for link in links:
        link.close()


@pytest.fixture
def free_port():
    """A TCP port on which nobody listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
