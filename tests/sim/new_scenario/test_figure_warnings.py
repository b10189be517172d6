"""Figures that cannot be, and drag where it rules."""

import pytest

from fsw.input.toml_text import parse_toml
from sim.new_scenario.command import scenario_text
from sim.new_scenario.figure_warnings import figure_warnings, in_options
from sim.new_scenario.satellite import NewSatellite
from sim.scenario.schema import scenario_of


def told(**figures):
    usual = {"altitude_km": 700.0, "inclination_deg": 97.6, "mass_kg": 4.0, "size_m": (0.34, 0.1, 0.1)}
    satellite = NewSatellite("mine", **(usual | figures))
    return figure_warnings(satellite, scenario_of(parse_toml(scenario_text(satellite, "x.toml")), "x.toml"))


def test_a_cubesat_is_not_doubted():
    assert told() == []
    assert told(altitude_km=500.0) == []


@pytest.mark.parametrize(
    ("figures", "said"),
    [
        (
            {"mass_kg": 4000.0},
            "4000 kg in 0.34 x 0.1 x 0.1 m are 1.18e+06 kg/m^3, more than osmium, 22 600: is --mass-kg in kg",
        ),
        ({"size_m": (3.4, 1.0, 2.0)}, "4 kg in 3.4 x 1 x 2 m are 0.588 kg/m^3, less than air, 1.2"),
    ],
)
def test_a_density_that_no_satellite_has(figures, said):
    (doubt,) = told(**figures)
    assert doubt.startswith(said)
    assert doubt.endswith("--size-m in m?")


def test_moments_that_are_given_have_no_density():
    assert told(mass_kg=None, size_m=None, inertia_kgm2=(1.0, 1.9, 2.0)) == []


@pytest.mark.parametrize("altitude_km", [200.0, 300.0, 400.0])
def test_drag_that_rules_and_is_left_out_is_said(altitude_km):
    (doubt,) = told(altitude_km=altitude_km)
    assert doubt.startswith(f"drag is left out, and at {altitude_km:.0f} km it rules: about ")
    assert doubt.endswith("a scenario with body.plates and [disturbance.drag] has it")


def test_a_sentence_names_options_where_there_is_no_file():
    assert in_options("orbit.inclination_deg = 3: over") == "--inclination-deg = 3: over"
