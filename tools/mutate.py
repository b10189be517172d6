"""Mutation testing: change one small thing, run the tests that should notice, tell of each that none did.

    python tools/mutate.py [TARGET or MODULE ...] [--stale] [--workers N] [--list] [--page] [--coverage FILE]

Writes docs/mutation.md from tests/mutation/results.json, which keeps what has been measured with the digest
of the module it was measured on. Survivors that change nothing anybody can see stand in
tests/mutation/survivors.toml, with reasons. Exit code 1 if a mutant survives that is not listed there, or a
module has been changed since it was measured.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
from mutants import mutants
from mutation_page import (
    RESULTS,
    ROOT,
    Target,
    digest,
    note_coverage,
    outdated,
    store,
    stored,
    targets,
    unlisted,
    write_page,
)
from mutation_tests import KILLED, SURVIVED, TIMEOUT, Judge

_judge: Judge | None = None


def judge_mutant(module: str, target: Target, source: str) -> tuple[str, str]:
    """In a worker, which sees one module."""
    global _judge  # noqa: PLW0603
    if _judge is None:
        _judge = Judge(module, [target.quick, target.slow])
    return _judge.judge(source)


def measure(module: str, target: Target, pool: ProcessPoolExecutor, verbose: bool) -> dict[str, Any]:
    made = list(mutants((ROOT / module).read_text(encoding="utf-8")))
    measured, counts, survived = digest(module), Counter[str](), []
    began = time.monotonic()
    outcomes = pool.map(partial(judge_mutant, module, target), [mutant.source for mutant in made])
    for number, (mutant, (outcome, test)) in enumerate(zip(made, outcomes, strict=True), 1):
        counts[outcome] += 1
        if outcome == SURVIVED:
            survived.append(mutant.change)
        if verbose or outcome == SURVIVED:
            print(f"{module}:{mutant.line}: {outcome}: {mutant.change}  {test}", flush=True)
        if number % 25 == 0:
            print(f"{module}: {number} of {len(made)}", file=sys.stderr, flush=True)
    return {
        "sha256": measured,
        "mutants": len(made),
        "killed": counts[KILLED],
        "timeouts": counts[TIMEOUT],
        "survived": survived,
        "wall_s": round(time.monotonic() - began),
    }


def measure_alone(target: Target, module: str, workers: int, verbose: bool) -> dict[str, Any]:
    """In processes that see this module only; copies, and what tests leave, in a folder of their own."""
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        tempfile.tempdir = folder
        try:
            with ProcessPoolExecutor(workers) as pool:
                return measure(module, target, pool, verbose)
        finally:
            tempfile.tempdir = None


def measure_all(chosen: list[tuple[Target, str]], workers: int, verbose: bool) -> None:
    """Results are kept as they come."""
    for target, module in chosen:
        result = measure_alone(target, module, workers, verbose)
        store(RESULTS, stored(RESULTS) | {module: result})
        write_page()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("only", nargs="*", help="targets or modules; default all")
    parser.add_argument("--stale", action="store_true", help="only modules not measured as they are now")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--verbose", action="store_true", help="tell every mutant, and the test that noticed")
    parser.add_argument("--quick", action="store_true", help="only the quick tests; the outcome is not kept")
    parser.add_argument("--list", action="store_true", help="count mutants, run nothing")
    parser.add_argument("--page", action="store_true", help="write the page anew, run nothing")
    parser.add_argument("--coverage", type=Path, help="take branch coverage from this file, run nothing")
    options = parser.parse_args()
    old = outdated(stored(RESULTS)) if options.stale else None
    chosen = [
        (target, module)
        for target in targets()
        for module in target.modules
        if not options.only or target.name in options.only or module in options.only
        if old is None or module in old
    ]
    if options.list:
        for target, module in chosen:
            count = sum(1 for _ in mutants((ROOT / module).read_text(encoding="utf-8")))
            print(f"{target.name:<10} {module:<36} {count} mutants")
        return 0
    if options.coverage:
        note_coverage(json.loads(options.coverage.read_text(encoding="utf-8")))
        write_page()
        return 0
    if options.quick:
        for target, module in chosen:
            measure_alone(target._replace(slow=[]), module, options.workers, options.verbose)
        return 0
    if options.page:
        write_page()
    else:
        measure_all(chosen, options.workers, options.verbose)
    results = stored(RESULTS)
    for module in outdated(results):
        print(f"{module}: not measured as it is now")
    for module, change in unlisted(results):
        print(f"{module}: survives, and is not listed: {change}")
    return 1 if outdated(results) or unlisted(results) else 0


if __name__ == "__main__":
    sys.exit(main())
