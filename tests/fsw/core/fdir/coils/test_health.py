"""What follows from the health of the coils for the dipole of a tick."""

import numpy as np
import pytest
from pulse_samples import CONFIG, PULSES, WEAK

from fsw.core.actuation.actuator import CoilView
from fsw.core.fdir.coils.health import CoilHealth, CoilHealthConfig, driven_am2, isolate_coil
from fsw.core.fdir.faults import CoilFault

AXES = ((-0.9, 0.03, 0.01), (0.02, 1.1, -0.04), (0.05, 0.0, 1.2))
"""Rows: the dipole per nominal one of a current in each coil; the first is wired the other way."""
LIMITS = CoilHealthConfig((40.0, 120.0, 400.0), WEAK, 1.0, 5, PULSES, CONFIG, 3000, AXES)
REPORTED = CoilView(driven_am2=(0.1, 0.2, 0.3))


@pytest.mark.parametrize("stray_ma", [200, -50])
def test_a_stray_current_gives_each_coils_part_of_its_true_dipole(stray_ma):
    parts = (0.5, 0.3, -0.1)
    health = CoilHealth(stray_ma=stray_ma, stray_parts=parts)
    expected = 8.0 * stray_ma / 400.0 * (np.array(parts) @ AXES)
    assert driven_am2(health, REPORTED, LIMITS) == pytest.approx(expected)


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_once_its_coil_is_isolated_it_flows_there_alone(coil):
    faults = tuple(int(CoilFault.STUCK) if number == coil else 0 for number in range(3))
    health = CoilHealth(faults=faults, stray_ma=-50, stray_parts=(0.5, 0.3, -0.1))
    assert driven_am2(health, REPORTED, LIMITS) == pytest.approx(-np.array(AXES[coil]))


def test_without_a_current_or_while_nothing_is_known_of_it_what_is_reported_counts():
    for health in (CoilHealth(stray_parts=(1.0, 0.0, 0.0)), CoilHealth(stray_ma=200)):
        assert driven_am2(health, REPORTED, LIMITS) == REPORTED.driven_am2


def test_a_coil_keeps_its_first_fault_unless_it_is_found_stuck():
    health = CoilHealth()
    isolate_coil(health, 1, CoilFault.WEAK, LIMITS)
    assert (health.faults, health.until_retest) == ((0, CoilFault.WEAK, 0), (0, 3000, 0))
    health.until_retest = (0, 7, 0)
    isolate_coil(health, 1, CoilFault.OPEN, LIMITS)
    assert (health.faults, health.until_retest) == ((0, CoilFault.WEAK, 0), (0, 7, 0))
    isolate_coil(health, 1, CoilFault.STUCK, LIMITS)
    assert (health.faults, health.until_retest) == ((0, CoilFault.STUCK, 0), (0, 3000, 0))
