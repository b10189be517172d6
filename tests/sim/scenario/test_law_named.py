"""A run's own law is executed only where it is named again: reading a run executes no code of others."""

import shutil

import pytest

import torquer
from fsw.input.schema import TableError, merge
from fsw.table.config import flight_config
from fsw.table.own_law import LawError
from sim.errors import HarnessError
from sim.flight import virtual
from sim.flight.record_flight import check_can_fly
from sim.record import run_dir
from sim.record.pace import Pace
from sim.replay import command
from sim.report.conclude import conclude
from sim.scenario.law_named import with_law_named
from sim.scenario.schema import flight_table, load

TICKS = 260

LAW = """
from dataclasses import dataclass
from fsw.core.algebra.vector import cross, scale
from fsw.own_law import ControlLaw, Demand, quantity

open(__file__ + ".trace", "a").close()

@dataclass(frozen=True)
class Gains:
    damping_nms_per_t2: float = quantity(6e6, "N m s/T^2", least=0.0)

def point(inputs, memory, setpoint, config):
    if not inputs.attitude.valid:
        return Demand()
    rate = inputs.attitude.omega_body_orbit_radps
    return Demand(scale(config.gains[setpoint.law].damping_nms_per_t2, cross(rate, inputs.b_body_t)))

damp = ControlLaw(point, gains=Gains)

def fails(inputs, memory, setpoint, config):
    return Demand() if inputs.tick < 230 else None
"""
SETTINGS = {"flight": {"modes": {"settle_s": 20.0, "slow_degps": 2.0, "fast_degps": 4.0}}}


def fly(folder, name="damp", **control):
    """Fly the law in a folder; its run is in the folder too."""
    (folder / "law.py").write_text(LAW)
    own = {"control": {"law": f"{folder / 'law.py'}:{name}", **control}}
    scenario = load("microsat", merge(SETTINGS, own))
    run_dir.begin(folder / "run", scenario, 5, TICKS, "virtual", Pace())
    virtual.fly_virtual(folder / "run", scenario, lambda tick: None)
    (folder / "law.py.trace").unlink()
    return folder / "run"


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """The folder of a law, with its run."""
    folder = tmp_path_factory.mktemp("flown")
    fly(folder, gains={"damp": {"damping_nms_per_t2": 7e6}})
    return folder


@pytest.fixture
def theirs(flown, tmp_path):
    """A copy that a test may change."""
    return shutil.copytree(flown, tmp_path / "theirs")


def replay(run, law):
    log, logged = command.locate(run, None, {}, law=law)
    return command.through_flight_software(log, logged)


def test_the_run_keeps_reference_digest_and_gains(flown):
    control = run_dir.read_scenario(flown / "run").control
    assert control.law == f"{flown / 'law.py'}:damp"
    assert len(control.law_sha256) == 64
    assert control.gains == {"damp": {"damping_nms_per_t2": 7e6}}


def test_a_replay_of_the_named_law_is_bit_exact_wherever_it_is(theirs, flown):
    (flown / "law.py").rename(flown / "away.py")
    try:
        found = replay(theirs / "run", f"{theirs / 'law.py'}:damp")
    finally:
        (flown / "away.py").rename(flown / "law.py")
    assert found.ok
    assert str(found).startswith(f"bit-exact: {TICKS} ticks")


@pytest.mark.parametrize("what", [replay, lambda run, law: conclude(run, law=law)])
def test_without_its_name_no_code_is_executed(flown, what):
    with pytest.raises(HarnessError, match=r"only where it is named again: --law .*law\.py:damp") as caught:
        what(flown / "run", None)
    assert caught.value.exit_code == 2
    assert not (flown / "law.py.trace").exists()


def test_no_flight_software_can_be_made_of_the_scenario_of_a_run(flown):
    for scenario in (run_dir.read_scenario(flown / "run"), torquer.load(flown / "run").scenario):
        with pytest.raises(TableError, match="only where it is named again"):
            flight_config(flight_table(scenario))
    assert not (flown / "law.py.trace").exists()


