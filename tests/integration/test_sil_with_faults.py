"""A scenario that schedules faults: run, replayed to the last bit, and put through the plant again."""

from importlib import resources

import pytest

pytestmark = pytest.mark.long

FAULTS = """
[[fault]]
kind = "loss"
at_s = 50.0
lasts_s = 100.0
parameters = {part = 0.3}

[[fault]]
kind = "mag_bias"
at_s = 150.0
parameters = {axis = 1, nt = 20000}

[[fault]]
kind = "coil_board_restarts"
at_s = 201.0
lasts_s = 1.0

[[fault]]
kind = "random_frames"
at_s = 220.0
lasts_s = 20.0
parameters = {frames = 10, as_fsw = 0}
"""


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    shipped = resources.files("sim.scenario.shipped").joinpath("microsat.toml").read_text()
    path = tmp_path_factory.mktemp("scenario") / "faulty.toml"
    path.write_text(shipped + FAULTS)
    return path


@pytest.mark.parametrize("bus", ["virtual", "loop"])
def test_a_flight_with_faults_replays_to_the_last_bit(bus, scenario, sil_run, torquer):
    run = sil_run(str(scenario), "--orbits", "0.06", "--bus", bus)
    replayed = torquer("replay", run)
    assert replayed.code == 0, replayed.out
    assert "bit-exact" in replayed.out
    reproduced = torquer("replay", run, "--plant")
    assert reproduced.code == 0, reproduced.out


def test_both_buses_carry_the_same_faults(scenario, sil_run):
    logs = [
        (sil_run(str(scenario), "--orbits", "0.06", "--bus", bus) / "bus.log").read_text().splitlines()
        for bus in ("virtual", "loop")
    ]
    frames = [[line.split(" ", 2)[2] for line in log] for log in logs]
    assert frames[0] == frames[1]
