"""Faults that a run is too short for."""

import pytest

from sim.faults.faulty_plant import FaultyPlant
from sim.faults.section import make_plant
from sim.flight.record_flight import ticks_of
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load
from sim.sizing.scenario_warnings import scenario_warnings, unbegun_faults

TIMES_S = (0.0, 3.3, 4.0, 4.01, 1e9)


def scenario_with(*times_s, tick_hz=1):
    faults = [{"at_s": at_s, "kind": "mag_frozen"} for at_s in times_s]
    return load("microsat", {"fault": faults, "time": {"tick_hz": tick_hz}})


@pytest.mark.parametrize("tick_hz", [1, 3])
@pytest.mark.parametrize("seconds", [1, 4, 5])
def test_it_names_those_that_begin_in_no_tick_of_the_run(tick_hz, seconds):
    scenario, ticks = scenario_with(*TIMES_S, tick_hz=tick_hz), seconds * tick_hz
    plant = make_plant(plant_config(scenario, 1), scenario.fault)
    assert isinstance(plant, FaultyPlant)
    for _ in range(ticks):
        plant.begin_tick()
        plant.end_tick()
    unbegun = [sentence.partition(",")[0] for sentence in unbegun_faults(scenario, ticks)]
    assert unbegun == [f"fault[{place}]" for place in range(len(plant.active), len(TIMES_S))]


def test_it_says_when_the_run_ends():
    (sentence,) = unbegun_faults(scenario_with(12.0, 600.0), 500)
    assert sentence == "fault[1], mag_frozen at 600 s, will not begin: the last tick is at 499 s"


def test_a_scenario_that_is_shorter_than_its_faults_is_doubted():
    ticks = ticks_of(scenario_with(), None)
    assert scenario_warnings(scenario_with(ticks - 1.0)) == []
    (doubt,) = scenario_warnings(scenario_with(float(ticks)))
    assert doubt.startswith("fault[0], mag_frozen at ")