def test_a_program_names_it_again(flown):
    with pytest.raises(torquer.InputError, match="only where it is named again"):
        torquer.load(flown / "run").replay()
    assert torquer.load(flown / "run", law=f"{flown / 'law.py'}:damp").replay().ok
    (flown / "law.py.trace").unlink()


def test_what_needs_no_law_goes_without(flown):
    log, logged = command.locate(flown / "run", None, {})
    assert command.through_plant(log, logged).ok
    assert not (flown / "law.py.trace").exists()


def test_a_replay_by_another_source_says_so_with_both_digests(theirs):
    before = run_dir.read_scenario(theirs / "run").control.law_sha256
    (theirs / "law.py").write_text(LAW.replace("scale(config", "scale(-config"))
    found = replay(theirs / "run", f"{theirs / 'law.py'}:damp")
    assert not found.ok
    note = found.lines[0]
    assert note.startswith("note: ")
    assert "is not the source that the run flew" in note
    assert before[:16] in note
    assert len(note.split("...")) == 3
    assert "first command that differs: tick" in str(found)


def test_a_report_by_another_source_is_refused(theirs):
    (theirs / "law.py").write_text(LAW + "\n")
    with pytest.raises(HarnessError, match="is not the source that the run flew") as caught:
        conclude(theirs / "run", law=f"{theirs / 'law.py'}:damp")
    assert caught.value.exit_code == 2
    assert not (theirs / "law.py.trace").exists()


@pytest.mark.long
def test_a_report_by_the_named_source(theirs):
    summary = conclude(theirs / "run", law=f"{theirs / 'law.py'}:damp")
    assert summary["replay"]["bit_exact"]
    assert "damp of law.py" in (theirs / "run" / run_dir.REPORT).read_text()


@pytest.mark.parametrize(
    ("law", "what"),
    [("law.py:fails", "the run flew another law"), ("nobody", "neither FILE.py:NAME nor an installed law")],
)
def test_another_law_than_that_of_the_run(flown, monkeypatch, law, what):
    monkeypatch.chdir(flown)
    with pytest.raises(HarnessError, match=what):
        with_law_named(run_dir.read_scenario(flown / "run"), law)


def test_a_law_named_for_a_run_of_the_table(flown):
    with pytest.raises(HarnessError, match="the run flew 'mpc', a law of the table"):
        with_law_named(load("microsat"), f"{flown / 'law.py'}:damp")


def test_a_law_of_the_onboard_table_alone_is_asked_for_too(flown):
    law = f"{flown / 'law.py'}:damp"
    scenario = load("microsat", {"flight": {"control": {"law": law}}})
    assert scenario.own_law == law
    assert not scenario.control.own
    with pytest.raises(HarnessError, match="--law"):
        with_law_named(scenario, None)
    assert with_law_named(scenario, law) == (scenario, "")


@pytest.mark.long
def test_a_law_that_fails_ends_the_flight_and_run_json_says_why(tmp_path):
    with pytest.raises(LawError, match=r"the law fails of law\.py, tick 230: it returns nothing"):
        fly(tmp_path, "fails")
    run = run_dir.read_run(tmp_path / "run")
    assert run["ended"].startswith("the law fails of law.py, tick 230")
    assert not run["complete"]
    summary = conclude(tmp_path / "run", law=f"{tmp_path / 'law.py'}:fails")
    assert "tick 230: it returns nothing" in summary["failures"]["complete"]


def test_loading_a_scenario_executes_nothing_and_preparing_its_flight_does(tmp_path):
    (tmp_path / "law.py").write_text(LAW)
    scenario = load("microsat", {"control": {"law": f"{tmp_path / 'law.py'}:damp"}})
    assert not (tmp_path / "law.py.trace").exists()
    check_can_fly(scenario, 1)
    assert (tmp_path / "law.py.trace").exists()
