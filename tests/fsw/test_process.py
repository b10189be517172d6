"""The flight software as a process: what it says and how it exits when its bus is gone."""

import pytest

from fsw import process
from fsw.bus.interface import BusClosed, BusError
from fsw.table.table import load_flight_table


class FailingBus:
    """A bus on which everything fails."""

    def __init__(self, error):
        self.error = error
        self.is_open = True

    def send(self, frames):
        raise self.error

    def receive(self, timeout_s):
        raise self.error

    def close(self):
        self.is_open = False


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (BusClosed("its hub is gone"), 0, ""),
        (BusError("the bus accepts no more data"), 1, "fsw: the bus accepts no more data\n"),
    ],
    ids=["gone", "failed"],
)
def test_a_bus_that_is_gone_ends_a_run_in_silence_and_one_that_fails_does_not(
    error, code, words, monkeypatch, capsys
):
    bus = FailingBus(error)
    monkeypatch.setattr(process, "open_bus", lambda spec: bus)
    assert process.fly(load_flight_table(None), "loop:1", quiet=True) == code
    assert capsys.readouterr().err == words
    assert not bus.is_open
