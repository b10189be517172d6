"""``torquer.scenario`` and ``torquer.scenarios``: scenarios as objects, and as the files they are of."""

import numpy as np
import pytest
from pydantic import ValidationError

import torquer
from sim.scenario.schema import load


@pytest.fixture(scope="module")
def microsat():
    return torquer.scenario("microsat")


def test_those_that_ship_are_those_that_the_command_lists(command):
    found = torquer.scenarios()
    assert list(found) == [line.split()[0] for line in command("scenarios").stdout.splitlines()]
    assert all(scenario.name == name for name, scenario in found.items())
    assert found["microsat"] == torquer.scenario("microsat")


def test_its_values_are_attributes(microsat):
    assert microsat.body.inertia_kgm2 == load("microsat").body.inertia_kgm2
    assert repr(microsat) == "<TypedScenario microsat>"
    with pytest.raises(ValidationError, match="frozen"):
        microsat.time.tick_hz = 10


@pytest.mark.parametrize(
    ("settings", "sections"),
    [
        (None, {"initial": {"angle_deg": 4.0}, "coils": {"backoff": "per_coil"}}),
        ({"initial.angle_deg": np.float64(4.0), "coils.backoff": "per_coil"}, {}),
        ({"initial.angle_deg": 4.0}, {"coils": {"backoff": "per_coil"}}),
    ],
)
def test_a_changed_copy_is_what_settings_make(microsat, settings, sections):
    changed = microsat.changed(settings, **sections)
    assert (changed.initial.angle_deg, changed.coils.backoff) == (4.0, "per_coil")
    assert changed == torquer.scenario(
        "microsat", set={"initial": {"angle_deg": 4.0}, "coils": {"backoff": "per_coil"}}
    )
    assert microsat == torquer.scenario("microsat"), "the scenario itself is what it was"


def test_a_section_of_another_scenario_may_be_given(microsat):
    other = torquer.scenario("realsat")
    assert microsat.changed(disturbance=other.disturbance).disturbance == other.disturbance


def test_an_orbit_takes_the_place_of_elements(microsat):
    assert microsat.orbit.tle is not None
    assert microsat.changed(orbit={"altitude_km": 500.0}).orbit.tle is None


def test_its_file_is_read_as_it_and_not_overwritten(microsat, tmp_path):
    changed = microsat.changed(name="mine", time={"tick_hz": 2})
    file = changed.write(tmp_path / "mine.toml")
    assert torquer.scenario(file) == changed
    assert file.read_text() == f"{changed}\n"
    with pytest.raises(torquer.InputError, match="exists, and is not overwritten"):
        microsat.write(file)
    assert torquer.scenario(file) == changed
    microsat.write(file, force=True)
    assert torquer.scenario(file) == microsat


def test_functions_take_it_as_they_take_its_name(microsat, tmp_path):
    assert torquer.size(microsat).values == torquer.size("microsat").values
    run = torquer.fly(microsat.changed(time={"orbits": 0.002}), out=tmp_path / "run")
    assert run.scenario == microsat.changed(time={"orbits": 0.002})
    assert run.scenario.changed(time={"orbits": 10.0}) == microsat
    given = torquer.design(microsat, gains=(6.27e6, 1615.0))
    assert given.values == torquer.design("microsat", gains=(6.27e6, 1615.0)).values


@pytest.mark.parametrize(
    "wrong", [{"time.tick_hz": 0}, {"initial.angel_deg": 4.0}, {"nothing": 1}, {"body.inertia_kgm2": "heavy"}]
)
def test_a_wrong_value_is_the_sentence_of_a_file(microsat, wrong):
    with pytest.raises(torquer.InputError) as of_file:
        torquer.scenario("microsat", set=wrong)
    with pytest.raises(torquer.InputError) as of_object:
        microsat.changed(wrong)
    assert str(of_object.value) == str(of_file.value)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda one: torquer.scenario("nosat"), "there is no scenario 'nosat'"),
        (lambda one: one.changed(3), "give a dictionary"),
        (lambda one: one.write("mine.txt"), "a scenario's file ends in .toml"),
        (lambda one: one.write(3), "give a path or a name"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(microsat, call, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError, match=sentence):
        call(microsat)
    assert not list(tmp_path.iterdir())
