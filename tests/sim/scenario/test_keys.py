"""The page of keys and the schema for editors say what the schema of scenarios says."""

import re
import tomllib
from importlib import resources

import jsonschema
import pytest
from click.testing import CliRunner

from fsw.table.table import FlightTable
from sim.scenario.keys.editor_schema import as_text, json_schema, unit_of
from sim.scenario.keys.page import page
from sim.scenario.schema import Scenario
from torquer.cli.scenarios import scenarios

SHIPPED = sorted(
    entry.name for entry in resources.files("sim.scenario.shipped").iterdir() if entry.name.endswith(".toml")
)
JUDGE = jsonschema.Draft202012Validator(json_schema())


def shipped(name):
    return tomllib.loads(resources.files("sim.scenario.shipped").joinpath(name).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", SHIPPED)
def test_what_ships_is_valid_by_the_schema_for_editors(name):
    JUDGE.validate(shipped(name))


@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("time", "tick_hz", 0),
        ("time", "tick_hertz", 1),
        ("coils", "backoff", "sometimes"),
        ("coils", "levels_am2", [1.0, 2.0]),
        ("flight", "unknown", 1),
    ],
)
def test_a_wrong_key_or_value_is_not(section, key, value):
    values = shipped("microsat.toml")
    values[section][key] = value
    assert not JUDGE.is_valid(values)


def test_sections_of_the_onboard_table_are_judged_too():
    values = shipped("microsat.toml")
    values["flight"]["calibration"] = {"magnetometer": {"offset_nt": [1000.0, -20.0, 3.0]}}
    JUDGE.validate(values)
    values["flight"]["calibration"]["magnetometer"]["offset"] = 1.0
    assert not JUDGE.is_valid(values)


def test_every_section_that_the_schema_refers_to_is_in_it():
    named = set(re.findall(r'"#/\$defs/(\w+)"', as_text()))
    assert len(named) > 40
    assert named <= json_schema()["$defs"].keys()


@pytest.mark.parametrize("table", [Scenario, FlightTable])
def test_every_key_is_on_the_page(table):
    shown, schema = page(), table.model_json_schema()
    keys = {key for each in [schema, *schema["$defs"].values()] for key in each["properties"]}
    tables = {key for key in keys if f"| `{key}` |" in shown}
    headings = {key for key in keys if f"{key}]" in shown}
    assert keys == tables | headings


@pytest.mark.long
def test_the_page_gives_unit_bounds_and_default():
    assert "| `backoff_s` | s | number at least 0 and at most 160 | `100.0` |" in page()
    assert "| `valid_sigma_deg` | deg | number above 0 | `1.67` |" in page()  # of fsw/flight.toml
    assert "| `tick_hz` | Hz | whole number at least 1 and at most 100 | must be given |" in page()


@pytest.mark.parametrize(
    ("key", "unit"),
    [("coil_field_nt_per_am2", "nT per A m^2"), ("levels_am2", "A m^2"), ("area_m2", "m^2"), ("driver", "")],
)
def test_a_unit_is_the_end_of_the_name(key, unit):
    assert unit_of(key) == unit


def test_the_command_prints_the_schema():
    assert CliRunner().invoke(scenarios, ["--schema"]).output == as_text()
