"""The runner's time: when silence ends a run, when a boot is told again, and when the parent is missed."""

import os

import pytest

from fsw import process
from fsw.bus.interface import BusClosed
from fsw.node import FlightNode
from fsw.wire.messages import CLASSES, FswBoot, MagField, PlantBoot, PlantEnd, Sync

FIELD = MagField(1, 20000.0, -7000.0, 31000.0).encode()
START = PlantBoot(0, 1, 2).encode()
DOUBTED_END = PlantEnd(3).encode()
NOTHING_CAME = None


class TimedScript:
    """A bus on which things happen at their times, and which closes at the end."""

    name = "timed script"

    def __init__(self, happenings):
        self.happenings = list(happenings)
        self.now_s = 0.0
        self.sent = []

    def send(self, frames):
        self.sent += [(self.now_s, CLASSES[frame.can_id]) for frame in frames]

    def receive(self, timeout_s):
        if not self.happenings:
            raise BusClosed("the script is over")
        self.now_s, happening = self.happenings.pop(0)
        return happening

    def close(self):
        pass


@pytest.fixture
def run(config, monkeypatch):
    """Runs a new node through a script: the times of its FSW_BOOTs, and what was left of the script."""

    def through(*happenings, parent=None):
        bus = TimedScript(happenings)
        monkeypatch.setattr(process.time, "monotonic", lambda: 1000.0 + bus.now_s)
        process.run(FlightNode(config), bus, parent)
        return [when for when, kind in bus.sent if kind is FswBoot], bus.happenings

    return through


def sync(config, tick):
    return Sync(tick, config.epoch_unix_s + tick).encode()


class TestSilence:
    """After a PLANT_END that is uncertain."""

    def test_is_counted_from_the_last_frame_whoever_sent_it(self, run, config):
        begun = [(0.0, sync(config, 0)), (1.0, DOUBTED_END), (4.0, FIELD)]
        late = [(6.5, NOTHING_CAME), (9.1, NOTHING_CAME), (9.2, FIELD)]
        assert run(*begun, *late)[1] == late[2:]

    def test_is_no_silence_while_frames_come(self, run, config):
        talking = [(float(second), FIELD) for second in range(2, 30)]
        assert run((0.0, sync(config, 0)), (1.0, DOUBTED_END), *talking, (30.0, NOTHING_CAME))[1] == []


class TestBootAgain:
    def test_for_a_plant_that_starts_anew_once_no_sync_was_answered_for_two_seconds(self, run, config):
        flown = [(0.7, sync(config, 700)), (2.5, FIELD)]
        assert run(*flown, (2.6, START))[0] == [0.0]
        assert run(*flown, (2.8, START))[0] == [0.0, 2.8]

    def test_no_sooner_than_half_a_second_after_the_last(self, run):
        asked = [(0.4, START), (0.6, START), (1.0, START), (1.2, START)]
        assert run(*asked)[0] == [0.0, 0.6, 1.2]


def test_a_parent_that_is_gone_is_noticed_within_a_second_of_talk(run):
    talk = [(0.1 * n, FIELD) for n in range(1, 40)]
    _, left = run(*talk, parent=os.getppid() + 1)
    assert 0.9 <= talk[-len(left) - 1][0] <= 1.2
