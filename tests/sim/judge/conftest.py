"""Flights of the planted firmwares, which are programs of their own and know the wire by its bytes alone."""

import dataclasses
import subprocess
import sys
from pathlib import Path

import pytest

from sim.bench.processes import hub_of
from sim.flight.fsw_answers import Patience
from sim.flight.node_command import NodeCommand
from sim.judge.flight import SoftwareUnderTest, fly_and_judge
from sim.judge.profile import Profile
from sim.record.pace import parse_pace
from sim.scenario.schema import load

FIRMWARE = Path(__file__).with_name("firmware.py")
TUMBLER = str(Path(__file__).with_name("tumbler.toml"))


def under_test(mistake="", profile=Profile.DETUMBLE, pace="lockstep", answer_s=20.0, boot_s=30.0):
    command = NodeCommand((sys.executable, str(FIRMWARE), "{port}", *filter(None, [mistake])))
    return SoftwareUnderTest(command, "loop", profile, parse_pace(pace), Patience(boot_s, answer_s, answer_s))


@pytest.fixture
def flown(tmp_path, monkeypatch):
    """A judged flight of the firmware with a mistake, of ``tumbler`` with settings."""

    def fly(mistake="", orbits=None, hang_s="0", patience_s="", settings=None, **options):
        monkeypatch.setenv("HANG_S", hang_s)
        monkeypatch.setenv("PATIENCE_S", patience_s)
        scenario = load(TUMBLER, settings or {})
        return fly_and_judge(under_test(mistake, **options), scenario, 1, tmp_path / "run", orbits)

    return fly


@pytest.fixture
def firmware():
    """The firmware with a mistake, as it is judged."""
    return under_test


@pytest.fixture
def running():
    """The firmware with a mistake, which runs already, on a loop bus that another process serves."""
    with hub_of("loop") as (spec, _):
        started = []

        def run(mistake=""):
            port = spec.partition(":")[2]
            started.append(subprocess.Popen([sys.executable, str(FIRMWARE), port, *filter(None, [mistake])]))
            return dataclasses.replace(under_test(mistake), command=None, bus=spec)

        yield run
        for process in started:
            process.kill()
            process.wait()
