"""Attitudes of the reference files: the steps of our integration, and the orbit that a header states."""

import numpy as np
import pytest

from sim.validate.reference import attitude_check
from sim.validate.reference.attitude_check import read_case, two_body
from sim.validate.reference.reference_table import ReferenceTable


def test_steps_shrink_with_the_rate():
    slow, fast = (attitude_check.step_s(np.full((3, 3), rate)) for rate in (1e-5, 0.1))
    assert slow == attitude_check.LONGEST_STEP_S
    assert fast == pytest.approx(0.006 / (0.1 * np.sqrt(3.0)))


def test_the_orbit_of_a_header(folder):
    table = ReferenceTable(folder.copy("attitude_c_dipole.csv"))
    case, times = read_case(table), table.column("t_s")
    r_km = table.columns("r_eci_x_km", "r_eci_y_km", "r_eci_z_km")
    ours_m = two_body(case.r0_m, case.v0_mps, case.mu_m3ps2, times)
    assert np.abs(ours_m - 1e3 * r_km).max() < 1e-4
