"""Short flights in one process, with nothing zero and no two axes alike."""

import pytest

from fsw.input.schema import merge
from fsw.table.config import flight_config
from sim.harness import run_dir, virtual
from sim.harness.pace import Pace
from sim.harness.scenario import flight_table, load, parse_settings

UNEVEN = parse_settings(
    (
        "body.inertia_kgm2=[[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]",
        "initial.axis=[0.5, -0.7, 0.4]",
        "initial.rate_degps=[0.05, -0.07, 0.04]",
        "sensors.magnetometer.bias_nt=[150.0, -250.0, 100.0]",
        "disturbance.torque_nm=[3e-8, -2e-8, 1e-8]",
        "disturbance.residual_dipole_am2=[0.003, 0.002, -0.004]",
        "flight.modes.settle_s=20.0",
    )
)


@pytest.fixture(scope="session")
def fly_run(tmp_path_factory):
    """Flies a run on the virtual bus; keywords are settings laid over the scenario. Returns its directory."""

    def fly(ticks=300, seed=5, scenario="microsat", **overrides):
        path = tmp_path_factory.mktemp("runs") / "run"
        flown = load(scenario, merge(UNEVEN, overrides))
        run_dir.begin(path, flown, seed, ticks, "virtual", Pace())
        virtual.fly_virtual(path, flown, lambda tick: None)
        return path

    return fly


@pytest.fixture(scope="session")
def flown_run(fly_run):
    """A run of 300 ticks, two pulses in it. Not to be changed: copy what is to be broken."""
    return fly_run()


@pytest.fixture(scope="session")
def config_of():
    """The flight config of a run directory."""
    return lambda path: flight_config(flight_table(run_dir.read_scenario(path)))
