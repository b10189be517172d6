"""What was driven and dissipated is by coil and current, whatever dipole the coils truly give."""

import numpy as np
import pytest

from sim.plant.hardware.coils import Coils
from sim.report.figures.coil_effort import dipole_squared_a2m4s, driven_coils, driven_s, nominal_dipole_am2
from sim.scenario.assemble import coil_config
from sim.scenario.schema import load

DRIVER = {"driver": "continuous", "max_dipole_am2": 2.0, "on_fraction": 0.5, "dipole_per_ampere_am2": 20.0}
WRONG = {
    "nothing": {},
    "scale": {"dipole_scale": [0.5, 0.5, 0.5]},
    "axes": {"misalignment_deg": [[0.0, 0.0, 0.5], [0.3, 0.0, 0.0], [0.0, -0.4, 0.2]]},
    "wiring": {"wiring": [2, 1, -3]},
    "all": {
        "dipole_scale": [0.7, -1.2, 1.1],
        "misalignment_deg": [[0.0, 5.0, 0.0], [0.0, 0.0, 9.0], [4.0, 0.0, 0.0]],
        "wiring": [3, -1, 2],
    },
}
CURRENT_A = np.array(
    [[0.1, 0.0, 0.0], [0.0, -0.05, 0.0], [0.0, 0.0, 0.02], [0.04, 0.0, 0.1], [0.0, 0.0, 0.0]]
)


@pytest.fixture(params=WRONG)
def flown(request):
    """A scenario with these coils, and the plant's mean dipole of ticks in which they carry ``CURRENT_A``."""
    scenario = load("microsat", {"coils": DRIVER | WRONG[request.param] | {"time_constant_s": 1e-6}})
    coils = Coils(coil_config(scenario))
    return scenario, np.array([coils.advance(tuple(current), 0.5, 1.0) for current in CURRENT_A.tolist()])


def test_the_nominal_dipole_is_that_of_the_currents(flown):
    scenario, dipole_am2 = flown
    assert nominal_dipole_am2(scenario, dipole_am2) == pytest.approx(0.5 * 20.0 * CURRENT_A, abs=1e-5)


def test_each_coil_is_driven_that_carries_a_current(flown):
    scenario, dipole_am2 = flown
    carries = CURRENT_A != 0.0
    assert (driven_coils(scenario, dipole_am2) == carries).all()
    assert driven_s(scenario, dipole_am2) == 0.5 * 4


def test_what_is_dissipated_is_by_the_current(flown):
    scenario, dipole_am2 = flown
    squared_a2s = dipole_squared_a2m4s(scenario, dipole_am2) / 20.0**2
    assert squared_a2s == pytest.approx(0.5 * np.sum(CURRENT_A**2), rel=1e-4)


def test_nominal_coils_keep_their_dipole_to_the_last_bit(flown):
    scenario, dipole_am2 = load("microsat", {}), flown[1]
    assert nominal_dipole_am2(scenario, dipole_am2) is dipole_am2


def test_a_coil_that_gives_no_dipole_counts_as_not_driven():
    scenario = load("microsat", {"coils": DRIVER | {"dipole_scale": [1.0, 0.0, 0.5]}})
    found = nominal_dipole_am2(scenario, np.array([[0.3, 0.0, 0.4]]))
    assert found == pytest.approx(np.array([[0.3, 0.0, 0.8]]))
