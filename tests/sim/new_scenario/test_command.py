"""``torquer new``: the scenario it writes, and what it refuses to overwrite."""

import json
import re
from dataclasses import asdict
from math import inf, nan

import numpy as np
import pytest

import torquer
from fsw.input.toml_text import parse_toml
from fsw.table.estimator import table_bounds
from sim.console import Console, speaking
from sim.errors import HarnessError
from sim.new_scenario.command import check_new, figure_warnings, in_options, new, scenario_text
from sim.new_scenario.satellite import NewSatellite
from sim.scenario.schema import flight_table, load, scenario_of
from sim.sizing.expectation import expect
from sim.sizing.scenario_warnings import scenario_warnings


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


# --- ``torquer new``: the scenario it writes, and what it refuses to overwrite

TLE = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)
SATELLITES = {
    "3U": NewSatellite("my-3u", None, 550.0, 97.6, 4.0, (0.1, 0.34, 0.1)),
    "50 kg": NewSatellite("my-50kg", TLE, inertia_kgm2=(1.0, 1.9, 2.0), levels_am2=(0.5, 2.0, 8.0)),
    "6U": NewSatellite("my-6u", None, 500.0, 51.6, 10.0, (0.1, 0.2263, 0.366), exact=False, per_coil=True),
    "cube": NewSatellite("my-cube", None, 700.0, 98.0, 50.0, (0.5, 0.5, 0.5)),
    "tons": NewSatellite("my-tons", None, 700.0, 98.0, 2000.0, (4.0, 2.0, 1.5)),
}


def written(satellite):
    return scenario_of(parse_toml(scenario_text(satellite, "mine.toml")), "mine.toml")


@pytest.mark.parametrize("satellite", SATELLITES.values(), ids=SATELLITES)
def test_a_new_scenario_is_valid_and_not_doubted(satellite):
    scenario = written(satellite)
    assert scenario.name == satellite.name
    told = scenario_warnings(scenario)
    assert all("asks for coils of" in doubt for doubt in told)
    assert len(told) == (satellite is SATELLITES["tons"])
    assert expect(scenario).pointing_deg < 5.0


@pytest.mark.long
@pytest.mark.parametrize("name", ["3U", "50 kg", "6U"])
def test_it_flies_at_once(name, tmp_path):
    scenario = written(SATELLITES[name])
    flown = torquer.fly(scenario, orbits=0.1, out=tmp_path / "run")
    assert flown.ok
    assert flown.summary["mode_final"] in ("ACQUIRE", "POINT")
    assert flown.summary["pulses"]["total"] > 0


def test_the_requirement_that_it_proposes_is_one():
    text, begin = scenario_text(SATELLITES["3U"], "mine.toml"), "# [[requirement]]"
    before, _, after = text.partition(begin)
    scenario = scenario_of(parse_toml(before + "[[requirement]]" + after.replace("\n# ", "\n")), "mine.toml")
    (required,) = scenario.requirement
    assert (required.index, required.limit, required.by_orbit) == ("ape", 5.0, 5.0)


def test_what_was_given_stands_in_it():
    scenario = written(SATELLITES["50 kg"])
    assert scenario.orbit.tle == TLE
    assert scenario.body.inertia_kgm2 == (1.0, 1.9, 2.0)
    assert scenario.coils.levels_am2 == (0.5, 2.0, 8.0)
    sixu = written(SATELLITES["6U"])
    assert (sixu.orbit.altitude_km, sixu.orbit.inclination_deg) == (500.0, 51.6)
    assert sixu.coils.backoff == "per_coil"
    assert "inertia_percent" not in sixu.flight["uncertainty"]


@pytest.mark.parametrize("cells", [False, True], ids=["sensor", "cells"])
def test_an_exact_table_has_bounds_of_bias_dipole_and_torque_alone(cells):
    exact = written(NewSatellite("my-3u", None, 550.0, 97.6, 4.0, (0.1, 0.34, 0.1), cells=cells))
    known = table_bounds(flight_table(exact))
    of_pulses = {"pulse_am2"}  # by how much a pulse is, not by how far it is off
    of_cells = {"cell_gain_part", "cell_light", "cell_excess", "earth_light"} if cells else set()
    wide = {name for name, value in asdict(known).items() if value} - of_pulses - of_cells
    assert wide == {"mag_bias_t", "dipole_am2", "torque_nm", "torque_variation_nm"}


