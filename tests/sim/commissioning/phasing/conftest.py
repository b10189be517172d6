from functools import cache

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.samples import read_samples
from sim.commissioning.phasing.command import sequence_ticks, with_sequence
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import Pace
from sim.scenario.schema import flight_table, load

COILS = (-3, 1, 2)
"""Their wiring."""
CHANNELS = (2, -1, 3)
ERRORS = {
    "bias_nt": [24000.0, -9000.0, 5000.0],
    "scale": [1.03, 0.98, 1.01],
    "non_orthogonality_deg": [1.0, -1.5, 0.5],
    "latency_s": 0.6,
    "coil_field_nt_per_am2": [[1500.0, 700.0, -200.0], [-900.0, 2100.0, 400.0], [300.0, -100.0, 1800.0]],
}
SETTINGS = {
    "initial": {"rate_degps": [0.3, -0.2, 0.35], "angle_deg": 50.0, "axis": [1.0, 2.0, -0.5]},
    "coils": {"wiring": list(COILS)},
    "sensors": {"magnetometer": {**ERRORS, "wiring": list(CHANNELS)}},
}


@pytest.fixture(scope="session")
def wired():
    """The wirings of the satellite that is flown: (magnetometer, coils)."""
    return CHANNELS, COILS


@pytest.fixture(scope="session")
def flown(tmp_path_factory):
    """Flies the telecommanded sequence of a satellite that is wired wrongly: (run, samples, table)."""

    @cache
    def fly(channels=CHANNELS, ticks=None):
        magnetometer = {**ERRORS, "wiring": list(channels)}
        scenario = with_sequence(load("microsat", {**SETTINGS, "sensors": {"magnetometer": magnetometer}}), 1)
        folder = tmp_path_factory.mktemp("phasing") / "run"
        run_dir.begin(folder, scenario, 1, ticks or sequence_ticks(scenario, 1), "virtual", Pace())
        fly_virtual(folder, scenario, lambda tick: None)
        return folder, read_samples(folder / run_dir.BUS_LOG, 1), flight_table(scenario)

    return fly


@pytest.fixture(scope="session")
def bench_csv(tmp_path_factory):
    """A recorded bench log: two magnetometers, four levels along x, each 4 s on and 4 s off, with quirks.

    The first repeats y in z with the other sign; the second answers out of proportion.
    """
    lines = ["log_time_s,channel,mag_x_nt,mag_y_nt,mag_z_nt,cmd_x_am2,cmd_y_am2,cmd_z_am2"]
    draw, command, t = np.random.default_rng(1), 0.0, 100.0
    shown = 0.0
    for k in range(400):
        if k % 20 == 0:
            phase = k // 20
            command = 0.0 if phase % 2 == 0 else (0.01, 0.02, 0.04, 0.08)[phase // 2 % 4]
        x, y = 20000.0 + 3e5 * shown, -7000.0 - 5e5 * shown
        noise = draw.normal(size=2) * 200.0
        x, y = (round((value + error) / 1000.0) * 1000 for value, error in zip((x, y), noise, strict=True))
        other = round(5000.0 + 1e7 * shown**2)
        lines.append(f"{t:.4f},mag1,{x},{y},{-y},,,")
        lines.append(f"{t + 0.005:.4f},mag2,{other},1000,-3000,,,")
        lines.append(f"{t + 0.01:.4f},cmd,,,,{command:.6f},0.000000,0.000000")
        shown, t = command, t + 0.2
    path = tmp_path_factory.mktemp("bench") / "bench.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
