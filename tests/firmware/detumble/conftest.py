"""The flight software in C, compiled once for each satellite, and flown once."""

import json
from pathlib import Path

import pytest
from c_compiler import has_compiler
from click.testing import CliRunner
from detumble_bench import NO_COMPILER, Firmware, compile_library, compile_program, loaded

from sim.scenario.schema import load, parse_settings
from torquer.cli.main import main

TUMBLER = Path(__file__).parents[2] / "sim" / "judge" / "tumbler.toml"
POINTS = (
    "requirement=[{index='ape',at_most_deg=3.0,by_orbit=2.0},"
    "{index='settling',at_most_orbits=1.5,by_orbit=2.0}]"
)
"""What PD in pulses attains within few orbits; the requirements of microsat are judged after five."""
FLIGHTS = {
    "tumbler": (str(TUMBLER), (), "detumble", 1.0),
    "microsat": ("microsat", ("knowledge=perfect", POINTS), "actuator", 2.5),
}
"""Scenario, settings, profile and orbits of each flight."""


@pytest.fixture(scope="session")
def firmware_of(tmp_path_factory):
    """Makes the flight software for a satellite: a scenario, with settings."""
    if not has_compiler():
        pytest.skip(NO_COMPILER)
    compiled = {}

    def firmware(name, *settings):
        if (name, settings) not in compiled:
            scenario = load(name, parse_settings(settings))
            compiled[name, settings] = compile_library(tmp_path_factory.mktemp("library"), scenario)
        return Firmware(loaded(compiled[name, settings]))

    return firmware


@pytest.fixture(scope="session", params=FLIGHTS.values(), ids=FLIGHTS)
def flight(request, tmp_path_factory):
    """A flight of the program, judged: the scenario, the verdicts, the run's folder."""
    if not has_compiler():
        pytest.skip(NO_COMPILER)
    name, settings, profile, orbits = request.param
    folder = tmp_path_factory.mktemp("flown")
    scenario = load(name, parse_settings(settings))
    program = compile_program(folder, scenario)
    words = ["judge", name, "--flight-software", f"{program} {{port}}", "--profile", profile, "--json"]
    words += ["--orbits", str(orbits), "--out", str(folder / "run")]
    for setting in settings:
        words += ["--set", setting]
    done = CliRunner().invoke(main, words)
    assert done.stdout, done.output
    return scenario, json.loads(done.stdout), folder / "run"


@pytest.fixture
def tumbler():
    """The scenario of a tumble."""
    return str(TUMBLER)
