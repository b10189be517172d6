"""Compute what docs/ states of flights, from nothing, one stage after the other on all cores.

Each stage is a command of its own. A run that was stopped goes on where it was, as results are kept outside
of the project (TORQUER_CACHE). At the end stands how long each stage took, and what changed in the pages.
Exit code 1 where a claim fails or a limit is broken.
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.record.whole_file import replace_file
from sim.scenario.schema import load
from sim.tuning.kept import shipped_gains

ROOT = Path(__file__).resolve().parent.parent
DOCS, GAINS = ROOT / "docs", ROOT / "sim" / "tuning" / "found"
TORQUER = ("-m", "torquer")
FAULTS = ("faults", "--phases", "10", "--seeds", "5", "--slow", "--write-docs")
STAGES: Mapping[str, tuple[str, ...]] = {
    "gains": (),
    "population": ("tools/population.py",),
    "validate": (*TORQUER, "validate"),
    "comparison": ("tools/comparison.py",),
    "faults": (*TORQUER, *FAULTS),
    "pulse-limits": ("tools/pulse_limits.py",),
    "sizing": ("tools/sizing.py",),
}
"""The words after ``python`` of each; gains come first, as others fly with them."""

Rows = dict[tuple[str, str], str]


def run(stage: str) -> int:
    """Run a stage: its exit code."""
    return search_gains() if stage == "gains" else call(*STAGES[stage])


def search_gains() -> int:
    """Those of every body that ships some: borne out by flights of today, or searched again.

    A file is replaced once all of its laws are done; of another body or start, all are searched.
    """
    for shipped in sorted(GAINS.glob("*.toml")):
        with TemporaryDirectory() as folder:
            found = Path(folder, shipped.name)
            if shipped_gains(load(shipped.stem)) is not None:
                found.write_bytes(shipped.read_bytes())
            if code := call(*TORQUER, "design", shipped.stem, "--laws", "all", "--keep", str(found)):
                return code
            replace_file(shipped, found.read_bytes())
    return 0


def call(*words: str) -> int:
    """Python in the repository: its exit code."""
    environment = {"OPENBLAS_NUM_THREADS": "1", **os.environ}
    return subprocess.run([sys.executable, *words], cwd=ROOT, env=environment, check=False).returncode


def rows_of(docs: Path) -> Rows:
    """The rows of all tables of a folder's pages, by page and first cell; of equal ones the last."""
    found: Rows = {}
    for page in sorted(docs.glob("*.md")):
        for line in page.read_text(encoding="utf-8").splitlines():
            if line.startswith("| "):
                first, _, rest = line.removeprefix("| ").partition(" | ")
                found[page.name, first] = rest
    return found


def changes(before: Rows, now: Rows) -> Iterator[str]:
    """A line for each page that changed, and below it one for each row with another verdict."""
    apart = [key for key in before.keys() | now.keys() if before.get(key) != now.get(key)]
    for page in sorted({page for page, _ in apart}):
        mine = sorted(key for key in apart if key[0] == page)
        yield f"{page}: {len(mine)} rows changed"
        for key in mine:
            old, new = (verdict(rows.get(key, "")) for rows in (before, now))
            if old != new and key in before and key in now:
                yield f"  {key[1]}: {old} -> {new}"


def verdict(row: str) -> str:
    """The last cell of a row, where it is a word."""
    last = row.removesuffix(" |").rpartition(" | ")[2]
    return last if last.replace(" ", "").isalpha() else ""


def main(words: Sequence[str] | None = None) -> int:
    """Run the stages; 1 where something is not as it should be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("stages", nargs="*", metavar="STAGE", help=f"default: {' '.join(STAGES)}")
    chosen = parser.parse_args(words).stages or list(STAGES)
    if unknown := [stage for stage in chosen if stage not in STAGES]:
        parser.error(f"there is no stage '{unknown[0]}': choose among {', '.join(STAGES)}")
    before, lines, worst = rows_of(DOCS), [], 0
    for stage in [stage for stage in STAGES if stage in chosen]:
        began = time.monotonic()
        try:
            code = run(stage)
        except KeyboardInterrupt:  # the stage itself has it too, and has said so
            code = 130
        lines.append(f"{stage}: {time.monotonic() - began:.0f} s, exit code {code}")
        print(lines[-1], file=sys.stderr, flush=True)
        if code not in (0, 1):
            print(f"evidence: {stage} was not completed", file=sys.stderr)
            return code
        worst = max(worst, code)
    print("\n".join([*lines, *changes(before, rows_of(DOCS))]))
    return worst


if __name__ == "__main__":
    sys.exit(main())
