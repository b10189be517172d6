"""Golden logs: what the flight software answered when they were recorded, it answers today.

Commands are the same on every machine; every bit is the same where the platform is that of the recording.
Only ``make golden`` changes the logs.
"""

import gzip
import json
import runpy
import tomllib
from pathlib import Path

import pytest

from fsw.table.config import flight_config
from fsw.wire.messages import CoilFire, FswEvent
from sim.record import run_dir
from sim.record.candump import read_log
from sim.replay.log_replay import replay
from sim.scenario.schema import flight_table, load

HERE = Path(__file__).resolve().parent
FLIGHTS = runpy.run_path(str(HERE / "record.py"))["FLIGHTS"]
NAMES = sorted(path.parent.name for path in HERE.glob("*/bus.log.gz"))


@pytest.fixture(params=NAMES)
def golden(request, tmp_path):
    """A run directory unpacked from a golden log."""
    folder = HERE / request.param
    (tmp_path / run_dir.BUS_LOG).write_bytes(gzip.decompress((folder / "bus.log.gz").read_bytes()))
    for name in (run_dir.SCENARIO, "platform.json"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    return tmp_path


@pytest.fixture
def shown(golden):
    scenario = load(str(golden / run_dir.SCENARIO))
    return replay(golden / run_dir.BUS_LOG, flight_config(flight_table(scenario)))


def test_there_are_logs():
    assert len(NAMES) >= 4


@pytest.mark.long
def test_commands_are_those_recorded(shown):
    assert shown.ended
    assert shown.first_command_difference is None


def test_every_bit_is_as_recorded_on_the_same_platform(golden, shown):
    recorded_on = json.loads((golden / "platform.json").read_text())
    if recorded_on == run_dir.fingerprint():
        assert shown.first_bit_difference is None
    else:
        assert shown.command_exact


@pytest.mark.long
def test_the_filter_by_filterpy_gives_the_same_commands(golden):
    scenario = load(str(golden / run_dir.SCENARIO), {"flight": {"estimator": {"algebra": "filterpy"}}})
    shown = replay(golden / run_dir.BUS_LOG, flight_config(flight_table(scenario)))
    assert shown.ended
    assert shown.first_command_difference is None


def leaves(values, path=""):
    """Every value of nested tables by its full key."""
    if not isinstance(values, dict):
        return {path: values}
    return {key: leaf for name in values for key, leaf in leaves(values[name], f"{path}.{name}").items()}


@pytest.mark.parametrize("name", NAMES)
def test_they_fly_what_ships_today(name):
    """Where a scenario has been changed on purpose: make golden."""
    scenario, _, overrides = FLIGHTS[name]
    today = leaves(load(scenario, overrides).model_dump(mode="json", exclude_none=True))
    recorded = leaves(tomllib.loads((HERE / name / run_dir.SCENARIO).read_text()))
    keys = sorted(today.keys() | recorded.keys())
    assert [(k, recorded.get(k), today.get(k)) for k in keys if recorded.get(k) != today.get(k)] == []


def test_something_happens_in_them(golden):
    """A log without a pulse and a change of mode would show little."""
    ids = [entry.frame.can_id for entry in read_log(golden / run_dir.BUS_LOG)]
    assert ids.count(CoilFire.ID) >= 2
    assert ids.count(FswEvent.ID) >= 2
