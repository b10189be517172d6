"""``law=`` of the functions: from the script that runs, as a function, as a ControlLaw."""

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import pytest

import torquer
from fsw.core.algebra.vector import cross, scale
from fsw.own_law import ControlLaw, Demand, quantity
from sim.report import follow
from sim.report.tables import scenario_in_words

ORBITS = 0.04
SETTINGS = {"flight.modes": {"settle_s": 20.0, "slow_degps": 2.0, "fast_degps": 4.0}}
"""It points after 20 s, so that the law is asked."""


@dataclass(frozen=True)
class Gains:
    """Of the law."""

    damping_nms_per_t2: float = quantity(6e6, "N m s/T^2", least=0.0)


def idle(inputs, memory, setpoint, config):
    return Demand()


def turning(inputs, memory, setpoint, config):
    return Demand((1.0, 0.0, 0.0))


def fails(inputs, memory, setpoint, config):
    return Demand() if inputs.tick < 40 else 1 / 0


def point(inputs, memory, setpoint, config):
    if not inputs.attitude.usable:
        return Demand()
    rate = inputs.attitude.omega_body_orbit_radps
    return Demand(scale(config.gains[setpoint.law].damping_nms_per_t2, cross(rate, inputs.b_body_t)))


damp = ControlLaw(point, gains=Gains)


def dipole_along(axis):
    """A law that another call makes anew, under the same name."""

    def along(inputs, memory, setpoint, config):
        return Demand(tuple(float(axis == other) for other in range(3)))

    return along


def fly(law, out, **arguments):
    return torquer.fly("microsat", law=law, out=out, **{"orbits": ORBITS, "set": SETTINGS, **arguments})


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A run of ``idle``. For reading only."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim.report.conclude.write_report", lambda path, *rest: path.write_text(""))
        return fly(idle, tmp_path_factory.mktemp("laws") / "run")


# --- a function or a ControlLaw


@pytest.mark.long
def test_a_function_flies_and_its_run_says_what_it_was(flown):
    assert flown.ok
    control = flown.scenario.control
    assert control.law == f"object {__name__}:idle"
    assert control.law_name == "idle"
    given = {"module": __name__, "qualname": "idle", "source_sha256": control.law_sha256}
    assert flown.record["law_object"] == given
    assert len(control.law_sha256) == 64
    (note,) = flown.notes
    assert note.startswith("the law is idle of ")
    assert note.endswith(
        "given as an object: only whoever has it can replay the run, by torquer.load(RUN, law=IT)"
    )


@pytest.mark.long
def test_its_page_says_who_can_replay_it(flown):
    _, right = scenario_in_words(flown.scenario)
    assert ("Replay", "only by whoever has the law, which was given as an object") in right


@pytest.mark.long
def test_the_run_is_replayed_with_the_function(flown):
    assert flown.replay().ok
    assert torquer.load(flown.path, law=idle).replay().ok
    assert torquer.replay(flown.path, law=idle).ok
    assert torquer.replay(flown.path, plant=True).ok


@pytest.mark.long
@pytest.mark.parametrize(
    "again",
    [
        lambda path: torquer.load(path).replay(),
        torquer.replay,
        torquer.report,
        lambda path: torquer.replay(path, law=f"{__file__}:idle"),
        lambda path: torquer.replay(path, law=f"object {__name__}:idle"),
        lambda path: torquer.fly(path / "scenario.toml", orbits=ORBITS, out=path / "again"),
    ],
)
def test_without_it_nothing_is_replayed_and_one_sentence_says_who_can(flown, again):
    with pytest.raises(torquer.InputError, match=r"idle of .*test_laws") as caught:
        again(flown.path)
    assert "given as an object" in str(caught.value)
    assert "only whoever has it" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.long
def test_another_function_is_noted_by_a_replay_and_refused_by_a_report(flown):
    found = torquer.replay(flown.path, law=turning)
    assert not found.ok
    assert "is not the source that the run flew" in found.lines[0]
    with pytest.raises(torquer.InputError, match="is not the source that the run flew"):
        torquer.report(flown.path, law=turning)


SOURCE = """
from fsw.own_law import Demand

def law(inputs, memory, setpoint, config):
    return Demand((0.0, 0.0, {z}))
"""


@pytest.mark.long
def test_a_function_whose_source_has_changed_since(tmp_path, monkeypatch):
    def imported(z):
        (tmp_path / "changing_law.py").write_text(SOURCE.format(z=z))
        sys.modules.pop("changing_law", None)
        return __import__("changing_law").law

    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    run = fly(imported("0.0"), tmp_path / "run")
    with pytest.raises(torquer.InputError, match="is not the source that the run flew"):
        torquer.report(run.path, law=imported("1.000"))
    assert torquer.report(run.path, law=imported("0.0")).ok


@pytest.mark.long
def test_a_control_law_flies_under_the_name_that_it_is_bound_to(tmp_path):
    gains = {"control.gains.damp.damping_nms_per_t2": 3e6}
    run = fly(damp, tmp_path / "run", set={**SETTINGS, **gains})
    assert run.ok
    assert run.scenario.control.law == f"object {__name__}:damp"
    assert run.record["law_object"]["source_sha256"] is not None
    unbound = ControlLaw(point, gains=Gains)
    assert torquer.load(run.path, law=unbound).replay().ok
    assert torquer.report(run.path, law=damp).ok
    with pytest.raises(torquer.InputError, match="is not the source that the run flew"):
        torquer.report(run.path, law=ControlLaw(point))


