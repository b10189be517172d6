"""``torquer.design``: gains and exponents as the command gives them."""

import json
from importlib import resources

import pytest

import torquer
from sim.design import command as command_of_design

pytestmark = pytest.mark.long

GAINS = (2e4, 10.0)


@pytest.fixture(scope="module")
def judged():
    return torquer.design("microsat", gains=GAINS)


@pytest.fixture
def no_search(judged, monkeypatch):
    """The analysis is already done."""
    monkeypatch.setattr(command_of_design, "analyse", lambda *of_what: judged.found.analysis)


@pytest.mark.usefixtures("no_search")
def test_it_says_what_the_command_prints(judged, command):
    words = ("design", "microsat", "--gains", *GAINS, "--json")
    done = command(*words)
    assert done.exit_code == 0
    values, printed = json.loads(json.dumps(judged.values)), json.loads(done.stdout)
    assert {key: printed[key] for key in values} == values
    assert judged.gains == {"k_w": 2e4, "k_a": 10.0}
    assert judged.degree_of_stability == pytest.approx(max(judged.exponents))
    assert judged.ok
    assert str(judged).startswith("microsat: J ")
    assert judged.pictures == ()


@pytest.mark.usefixtures("no_search")
def test_gains_are_written_into_a_file_alone(tmp_path):
    shipped = resources.files("sim.scenario.shipped").joinpath("microsat.toml").read_text()
    path = tmp_path / "own.toml"
    path.write_text(shipped)
    found = torquer.design(path, gains=GAINS, write=True)
    assert found.written == path
    assert torquer.design(path, gains=GAINS).written is None
    assert "k_w = 20000" in path.read_text()
    for scenario in ("microsat", torquer.scenarios()["microsat"]):
        with pytest.raises(torquer.InputError, match="write"):
            torquer.design(scenario, gains=GAINS, write=True)


@pytest.mark.parametrize("gains", [3, (1.0,), (-1.0, 1.0), ("a", 1.0), (1.0, 2.0, 3.0)])
def test_gains_that_are_none_are_wrong_input(gains):
    with pytest.raises(torquer.InputError, match="gains"):
        torquer.design("microsat", gains=gains)
