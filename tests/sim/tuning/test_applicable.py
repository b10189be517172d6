"""Which laws suit a body: by its wheel against the axes that the laws count by, and by its driver."""

import pytest

from sim.scenario.schema import load
from sim.tuning.applicable import is_suited

WHEEL = {"inertia_kgm2": 1e-3, "max_torque_nm": 1e-3, "max_momentum_nms": 0.1}
UP_IS_Z = {"up": "z", "ahead": "x"}
"""The orbit's normal is body axis y."""


@pytest.mark.parametrize(("normal", "axes"), [("z", {}), ("y", UP_IS_Z)])
def test_a_wheel_counts_by_the_orbits_normal_whatever_its_builders_call_that(normal, axes):
    for axis in "xyz":
        along = [float(axis == other) for other in "xyz"]
        driven = load("microsat", {"body": axes, "wheel": {"axis": along, **WHEEL}})
        assert is_suited("pitch_wheel", driven) is (axis == normal)
        turning = load("microsat", {"body": {**axes, "wheel_nms": [0.1 * part for part in along]}})
        assert is_suited("dual_spin", turning) is (axis == normal)


def test_a_law_that_plans_pulses_suits_no_continuous_driver():
    scenario = load("microsat")
    assert is_suited("pulse_mpc", scenario, "pulsed")
    assert not is_suited("pulse_mpc", scenario, "continuous")
    assert is_suited("mpc", scenario, "continuous"), "which plans impulses"