def test_the_longest_edge_of_a_box_points_up():
    body = written(SATELLITES["6U"]).body
    assert tuple(np.diag(body.law_inertia)) == pytest.approx(
        (
            10.0 / 12.0 * (0.2263**2 + 0.1**2),
            10.0 / 12.0 * (0.366**2 + 0.1**2),
            10.0 / 12.0 * (0.366**2 + 0.2263**2),
        ),
        rel=1e-5,
    )


def test_moments_stay_in_the_user_s_order_and_the_axes_say_where_they_look():
    given = NewSatellite("mine", None, 550.0, 97.6, inertia_kgm2=(0.03, 0.04, 0.01), axes=("z", "x", "y"))
    body = written(given).body
    assert (body.inertia_kgm2, body.up, body.ahead) == ((0.03, 0.04, 0.01), "z", "x")
    assert "does not hold" not in scenario_text(given, "mine.toml")
    box = NewSatellite("mine", None, 550.0, 97.6, 4.0, (0.1, 0.2, 0.34), axes=("x", "y", "z"))
    assert (written(box).body.up, written(box).body.ahead) == ("x", "y"), "not the longest edge: as they said"
    unsaid = NewSatellite("mine", None, 550.0, 97.6, 4.0, (0.1, 0.2, 0.34))
    assert (written(unsaid).body.up, written(unsaid).body.ahead) == ("z", "y")


def test_a_continuous_driver_takes_the_dipole_given():
    given = NewSatellite(
        "mine", None, 550.0, 97.6, inertia_kgm2=(0.01, 0.03, 0.04), dipole_am2=0.3, continuous=True
    )
    coils = written(given).coils
    assert (coils.driver, coils.max_dipole_am2, coils.levels_am2[2]) == ("continuous", 0.3, 0.3)
    low, middle, high = coils.levels_am2
    assert 0.0 < 2.0 * low < middle < 0.5 * high


def test_cells_stand_in_place_of_the_sun_sensor():
    given = NewSatellite("mine", None, 550.0, 97.6, inertia_kgm2=(0.01, 0.03, 0.04), cells=True)
    scenario = written(given)
    assert scenario.sensors.cells is not None
    assert len(scenario.sensors.cells.normals) == 6


def test_a_body_that_the_gravity_gradient_turns_over_is_said_to_be_one():
    turned = NewSatellite("mine", None, 550.0, 97.6, inertia_kgm2=(0.03, 0.03, 0.01))
    assert "does not hold this body upright" in scenario_text(turned, "mine.toml")
    assert "does not hold" not in scenario_text(SATELLITES["6U"], "mine.toml")


@pytest.mark.parametrize("satellite", SATELLITES.values(), ids=SATELLITES)
def test_every_key_has_a_comment(satellite):
    lines = scenario_text(satellite, "mine.toml").splitlines()
    keys = [line for line in lines if " = " in line and not line.startswith(("#", " "))]
    named = {line.split(" = ")[0] for line in keys}
    plain = {line.split(" = ")[0] for line in keys if "#" not in line}
    assert plain <= {"name", "summary", "altitude_km", "inclination_deg", "tle", "angle_deg", "axis"}
    assert {"tick_hz", "levels_am2", "noise_nt", "law", "torque_nm"} <= named


@pytest.mark.parametrize("satellite", SATELLITES.values(), ids=SATELLITES)
def test_comments_stand_below_each_other(satellite):
    lines = scenario_text(satellite, "mine.toml").splitlines()
    commented = [line.split("# ", 1)[0] for line in lines if re.match(r"[a-z0-9_]+ = .*[^ ] +# ", line)]
    assert len(commented) > 20
    assert {max(34, len(value.rstrip()) + 1) - len(value) for value in commented} == {0}


