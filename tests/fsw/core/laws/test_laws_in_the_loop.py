"""The laws of the review in the flight loop: every one is flown in ACQUIRE, with real frames."""

import pytest

from fsw.core.laws.table import LAWS
from fsw.wire.messages import CoilDipole, CoilFire, Mode

REVIEW = [name for name, row in LAWS.items() if 4 <= row.number < 40 or 100 <= row.number < 110]
CONTINUOUS = {"driver": "continuous", "max_dipole_am2": 5.0, "on_fraction": 0.8}


AXES = [[sign * float(row == column) for column in range(3)] for row in range(3) for sign in (1.0, -1.0)]
CELLS = {"sensors": {"cells": {"normals": AXES}}, "initial": {"axis": [0.5, -0.7, 0.4], "angle_deg": 70.0}}


@pytest.fixture(scope="module")
def run(make_world):
    """A world some ticks into ACQUIRE, and the dipoles asked for there."""

    def fly(name, ticks=10, **settings):
        world = make_world(
            knowledge="perfect",
            control={"law": name, "spin_radps": 0.001},
            coils=CONTINUOUS,
            body={"inertia_kgm2": [1.02, 1.85, 1.95], "wheel_nms": [0.0, 0.0, 0.05]},
            **settings,
        )
        while world.state.modes.mode is not Mode.ACQUIRE:
            world.step()
            assert world.state.tick < 60
        messages = [message for tick in world.fly(ticks) for message in tick]
        return world, [message for message in messages if isinstance(message, CoilDipole)]

    return fly


@pytest.mark.parametrize("name", REVIEW)
def test_each_law_drives_the_coils(run, name):
    world, dipoles = run(name)
    assert world.state.modes.mode is Mode.ACQUIRE
    assert any((message.m_x, message.m_y, message.m_z) != (0.0, 0.0, 0.0) for message in dipoles)


@pytest.mark.parametrize("name", ["sun_pointing", "sun_panels", "sun_critical"])
def test_the_laws_to_the_sun_drive_the_coils_by_sun_cells_too(run, name):
    _, dipoles = run(name, **CELLS)
    assert any((message.m_x, message.m_y, message.m_z) != (0.0, 0.0, 0.0) for message in dipoles)


@pytest.mark.parametrize("name", ["field_tracking", "sun_pointing"])
def test_a_law_that_remembers_when_knows_the_tick(run, name):
    world, _ = run(name)
    assert world.state.memory[0] == world.state.tick


def test_while_pd_apart_measures_no_pulse_is_fired(make_world):
    """Nor is what was asked for before it: pulses are owed for a long time otherwise."""
    world = make_world(knowledge="perfect", control={"law": "pd_apart"}, coils={"backoff_s": 20.0})
    fired = {True: 0, False: 0}
    for _ in range(600):
        sent = world.step()
        if world.state.modes.mode in (Mode.ACQUIRE, Mode.POINT):
            acting = world.state.memory[1] == 1.0
            fired[acting] += sum(isinstance(message, CoilFire) for message in sent)
    assert fired[True] > 5
    assert fired[False] == 0
