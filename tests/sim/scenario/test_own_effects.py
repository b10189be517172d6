"""User effects in a scenario: named with their digest, loaded, replayed on demand."""

from hashlib import sha256

import pytest

import torquer
from fsw.input.schema import TableError
from sim.record.truth import read_truth
from sim.scenario.assemble import effects_of
from sim.scenario.own_effects import own_effects
from sim.scenario.schema import load, shipped

CODE = """
from dataclasses import dataclass
from fsw.input.quantities import quantity

open(__file__ + ".trace", "a").close()

@dataclass(frozen=True)
class GasLeak:
    torque_nm: float = quantity(1e-7, "N m", least=0.0, most=1e-3)

    def torque_body_nm(self, moment):
        return (0.0, self.torque_nm, 0.0)

class NoDataclass:
    pass

@dataclass(frozen=True)
class Idle:
    k: float = 1.0

@dataclass(frozen=True)
class Fails:
    def torque_body_nm(self, moment):
        return (1.0 / (5.0 - moment.t_s), 0.0, 0.0)

def function(moment):
    return None
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "leak.py").write_text(CODE)
    return tmp_path


def test_an_effect_that_is_laid_over_a_scenario_is_named_with_its_digest_too(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (entry,) = load("microsat", {"effect": [{"use": "leak.py:GasLeak"}]}).effect
    assert entry.use == f"{folder / 'leak.py'}:GasLeak"
    assert entry.sha256 == sha256(CODE.encode()).hexdigest()
    assert not (folder / "leak.py.trace").exists()
    with pytest.raises(TableError, match=r"none\.py"):
        load("microsat", {"effect": [{"use": "none.py:GasLeak"}]})


@pytest.fixture
def scenario_with(folder):
    """A scenario file beside the code, with these effects: its path."""

    def write(*entries):
        text = "".join(
            f"\n[[effect]]\nuse = {use!r}\nparameters = {{ {', '.join(parameters)} }}\n"
            for use, *parameters in entries
        )
        path = folder / "mine.toml"
        path.write_text(MICROSAT + text)
        return str(path)

    return write


MICROSAT = """
name = "mine"
summary = "with effects"
time = { tick_hz = 1, orbits = 0.005 }
orbit = { altitude_km = 800.0, inclination_deg = 98.6 }
body.inertia_kgm2 = [1.02, 1.85, 1.95]
coils = { dipole_per_ampere_am2 = 11.0, levels_am2 = [0.5, 2.0, 8.0] }
sensors.sun = { fov_half_deg = 60.0, boresights = [[1.0, 0.0, 0.0]] }
control = { law = "pd", k_w = 6e6, k_a = 1600.0, leak_s = 300.0 }
"""


def test_shipped_scenarios_have_none():
    assert {scenario.effect for scenario in shipped()} == {None}


def test_loading_names_it_and_executes_nothing(folder, scenario_with, monkeypatch):
    path = scenario_with(("leak.py:GasLeak", "torque_nm = 2e-7"))
    monkeypatch.chdir("/")
    (effect,) = load(path).effect
    assert effect.use == f"{folder / 'leak.py'}:GasLeak"
    assert len(effect.sha256) == 64
    assert not (folder / "leak.py.trace").exists()


def test_each_has_a_name_in_the_histories(scenario_with):
    effects = own_effects(load(scenario_with(("leak.py:GasLeak",), ("leak.py:GasLeak",))).effect)
    assert effects.torque_sources == ("own_0_gas_leak", "own_1_gas_leak")


@pytest.mark.parametrize(
    ("entry", "what"),
    [
        (("none.py:GasLeak",), r"none\.py: cannot be read"),
        (("nobody",), "effect: 'nobody' is neither FILE.py:NAME nor the entry point"),
        (("leak.py:Missing",), "there is no Missing in it"),
        (("leak.py:NoDataclass",), "is no effect: not a frozen dataclass"),
        (("leak.py:function",), "is no effect: not a frozen dataclass"),
        (("leak.py:Idle",), "is no effect: it has none of torque_body_nm, field_body_t, sun_body"),
        (
            ("leak.py:GasLeak", "torque_nm = 1.0"),
            r"effect\.0\.parameters\.torque_nm = 1\.0 .* at most 0\.001 N m",
        ),
        (("leak.py:GasLeak", "force_n = 1.0"), r"effect\.0\.parameters\.force_n is not a known key"),
    ],
)
def test_what_is_wrong_is_one_sentence(scenario_with, entry, what):
    with pytest.raises(TableError, match=what):
        own_effects(load(scenario_with(entry)).effect)


def test_another_source_than_that_of_the_scenario_is_not_executed(folder, scenario_with):
    scenario = load(scenario_with(("leak.py:GasLeak",)))
    (folder / "leak.py").write_text(CODE + "\n")
    with pytest.raises(TableError, match="its source has the SHA-256"):
        own_effects(scenario.effect)
    assert not (folder / "leak.py.trace").exists()


@pytest.mark.long
def test_it_flies_and_its_run_is_replayed_through_the_plant_only_on_demand(folder, scenario_with):
    run = torquer.fly(scenario_with(("leak.py:GasLeak", "torque_nm = 2e-6")), out=folder / "run")
    assert run.ok
    assert set(read_truth(run.path / "truth.h5")["torque_body_nm/own_0_gas_leak"][:, 1]) == {2e-6}
    (folder / "leak.py.trace").unlink()
    assert torquer.replay(run.path).ok
    with pytest.raises(torquer.InputError, match=r"user effects \(GasLeak of leak\.py\): --effects"):
        torquer.replay(run.path, plant=True)
    assert not (folder / "leak.py.trace").exists()
    assert torquer.replay(run.path, plant=True, effects=True).ok


def test_one_that_fails_ends_the_flight_with_a_sentence(folder, scenario_with):
    with pytest.raises(torquer.Error, match=r"the effect Fails of leak\.py, 5 s: it fails: Zero"):
        torquer.fly(scenario_with(("leak.py:Fails",)), out=folder / "run")


BENT = """
from dataclasses import dataclass

@dataclass(frozen=True)
class Bent:
    def sun_body(self, sun_body, moment):
        return sun_body
"""


def test_what_acts_on_the_sun_sensor_is_refused_where_there_are_cells(folder):
    (folder / "bent.py").write_text(BENT)
    bent = {"effect": [{"use": f"{folder / 'bent.py'}:Bent"}]}
    assert effects_of(load("microsat", bent)).any
    with pytest.raises(
        TableError, match=r"bent\.py:Bent: its sun_body acts on the Sun sensor, in whose place"
    ):
        effects_of(load("cubesat-cells", bent))
    leak = {"effect": [{"use": f"{folder / 'leak.py'}:GasLeak"}]}
    assert effects_of(load("cubesat-cells", leak)).any
