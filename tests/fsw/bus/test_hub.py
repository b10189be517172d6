"""The loop bus's hub: who keeps up with it, who does not, and one that serves only when it is polled."""

import socket
import threading
import time

import pytest

from fsw.bus import hub as hub_module
from fsw.bus.hub import Hub
from fsw.bus.hub_listener import GREETING
from fsw.bus.interface import BusClosed
from fsw.bus.link import LoopLink

PATIENCE_S = 10.0


class TestLaggards:
    @pytest.mark.long
    def test_one_that_never_reads_is_disconnected_and_the_bus_goes_on(
        self, monkeypatch, open_link, numbered, take, take_until_closed
    ):
        monkeypatch.setattr(hub_module, "BACKLOG_LIMIT", 2**20)
        sender, sleeper, reader = open_link(), open_link(), open_link()
        flood = numbered(20_000)
        count = 40  # 12.8 MB
        for _ in range(count):
            sender.send(flood)
            assert take(reader, len(flood)) == flood
        received = take_until_closed(sleeper)
        assert received == (flood * count)[: len(received)]  # up to the end it has lost nothing
        assert len(received) < len(flood) * count
        sender.send(numbered(3))
        assert take(reader, 3) == numbered(3)

    @pytest.mark.parametrize("words", [b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\xff" * 64])
    def test_a_stranger_is_disconnected(self, hub, open_link, words):
        link = open_link()
        with socket.create_connection(("127.0.0.1", hub.port)) as stranger:
            stranger.settimeout(PATIENCE_S)
            stranger.recv(len(GREETING), socket.MSG_WAITALL)
            stranger.sendall(words)
            assert stranger.recv(1) == b""
        assert link.receive(0.05) is None


class TestPolledHub:
    def test_it_serves_only_when_polled(self, numbered, take):
        hub = Hub()
        links = []
        thread = threading.Thread(target=lambda: links.extend(LoopLink(hub.port) for _ in range(2)))
        thread.start()
        while thread.is_alive():
            hub.poll(0.01)
        assert hub.clients == 2
        sender, reader = links
        sender.send(numbered(100))
        assert reader.receive(0.05) is None
        while hub.poll(0.0):
            pass
        assert take(reader, 100) == numbered(100)
        hub.close()
        hub.close()
        with pytest.raises(BusClosed):
            reader.receive(None)

    def test_it_waits_no_longer_than_told(self):
        hub = Hub()
        began = time.monotonic()
        assert not hub.poll(0.1)
        assert 0.09 <= time.monotonic() - began < 0.5
        hub.close()

    def test_a_taken_port_is_an_error(self):
        hub = Hub()
        with pytest.raises(OSError, match="in use"):
            Hub(hub.port)
        hub.close()
