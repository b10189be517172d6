"""What is about to be written is read first: files and programs have one set of bounds."""

import pytest

from fsw.input.schema import TableError, merge
from fsw.input.toml_text import MOST_BYTES, parse_toml
from fsw.table.table import load_flight_table
from sim.scenario.schema import flight_table, load, parse_settings, scenario_of, shipped
from sim.scenario.written import FLIGHT_TABLE, scenario_toml, values_of, write_flight_table

RESIDUE = 2.2e-19
TURNED = [[1.02, RESIDUE, 0.0], [RESIDUE, 1.85, 0.0], [0.0, 0.0, 1.95]]


def changed(**over):
    return scenario_of(merge(values_of(load("microsat")), over), "microsat")


def again(scenario):
    return scenario_of(parse_toml(scenario_toml(scenario)), "again")


@pytest.mark.parametrize("scenario", shipped(), ids=lambda scenario: scenario.name)
def test_a_scenario_that_ships_is_read_as_what_it_was(scenario):
    assert again(scenario) == scenario


def test_what_rounding_has_left_of_a_product_of_inertia_is_zero():
    scenario = changed(body={"inertia_kgm2": TURNED})
    assert scenario.body.inertia == ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))
    assert again(scenario) == scenario


def test_the_same_in_a_setting_of_the_command_line():
    assert load("microsat", parse_settings((f"body.inertia_kgm2={TURNED}",))) == changed(
        body={"inertia_kgm2": TURNED}
    )


BEYOND = "is not allowed: a number is 0, or from 1e-18 to 1e\\+15 in magnitude"


@pytest.mark.parametrize(
    ("over", "key"),
    [
        ({"disturbance": {"torque_nm": [1e-19, 0.0, 0.0]}}, "disturbance.torque_nm.0"),
        ({"disturbance": {"eddy_nms_per_t2": 1e-19}}, "disturbance.eddy_nms_per_t2"),
        ({"sensors": {"magnetometer": {"bias_nt": [0.0, 1e16, 0.0]}}}, "sensors.magnetometer.bias_nt.1"),
        ({"flight": {"control": {"k_w": 1e-300}}}, "flight.control.k_w"),
    ],
)
def test_a_program_has_the_bounds_of_a_file(over, key):
    with pytest.raises(TableError, match=f"^microsat: {key} {BEYOND}$"):
        changed(**over)


@pytest.mark.long
@pytest.mark.parametrize(
    ("summary", "why"),
    [
        ("\udcff", r"cannot be written: '\\udcff' is no character of a text"),
        ("x" * MOST_BYTES, f"could not be read again: .* bytes, at most {MOST_BYTES} are read"),
    ],
)
def test_what_could_not_be_read_is_refused(summary, why):
    with pytest.raises(TableError, match=f"^scenario: {why}$"):
        scenario_toml(load("microsat").model_copy(update={"summary": summary}))


def test_so_is_a_scenario_that_no_file_can_give():
    unchecked = load("microsat").model_copy(update={"knowledge": "all"})
    with pytest.raises(TableError, match="knowledge"):
        scenario_toml(unchecked)


# --- The onboard table written for flight software in another process: read back, it is the same table

SCENARIOS = [scenario.name for scenario in shipped()]
SETTINGS = {
    "none": (),
    "tick rate and dwell times": ("time.tick_hz=2", "flight.modes.settle_s=20.0", "flight.modes.hold_s=0.1"),
    "last digits": (
        "body.inertia_kgm2=[[0.1, 1e-9, 0.0], [1e-9, 0.30000000000000004, 0.0], [0.0, 0.0, 0.3]]",
    ),
}
CONTINUOUS = ("coils.driver=continuous", "coils.max_dipole_am2=5.0", "coils.on_fraction=0.8")


def check(scenario, folder):
    path = write_flight_table(folder, scenario)
    assert path == folder / FLIGHT_TABLE
    table, resolved = load_flight_table(str(path)), flight_table(scenario)
    assert table == resolved
    assert table.crc == resolved.crc


@pytest.mark.parametrize("settings", SETTINGS.values(), ids=SETTINGS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_of_every_shipped_scenario_with_settings_laid_over_it(name, settings, tmp_path):
    check(load(name, parse_settings(settings)), tmp_path)


@pytest.mark.parametrize(
    "settings",
    [
        ("coils.backoff=per_coil", "coils.pulse_s=2.5"),
        (*CONTINUOUS, "flight.control.law=lqr"),
        ("flight.control.law=bdot_switched", "flight.control.gains.bdot_switched.factor=3.3"),
    ],
    ids=["per coil", "continuous", "gains of a law"],
)
def test_of_another_driver_back_off_or_law(settings, tmp_path):
    check(load("microsat", parse_settings(settings)), tmp_path)
