"""Which boards a bench has: a Sun sensor or Sun cells, as the satellite has; none of a wheel."""

from dataclasses import replace

import pytest

from fsw.bus.interface import BusError
from sim.bench.command import BOARDS, HilSettings, boards_of, hil, real_boards
from sim.errors import HarnessError
from sim.scenario.schema import load

SETTINGS = HilSettings(
    scenario=load("microsat"),
    bus="loop",
    real=frozenset(),
    armed=False,
    seconds=1.0,
    stimulus="plant",
    deadman_s=5.0,
    budgets=None,
    warm_s=60.0,
    seed=1,
    out=None,
)


@pytest.mark.parametrize(("scenario", "sees"), [("microsat", "sun"), ("cubesat-cells", "cells")])
def test_the_boards_are_those_of_the_satellite(scenario, sees):
    assert boards_of(load(scenario)) == ("coil", "magnetometer", sees)
    assert BOARDS[sees] == "SUN"


@pytest.mark.parametrize(
    ("scenario", "real", "has"), [("microsat", "cells", "Sun sensor"), ("cubesat-cells", "sun", "Sun cells")]
)
def test_one_that_the_satellite_has_not_cannot_be_real(scenario, real, has):
    settings = replace(SETTINGS, scenario=load(scenario), real=real_boards(f"coil,{real}"))
    with pytest.raises(HarnessError, match=f"--real {real}: {scenario} has .?.?{has}"):
        hil(settings)


def test_a_satellite_whose_wheel_no_board_would_drive_is_refused():
    settings = replace(SETTINGS, scenario=load("microsat-wheel"))
    with pytest.raises(HarnessError, match=r"^\[wheel\]: a bench has no board of a wheel"):
        hil(settings)


def test_a_dead_man_no_longer_than_a_tick_is_refused_and_that_of_a_real_board_is_not_judged():
    with pytest.raises(HarnessError, match=r"^--deadman-s 1: at 1 Hz"):
        hil(replace(SETTINGS, deadman_s=1.0))
    with pytest.raises(BusError, match="no such bus"):
        hil(replace(SETTINGS, deadman_s=1.01, bus="no such bus"))
    with pytest.raises(BusError, match="no such bus"):
        hil(replace(SETTINGS, deadman_s=1.0, bus="no such bus", real=frozenset({"coil"})))
