"""Keys of parts that the satellite does not have."""

import pytest

from sim.scenario.schema import load, shipped
from sim.sizing.scenario_warnings import ignored_keys, scenario_warnings

TLE = load("microsat").orbit.tle
CONTINUOUS = {"driver": "continuous", "max_dipole_am2": 1.0, "on_fraction": 0.5}


def test_shipped_scenarios_have_none():
    assert [ignored_keys(scenario) for scenario in shipped()] == [[]] * len(shipped())


@pytest.mark.parametrize(
    ("scenario", "values", "told"),
    [
        (
            "cubesat-cells",
            {"sensors": {"sun": {"noise_deg": 2.0, "albedo": True}}},
            "sensors.sun.noise_deg, sens",
        ),
        ("cubesat-cells", {"sensors": {"sun": {"noise_deg": 0.5}}}, ""),
        ("microsat", {"sensors": {"sun": {"noise_deg": 2.0}}}, ""),
        ("microsat", {"coils": {"on_fraction": 0.5}}, "coils.on_fraction = 0.5 is of no effect"),
        ("microsat", {"coils": {"on_fraction": 0.8}}, ""),
        ("microsat", {"coils": CONTINUOUS}, ""),
        (
            "microsat",
            {"orbit": {"tle": TLE, "inclination_deg": 50.0, "raan_deg": 0.0}},
            "orbit.inclination_deg: of no effect, the elements of orbit.tle are flown",
        ),
    ],
)
def test_a_key_that_is_ignored_is_told_unless_it_is_the_default(scenario, values, told):
    found = ignored_keys(load(scenario, values))
    assert [sentence.startswith(told) for sentence in found] == [True] * bool(told)
    assert set(found) <= set(scenario_warnings(load(scenario, values)))
