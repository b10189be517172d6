"""The runner: boots, answers, repeats its boot for a plant that came later, and ends when it should."""

import os

import pytest

from fsw import node, process
from fsw.bus.interface import BusClosed
from fsw.node import FlightNode
from fsw.wire.messages import CLASSES, FswBoot, MagField, PlantBoot, PlantEnd, Sync, TickDone

FIELD = MagField(1, 20000.0, -7000.0, 31000.0).encode()
START = PlantBoot(0, 1, 2).encode()
END = PlantEnd(1).encode()
NOTHING_CAME = None


class Script:
    """A bus on which things happen one after the other, and which closes at the end."""

    name = "script"

    def __init__(self, *happenings):
        self.happenings = list(happenings)
        self.sent = []

    def send(self, frames):
        self.sent += [CLASSES[frame.can_id].decode(frame.data) for frame in frames]

    def receive(self, timeout_s):
        assert timeout_s is not None, "an endless wait would outlive a parent that is gone"
        if not self.happenings:
            raise BusClosed("the script is over")
        return self.happenings.pop(0)

    def close(self):
        pass


@pytest.fixture
def run(config):
    """Runs a new node through a script; the messages it sent."""

    def through(*happenings, parent=None, bench=False):
        bus = Script(*happenings)
        process.run(FlightNode(config), bus, parent, bench)
        through.left = bus.happenings
        return bus.sent

    return through


def sync(config, tick):
    return Sync(tick, config.epoch_unix_s + tick).encode()


def kinds(messages):
    return [type(message) for message in messages]


def test_says_first_that_it_has_booted(run):
    assert kinds(run()) == [FswBoot]


def test_answers_each_sync_last_with_tick_done(run, config):
    sent = run(FIELD, sync(config, 0), FIELD, sync(config, 1), END)
    assert [message.tick for message in sent if isinstance(message, TickDone)] == [0, 1]
    assert isinstance(sent[-1], TickDone)


def test_ends_with_the_run(run, config):
    run(sync(config, 0), END, sync(config, 1))
    assert run.left == [sync(config, 1)]


class TestEnd:
    def test_that_does_not_fit_ends_nothing(self, run, config):
        sent = run(sync(config, 0), PlantEnd(7200).encode(), NOTHING_CAME, sync(config, 1))
        assert [message.tick for message in sent if isinstance(message, TickDone)] == [0, 1]

    def test_on_a_bench_none_ends_it(self, run, config):
        sent = run(sync(config, 0), END, NOTHING_CAME, sync(config, 1), bench=True)
        assert [message.tick for message in sent if isinstance(message, TickDone)] == [0, 1]

    def test_where_the_last_sync_was_lost_silence_confirms_it(self, run, config, monkeypatch):
        monkeypatch.setattr(process, "SILENCE_S", -1.0)
        run(sync(config, 0), PlantEnd(3).encode(), NOTHING_CAME, sync(config, 1))
        assert run.left == [sync(config, 1)]

    @pytest.mark.parametrize("bench", [False, True])
    def test_a_short_silence_or_a_bench_does_not(self, run, config, monkeypatch, bench):
        monkeypatch.setattr(process, "SILENCE_S", -1.0 if bench else 5.0)
        run(sync(config, 0), PlantEnd(3).encode(), NOTHING_CAME, sync(config, 1), bench=bench)
        assert run.left == []

    def test_a_doubted_one_is_forgotten_when_the_flight_goes_on(self, run, config, monkeypatch):
        monkeypatch.setattr(process, "SILENCE_S", -1.0)
        run(sync(config, 0), PlantEnd(3).encode(), sync(config, 1), NOTHING_CAME, sync(config, 2))
        assert run.left == []


def test_ends_when_the_bus_is_gone(run):
    assert kinds(run(FIELD, FIELD)) == [FswBoot]


class ClosedForSending(Script):
    """A bus whose hub went away after a frame was received."""

    def send(self, frames):
        if self.sent or not self.happenings:
            raise BusClosed("its hub is gone")
        super().send(frames)


@pytest.mark.parametrize("frames", [0, 1], ids=["at its boot", "while it answers"])
def test_ends_as_well_when_it_is_sending_as_the_bus_goes(frames, config):
    bus = ClosedForSending(*[sync(config, 0), FIELD][:frames])
    process.run(FlightNode(config), bus)
    assert kinds(bus.sent) == [FswBoot] * frames


def test_waits_on_while_nothing_comes(run, config):
    sent = run(NOTHING_CAME, NOTHING_CAME, sync(config, 0), END, parent=os.getppid())
    assert TickDone in kinds(sent)


def test_ends_when_its_parent_is_gone(run, config):
    run(NOTHING_CAME, sync(config, 0), parent=os.getppid() + 1)
    assert run.left == [sync(config, 0)]


def test_ends_also_when_others_never_stop_talking(run, config, monkeypatch):
    monkeypatch.setattr(process, "IDLE_S", -1.0)
    run(FIELD, FIELD, sync(config, 0), parent=os.getppid() + 1)
    assert run.left == [FIELD, sync(config, 0)]


def test_without_a_parent_it_waits_for_ever(run, config):
    assert TickDone in kinds(run(*[NOTHING_CAME] * 50, sync(config, 0), END))


class TestBootAgain:
    def test_a_plant_that_comes_later_is_told_again(self, run, config, monkeypatch):
        monkeypatch.setattr(process, "REPEAT_BOOT_AFTER_S", -1.0)
        assert kinds(run(START, START, sync(config, 0), END))[:3] == [FswBoot] * 3

    def test_not_at_once_since_the_first_may_still_be_on_its_way(self, run, config):
        assert kinds(run(START, START, sync(config, 0), END)).count(FswBoot) == 1

    @pytest.mark.interpreted
    def test_a_plant_that_starts_anew_is_told_where_there_was_none_for_a_while(
        self, run, config, monkeypatch
    ):
        monkeypatch.setattr(process, "REPEAT_BOOT_AFTER_S", -1.0)
        monkeypatch.setattr(node, "NO_PLANT_S", -1.0)
        sent = run(sync(config, 700), START, sync(config, 0), sync(config, 1), END)
        assert kinds(sent).count(FswBoot) == 2
        assert [message.tick for message in sent if isinstance(message, TickDone)] == [700, 0, 1]

    def test_not_once_the_ticks_run(self, run, config, monkeypatch):
        """The plant says at tick 0 itself that it has booted: one FSW_BOOT a run."""
        monkeypatch.setattr(process, "REPEAT_BOOT_AFTER_S", -1.0)
        assert kinds(run(sync(config, 0), START, sync(config, 1), END)).count(FswBoot) == 1
