"""One search of the default scenario's gains, and a scenario file to write into."""

import pytest

from sim.design.analysis import ANALYSIS_STEPS, analyse
from sim.design.from_scenario import body_of, pulsing_of
from sim.scenario.schema import load

SCENARIO_FILE = """\
# my satellite
name = "mine"
summary = "k_w = 5 [control]"
knowledge = "perfect"

[time]
tick_hz = 1
orbits = 1.0

[orbit]
altitude_km = 800.0
inclination_deg = 98.6

[body]
inertia_kgm2 = [1.02, 1.85, 1.95]

[coils]
levels_am2 = [0.5, 2.0, 8.0]
dipole_per_ampere_am2 = 20.0

[control]   # how it points
law = "pd"
  k_w= 6.2e6   # not k_w = 1
k_a =1615     # N m/T^2
leak_s = 300.0

[flight.modes]
axis_only = false
"""


@pytest.fixture
def scenario_file(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(SCENARIO_FILE, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def searched():
    """(scenario, analysis, progress) of a search for the default scenario."""
    scenario, progress = load("microsat"), []
    analysis = analyse(body_of(scenario), pulsing_of(scenario), None, progress.append)
    assert progress[-1] == ANALYSIS_STEPS
    return scenario, analysis, progress
