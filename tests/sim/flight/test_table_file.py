"""The onboard table written for flight software in another process: read back, it is the same table."""

import pytest

from fsw.table.table import load_flight_table
from sim.flight.table_file import FLIGHT_TABLE, write_flight_table
from sim.scenario.schema import flight_table, load, parse_settings, shipped

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
