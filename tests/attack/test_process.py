"""The real board process keeps invariant I under attack in real time, judged by what it logs of its pins.

Some seconds as a rule; ``make attack`` takes ten minutes. Beside what is done to a board on the bus, the
process is killed and started anew, and stopped in the middle of a pulse.
"""

import os
import signal
import socket
import subprocess
import sys
import time
from queue import SimpleQueue
from random import Random
from threading import Thread

import pytest

from fsw.bus.open_bus import open_bus

SECONDS = float(os.environ.get("TORQUER_ATTACK_SECONDS", "3"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))
STARTS_WITHIN_S = 20.0
STOP, KILL = 0.03, 0.01
"""Parts of all waits in which the process is stopped, and before which it is killed."""


def now_ms():
    return time.monotonic_ns() // 1_000_000


class ProcessTarget:
    """``python -m hil_stub coil``, its bus hosted here."""

    def __init__(self, setup, judge, random):
        self._setup, self._judge, self._random = setup, judge, random
        with socket.create_server(("127.0.0.1", 0)) as free:
            self._spec = f"loop:{free.getsockname()[1]}"
        self._bus = open_bus(self._spec)
        self._until_ms = None  # of the pin that is on
        self._off_ms = None
        self._start()

    def now_ms(self):
        return now_ms()

    def off_at_ms(self):
        self._judge_lines()
        return self._off_ms if self._until_ms is None else self._until_ms

    def send(self, frame):
        self._bus.send([frame])
        self._hear()

    def wait(self, milliseconds):
        if milliseconds > 5 and self._random.random() < KILL:
            self.restart()
        stopped = milliseconds > 5 and self._random.random() < STOP
        if stopped:
            self._process.send_signal(signal.SIGSTOP)
        time.sleep(milliseconds / 1000.0)
        if stopped:
            self._process.send_signal(signal.SIGCONT)
        self._hear()

    def restart(self):
        self.stop()
        self._start()

    def stop(self):
        """Its power goes off."""
        self._process.kill()
        self._process.wait()
        killed_ms = now_ms()
        self._reader.join()
        self._judge_lines()
        self._off(killed_ms)

    def close(self):
        self.stop()
        self._bus.close()

    def _start(self):
        setup = self._setup
        words = {
            "--bus": self._spec,
            "--tick-hz": setup.tick_hz,
            "--pulse-s": setup.pulse_ms / 1000.0,
            "--backoff-s": setup.backoff_ms / 1000.0,
            "--backoff": "shared" if setup.shared else "per_coil",
            "--deadman-s": setup.deadman_ms / 1000.0,
            "--pins": "-",
        }
        command = [
            sys.executable,
            "-m",
            "hil_stub",
            "coil",
            *(str(w) for pair in words.items() for w in pair),
        ]
        self._process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self._lines = SimpleQueue()
        self._reader = Thread(target=self._read, args=(self._process.stdout, self._lines), daemon=True)
        self._reader.start()
        assert self._bus.receive(STARTS_WITHIN_S) is not None, "the board does not start"

    @staticmethod
    def _read(stream, lines):
        with stream:
            for line in stream:
                lines.put((now_ms(), line))

    def _hear(self):
        while self._bus.receive(0.0) is not None:
            pass
        self._judge_lines()

    def _judge_lines(self):
        while not self._lines.empty():
            heard_ms, line = self._lines.get()
            told_ms, what, *rest = line.split()
            at_ms = int(told_ms)
            assert at_ms <= heard_ms, "its clock is ahead of the time"
            self._off(at_ms)
            if what == "on":
                coil, level, _, until_ms = rest
                self._on = int(coil), int(level)
                self._until_ms = int(until_ms)
                self._judge.see(at_ms, self._on)

    def _off(self, at_ms):
        """What was on went off at this instant, or before by its timer."""
        if self._until_ms is None:
            return
        self._off_ms = min(at_ms, self._until_ms)
        if self._off_ms > self._judge.seen_ms:
            self._judge.see(self._off_ms - 1, self._on)
        self._judge.see(self._off_ms, None)
        self._until_ms = None


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per coil"])
def test_no_attack_on_the_process_breaks_a_limit(tools, shared):
    attacker_of, judge_of, setup_of = tools
    setup = setup_of(10, 300, 2000, shared, 500)
    judge = judge_of(setup)
    random = Random(f"{SEED}/{shared}")
    target = ProcessTarget(setup, judge, random)
    try:
        attacker = attacker_of(target, setup, random)
        end_s = time.monotonic() + SECONDS / 2
        while judge.pulses == 0 and time.monotonic() < end_s + STARTS_WITHIN_S:
            attacker.aim()
        while time.monotonic() < end_s:
            attacker.move()
    finally:
        target.close()
    print(
        f"\n{SECONDS / 2:g} s, {'shared' if shared else 'per coil'}: {attacker.requests} requests, "
        f"{judge.pulses} pulses, longest {judge.longest_ms} ms, least gap {judge.least_gap_ms} ms, "
        f"{len(judge.violations)} violations"
    )
    assert judge.violations == []
    assert judge.pulses >= max(1.0, SECONDS / 20.0), "it was let fire: no proof by doing nothing"
