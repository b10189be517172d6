"""Mutation testing: change one small thing, run the tests that should notice, tell of each that none did.

    python tools/mutate.py [TARGET or MODULE ...] [--workers N] [--list]

Writes docs/mutation.md from tests/mutation/results.json, which keeps what has been measured with the digest
of the module it was measured on. Survivors that change nothing anybody can see stand in
tests/mutation/survivors.toml, with reasons. Exit code 1 if a mutant survives that is not listed there.

Tests run in a copy of the repository, in a child that is forked off a process that has already imported the
large libraries.
"""

import argparse
import hashlib
import json
import os
import shutil
import signal
import sys
import tempfile
import time
import tomllib
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parent))
from mutants import mutants

ROOT = Path(__file__).resolve().parents[1]
HERE = Path("tests/mutation")
PAGE = Path("docs/mutation.md")
COPIED = ("fsw", "hil_stub", "sim", "tests", "tools", "docs", "examples", "pyproject.toml", "README.md")
LEAST_TIMEOUT_S = 20.0
SLOWER = 8.0
"""A mutant that takes so many times as long as no mutant is stopped, and counts as noticed."""

KILLED, SURVIVED, TIMEOUT = "killed", "survived", "timeout"


class Target(NamedTuple):
    """A group of modules, and the tests for it."""

    name: str
    modules: list[str]
    quick: list[str]
    slow: list[str]


def targets() -> list[Target]:
    tables = tomllib.loads((ROOT / HERE / "targets.toml").read_text(encoding="utf-8"))
    return [Target(name, table["modules"], table["quick"], table["slow"]) for name, table in tables.items()]


def survivors() -> dict[tuple[str, str], str]:
    listed = tomllib.loads((ROOT / HERE / "survivors.toml").read_text(encoding="utf-8"))
    return {(one["module"], one["change"]): one["reason"] for one in listed.get("survivor", [])}


# --- running tests


def copy_of_the_repository() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="mutation-"))
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (ROOT / name).exists():
            shutil.copy(ROOT / name, folder / name)
    return folder


def warm_up() -> None:
    """Import in the parent what every child needs and no mutant is in."""
    for name in ("cantools", "click", "h5py", "hypothesis", "numpy", "pydantic", "pytest", "scipy.signal"):
        import_module(name)
    import hypothesis  # noqa: PLC0415

    hypothesis.settings.register_profile(
        "mutation",
        derandomize=True,
        database=None,
        deadline=None,
        phases=[hypothesis.Phase.explicit, hypothesis.Phase.generate],
    )


def run_tests(folder: Path, tests: list[str], timeout_s: float) -> str:
    """Run them on what stands in the folder."""
    child = os.fork()
    if child == 0:
        os.setsid()
        code = 1
        try:
            code = _in_child(folder, tests)
        finally:
            os._exit(code)
    deadline = time.monotonic() + timeout_s
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            _end_group(child)
            return SURVIVED if status == 0 else KILLED
        if time.monotonic() > deadline:
            _end_group(child)
            os.waitpid(child, 0)
            return TIMEOUT
        time.sleep(0.01)


def _end_group(child: int) -> None:
    """The child, and what its tests have started."""
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)


