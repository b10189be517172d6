"""Limits by the currents that flowed: kept to a tick, broken where they are beyond that, of each coil."""

import numpy as np
import pytest

from sim.faults.kinds import KINDS
from sim.judge.driven import ALTER_REPORTS, DrivenLimits, alters_reports, limits_as_driven
from sim.scenario.schema import load, parse_settings

LEVEL_3 = load("microsat").coils.levels_am2[2]


def truth(*pulses, ticks=1000, dipole_am2=LEVEL_3):
    """Histories with a dipole of level 3 in the ticks from the first to before the second, of coil 1."""
    m = np.zeros((ticks, 3))
    for first, past, *coil in pulses:
        axis = coil[0] if coil else 1
        m[first + 1 : past + 1, axis] = dipole_am2
        m[past + 1 : past + 2, axis] += 0.02  # the current decays
    return {"m_body_am2": m}


def found(*pulses, settings=(), scenario="microsat", **options):
    return limits_as_driven(load(scenario, parse_settings(settings)), truth(*pulses, **options))


def test_pulses_of_three_seconds_a_back_off_apart_are_kept():
    assert found((100, 103), (203, 206), (400, 401)) == DrivenLimits()


def test_one_of_five_seconds_is_too_long():
    assert found((100, 105)).broken == "coil 1 was driven for 5 s from tick 100 on"


def test_one_that_comes_after_90_s_is_too_soon():
    assert found((100, 103), (193, 196)).broken == "a pulse began 90 s after the last, in tick 193"
    assert found((100, 103, 0), (193, 196, 2)).broken == "a pulse began 90 s after the last, in tick 193"


def test_one_within_the_back_off_from_boot_is_too_soon():
    assert found((50, 53)).broken == "a pulse began 50 s after the board's boot, in tick 50"


def test_with_a_back_off_per_coil_each_coil_has_its_own():
    per_coil = ("coils.backoff=per_coil",)
    assert found((100, 103, 0), (110, 113, 1), (203, 206, 0), settings=per_coil) == DrivenLimits()
    early = found((100, 103, 0), (110, 113, 1), (190, 193, 0), settings=per_coil)
    assert early.broken == "a pulse began 87 s after the last, in tick 190"


def test_two_coils_at_once_and_a_current_beyond_the_highest_level_are_told():
    at_once = found((100, 103, 0), (100, 103, 2), settings=("coils.backoff=per_coil",))
    assert at_once.broken == "coils 0 and 2 were driven at once in tick 101"
    strong = found((100, 103), dipole_am2=1.1 * LEVEL_3)
    assert strong.broken == "coil 1 was driven beyond level 3 in tick 100"


def test_currents_are_those_of_the_coils_and_not_of_the_axes_of_the_body():
    settings = ("coils.wiring=[2,-1,3]", "coils.dipole_scale=[0.5,1,1]")
    half = found((100, 105), settings=settings, dipole_am2=0.5 * LEVEL_3)
    assert half.broken == "coil 0 was driven for 5 s from tick 100 on"
    assert "coil 0 was driven beyond level 3" in found((100, 103), settings=settings).broken


def test_of_a_continuous_driver_full_scale_is_the_limit():
    coils = load("detumble3u").coils
    full = coils.max_dipole_am2 * coils.on_fraction
    assert found((0, 900), scenario="detumble3u", dipole_am2=full) == DrivenLimits()
    beyond = found((7, 900), scenario="detumble3u", dipole_am2=1.1 * full)
    assert beyond.broken == "coil 1 was driven beyond full scale in tick 7"


@pytest.mark.parametrize("kind", ["coil_stuck_on", "coil_open", "coil_wired"])
def test_where_a_fault_drives_the_coils_nothing_is_told(kind):
    told = found((100, 105), settings=(f'fault=[{{kind="{kind}", at_s=3.0}}]',))
    assert not told.broken
    assert told.unjudged


@pytest.mark.parametrize(("kind", "alters"), [("corruption", True), ("delay", True), ("mag_bias", False)])
def test_what_alters_reports_is_on_the_bus(kind, alters):
    settings = parse_settings((f'fault=[{{kind="{kind}", at_s=3.0}}]',))
    assert alters_reports(load("microsat", settings)) is alters


def test_kinds_are_kinds():
    assert set(KINDS) >= ALTER_REPORTS
