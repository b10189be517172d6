"""Small campaigns: every kind of dispersion, and runs of two minutes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.definition.columns import input_cells
from sim.campaign.results.store import RunRow, Status
from sim.statistics.indices import INDICES, POINTS

CAMPAIGN = """
scenario = "microsat"
runs = 6
orbits = 0.02
seed = 11

[set]
sensors.magnetometer.noise_nt = 150.0

[requirement]
pointing_deg = 60.0

[index]
ape = 150.0
rpe = 100.0
mpe = 170.0

[statistics]
last_orbits = 0.01
window_s = 20.0

[[disperse]]
key = "sensors.magnetometer.bias_nt"
distribution = "normal"
mean = [10.0, 20.0, 30.0]
sigma = [100.0, 200.0, 300.0]

[[disperse]]
key = "disturbance.residual_dipole_am2"
distribution = "direction"
length = "log_uniform"
low = 0.001
high = 0.1

[[disperse]]
key = "initial.angle_deg"
distribution = "uniform"
low = 20.0
high = 80.0

[[disperse]]
key = "body.inertia_kgm2"
distribution = "normal"
apply = "multiply"
mean = 1.0
sigma = 0.02
low = 0.95
high = 1.05

[[disperse]]
key = "coils.backoff"
distribution = "choice"
values = ["shared", "per_coil"]

[[disperse]]
keys = ["sensors.sun.misalignment_deg.0", "sensors.sun.misalignment_deg.2"]
distribution = "correlated"
mean = [0.1, -0.1]
covariance = [[0.04, 0.02], [0.02, 0.04]]

[[disperse]]
key = "flight.estimator.sun_sigma_deg"
distribution = "log_uniform"
low = 0.3
high = 0.8
"""


@pytest.fixture(scope="session")
def campaign_file(tmp_path_factory) -> Path:
    """A campaign file. Not to be changed."""
    path = tmp_path_factory.mktemp("campaign") / "small.toml"
    path.write_text(CAMPAIGN)
    return path


@pytest.fixture(scope="session")
def small(campaign_file):
    """The campaign of that file."""
    return load_campaign(str(campaign_file), {}, {})


@pytest.fixture(scope="session")
def row_of():
    """Makes the row of a run that was flown, with made-up figures, but for the changes."""

    def made(campaign, run, **changes):
        drawn = campaign.draw(run)
        figures = {"limits_ok": 1, "pointing_deg_rms_last_orbit": 1.0 / (run + 3), "mode_final": "POINT"}
        profiles = {name: np.linspace(0.5, run, POINTS).astype("<f4").tobytes() for name in INDICES}
        inputs = input_cells(drawn.inputs)
        row = RunRow(run, Status.DONE, "", drawn.seed, True, "", inputs | figures, profiles, 0.25)
        return replace(row, **changes)

    return made