@pytest.mark.long
def test_a_lambda_flies_without_a_digest(tmp_path):
    run = fly(lambda inputs, memory, setpoint, config: Demand(), tmp_path / "run")
    assert run.ok
    assert run.scenario.control.law_sha256 is None
    assert run.record["law_object"]["source_sha256"] is None
    assert run.replay().ok
    assert torquer.report(run.path, law=lambda *inputs: Demand()).ok
    with pytest.raises(torquer.InputError, match=r"without a digest.*only whoever has it"):
        torquer.replay(run.path)


@pytest.mark.long
def test_laws_of_one_name_that_fly_at_once_are_told_apart(tmp_path):
    with ThreadPoolExecutor(2) as threads:
        flights = [threads.submit(fly, dipole_along(axis), tmp_path / str(axis)) for axis in range(2)]
        runs = [flight.result() for flight in flights]
    assert all(run.replay().ok for run in runs)
    assert runs[0].log.read_bytes() != runs[1].log.read_bytes()
    assert not torquer.replay(runs[0].path, law=dipole_along(1)).ok


@pytest.mark.long
def test_a_function_that_fails_says_at_which_of_its_lines(tmp_path):
    run = fly(fails, tmp_path / "run")
    assert "it fails: line " in run.ended
    assert "ZeroDivisionError" in run.ended
    with pytest.raises(torquer.InputError, match=r"there is no summary\.json .*ZeroDivisionError"):
        run.summary  # noqa: B018  to be asked for is to fail


@pytest.mark.long
def test_what_a_long_flight_needs_no_other_process_for(tmp_path, monkeypatch):
    monkeypatch.setattr(follow, "LEAST_TICKS", 10)
    assert fly(idle, tmp_path / "run").ok


@pytest.mark.parametrize(
    ("law", "arguments", "says"),
    [
        (3, {}, "law = 3: give FILE.py:NAME, an installed law, a function or a ControlLaw"),
        (Gains, {}, "is the class Gains, not a law"),
        (lambda inputs: None, {}, "cannot be called as a law, with inputs, memory"),
        (ControlLaw(3), {}, "point is no function"),
        (idle, {"bus": "loop"}, r"flies in this process only: write it to a file, or use bus=.virtual."),
        ("object nothing:law", {}, "only whoever has it"),
    ],
)
def test_what_cannot_fly_is_one_sentence(law, arguments, says, tmp_path):
    with pytest.raises(torquer.InputError, match=says) as caught:
        fly(law, tmp_path / "run", **arguments)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "run").exists()


# --- the file that runs

HEAD = """
import torquer
from fsw.own_law import Demand

print("once", flush=True)
"""
LAW = """
def idle(inputs, memory, setpoint, config):
    return Demand()
"""
CALL = """
try:
    run = torquer.fly("microsat", orbits=0.005, law="rec.py:idle", out="run", bus={bus!r})
    print(run.ok, run.replay().ok)
except torquer.InputError as error:
    print(error)
"""
GUARD = '\nif __name__ == "__main__":'


def ran(folder, *parts, bus="virtual"):
    """What ``rec.py`` of these parts prints after "once"."""
    (folder / "rec.py").write_text("".join(parts).replace("{bus!r}", repr(bus)))
    done = subprocess.run([sys.executable, "rec.py"], cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    first, *others = done.stdout.splitlines()
    assert first == "once"
    return others


def guarded():
    return GUARD + CALL.replace("\n", "\n    ")


@pytest.mark.long
@pytest.mark.parametrize("call", [CALL, guarded()], ids=["unguarded", "guarded"])
def test_a_script_flies_its_own_law_and_is_executed_once(call, tmp_path):
    assert ran(tmp_path, HEAD, LAW, call) == ["True True"]
    assert "law_object" not in json.loads((tmp_path / "run" / "run.json").read_text())


@pytest.mark.long
def test_a_law_that_is_not_yet_defined_is_one_sentence(tmp_path):
    (said,) = ran(tmp_path, HEAD, CALL, LAW)
    assert "rec.py: there is no idle in it yet" in said
    assert 'define it above the call, or put the call under if __name__ == "__main__"' in said


@pytest.mark.long
@pytest.mark.slow
def test_two_processes_need_the_guard(tmp_path):
    (tmp_path / "rec.py").write_text(HEAD + LAW + 'torquer.fly("microsat", law="rec.py:idle", bus="loop")\n')
    done = subprocess.run(
        [sys.executable, "rec.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.stdout == "once\n" * 2  # also as a law, to see whether the other process can execute it
    assert 'flies nothing: put the call under if __name__ == "__main__"' in done.stderr.splitlines()[-1]
    assert not (tmp_path / "runs").exists()
    assert ran(tmp_path, HEAD, LAW, guarded(), bus="loop")[-1] == "True True"


@pytest.mark.long
def test_a_file_that_flies_while_it_is_loaded_as_a_law_is_one_sentence(tmp_path, command):
    (tmp_path / "rec.py").write_text(f'import torquer\ntorquer.fly("microsat", law={"rec.py:idle"!r})\n{LAW}')
    with pytest.raises(torquer.InputError) as caught:
        torquer.fly("microsat", law=f"{tmp_path / 'rec.py'}:idle", out=tmp_path / "run")
    said = "a file that is loaded for what it defines flies nothing"
    assert f"rec.py: line 2: InputError: torquer.fly: {said}" in str(caught.value)
    assert "\n" not in str(caught.value)
    done = command("sil", "microsat", "--law", f"{tmp_path / 'rec.py'}:idle", "--out", tmp_path / "run")
    assert (done.exit_code, said in done.output) == (2, True)
    assert not (tmp_path / "run").exists()
