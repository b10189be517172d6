"""``[[fault]]`` in a scenario."""

from random import Random

import pytest

from fsw.input.schema import TableError
from fsw.wire.messages import MagField
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.faults.kinds import KINDS, make
from sim.faults.section import break_frames, forge_answers, forge_sync, make_plant
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load


def scenario(**fault):
    return load("microsat", {"fault": [fault]})


def field_nt(frames):
    return next(MagField.decode(frame.data) for frame in frames if frame.can_id == MagField.ID)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ({"kind": "gremlins", "at_s": 1.0}, "fault.0: kind 'gremlins' is none of .*loss"),
        ({"kind": "killed", "at_s": 1.0}, "fault.0: kind 'killed' is none of"),
        ({"kind": "loss", "at_s": -1.0}, "fault.0.at_s"),
        ({"kind": "loss"}, "fault.0.at_s"),
        ({"kind": "loss", "at_s": 1.0, "lasts_s": 0.0}, "fault.0.lasts_s"),
        ({"kind": "loss", "at_s": 1.0, "parameters": {"part": 1.1}}, "part = 1.1 is outside 0 to 1"),
        (
            {"kind": "loss", "at_s": 1.0, "parameters": {"parts": 0.1}},
            r"no such parameter \(did you mean 'part'\?\), but part",
        ),
        ({"kind": "loss", "at_s": 1.0, "often": True}, "fault.0.often"),
        ({"kind": "mag_late", "at_s": 1.0, "parameters": {"ticks": 0.0}}, "ticks = 0 is outside 1 to 1000"),
        ({"kind": "sun_turned", "at_s": 1.0, "parameters": {"nt": 1.0}}, "sun_turned has no such parameter"),
        ({"kind": "mag_frozen", "at_s": 1.0, "parameters": {"per_s": 1.0}}, "no such parameter, but none"),
    ],
)
def test_what_makes_no_sense_is_a_sentence(fault, said):
    with pytest.raises(TableError, match=said):
        scenario(**fault)


SUN_KINDS = [name for name, kind in KINDS.items() if kind.sensor == "sun"]
CELL_KINDS = [name for name, kind in KINDS.items() if kind.sensor == "cells"]


@pytest.mark.parametrize(
    ("flown", "kinds", "said"),
    [
        ("microsat", CELL_KINDS, "acts on Sun cells, and there is no sensors.cells"),
        ("cubesat-cells", SUN_KINDS, "acts on the Sun sensor, in whose place there is sensors.cells"),
    ],
)
def test_a_fault_of_what_the_satellite_does_not_have_is_refused(flown, kinds, said):
    for kind in kinds:
        faults = [{"kind": "mag_frozen", "at_s": 1.0}, {"kind": kind, "at_s": 1.0}]
        with pytest.raises(TableError, match=rf"fault\[1\]\.kind = '{kind}' {said}"):
            load(flown, {"fault": faults})


def test_a_fault_of_a_cell_that_is_not_there_is_refused():
    cells = load("cubesat-cells").sensors.cells.model_dump(mode="json", exclude_none=True)
    five = {key: value[:5] if isinstance(value, list) else value for key, value in cells.items()}
    for cell in (5.0, 6.0):
        fault = {"kind": "cell_dead", "at_s": 1.0, "parameters": {"cell": cell}}
        values = {"fault": [fault], "sensors": {"cells": five}}
        if cell == 5.0:
            assert load("cubesat-cells", values).fault
            continue
        with pytest.raises(TableError, match=r"fault\[0\]\.parameters\.cell = 6 is none of the 5"):
            load("cubesat-cells", values)


@pytest.mark.parametrize("name", ["microsat", "cubesat-cells"])
@pytest.mark.parametrize("kind", [name for name, kind in KINDS.items() if kind.sensor])
def test_of_the_kinds_of_sun_sensing_those_of_its_own_change_what_its_board_sends(name, kind):
    chosen = load(name)
    plant = Plant(plant_config(chosen, 1))
    fault = make(kind, {"ticks": 1.0} if "late" in kind else {}, Random(1))
    changed = FaultyPlant(plant_config(chosen, 1), [ScheduledFault(fault, 0)])
    acts = False
    for _ in range(3):
        acts |= plant.begin_tick() != changed.begin_tick()
        plant.end_tick()
        changed.end_tick()
    assert acts is (KINDS[kind].sensor == ("cells" if chosen.sensors.cells else "sun"))


def test_a_flight_without_faults_has_a_plain_plant():
    chosen = load("microsat")
    assert type(make_plant(plant_config(chosen, 1), chosen.fault)) is Plant


