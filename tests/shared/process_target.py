"""A board that is a process of its own, under attack in real time.

Beside what is done to it on the bus it is killed and started anew, and stopped in the middle of a pulse.
"""

import signal
import socket
import subprocess
import time
from queue import SimpleQueue
from threading import Thread

from coil_attack import Attacker

from fsw.bus.open_bus import open_bus

STARTS_WITHIN_S = 20.0


def now_ms():
    return time.monotonic_ns() // 1_000_000


class ProcessTarget:
    """A board on a loop bus that is hosted here, which logs its pins on stdout.

    Args:
        command_of: the words that start it on a bus.
        judge: is shown its pins.
        random: chooses when it is killed, and when it is stopped.
    """

    STOP, KILL = 0.03, 0.01
    """Parts of all waits in which the process is stopped, and before which it is killed."""
    AHEAD_MS = 0
    """By so much its clock may seem to be ahead of this machine's."""

    def __init__(self, command_of, judge, random):
        self._command_of, self._judge, self._random = command_of, judge, random
        self._open()
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
        if milliseconds > 5 and self._random.random() < self.KILL:
            self.restart()
        stopped = milliseconds > 5 and self._random.random() < self.STOP
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

    def _open(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            self._spec = f"loop:{free.getsockname()[1]}"
        self._bus = open_bus(self._spec)

    def _start(self):
        self._process = subprocess.Popen(
            self._command_of(self._spec), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
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
            at_ms = self._true_ms(int(told_ms))
            assert at_ms <= heard_ms + self.AHEAD_MS, "its clock is ahead of the time"
            self._off(at_ms)
            if what == "on":
                coil, level, _, until_ms = rest
                self._on = int(coil), int(level)
                self._until_ms = self._true_ms(int(until_ms))
                self._judge.see(at_ms, self._on)

    def _true_ms(self, told_ms):
        """The time that the board calls so: its clock is this machine's."""
        return told_ms

    def _off(self, at_ms):
        """What was on went off at this instant, or before by its timer."""
        if self._until_ms is None:
            return
        self._off_ms = min(at_ms, self._until_ms)
        if self._off_ms > self._judge.seen_ms:
            self._judge.see(self._off_ms - 1, self._on)
        self._judge.see(self._off_ms, None)
        self._until_ms = None


def attack_in_real_time(target, setup, judge, random, seconds):
    """Attack a target for so long, at least until a pulse was driven, and close it: the attacker."""
    try:
        attacker = Attacker(target, setup, random)
        end_s = time.monotonic() + seconds
        while judge.pulses == 0 and time.monotonic() < end_s + STARTS_WITHIN_S:
            attacker.aim()
        while time.monotonic() < end_s:
            attacker.move()
    finally:
        target.close()
    return attacker
