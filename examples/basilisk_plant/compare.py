"""The same scenario over Torquer's own plant and over Basilisk's: figures side by side, and a verdict.

    python compare.py [SCENARIO] [--orbits N] [--seeds 1,2,3] [--out DIR] [--page FILE.md]

Every figure of both plants is computed here, from bus.log and truth.h5 of the run. Exit code 1: they differ
by more than ``WITHIN_DEG``, a unit was isolated, or the audit or the replay of a flight failed.
"""

import argparse
import subprocess
import sys
import tomllib
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from basilisk_plant import LEAST_LIT, fly, relative_motion
from boards import COIL_FIRE, COIL_REFUSED, SYNC, signed, unsigned
from satellite import Array, Satellite, epoch_unix_s, orbit_s

WITHIN_DEG = 0.2
CONVERGED_DEG, CONVERGED_S = 2.0, 600.0
NAV_ATTITUDE, FSW_EVENT = 0x200, 0x410
SENSOR_ISOLATED, COIL_FAULT = 7, 10
"""Events of the flight software (docs/telemetry.md)."""


class Bus(NamedTuple):
    """What the log of a flight says.

    Attributes:
        q_estimated: q_body_from_orbit of each tick, scalar first; NaN where none is sent.
        pulses: requests.
        refused: of them.
        isolated: units.
    """

    q_estimated: Array
    pulses: int
    refused: int
    isolated: int


class Figures(NamedTuple):
    """What a flight achieved; degrees, RMS, errors of the whole attitude."""

    pointing: float
    estimate: float
    sunlit: float
    eclipse: float
    converged_s: float
    isolated: int
    pulses: int
    refused: int


def read_bus(log: Path, ticks: int) -> Bus:
    """Read a log in candump's format."""
    q_estimated, tick = np.full((ticks, 4), np.nan), 0
    counts = {COIL_FIRE: 0, COIL_REFUSED: 0, FSW_EVENT: 0}
    for line in log.read_text(encoding="ascii").splitlines():
        identifier, _, digits = line.rpartition(" ")[2].partition("#")
        can_id, data = int(identifier, 16), bytes.fromhex(digits)
        if can_id == SYNC:
            tick = unsigned(data, 0, 32)
        elif can_id == NAV_ATTITUDE:  # in answer to a tick, of its instant
            x, y, z = (2.0**-16 * signed(data, first_bit, 17) for first_bit in (5, 22, 39))
            q_estimated[tick] = np.sqrt(max(0.0, 1.0 - x * x - y * y - z * z)), x, y, z
        elif can_id in counts:
            counts[can_id] += can_id != FSW_EVENT or data[1] in (SENSOR_ISOLATED, COIL_FAULT)
    return Bus(q_estimated, counts[COIL_FIRE], counts[COIL_REFUSED], counts[FSW_EVENT])


def angle_deg(q: Array, from_q: Array) -> Array:
    """The angle between attitudes, (n, 4) each, scalar first; 180 deg where there is none."""
    apart = np.minimum(np.linalg.norm(q - from_q, axis=1), np.linalg.norm(q + from_q, axis=1))
    angle: Array = np.degrees(4.0 * np.arcsin(np.minimum(apart / 2.0, 1.0)))
    return np.nan_to_num(angle, nan=180.0)


def rms(values: Array) -> float:
    """Root of the mean of the squares."""
    return float(np.sqrt(np.mean(values**2)))


def figures(run: Path) -> Figures:
    """The figures of a run directory."""
    scenario = tomllib.loads((run / "scenario.toml").read_text(encoding="utf-8"))
    tick_hz = scenario["time"]["tick_hz"]
    with h5py.File(run / "truth.h5") as truth:
        q, sunlit = truth["q_body_from_orbit"][:], truth["lit"][:] >= LEAST_LIT
    bus = read_bus(run / "bus.log", len(q))
    pointing = angle_deg(q, np.array([[1.0, 0.0, 0.0, 0.0]]))
    estimate = angle_deg(q, bus.q_estimated)
    wrong = np.flatnonzero(np.append(estimate >= CONVERGED_DEG, True))
    starts, length = np.append(0, wrong[:-1] + 1), round(CONVERGED_S * tick_hz)
    found = starts[wrong - starts >= length]
    first = int(found[0]) if len(found) else len(q) - 1
    last = slice(-round(orbit_s(scenario) * tick_hz), None)
    after = np.arange(len(q)) >= first
    return Figures(
        pointing=rms(pointing[last]),
        estimate=rms(estimate[last]),
        sunlit=rms(estimate[after & sunlit]),
        eclipse=rms(estimate[after & ~sunlit]),
        converged_s=first / tick_hz if len(found) else float("nan"),
        isolated=bus.isolated,
        pulses=bus.pulses,
        refused=bus.refused,
    )


def agree(own: Figures, other: Figures) -> bool:
    """Whether pointing and estimate are near each other, and no unit was isolated."""
    near = [abs(a - b) <= WITHIN_DEG for a, b in zip(own[:4], other[:4], strict=True)]
    return all(near) and not own.isolated and not other.isolated


