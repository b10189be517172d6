"""``torquer.size`` and ``torquer.new``: what the commands print and write, for programs."""

import json

import numpy as np
import pytest

import torquer

BODY = {"altitude_km": 550.0, "inclination_deg": 97.6, "inertia_kgm2": (0.04, 0.035, 0.008)}


def test_sizing_says_what_the_command_prints(command):
    found = torquer.size("cubesat3u", set={"coils.backoff": "per_coil"})
    words = ("size", "cubesat3u", "--set", "coils.backoff=per_coil")
    assert str(found) + "\n" == command(*words).stdout
    assert found.ok
    printed = json.loads(command(*words, "--json").stdout)
    assert printed | json.loads(json.dumps(found.values)) == printed
    assert repr(found) == f"<Sizing of cubesat3u: pointing {found.pointing_deg:.2f} deg>"


def test_a_body_that_gravity_turns_over_has_no_pointing_to_rely_on():
    found = torquer.size("cubesat3u", set={"body.inertia_kgm2": [0.04, 0.04, 0.008]})
    assert (found.pointing_deg, found.ok) == (None, True)
    assert "body.up = 'z'" in str(found)


def test_coils_that_cannot_balance_are_not_ok():
    assert not torquer.size("cubesat3u", set={"disturbance.torque_nm": [1e-7, 0.0, 0.0]}).ok


def test_a_new_scenario_is_in_its_file_and_can_be_flown(tmp_path):
    mine = torquer.new("mine", out=tmp_path / "mine.toml", axes="z y x", **BODY)
    assert mine.scenario.body.inertia_kgm2 == (0.04, 0.035, 0.008)
    assert (mine.scenario.body.up, mine.scenario.body.ahead) == ("z", "y")
    assert mine.path == tmp_path / "mine.toml"
    assert torquer.size(mine).found.values["scenario"] == "mine"
    run = torquer.fly(mine, orbits=0.002, out=tmp_path / "run")
    assert run.scenario == mine.scenario


def test_what_is_most_likely_wrong_is_said(tmp_path):
    turned = torquer.new("turned", out=tmp_path / "turned.toml", **BODY)
    assert any("gravity turns the body over" in doubt for doubt in turned.warnings)


def test_numbers_of_numpy_and_names_are_taken(tmp_path):
    body = BODY | {"inertia_kgm2": np.array(BODY["inertia_kgm2"][::-1]), "altitude_km": np.float64(500.0)}
    coils = {"driver": "continuous", "dipole_am2": 0.2, "sun": "cells"}
    found = torquer.new("mine", out=tmp_path / "mine.toml", **body, **coils).scenario
    assert (found.coils.driver, found.coils.max_dipole_am2) == ("continuous", 0.2)
    assert found.sensors.cells is not None


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"driver": "pulse"}, "new: driver"),
        ({"altitude_km": "high"}, "new: altitude_km"),
        ({"altitude_km": None}, "give --tle FILE, or --altitude-km"),
        ({"levels_am2": (0.2, 0.2, 0.2)}, "three equal levels are one"),
        ({"axes": "z z x"}, "--axes: 'z z x' is not allowed"),
        ({"axes": "z x"}, "new: axes"),
        ({"inertia_kgm2": (1.0, 1.0, 3.0)}, "no principal moment above"),
    ],
)
def test_a_wrong_argument_is_one_sentence_and_writes_nothing(changed, sentence, tmp_path):
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.new("mine", out=tmp_path / "mine.toml", **(BODY | changed))
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(tmp_path):
    torquer.new("mine", out=tmp_path / "mine.toml", **BODY)
    with pytest.raises(torquer.InputError, match="exists, and is not overwritten"):
        torquer.new("mine", out=tmp_path / "mine.toml", **BODY)
