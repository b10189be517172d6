"""What the satellite is beyond the bounds of its onboard table, in words."""

import pytest

from sim.report.requirements.causes import beyond_bounds
from sim.scenario.schema import load


def cells(uncertainty=None, **unlike):
    return load("cubesat-cells", {"sensors": {"cells": unlike}, "flight": {"uncertainty": uncertainty or {}}})


@pytest.mark.parametrize("misled", [False, True])
@pytest.mark.parametrize("name", ["microsat", "realsat", "cubesat-cells"])
def test_a_satellite_within_its_bounds_has_none(name, misled):
    assert beyond_bounds(load(name), misled) == []


def test_what_is_ordinary_for_such_a_satellite_counts_once_the_estimate_was_misled():
    undeclared = load("microsat", {"disturbance": {"residual_dipole_am2": [0.0005, -0.008, 0.005]}})
    assert beyond_bounds(undeclared) == []
    assert beyond_bounds(undeclared, misled=True) == [
        "disturbance.residual_dipole_am2 is off by 0.008, and flight.uncertainty.residual_dipole_am2 = 0"
    ]


def test_of_perfect_knowledge_what_turns_the_body():
    sensors = {"sensors": {"sun": {"misalignment_deg": [9.0, 0.0, 0.0]}}, "knowledge": "perfect"}
    assert beyond_bounds(load("microsat", sensors)) == []
    inertia = {"flight": {"body": {"inertia_kgm2": [1.95, 1.85, 1.02]}}, "knowledge": "perfect"}
    (clause,) = beyond_bounds(load("microsat", inertia))
    assert "body.inertia_kgm2 is off by 91.2 %" in clause


def test_the_worst_comes_first():
    sensors = {"magnetometer": {"bias_nt": [0.0, 9000.0, 0.0]}, "sun": {"misalignment_deg": [0.0, 0.0, 12.0]}}
    found = beyond_bounds(load("realsat", {"sensors": sensors}))
    assert [sentence.split(",")[0] for sentence in found] == [
        "sensors.sun.misalignment_deg is off by 12",
        "sensors.magnetometer.bias_nt is off by 9e+03",
    ]


def test_of_sun_cells_gain_and_the_light_of_the_earth():
    found = beyond_bounds(cells(gain=[1.0, 1.0, 0.4, 1.0, 1.0, 1.0]))
    assert found == ["sensors.cells.gain is off by 60 %, and flight.uncertainty.cell_gain_percent = 10"]
    bright = load(
        "cubesat-cells", {"sensors": {"cells": {"albedo": 0.9}}, "flight": {"cells": {"albedo": 0.3}}}
    )
    assert beyond_bounds(bright) == [
        "sensors.cells.albedo is off by 60 %, and flight.uncertainty.cell_light_percent = 15"
    ]


def test_a_gain_that_the_table_calls_exact_and_is():
    assert beyond_bounds(cells({"cell_gain_percent": 0.0}, gain=[1.0] * 6)) == []


@pytest.mark.parametrize(
    ("known_nt", "off"),
    [([20000.0, -30000.0, 0.0], None), ([20000.0, -25000.0, 0.0], "5e+03"), ([0.0, 0.0, 0.0], "3e+04")],
)
def test_of_a_calibrated_sensor_what_the_calibration_leaves(known_nt, off):
    sensors = {"magnetometer": {"bias_nt": [20000.0, -30000.0, 0.0]}}
    calibration = {"magnetometer": {"offset_nt": known_nt}}
    words = "sensors.magnetometer.bias_nt is off by {}, and flight.uncertainty.magnetometer_bias_nt = 500"
    found = beyond_bounds(load("microsat", {"sensors": sensors, "flight": {"calibration": calibration}}))
    assert found == ([words.format(off)] if off else [])
