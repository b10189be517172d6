"""``torquer.phasing``: the verdict on the wiring, for programs."""

import json

import pytest

import torquer

REVERSED = {"coils.wiring": [1, -2, 3]}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return tmp_path_factory.mktemp("phasing") / "run"


@pytest.fixture(scope="module")
def told(run):
    return torquer.phasing("microsat", set=REVERSED, out=run)


@pytest.mark.long
@pytest.mark.slow
def test_it_is_what_the_command_prints(told, command):
    result = command("phasing", "microsat", "--set", "coils.wiring=[1,-2,3]")
    assert result.stdout == f"{told}\n"
    assert (result.exit_code, told.ok) == (1, False)


@pytest.mark.long
def test_a_reversed_coil_is_told(told):
    assert told.pairs == (((1, 2, 3), (1, -2, 3)),)
    assert "coil 2 is reversed" in told.verdict
    assert repr(told) == "<WiringVerdict: not ok>"


@pytest.mark.long
@pytest.mark.slow
def test_the_log_of_a_run_tells_the_same_as_its_flight(told, run, command):
    printed = json.loads(command("phasing", run, "--json").stdout)
    assert printed | json.loads(json.dumps(told.values)) == printed


@pytest.mark.long
@pytest.mark.slow
def test_a_scenario_as_an_object_may_be_given():
    assert torquer.phasing(torquer.scenarios()["microsat"]).ok


@pytest.mark.parametrize(
    ("source", "given", "sentence"),
    [
        ("microsat", {"real": ["coil"], "arm": True}, "--real, --arm: without --bus the SCENARIO is flown"),
        ("microsat", {"scenario": "microsat"}, "--scenario: microsat is no log, but a scenario itself"),
        ("microsat", {"bus": "loop"}, "phasing drives coils: allow it by --arm"),
        ("microsat", {"rounds": 0}, "phasing: rounds"),
        ("microsat", {"set": {"coils.driver": "continuous", "coils.max_dipole_am2": 5.0}}, "pulsed coils"),
        ("bench.csv", {"seed": 0, "at_rest": True}, "--at-rest, --seed: bench.csv is a recorded bench log"),
        ("bench.csv", {}, "bench.csv: cannot be read"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(source, given, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.phasing(source, **given)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
