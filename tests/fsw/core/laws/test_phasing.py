"""The law of phasing: each coil in both polarities in turn, whatever the attitude, within the scheduler."""

from dataclasses import dataclass, field
from typing import Any

import pytest

from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.phasing import PhasingGains, phasing
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE
from fsw.core.laws.table import LAWS


@dataclass
class Config:
    gains: dict[str, Any] = field(default_factory=dict)
    pulsed: bool = True


def asked(waits, gains=None, pulsed=True):
    """(coil, level) by tick, None where nothing is asked for."""
    config, memory, found = Config({"phasing": gains or PhasingGains()}, pulsed), (), []
    for wait in waits:
        inputs = LawInput(UNKNOWN, ZERO, FieldSample(), FieldSample(), wait_ticks=wait)
        demand = phasing(inputs, memory, None, config)
        memory = demand.memory
        found.append(None if demand.pulse == NO_PULSE else demand.pulse.values())
    return found


READY = (0, 0, 0)


def test_each_coil_comes_in_both_polarities_and_in_turn():
    expected = [(0, 3), (1, 3), (2, 3), (0, -3), (1, -3), (2, -3), (0, 3)]
    assert asked([READY] * 7) == expected


def test_it_waits_for_the_coil_whose_turn_it_is():
    assert asked([(5, 0, 0), (4, 0, 0), READY, (103, 103, 103), READY]) == [None, None, (0, 3), None, (1, 3)]


def test_a_coil_with_a_fault_is_passed_over():
    assert asked([READY, (0, NEVER, 0), (0, NEVER, 0), READY]) == [(0, 3), None, (2, 3), (0, -3)]


def test_after_its_rounds_it_asks_for_nothing():
    assert asked([READY] * 8, PhasingGains(level=1.0, rounds=1.0)) == [
        (0, 1), (1, 1), (2, 1), (0, -1), (1, -1), (2, -1), None, None,
    ]  # fmt: skip


def test_a_continuous_driver_is_asked_for_nothing():
    assert asked([READY] * 3, pulsed=False) == [None] * 3


@pytest.mark.parametrize("wrong", [{"level": 0.0}, {"level": 2.5}, {"rounds": -1.0}, {"rounds": 0.5}])
def test_gains_are_whole(wrong):
    with pytest.raises(ValueError, match="must be"):
        PhasingGains(**wrong)


def test_it_alone_is_flown_without_looking():
    assert [name for name, law in LAWS.items() if law.open_loop] == ["phasing"]
