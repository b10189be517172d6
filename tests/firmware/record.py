"""Try the coil board in C on an emulated Cortex-M3 and write docs/firmware-qemu.md: ``make firmware-qemu``.

A million requests as a rule, and a minute in real time. The exit code is 1 if a check fails or a limit is
broken.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from random import Random

from coil_attack import SETUPS, Judge, Setup, attack
from emulated_board import (
    CROSS,
    EMULATOR,
    MACHINE,
    NO_EMULATOR,
    EmulatedStep,
    EmulatedTarget,
    build_images,
    has_emulator,
    start_board,
)
from firmware_bench import FirmwareBench
from process_target import attack_in_real_time
from simulated_bus import SimulatedBus

from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import run_checks
from sim.record.whole_file import replace_text

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "firmware-qemu.md"
SEED = 20150327
SHORT = {"pulse_ms": 1200, "backoff_ms": 3900, "deadman_ms": 2000}
REAL_TIME = Setup(10, 300, 2000, True, 500)
CORE_STATE = ("board", "sent")
"""The variables of the image that hold all that the core remembers, and what it sends."""


def main():
    """Build, measure, check, attack, and write the page."""
    arguments = _arguments()
    if not has_emulator():
        print(f"firmware-qemu: {NO_EMULATOR}", file=sys.stderr)
        return 2
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sizes = _say("sizes", _sizes(build_images(folder / "sizes")))
        checks = _say("conformance in real time", _conformance(build_images(folder / "short", **SHORT)))
        flight = _say("conformance with the limits of flight", _conformance_of_flight(folder / "flight"))
        rows = [
            _say(f"attack: {title}", _attack(folder / f"attack{number}", title, setup, arguments.requests))
            for number, (title, setup) in enumerate(SETUPS.items())
        ]
        real = _say("attack in real time", _attack_in_real_time(folder / "real", arguments.seconds))
    page = _page(sizes, checks, flight, rows, real, time.monotonic() - began)
    replace_text(arguments.out, page)
    print(page)
    failed = [check for check in checks if check["failure"]] + flight
    violations = sum(len(judge.violations) for _, _, judge in rows) + len(real[1].violations)
    return int(bool(failed) or violations > 0)


def _arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--requests", type=int, default=1_000_000, help="default: a million")
    parser.add_argument("--seconds", type=float, default=60.0, help="of the attack in real time, default: 60")
    parser.add_argument("--out", type=Path, default=PAGE)
    return parser.parse_args()


def _say(what, result):
    print(f"firmware-qemu: {what}: done", file=sys.stderr, flush=True)
    return result


def _text(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def _sizes(build):
    """Bytes of code of each part of the core, and of RAM."""
    code = {}
    for line in _text(f"{CROSS}size", str(build / "libcoil_board.a")).splitlines()[1:]:
        text, _, _, _, _, name, *_ = line.split()
        code[name.removesuffix(".obj")] = int(text)
    state = {}
    for line in _text(f"{CROSS}nm", "-S", "--defined-only", str(build / "coil_board.elf")).splitlines():
        words = line.split()
        if len(words) == 4 and words[3] in CORE_STATE:
            state[words[3]] = int(words[1], 16)
    image = _text(f"{CROSS}size", str(build / "coil_board.elf")).splitlines()[1].split()
    return code, state, (int(image[0]) + int(image[1]), int(image[1]) + int(image[2]))


def _conformance(build):
    """The checks of ``torquer hil --conformance``, over the emulated UART."""
    board, spec = start_board(build / "coil_board.elf")
    limits = ("--set", "coils.pulse_s=1.2", "--set", "coils.backoff_s=3.9", "--deadman-s", "2.0")
    words = ("torquer", "hil", "--conformance", "coil", "--bus", spec, "--tick-hz", "1", *limits)
    try:
        done = subprocess.run(
            [sys.executable, "-m", *words, "--arm", "--json"], check=False, capture_output=True, text=True
        )
    finally:
        board.kill()
        board.communicate()
    if not done.stdout:
        sys.exit(f"firmware-qemu: {done.stderr.strip()}")
    return json.loads(done.stdout)["checks"]


def _conformance_of_flight(folder):
    """What fails of the same checks in simulated time, with the limits of flight."""
    step = EmulatedStep(build_images(folder) / "harness.elf")
    bus = SimulatedBus(FirmwareBench(step))
    link = BoardLink(bus, BOARD_KINDS["coil"], 1, clock=lambda: bus.now_s)
    try:
        return [result for result in run_checks(link, BoardLimits(), armed=True) if result.failure]
    finally:
        step.close()


def _attack(folder, title, setup, requests):
    step = EmulatedStep(build_images(folder, **setup._asdict()) / "harness.elf")
    try:
        attacker, judge = attack(setup, FirmwareBench(step), requests // len(SETUPS), SEED)
    finally:
        step.close()
    return title, attacker, judge


def _attack_in_real_time(folder, seconds):
    judge, random = Judge(REAL_TIME), Random(SEED)
    image = build_images(folder, **REAL_TIME._asdict()) / "coil_board.elf"
    target = EmulatedTarget(image, judge, random)
    return attack_in_real_time(target, REAL_TIME, judge, random, seconds), judge


def _page(sizes, checks, flight, rows, real, wall_s):
    code, state, (flash, ram) = sizes
    compiler = _text(f"{CROSS}gcc", "--version").splitlines()[0]
    emulator = _text(EMULATOR, "--version").splitlines()[0]
    of_flight = f"{', '.join(result.name for result in flight)} failed" if flight else "all kept"
    kept = sum(1 for check in checks if check["ran"] and not check["failure"])
    lines = [
        "# The coil board in C on a Cortex-M3",
        "",
        f"Written by `make firmware-qemu`: {EMULATOR} as the board {MACHINE}, a Cortex-M3 at 25 MHz, in "
        f"{wall_s / 60.0:.0f} minutes.",
        f"{compiler}; {emulator}. What the board is: [firmware.md](firmware.md).",
        "",
        "## Size",
        "",
        "| part of the core | code and constants, bytes |",
        "|---|---|",
        *(f"| `{name}` | {size} |" for name, size in sorted(code.items())),
        f"| all | {sum(code.values())} |",
        "",
        f"Its state has {state['board']} bytes of RAM, its outbox {state['sent']}; nothing else is static.",
        f"The whole image, with startup, slcan, two UARTs and a log of its outputs: {flash} bytes of flash,",
        f"{ram} of RAM without the stack.",
        "",
        "## Conformance",
        "",
        "`torquer hil --conformance coil` over slcan on its UART, in real time, with pulses of 1.2 s,",
        f"a back-off of 3.9 s and a dead-man of 2 s: {kept} of {len(checks)} kept. With those of flight,",
        f"in simulated time, by the same machine code: {of_flight}.",
        "",
        *(f"- `{check['name']}`: {check['failure']}" for check in checks if check["failure"]),
        "## Under attack",
        "",
        "The attacker of `tests/attack`, in simulated time that is an argument of the board. Invariant I is",
        "judged by its outputs alone, over the true time.",
        "",
        "| board | requests | pulses | longest pulse, ms | allowed | least gap, ms | allowed | violations |",
        "|---|---|---|---|---|---|---|---|",
        *(
            f"| {title} | {attacker.requests} | {judge.pulses} | {judge.longest_ms} | {judge.setup.pulse_ms} "
            f"| {judge.least_gap_ms} | {judge.setup.backoff_ms} | {len(judge.violations)} |"
            for title, attacker, judge in rows
        ),
        "",
        f"In real time over its UART, its outputs reported by a second one: {real[0].requests} requests, "
        f"{real[1].pulses} pulses, the longest {real[1].longest_ms} ms of",
        f"{REAL_TIME.pulse_ms}, the least gap {real[1].least_gap_ms} ms of {REAL_TIME.backoff_ms}, "
        f"{len(real[1].violations)} violations.",
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
