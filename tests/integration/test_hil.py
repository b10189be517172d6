"""``torquer hil``: everything in real time, each node a process of its own. Several benches run at once."""

import json
import os
import signal
import socket
import subprocess
import sys
import time

import pytest

from fsw.bus.open_bus import open_bus
from fsw.wire.messages import MagField, SunVector, TcAck, TcLaw, TcMode
from torquer.cli.main import main

pytestmark = [pytest.mark.long, pytest.mark.paced, pytest.mark.alone]

SHORT = ("--set", "coils.pulse_s=0.5", "--set", "coils.backoff_s=1.0", "--tick-hz", "10")
LOOSE = ("--jitter-ms", "1000", "--latency-ms", "1000", "--slips", "15")
"""What is tested is the bench, not how busy this machine is."""
COMMANDED = 'telecommand=[{at_s=1.5, message="TC_LAW", law="bdot"}]'
COMMANDED_TOO_LATE = 'telecommand=[{at_s=4.0, message="TC_MODE", mode="SAFE"}]'

SCRIPT = """
[[step]]
t_s = 0.0
field_nt = [20000, 0, -30000]
sun = [0.0, 1.0, 0.0]
[[step]]
t_s = 1.0
sun = false
"""


def start(*words):
    command = [sys.executable, "-m", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def torquer(*words):
    return subprocess.run(
        [sys.executable, "-m", "torquer", *words], capture_output=True, text=True, check=False
    )


def free_loop():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return f"loop:{free.getsockname()[1]}"


def bench(*words):
    return start("torquer", "hil", *SHORT, "--json", *words)


def children(pid):
    """Process ids of the children, by what they run."""
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
        pids = file.read().split()
    found = {}
    for child in pids:
        with open(f"/proc/{child}/cmdline", encoding="utf-8") as file:
            found[file.read().split("\0")[2]] = int(child)
    return found


def kill_its_fsw(process, log):
    """When a bench has run for two seconds, its flight software is killed."""
    while process.poll() is None and not (log.exists() and log.read_text().count(" 180#") > 20):
        time.sleep(0.05)
    os.kill(children(process.pid)["fsw"], signal.SIGKILL)


@pytest.fixture(scope="module")
def benches(tmp_path_factory):
    """Each bench: numbers, errors, exit code, run directory."""
    path = tmp_path_factory.mktemp("hil")
    script = path / "script.toml"
    script.write_text(SCRIPT)
    runs = {name: path / name for name in ("armed", "real", "killed")}
    bus = free_loop()
    hub = open_bus(bus)  # so that the board that is not there finds nobody, and the one that is, a bus
    running = {
        "armed": bench("--arm", "--seconds", "6", "--out", str(runs["armed"]), "--set", COMMANDED, *LOOSE),
        "real": bench(
            *("--seconds", "4", "--bus", bus, "--real", "coil,sun", "--stimulus", str(script)),
            *("--set", COMMANDED_TOO_LATE, "--out", str(runs["real"]), *LOOSE),
        ),
        "killed": bench("--seconds", "6", "--out", str(runs["killed"]), *LOOSE),
    }
    sun = start("hil_stub", "sun", "--bus", bus, "--tick-hz", "10", "--stimulus", str(script))
    try:
        kill_its_fsw(running["killed"], runs["killed"] / "bus.log")
        ended = {name: (*bench.communicate(timeout=150), bench.returncode) for name, bench in running.items()}
    finally:
        for process in (*running.values(), sun):
            process.kill()
            process.communicate()
        hub.close()
    return {name: (json.loads(out), errors, code, runs[name]) for name, (out, errors, code) in ended.items()}


def test_an_armed_bench_flies_in_real_time_and_its_log_is_as_good_as_any(benches):
    numbers, errors, code, run = benches["armed"]
    assert (errors, code) == ("", 0)
    assert (numbers["ticks"], numbers["armed"], numbers["real"]) == (60, True, [])
    assert 0.0 < numbers["latency_ms"]["p50"] <= numbers["latency_ms"]["p99"] <= numbers["latency_ms"]["max"]
    assert 2.0 < numbers["bus_load_percent"]["mean"] < 20.0
    assert numbers["messages"]["TICK_DONE"] >= 45
    assert json.loads((run / "hil.json").read_text()).items() <= numbers.items()
    audited = torquer("check", str(run))
    assert audited.returncode == 0, audited.stdout + audited.stderr
    reflown = torquer("replay", str(run))
    assert reflown.stdout.startswith("bit-exact: 60 ticks"), reflown.stdout + reflown.stderr


def test_the_telecommands_of_the_scenario_are_sent_at_their_time_and_answered(benches):
    lines = (benches["armed"][3] / "bus.log").read_text().splitlines()
    frames = [line.split()[2].partition("#") for line in lines]
    names = [can_id for can_id, _, _ in frames]
    sent = names.index(f"{TcLaw.ID:03X}")
    assert names[:sent].count("180") == 15, "SYNC of ticks 0 to 14"
    (acknowledged,) = [
        TcAck.decode(bytes.fromhex(data)) for can_id, _, data in frames if can_id == f"{TcAck.ID:03X}"
    ]
    assert (acknowledged.command, acknowledged.result) == (TcLaw.ID, 0)
    assert acknowledged.tick in (15, 16)


def test_a_telecommand_after_the_last_tick_is_not_sent_and_the_bench_says_so(benches):
    numbers, errors, _, run = benches["real"]
    sentence = "telecommand[0], TC_MODE at 4 s, will not be sent: the last tick is at 3.9 s"
    assert numbers["warnings"] == [sentence]
    assert errors.startswith(f"torquer: warning: {sentence}\n")
    assert f" {TcMode.ID:03X}#" not in (run / "bus.log").read_text()


def test_a_real_board_is_not_started_and_one_that_is_silent_breaks_its_budget(benches):
    numbers, _, code, _ = benches["real"]
    assert code == 1
    assert numbers["real"] == ["coil", "sun"]
    assert set(numbers["memory"]["kib"]) == {"bench", "fsw", "magnetometer"}
    broken = [line["name"] for line in numbers["budgets"] if not line["kept"]]
    assert broken == ["ticks without one coil sample"], "the Sun sensor of another shell is on the bus"


def test_not_armed_nothing_is_asked_and_a_script_is_shown(benches):
    numbers, _, _, run = benches["real"]
    assert not numbers["armed"]
    frames = [line.split()[2].partition("#") for line in (run / "bus.log").read_text().splitlines()]
    assert not any(can_id == "080" for can_id, _, _ in frames)
    sun = [SunVector.decode(bytes.fromhex(data)) for can_id, _, data in frames if can_id == "118"]
    lit = [sample.values()[:4] for sample in sun if sample.valid]
    assert set(lit) == {(1, 0.0, 1.0, 0.0)}
    assert 8 <= len(lit) <= 11
    assert len(sun) >= 25
    fields = {
        MagField.decode(bytes.fromhex(data)).values()[:4] for can_id, _, data in frames if can_id == "110"
    }
    assert fields == {(1, 20_000.0, 0.0, -30_000.0)}


def test_the_bench_goes_on_without_its_flight_software_and_says_so(benches):
    numbers, errors, code, _ = benches["killed"]
    assert code == 1
    assert numbers["ticks"] == 60
    assert numbers["slips"] > 15
    assert set(numbers["ended"]) == {"fsw"}
    assert errors.startswith("torquer: fsw ended before its time")
    assert numbers["missing_samples"]["coil"] <= 15, "the boards go on"


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--real", "coil,gyro"), "gyro"),
        (("--stimulus", "x.log", "--set", "knowledge=perfect"), "perfect"),
        (("--set", 'fault=[{kind="mag_bias", at_s=3.0}]'), "mag_bias"),
        (("--bus", "nowhere"), "nowhere"),
        (("--seconds", "0"), "--seconds"),
        (("nonesuch",), "nonesuch"),
    ],
)
def test_what_cannot_be_is_one_sentence(capsys, words, named):
    with pytest.raises(SystemExit) as ended:
        main(["hil", *words])
    output = capsys.readouterr()
    assert (ended.value.code, output.out) == (2, "")
    (sentence,) = output.err.splitlines()
    assert named in sentence


def test_a_node_that_does_not_start_is_named_with_what_it_said():
    done = torquer("hil", "--stimulus", "no.such.log", "--seconds", "1")
    assert done.returncode == 2
    (sentence,) = done.stderr.splitlines()
    assert "node does not start" in sentence
    assert "no.such.log" in sentence