def torquer(*words: str) -> bool:
    """Run a command of torquer quietly; whether it succeeded."""
    done = subprocess.run(["torquer", *words], capture_output=True, text=True, check=False)
    if done.returncode:
        print(done.stdout + done.stderr, file=sys.stderr)
    return done.returncode == 0


def same_pulses_deg(own: Path) -> Array:
    """By how much Basilisk's attitude differs, tick by tick, when it is given the dipoles of a flight."""
    scenario = tomllib.loads((own / "scenario.toml").read_text(encoding="utf-8"))
    with h5py.File(own / "truth.h5") as truth:
        m_body_am2, q = truth["m_body_am2"][:], truth["q_body_from_orbit"][:]
    satellite, found = Satellite(scenario, epoch_unix_s(scenario)), []
    for tick, dipole_am2 in enumerate(m_body_am2):
        if tick:
            satellite.advance(tick, dipole_am2)
        found.append(relative_motion(satellite.state(tick))[0])
    return angle_deg(q, np.array(found))


def physics(own: Path, other: Path) -> str:
    """How far the worlds of two runs differ, as rows of a table."""
    apart_deg = same_pulses_deg(own)
    with h5py.File(own / "truth.h5") as a, h5py.File(other / "truth.h5") as b:
        apart_m = np.linalg.norm(a["r_eci_m"][:] - b["r_eci_m"][:], axis=1)
        field_nt = 1e9 * (np.linalg.norm(a["b_body_t"][:], axis=1) - np.linalg.norm(b["b_body_t"][:], axis=1))
        shadow = np.sum((a["lit"][:] >= LEAST_LIT) != (b["lit"][:] >= LEAST_LIT))
        before = 100 * round(1.0 / (a["t_s"][1] - a["t_s"][0]))  # the lockout at boot: no coil has been on
    return (
        f"| attitude after 100 s, before the first pulse | {apart_deg[before]:.0e} deg |\n"
        f"| attitude, both by the dipoles of the own flight, at most | {apart_deg.max():.2f} deg |\n"
        f"| position, at most | {apart_m.max():.0f} m |\n"
        f"| strength of the field, at most | {np.abs(field_nt).max():.0f} nT |\n"
        f"| ticks that are lit in one and dark in the other | {shadow} |"
    )


def main() -> int:
    """Fly both, print the table, and write it; the exit code."""
    parser = argparse.ArgumentParser(description="Compare Torquer's own plant with Basilisk's.")
    parser.add_argument("scenario", nargs="?", default="microsat")
    parser.add_argument("--orbits", type=float, default=4.0)
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--out", type=Path, help="where there is no run yet; default: runs/basilisk-<time>")
    parser.add_argument("--page", type=Path, help="write the tables here")
    options = parser.parse_args()
    out = options.out or Path("runs", f"basilisk-{datetime.now(UTC):%Y%m%dT%H%M%SZ}")
    rows, fine, last = [], True, (Path(), Path())
    for seed in map(int, options.seeds.split(",")):
        own, other = out / f"own-{seed}", out / f"basilisk-{seed}"
        words = ("--orbits", str(options.orbits), "--seed", str(seed), "--bus", "virtual", "--out", str(own))
        if not torquer("sil", options.scenario, *words):
            return 2
        wall_s = fly(own / "scenario.toml", options.orbits, seed, other)
        print(f"seed {seed}: flown over Basilisk in {wall_s:.0f} s", file=sys.stderr)
        ours, theirs = figures(own), figures(other)
        fine &= agree(ours, theirs)
        for plant, run, found in (("own", own, ours), ("Basilisk", other, theirs)):
            limits, replay = torquer("check", str(run)), torquer("replay", str(run))
            fine &= limits and replay
            verdicts = f"{'kept' if limits else 'broken'} | {'bit-exact' if replay else 'differs'}"
            rows.append(row(seed, plant, found, verdicts))
        last = own, other
    text = page(options.scenario, options.orbits, rows, physics(*last), fine)
    print(text)
    if options.page is not None:
        options.page.write_text(text, encoding="utf-8")
    return 0 if fine else 1


def row(seed: int, plant: str, found: Figures, verdicts: str) -> str:
    """A row of the table."""
    angles = " | ".join(f"{value:.3f}" for value in found[:4])
    rest = f"{found.converged_s:.0f} | {found.isolated} | {found.pulses} | {found.refused}"
    return f"| {seed} | {plant} | {angles} | {rest} | {verdicts} |"


def page(scenario: str, orbits: float, rows: list[str], worlds: str, fine: bool) -> str:
    """The page docs/basilisk.md."""
    template = Path(__file__).with_name("page.md.in").read_text(encoding="utf-8")
    return template.format(
        scenario=scenario,
        orbits=f"{orbits:g}",
        basilisk=version("bsk"),
        verdict="agree" if fine else "DO NOT AGREE",
        within_deg=f"{WITHIN_DEG:g}",
        rows="\n".join(rows),
        worlds=worlds,
    )


if __name__ == "__main__":
    sys.exit(main())
