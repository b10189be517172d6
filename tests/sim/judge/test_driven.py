"""Limits by the dipole that flowed: kept to a tick, broken where a pulse is too long or comes too soon."""

import numpy as np
import pytest

from sim.faults.kinds import KINDS
from sim.judge.driven import ALTER_REPORTS, limits_as_driven
from sim.scenario.schema import load, parse_settings


def truth(*pulses, ticks=1000):
    """Histories with a dipole of level 3 from each first tick to before the second."""
    m = np.zeros((ticks, 3))
    for first, past in pulses:
        m[first:past, 1] = 8.0
        m[past : past + 1, 1] += 0.02  # the current decays
    return {"m_body_am2": m}


def found(*pulses, settings=()):
    return limits_as_driven(load("microsat", parse_settings(settings)), truth(*pulses))


def test_pulses_of_three_seconds_a_back_off_apart_are_kept():
    assert found((100, 103), (203, 206), (400, 401)) == ""


def test_one_of_five_seconds_is_too_long():
    assert found((100, 105)) == "a coil was driven for 5 s from tick 100 on"


def test_one_that_comes_after_90_s_is_too_soon():
    assert found((100, 103), (193, 196)) == "a pulse began 90 s after the last, in tick 193"


@pytest.mark.parametrize(
    "settings",
    [("coils.backoff=per_coil",), ('fault=[{kind="coil_stuck_on", at_s=3.0}]',)],
)
def test_what_one_dipole_does_not_tell_is_not_judged(settings):
    assert found((100, 105), (110, 113), settings=settings) == ""


def test_kinds_are_kinds():
    assert set(KINDS) >= ALTER_REPORTS