def test_a_fault_comes_and_goes_when_it_is_to():
    chosen = scenario(kind="mag_bias", at_s=3.0, lasts_s=2.0, parameters={"axis": 1.0, "nt": 9000.0})
    plant = make_plant(plant_config(chosen, 1), chosen.fault)
    healthy = Plant(plant_config(chosen, 1))
    assert isinstance(plant, FaultyPlant)
    off_nt = []
    for _ in range(8):
        faulty, right = field_nt(plant.begin_tick()), field_nt(healthy.begin_tick())
        off_nt.append(faulty.b_y - right.b_y)
        assert (faulty.b_x, faulty.b_z) == (right.b_x, right.b_z)
        plant.end_tick()
        healthy.end_tick()
    assert off_nt == pytest.approx([0.0, 0.0, 0.0, 9000.0, 9000.0, 0.0, 0.0, 0.0], abs=2.0)


def test_a_fault_grows_from_its_own_beginning_in_seconds():
    chosen = load(
        "microsat",
        {
            "time": {"tick_hz": 2},
            "fault": [
                {
                    "kind": "mag_bias",
                    "at_s": 2.0,
                    "parameters": {"axis": 1.0, "nt": 4000.0, "per_s": 600.0},
                }
            ],
        },
    )
    plant = make_plant(plant_config(chosen, 1), chosen.fault)
    healthy = Plant(plant_config(chosen, 1))
    off_nt = []
    for _ in range(8):
        off_nt.append(field_nt(plant.begin_tick()).b_y - field_nt(healthy.begin_tick()).b_y)
        plant.end_tick()
        healthy.end_tick()
    assert off_nt == pytest.approx([0.0, 0.0, 0.0, 0.0, 4000.0, 4300.0, 4600.0, 4900.0], abs=2.0)


def test_a_fault_without_an_end_stays():
    chosen = scenario(kind="sun_board_dead", at_s=2.0)
    plant = make_plant(plant_config(chosen, 1), chosen.fault)
    counts = []
    for _ in range(5):
        counts.append(len(plant.begin_tick()))
        plant.end_tick()
    assert counts[1] - 1 == counts[2] == counts[4]


@pytest.mark.parametrize(
    ("tick_hz", "at_s", "lasts_s", "ticks"),
    [
        (1, 2.3, 2.0, [3, 4]),
        (1, 3.0, 0.2, [3]),
        (4, 1.0, 0.5, [4, 5]),
        (4, 1.1, 0.75, [5, 6, 7]),
        (50, 0.14, 0.04, [7, 8]),
    ],
)
def test_it_begins_with_the_first_tick_at_its_time_and_lasts_in_seconds(tick_hz, at_s, lasts_s, ticks):
    timed = {"kind": "sun_board_dead", "at_s": at_s, "lasts_s": lasts_s}
    chosen = load("microsat", {"time": {"tick_hz": tick_hz}, "fault": [timed]})
    plant = make_plant(plant_config(chosen, 1), chosen.fault)
    active = []
    for tick in range(10):
        plant.begin_tick()
        active += [tick] if plant.active else []
        plant.end_tick()
    assert active == ticks


def test_each_fault_of_each_seed_has_random_numbers_of_its_own():
    chosen = load("microsat", {"fault": [{"kind": "random_frames", "at_s": 0.0}] * 2})
    heard = {}
    for seed in (1, 2, 1):
        plant = make_plant(plant_config(chosen, seed), chosen.fault)
        plant.begin_tick()
        drawn = tuple(fault.rng.random() for fault in plant.active)
        assert heard.setdefault(seed, drawn) == drawn
    assert len({number for drawn in heard.values() for number in drawn}) == 4


@pytest.mark.parametrize(
    ("kind", "breaks", "forges_sync", "forges"),
    [
        ("loss", False, False, False),
        ("corruption", True, False, False),
        ("wrong_length", True, False, False),
        ("random_frames", True, False, True),
        ("second_sender", False, False, True),
        ("done_forged", False, False, True),
        ("sync_forged", False, True, False),
    ],
)
def test_what_a_fault_may_do_to_statuses_and_in_the_place_of_others(kind, breaks, forges_sync, forges):
    chosen = load("microsat", {"fault": [{"kind": "mag_frozen", "at_s": 1.0}, {"kind": kind, "at_s": 1.0}]})
    found = break_frames(chosen.fault), forge_sync(chosen.fault), forge_answers(chosen.fault)
    assert found == (breaks, forges_sync, forges)
