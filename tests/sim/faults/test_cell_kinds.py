"""Faults of Sun cells: the wrong current of one, the others as they are."""

from random import Random

import pytest

from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.faults.kinds import make
from sim.plant.rotation import ZERO
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load

CURRENTS = (0.5, 0.25, 0.75, 0.1)


def fault(kind, **parameters):
    return make(kind, parameters, Random(1))


@pytest.mark.parametrize(
    ("kind", "parameters", "read"),
    [
        ("cell_dead", {"cell": 2.0}, (0.5, 0.0, 0.75, 0.1)),
        ("cell_scaled", {"cell": 3.0, "scale": 0.4}, (0.5, 0.25, 0.3, 0.1)),
        ("cell_stuck", {"cell": 1.0, "percent": 60.0}, (0.6, 0.25, 0.75, 0.1)),
        ("cell_dead", {"cell": 6.0}, CURRENTS),
    ],
)
def test_one_cell_is_wrong(kind, parameters, read):
    assert fault(kind, **parameters).cells(CURRENTS) == pytest.approx(read)


def test_a_stuck_cell_stays_at_what_it_had():
    stuck = fault("cell_stuck", cell=2.0)
    assert stuck.cells(CURRENTS) == CURRENTS
    assert stuck.cells((0.1, 0.9, 0.2, 0.3)) == (0.1, 0.25, 0.2, 0.3)


def test_random_cells_are_dark_or_lit_each_by_itself_and_anew_in_each_tick():
    nonsense = fault("cells_random", percent=60.0)
    read = [nonsense.cells((0.5, 0.25, 0.75, 0.1, 0.0, 0.3)) for _ in range(400)]
    assert {value for currents in read for value in currents} == {0.0, 0.6}
    assert len(set(read)) > 50
    assert all(150 < sum(currents[cell] > 0.0 for currents in read) < 250 for cell in range(6))


def test_it_lasts_as_long_as_it_is_scheduled():
    dead = fault("cell_dead", cell=1.0)
    plant = FaultyPlant(plant_config(load("cubesat-cells"), 1), [ScheduledFault(dead, 1, 2)])
    read = []
    for _ in range(3):
        plant.begin_tick()
        read.append(plant.interference.cells((0.5, 0.6)))
        plant.end_tick()
    assert read == [(0.5, 0.6), (0.0, 0.6), (0.5, 0.6)]
    assert plant.interference.field(ZERO, True) == (ZERO, True)
