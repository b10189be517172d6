"""``torquer phasing`` on a bench: boards that are wired wrongly, each a process of its own, in real time.

The verdict is drawn from the bus alone. A pair that is not told must be among those that are named.
"""

import json
import socket
import subprocess
import sys

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.samples import read_samples
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import Pace
from sim.scenario.schema import load, parse_settings

pytestmark = [pytest.mark.long, pytest.mark.paced]

QUICK = (
    "time.tick_hz=10",
    "coils.pulse_s=0.5",
    "coils.backoff_s=1.0",
    "initial.rate_degps=[0.02,-0.01,0.015]",
    "flight.modes.recover_s=2.0",
)
COIL_FIELD = [[2400.0, -1800.0, -1000.0], [400.0, 1200.0, 2000.0], [-400.0, 1200.0, 1100.0]]
PAIRS = {
    "the magnetometer": ((2, -1, 3), (1, 2, 3)),
    "a coil": ((1, 2, 3), (1, 2, -3)),
    "both": ((-3, 2, 1), (3, -1, 2)),
}
"""Wiring of the magnetometer's channels and of the coils."""


def field_nt(folder):
    """Around the bench while the sequence runs, body axes."""
    scenario = load("microsat", parse_settings(QUICK))
    run_dir.begin(folder, scenario, 1, 150, "virtual", Pace())
    fly_virtual(folder, scenario, lambda tick: None)
    return np.nanmean(read_samples(folder / run_dir.BUS_LOG, 10).field_nt, axis=0).round().tolist()


def free_loop():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return f"loop:{free.getsockname()[1]}"


def bench(around_nt, magnetometer, coils):
    settings = (
        *QUICK,
        f"coils.wiring={json.dumps(coils)}",
        f"sensors.magnetometer.wiring={json.dumps(magnetometer)}",
        f"sensors.magnetometer.coil_field_nt_per_am2={COIL_FIELD}",
        f"flight.calibration.coils.field_nt_per_am2={COIL_FIELD}",
    )
    return subprocess.Popen(
        [
            *(
                sys.executable,
                "-m",
                "torquer",
                "phasing",
                "microsat",
                "--bus",
                free_loop(),
                "--arm",
                "--json",
            ),
            *("--field-nt", *map(str, around_nt), "--offset-nt", "3000"),
            *(word for setting in settings for word in ("--set", setting)),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory):
    """Of each bench, which all run at once: exit code, errors, document."""
    around_nt = field_nt(tmp_path_factory.mktemp("around") / "run")
    running = {name: bench(around_nt, *pair) for name, pair in PAIRS.items()}
    try:
        ended = {name: (*one.communicate(timeout=150), one.returncode) for name, one in running.items()}
    finally:
        for one in running.values():
            one.kill()
            one.communicate()
    return {name: (code, errors, json.loads(out or "{}")) for name, (out, errors, code) in ended.items()}


@pytest.mark.parametrize("wrong", PAIRS)
def test_the_wiring_is_told_or_named_among_those_that_look_alike(verdicts, wrong):
    code, errors, found = verdicts[wrong]
    pairs = [(tuple(pair["magnetometer"]), tuple(pair["coils"])) for pair in found["pairs"]]
    assert (code, found["as_table"]) == (1, False), errors
    assert PAIRS[wrong] in pairs
    assert len(pairs) <= 3
    assert found["pulses"] == [2, 2, 2], "each coil in both polarities, and no other law meanwhile"
