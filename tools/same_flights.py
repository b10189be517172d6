"""Are the flights of this code those of an earlier commit, byte for byte?

    python tools/same_flights.py COMMIT [--orbits N] [--but-state-crc]

For a change that means to alter no flight, such as one of a sentence. Both versions fly every shipped
scenario and inject every fault once, but for those that kill processes; log, truth and summary, and what each
fault did, must be equal. Exit code 1 if one is not.

With --but-state-crc the CRC of the flight state in each TICK_DONE is left out, for a change that lays out the
state in another way; and so is the fault that flips bits of the state, since it draws their places from the
layout.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from argument_types import count, positive

from fsw.wire.messages import TickDone
from sim.campaign.study_cache import VARIABLE
from sim.console import counted
from sim.errors import HarnessError

ROOT = Path(__file__).resolve().parent.parent
SCENARIOS = "sim/scenario/shipped"
NO_FIGURES = frozenset(
    {
        "wall_seconds",
        "realtime_factor",
        "wall_s",
        "worst step ms",
        "code",
        "algebra",
        "otherwise_flown",
        "injected",
    }
)
"""Of a summary or a row of faults: the time that the computer took, what code computed it, and words."""
OF_LAYOUT = ("bit-flip",)
"""Faults whose places are drawn from the layout of the flight state."""
STATE_CRC_FROM = 8
"""Hex digits of a TICK_DONE before those of its state_crc and CRC: the tick."""

Digests = Mapping[str, str]
Json = Any


def run(tree: Path, *words: str) -> str:
    """Python in a tree, on its own modules: what it prints. That a flight missed its aim is no error here.

    Raises:
        HarnessError: it failed otherwise.
    """
    settings = {"PYTHONPATH": str(tree), "PYTHONSAFEPATH": "1", "OPENBLAS_NUM_THREADS": "1", VARIABLE: ""}
    environment = {**os.environ, **settings}
    done = subprocess.run(
        [sys.executable, *words], cwd=tree, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode not in (0, 1):
        raise HarnessError(f"python {' '.join(words)} in {tree}: {done.stderr.strip()}")
    return done.stdout


def flown(tree: Path, scenario: str, orbits: float, state_crc: bool = True) -> str:
    """The digest of log, truth and summary of a flight; ``state_crc``: with that of each TICK_DONE."""
    with TemporaryDirectory() as folder:
        out = Path(folder, "run")
        words = ("sil", scenario, "--bus", "virtual", "--orbits", str(orbits), "--out", str(out), "--quiet")
        run(tree, "-m", "torquer", *words)
        summary = figures(json.loads((out / "summary.json").read_text()))
        log = (out / "bus.log").read_bytes()
        files = [log if state_crc else without_state_crc(log), (out / "truth.h5").read_bytes()]
        parts = [json.dumps(summary), *map(_sha256, files)]
        return _sha256("\n".join(parts).encode())


def without_state_crc(log: bytes) -> bytes:
    """A candump log whose TICK_DONE end after the tick."""
    done = b" %03X#" % TickDone.ID
    lines = []
    for line in log.splitlines():
        before, found, data = line.partition(done)
        lines.append(before + found + data[:STATE_CRC_FROM] if found else line)
    return b"\n".join(lines)


def faults(tree: Path, rows: Sequence[str] = ()) -> dict[str, str]:
    """The digest of what each fault of the table did, once each; of some rows alone if they are named."""
    with TemporaryDirectory() as folder:
        chosen = [word for row in rows for word in ("--row", row)]
        once = ["--phases", "1", "--seeds", "1", "--quiet"]
        run(tree, "-m", "torquer", "faults", *once, "--out", folder, *chosen)
        found = json.loads(Path(folder, "faults.json").read_text())["rows"]
    return {f"fault {row['row']}": _sha256(json.dumps(figures(row)).encode()) for row in found}


def figures(value: Json) -> Json:
    """Without what differs from run to run, or says the same in other words."""
    if isinstance(value, dict):
        return {key: figures(one) for key, one in value.items() if key not in NO_FIGURES}
    return [figures(one) for one in value] if isinstance(value, list) else value


def scenarios(tree: Path) -> list[str]:
    """Those that ship."""
    return sorted(path.stem for path in (tree / SCENARIOS).glob("*.toml"))


def flights(tree: Path, orbits: float, workers: int, state_crc: bool = True) -> Digests:
    """The digests of all flights of a tree; without ``state_crc`` those that do not depend on the layout."""
    names = scenarios(tree)
    with ThreadPoolExecutor(workers) as pool:
        found = pool.map(lambda name: flown(tree, name, orbits, state_crc), names)
        digests = dict(zip(names, found, strict=True))
    print(f"{len(digests)} scenarios flown; faults now", file=sys.stderr, flush=True)
    left_out = set() if state_crc else {f"fault {row}" for row in OF_LAYOUT}
    return digests | {name: digest for name, digest in faults(tree).items() if name not in left_out}


def different(before: Digests, now: Digests) -> list[str]:
    """The flights that differ, or that only one version has."""
    return sorted(name for name in before.keys() | now.keys() if before.get(name) != now.get(name))


def exported(commit: str, folder: Path) -> None:
    """The files of a commit.

    Raises:
        HarnessError: there is no such commit.
    """
    archive = subprocess.run(["git", "archive", commit], cwd=ROOT, capture_output=True, check=False)
    if archive.returncode:
        raise HarnessError(archive.stderr.decode().strip())
    subprocess.run(["tar", "-x", "-C", str(folder)], input=archive.stdout, check=True)


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def main(words: Sequence[str] | None = None, fly: Callable[..., Digests] = flights) -> int:
    """Fly both, compare; 1 if a flight differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("commit", help="the earlier one")
    parser.add_argument("--orbits", type=positive, default=1.0, help="of each flight of a scenario")
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1, help="flights at once")
    parser.add_argument("--but-state-crc", action="store_true", help="the layout of the state may differ")
    arguments = parser.parse_args(words)
    try:
        with TemporaryDirectory() as folder:
            exported(arguments.commit, Path(folder))
            trees = (Path(folder), ROOT)
            how = (arguments.orbits, arguments.workers, not arguments.but_state_crc)
            before, now = (fly(tree, *how) for tree in trees)
    except HarnessError as error:
        print(f"same_flights: {error}", file=sys.stderr)
        return error.exit_code
    apart = different(before, now)
    if apart:
        print(
            "\n".join([*(f"differs: {name}" for name in apart), f"{len(apart)} of {len(now)} flights differ"])
        )
        return 1
    extent = ", but for the CRC of the state" if arguments.but_state_crc else ""
    print(f"{counted(len(now), 'flight')} the same byte for byte as by {arguments.commit}{extent}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
