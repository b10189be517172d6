"""A flight on a loop bus to which 10 000 strangers rush: who gets in never reads, all others are refused."""

import json
import subprocess
import sys

import pytest

CONNECTS = 10_000

PACE = 400
"""A flight in lockstep is over before so many have come."""

ORBIT_S = 6000.0

RUSH = """
import os, resource, socket, sys, time
run, port, connects = sys.argv[1], *map(int, sys.argv[2:])
hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
log = os.path.join(run, "bus.log")
while not os.path.exists(log) or not os.path.getsize(log):
    time.sleep(0.01)
held = []
for _ in range(connects):
    held.append(socket.create_connection(("127.0.0.1", port)))
    if len(held) > hard - 100:
        held.pop().close()
print("flown" in open(os.path.join(run, "run.json")).read(), flush=True)
time.sleep(600)
"""
"""Waits for the flight to begin, connects so often, keeps what it got. Says whether the flight was over."""


@pytest.mark.long
@pytest.mark.slow
def test_a_rush_of_strangers_does_not_hold_up_a_flight(torquer, port, tmp_path):
    run = tmp_path / "run"
    strangers = [sys.executable, "-c", RUSH, str(run), str(port), str(CONNECTS)]
    with subprocess.Popen(strangers, stdout=subprocess.PIPE, text=True) as rush:
        try:
            words = ["--orbits", "1", "--pace", f"realtime:{PACE}", "--bus", f"loop:{port}"]
            outcome = torquer("sil", *words, "--out", run)
            assert rush.stdout.readline() == "False\n", "the flight was over before the rush was"
        finally:
            rush.kill()
    assert outcome.code == 0
    assert "bit-exact" in outcome.out
    assert [line.rpartition(": ")[2] for line in outcome.err.splitlines()] == [
        f"{count} refused" for count in (1, 10, 100, 1000)
    ]
    flight = json.loads((run / "run.json").read_text())
    assert flight["complete"]
    assert flight["flown"]["wall_s"] < 2.0 * ORBIT_S / PACE
