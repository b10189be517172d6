"""``torquer phasing`` on a bench: boards that are wired wrongly, each a process of its own, in real time.

The verdict is drawn from the bus alone. A pair that is not told must be among those that are named.
"""

import json
import socket
import subprocess
import sys

import numpy as np
import pytest

from fsw.wire.messages import CoilFire, CoilStatus
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.pace import Pace
from sim.scenario.schema import load, parse_settings

pytestmark = [pytest.mark.long, pytest.mark.paced, pytest.mark.alone]

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
SEQUENCE = [(0, 3), (1, 3), (2, 3), (0, -3), (1, -3), (2, -3)]
"""Output and level: each coil in both polarities."""


def field_nt(folder):
    """Around the bench while the sequence runs, body axes."""
    scenario = load("microsat", parse_settings(QUICK))
    run_dir.begin(folder, scenario, 1, 150, "virtual", Pace())
    fly_virtual(folder, scenario, lambda tick: None)
    return np.nanmean(read_samples(folder / run_dir.BUS_LOG, 10).field_nt, axis=0).round().tolist()


def free_loop():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return f"loop:{free.getsockname()[1]}"


def bench(around_nt, magnetometer, coils, folder):
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
            *("--field-nt", *map(str, around_nt), "--offset-nt", "3000", "--out", str(folder)),
            *(word for setting in settings for word in ("--set", setting)),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def pulses(log):
    """Output and level of each pulse that the flight software asked for, and of each that was driven."""
    asked, driven = {}, {}
    for entry in read_log(log):
        if entry.frame.can_id == CoilFire.ID:
            fire = CoilFire.decode(entry.frame.data)
            asked[fire.seq] = (fire.coil, fire.level)
        elif entry.frame.can_id == CoilStatus.ID:
            status = CoilStatus.decode(entry.frame.data)
            if status.level:
                driven[status.seq] = (status.coil, status.level)
    return list(asked.values()), list(driven.values())


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory):
    """Of each bench, which all run at once: exit code, errors, document, log."""
    around_nt = field_nt(tmp_path_factory.mktemp("around") / "run")
    folders = {name: tmp_path_factory.mktemp("bench") / "run" for name in PAIRS}
    running = {name: bench(around_nt, *pair, folders[name]) for name, pair in PAIRS.items()}
    try:
        ended = {name: (*one.communicate(timeout=150), one.returncode) for name, one in running.items()}
    finally:
        for one in running.values():
            one.kill()
            one.communicate()
    return {
        name: (code, errors, json.loads(out or "{}"), folders[name] / run_dir.BUS_LOG)
        for name, (out, errors, code) in ended.items()
    }


@pytest.mark.parametrize("wrong", PAIRS)
def test_the_wiring_is_told_or_named_among_those_that_look_alike(verdicts, wrong):
    code, errors, found, _ = verdicts[wrong]
    pairs = [(tuple(pair["magnetometer"]), tuple(pair["coils"])) for pair in found["pairs"]]
    assert (code, found["as_table"]) == (1, False), errors
    assert PAIRS[wrong] in pairs
    assert len(pairs) <= 3
    assert all(1 <= used <= 2 for used in found["pulses"]), "a pulse beside a late tick is not used"


@pytest.mark.parametrize("wrong", PAIRS)
def test_each_coil_is_fired_in_both_polarities_and_no_other_law_fires(verdicts, wrong):
    *_, log = verdicts[wrong]
    assert pulses(log) == (SEQUENCE, SEQUENCE)