def _in_child(folder: Path, tests: list[str]) -> int:
    import hypothesis  # noqa: PLC0415
    import pytest  # noqa: PLC0415

    sink = os.open(os.environ.get("MUTATION_OUTPUT", os.devnull), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(sink, 1)
    os.dup2(sink, 2)
    os.chdir(folder)
    sys.path[:0] = [str(folder)]
    os.environ["PYTHONPATH"] = str(folder)
    sys.dont_write_bytecode = True
    hypothesis.settings.load_profile("mutation")
    return int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", *tests]))


class Judge:
    """Runs mutants of one module in one copy; made once a process."""

    def __init__(self, module: str, target: Target) -> None:
        self.folder = copy_of_the_repository()
        self.path = self.folder / module
        self.source = self.path.read_text(encoding="utf-8")
        self.timeouts_s = []
        self.stages = [target.quick, target.slow]
        for tests in self.stages:
            began = time.monotonic()
            if run_tests(self.folder, tests, 900.0) != SURVIVED:
                raise SystemExit(f"{module}: the tests fail without a mutant: {' '.join(tests)}")
            self.timeouts_s.append(max(LEAST_TIMEOUT_S, SLOWER * (time.monotonic() - began)))

    def judge(self, source: str) -> str:
        self.path.write_text(source, encoding="utf-8")
        try:
            for tests, timeout_s in zip(self.stages, self.timeouts_s, strict=True):
                outcome = run_tests(self.folder, tests, timeout_s)
                if outcome != SURVIVED:
                    return outcome
            return SURVIVED
        finally:
            self.path.write_text(self.source, encoding="utf-8")


_judges: dict[str, Judge] = {}


def judge_mutant(module: str, target: Target, source: str) -> str:
    """In a worker."""
    if module not in _judges:
        for old in _judges.values():
            shutil.rmtree(old.folder, ignore_errors=True)
        _judges.clear()
        _judges[module] = Judge(module, target)
    return _judges[module].judge(source)


def measure(module: str, target: Target, pool: ProcessPoolExecutor) -> dict[str, Any]:
    source = (ROOT / module).read_text(encoding="utf-8")
    made, counts, survived = list(mutants(source)), Counter[str](), []
    began = time.monotonic()
    outcomes = pool.map(partial(judge_mutant, module, target), [mutant.source for mutant in made])
    for number, (mutant, outcome) in enumerate(zip(made, outcomes, strict=True), 1):
        counts[outcome] += 1
        if outcome == SURVIVED:
            survived.append(mutant.change)
            print(f"{module}:{mutant.line}: survived: {mutant.change}", flush=True)
        if number % 25 == 0:
            print(f"{module}: {number} of {len(made)}", file=sys.stderr, flush=True)
    return {
        "sha256": hashlib.sha256(source.encode()).hexdigest(),
        "mutants": len(made),
        "killed": counts[KILLED],
        "timeouts": counts[TIMEOUT],
        "survived": survived,
        "wall_s": round(time.monotonic() - began),
    }


# --- the page


def page(results: dict[str, Any], listed: dict[tuple[str, str], str]) -> str:
    rows, reasons = [], []
    for target in targets():
        for module in target.modules:
            rows.append(_row(target.name, module, results.get(module), listed))
            for change in results.get(module, {}).get("survived", []):
                reason = listed.get((module, change), "**not listed**")
                reasons.append(f"- `{module}`: `{change}`  \n  {reason}")
    return "\n".join(
        [
            "# Mutation testing",
            "",
            "Each module is changed in one small thing at a time (an operator, a comparison, a constant,",
            "a condition, a statement left out), and its tests are run: one must fail. `make mutation`",
            "measures and writes this page; the tests of each module stand in `tests/mutation/targets.toml`,",
            "the reasons for what survives in `tests/mutation/survivors.toml`. Tests that run too long count",
            "as failed.",
            "",
            "| part | module | mutants | noticed | too long | survived, listed | survived, not listed |",
            "|---|---|---|---|---|---|---|",
            *rows,
            "",
            "## Survivors",
            "",
            *(reasons or ["None."]),
            "",
        ]
    )


def _row(part: str, module: str, result: dict[str, Any] | None, listed: dict[tuple[str, str], str]) -> str:
    if result is None:
        return f"| {part} | `{module}` | not measured | | | | |"
    known = [change for change in result["survived"] if (module, change) in listed]
    same = hashlib.sha256((ROOT / module).read_bytes()).hexdigest() == result["sha256"]
    numbers = (result["mutants"], result["killed"], result["timeouts"], len(known))
    cells = " | ".join(map(str, (*numbers, len(result["survived"]) - len(known))))
    return f"| {part} | `{module}`{'' if same else ' (changed since)'} | {cells} |"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("only", nargs="*", help="targets or modules; default all")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--list", action="store_true", help="count mutants, run nothing")
    chosen = parser.parse_args()
    store = ROOT / HERE / "results.json"
    results = json.loads(store.read_text(encoding="utf-8")) if store.exists() else {}
    listed = survivors()
    for target in targets():
        for module in target.modules:
            if chosen.only and target.name not in chosen.only and module not in chosen.only:
                continue
            if chosen.list:
                source = (ROOT / module).read_text(encoding="utf-8")
                print(f"{target.name:<10} {module:<36} {len(list(mutants(source)))} mutants")
                continue
            with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
                tempfile.tempdir = folder  # of the copies, and of what the tests leave
                with ProcessPoolExecutor(chosen.workers, initializer=warm_up) as pool:
                    results[module] = measure(module, target, pool)
            store.write_text(json.dumps(results, indent=2, sort_keys=True) + "\n", encoding="utf-8")
            (ROOT / PAGE).write_text(page(results, listed), encoding="utf-8")
    if chosen.list:
        return 0
    unlisted = [(m, c) for m in results for c in results[m]["survived"] if (m, c) not in listed]
    print(f"{len(unlisted)} mutants survive that are not listed")
    return 1 if unlisted else 0


if __name__ == "__main__":
    sys.exit(main())
