"""Replays logs with other processor features and other versions of Python; writes docs/replay.md.

Each variant is this machine with something switched off, or another Python: one machine cannot come closer to
another. Commands must be equal everywhere; the page says where telemetry and state first differ in a bit.
"""

import argparse
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from argument_types import count, positive

from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replace_text

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "replay.md"
NO_FMA = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX2_Usable,-FMA_Usable"
NO_AVX512 = "AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR"
NO_AVX2 = f"AVX2 FMA3 {NO_AVX512}"


@dataclass(frozen=True, slots=True)
class Variant:
    """A way to replay: what is changed in the environment, or another interpreter."""

    name: str
    environment: dict[str, str] = field(default_factory=dict)
    python: str = sys.executable


VARIANTS = (
    Variant("as flown"),
    Variant("OpenBLAS for Prescott (SSE3)", {"OPENBLAS_CORETYPE": "Prescott"}),
    Variant("OpenBLAS for Haswell (AVX2)", {"OPENBLAS_CORETYPE": "Haswell"}),
    Variant("OpenBLAS for Zen", {"OPENBLAS_CORETYPE": "Zen"}),
    Variant("OpenBLAS for SkylakeX (AVX-512)", {"OPENBLAS_CORETYPE": "SkylakeX"}),
    Variant("numpy without AVX-512", {"NPY_DISABLE_CPU_FEATURES": NO_AVX512}),
    Variant("numpy without AVX2 and FMA", {"NPY_DISABLE_CPU_FEATURES": NO_AVX2}),
    Variant("C library without FMA", {"GLIBC_TUNABLES": NO_FMA}),
    Variant(
        "all of it: SSE only",
        {
            "OPENBLAS_CORETYPE": "Prescott",
            "NPY_DISABLE_CPU_FEATURES": NO_AVX2,
            "GLIBC_TUNABLES": NO_FMA,
        },
    ),
)


def main() -> int:
    """Fly, replay in every variant, write the page; 1 if a command differs anywhere."""
    arguments = _arguments()
    try:
        check_file(arguments.out)
    except HarnessError as error:
        print(f"replay-elsewhere: {error}", file=sys.stderr)
        return 2
    variants = VARIANTS + tuple(Variant(_version(path), python=path) for path in arguments.python)
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(arguments.workers) as pool:
        runs = {name: Path(folder) / name for name in arguments.scenario}
        list(pool.map(lambda name: _fly(name, arguments.orbits, runs[name]), runs))
        order = [(name, variant) for name in runs for variant in variants]
        rows = list(pool.map(lambda one: _replay(one[0], runs[one[0]], one[1]), order))
    page = _page(rows, arguments.orbits, time.monotonic() - began)
    replace_text(arguments.out, page)
    print(page)
    return int(any(verdict not in ("bit-exact", "command-exact") for _, _, verdict, _ in rows))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenario", action="append", help="default: microsat and posat1-ekf")
    parser.add_argument("--orbits", type=positive, default=20.0)
    parser.add_argument(
        "--python", action="append", default=[], help="another interpreter with torquer in it"
    )
    parser.add_argument("--workers", type=count, default=os.cpu_count(), help="default: one a core")
    parser.add_argument("--out", type=Path, default=PAGE)
    arguments = parser.parse_args()
    for python in arguments.python:
        if shutil.which(python) is None:
            parser.error(f"--python {python} is no program")
    arguments.scenario = arguments.scenario or ["microsat", "posat1-ekf"]
    return arguments


def _fly(scenario: str, orbits: float, run: Path) -> None:
    print(f"{scenario}: flying", file=sys.stderr)
    arguments = ("sil", scenario, "--bus", "virtual", "--orbits", str(orbits), "--out", str(run))
    if (done := _torquer(Variant("as flown"), *arguments)).returncode:
        sys.exit(f"{scenario} does not fly: {done.stderr.strip()}")


def _replay(scenario: str, run: Path, variant: Variant) -> tuple[str, str, str, str]:
    """A row of the page."""
    verdict, detail = _verdict(_torquer(variant, "replay", str(run)))
    print(f"{scenario}: {variant.name}: {verdict}", file=sys.stderr)
    return scenario, variant.name, verdict, detail


def _torquer(variant: Variant, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [variant.python, "-m", "torquer.cli.main", *arguments],
        env=os.environ | variant.environment,
        capture_output=True,
        text=True,
        check=False,
    )


def _verdict(done: subprocess.CompletedProcess[str]) -> tuple[str, str]:
    """The verdict of ``torquer replay`` and its details; its error where it gave none."""
    lines = done.stdout.strip().splitlines()
    if not lines:
        return "failed", (done.stderr.strip().splitlines() or ["no output"])[-1]
    first = lines[0]
    if first.startswith("bit-exact"):
        return "bit-exact", ""
    if first.startswith("command-exact"):
        return "command-exact", f"first bit: {first.rpartition('): ')[2]}"
    return "differs", "; ".join(lines)


def _version(python: str) -> str:
    versions = "platform.python_version(), numpy.__version__, scipy.__version__"
    text = f"import numpy, platform, scipy; print({versions})"
    done = subprocess.run([python, "-c", text], capture_output=True, text=True, check=True)
    return "Python {}, numpy {}, scipy {}".format(*done.stdout.split())


def _page(rows: list[tuple[str, str, str, str]], orbits: float, wall_s: float) -> str:
    head = [
        "# Replay on other machines",
        "",
        "Written by `make replay-elsewhere`. Flights on the virtual bus, each replayed with some processor",
        "features hidden from the libraries, and by other versions of Python. Bit-exact: every frame and",
        "state CRC is equal. Command-exact: every `COIL_FIRE` is, telemetry within one unit of its signal.",
        "",
        f"{orbits:g} orbits each; {platform.machine()}, {_version(sys.executable)}; {wall_s:.0f} s in all.",
        "",
        "| flight | replayed with | verdict | |",
        "|---|---|---|---|",
    ]
    return "\n".join(head + [f"| {' | '.join(row)} |" for row in rows]) + "\n"


if __name__ == "__main__":
    sys.exit(main())
