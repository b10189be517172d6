"""The law of phasing: each coil in both polarities in turn, whatever the attitude, within the scheduler."""

from dataclasses import replace

import numpy as np
import pytest

from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.phasing import PhasingGains, phasing
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE
from fsw.core.laws.table import LAWS


@pytest.fixture
def asked(bench):
    """(coil, level) by tick, None where nothing is asked for."""

    def ask(waits, gains=None, pulsed=True):
        body = bench.Body(np.diag([1.0, 2.0, 3.0]))
        config = replace(bench.config(body, 1.0, {"phasing": gains or PhasingGains()}), pulsed=pulsed)
        memory, found = (), []
        for wait in waits:
            inputs = LawInput(UNKNOWN, ZERO, FieldSample(), FieldSample(), wait_ticks=wait)
            demand = phasing(inputs, memory, bench.setpoint(), config)
            memory = demand.memory
            found.append(None if demand.pulse == NO_PULSE else demand.pulse.values())
        return found

    return ask


READY = (0, 0, 0)


def test_each_coil_comes_in_both_polarities_and_in_turn(asked):
    expected = [(0, 3), (1, 3), (2, 3), (0, -3), (1, -3), (2, -3), (0, 3)]
    assert asked([READY] * 7) == expected


def test_it_waits_for_the_coil_whose_turn_it_is(asked):
    assert asked([(5, 0, 0), (4, 0, 0), READY, (103, 103, 103), READY]) == [None, None, (0, 3), None, (1, 3)]


def test_a_coil_with_a_fault_is_passed_over(asked):
    assert asked([READY, (0, NEVER, 0), (0, NEVER, 0), READY]) == [(0, 3), None, (2, 3), (0, -3)]


def test_after_its_rounds_it_asks_for_nothing(asked):
    assert asked([READY] * 8, PhasingGains(level=1.0, rounds=1.0)) == [
        (0, 1), (1, 1), (2, 1), (0, -1), (1, -1), (2, -1), None, None,
    ]  # fmt: skip


def test_a_continuous_driver_is_asked_for_nothing(asked):
    assert asked([READY] * 3, pulsed=False) == [None] * 3


@pytest.mark.parametrize("wrong", [{"level": 0.0}, {"level": 2.5}, {"rounds": -1.0}, {"rounds": 0.5}])
def test_gains_are_whole(wrong):
    with pytest.raises(ValueError, match="must be"):
        PhasingGains(**wrong)


def test_it_alone_is_flown_without_looking():
    assert [name for name, law in LAWS.items() if law.open_loop] == ["phasing"]