@pytest.mark.long
def test_the_file_loads_and_the_way_on_is_said(tmp_path, capsys):
    file = tmp_path / "my-3u.toml"
    with speaking(Console("new")) as console:
        assert new(SATELLITES["3U"], file) == 0
    assert load(str(file)) == written(SATELLITES["3U"])
    assert f"fly it: torquer sil {file}" in capsys.readouterr().out
    assert console.answer["file"] == file
    assert console.answer["pointing_rms_deg"] == expect(load(str(file))).pointing_deg


def test_coils_that_are_too_weak_to_point_are_not_said_to(tmp_path, capsys):
    weak = NewSatellite("weak", None, 600.0, 97.0, None, None, (1.0, 1.9, 2.0), (0.02, 0.06, 0.11))
    file = tmp_path / "weak.toml"
    with speaking(Console("new")) as console:
        assert new(weak, file) == 0
    assert f"written: {file}; no pointing to expect (torquer size {file})\n" in capsys.readouterr().out
    assert console.answer["pointing_rms_deg"] is None


def test_nothing_is_overwritten(tmp_path):
    file = tmp_path / "my-3u.toml"
    file.write_text("mine")
    with pytest.raises(HarnessError, match="exists, and is not overwritten"):
        new(SATELLITES["3U"], file)
    assert file.read_text() == "mine"


@pytest.mark.parametrize(
    ("name", "file", "sentence"),
    [
        ("../x", "x.toml", "is no name of a scenario"),
        ("", "x.toml", "is no name of a scenario"),
        ("microsat", "x.toml", "is a scenario that ships"),
        ("mine", "mine.txt", "ends in .toml"),
    ],
)
def test_names_that_cannot_be(name, file, sentence, tmp_path):
    with pytest.raises(HarnessError, match=sentence):
        check_new(name, tmp_path / file)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("satellite", "sentence"),
    [
        (NewSatellite("x", None, 550.0, 97.6), "give --inertia-kgm2"),
        (NewSatellite("x", None, 550.0, 97.6, mass_kg=4.0), "give --inertia-kgm2"),
        (NewSatellite("x", None, 550.0, None, inertia_kgm2=(1.0, 1.0, 1.0)), "give --tle FILE"),
        (NewSatellite("x", None, 550.0, 97.6, inertia_kgm2=(1.0, 1.0, 3.0)), "no principal moment above"),
        (NewSatellite("x", None, 550.0, 97.6, inertia_kgm2=(1e300,) * 3), "--inertia-kgm2: 1e.300 is not"),
        (NewSatellite("x", None, 550.0, 97.6, mass_kg=inf, size_m=(1.0,) * 3), "--mass-kg: inf is not"),
        (NewSatellite("x", None, nan, 97.6, inertia_kgm2=(1.0,) * 3), "--altitude-km: nan is not"),
        (NewSatellite("x", None, 550.0, 97.6, 4.0, (0.0, 1.0, 1.0)), "--size-m: 0 is not"),
        (
            NewSatellite("x", None, 550.0, 97.6, inertia_kgm2=(1.0,) * 3, levels_am2=(0.2,) * 3),
            "three equal levels are one.*for coils of 0.2 A m.2 give --dipole-am2 0.2",
        ),
        (
            NewSatellite(
                "x", None, 550.0, 97.6, inertia_kgm2=(1.0,) * 3, levels_am2=(1.0, 2.0, 3.0), dipole_am2=3.0
            ),
            "--levels-am2 and --dipole-am2 exclude each other",
        ),
        (
            NewSatellite("x", None, 550.0, 97.6, inertia_kgm2=(1.0,) * 3, axes=("z", "z", "x")),
            "--axes: 'z z x' is not allowed",
        ),
    ],
)
def test_what_is_missing_is_named(satellite, sentence, tmp_path):
    with pytest.raises(HarnessError, match=sentence):
        new(satellite, tmp_path / "x.toml")
    assert list(tmp_path.iterdir()) == []


def test_a_name_cannot_break_the_file():
    json.dumps(
        scenario_text(NewSatellite("a.b-c_1", None, 550.0, 97.6, inertia_kgm2=(1.0, 1.0, 1.0)), "x.toml")
    )
