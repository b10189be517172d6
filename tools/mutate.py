"""Mutation testing: change one thing, run the tests that should notice, report each change that none did.

    python tools/mutate.py [TARGET or MODULE ...] [--stale | --again | --quick] [--workers N] [--verbose]
    python tools/mutate.py --list | --page | --coverage FILE

Writes docs/mutation.md from tests/mutation/results.json, which stores each result with the digest of the
module it was measured on. Survivors that change nothing observable are listed in
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
from typing import Any, NamedTuple

from argument_types import count

sys.path.insert(0, str(Path(__file__).parent))
from mutants import Mutant
from mutation_page import (
    RESULTS,
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
    """Judge one mutant, in a worker process that imports one module only."""
    global _judge  # noqa: PLW0603  one a process
    if _judge is None:
        _judge = Judge(module, target.stages_of(module))
    return _judge.judge(source)


class Measurement(NamedTuple):
    """How to measure.

    Args:
        workers: processes.
        verbose: print every mutant, not only those that survive.
    """

    workers: int
    verbose: bool

    def judge_all(self, module: str, target: Target, made: list[Mutant]) -> dict[str, Any]:
        """Judge the mutants, in processes that import this module only."""
        counts, survived = Counter[str](), []
        with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
            tempfile.tempdir = folder  # for the copies, and for what the tests leave
            with ProcessPoolExecutor(self.workers) as pool:
                outcomes = pool.map(partial(judge_mutant, module, target), [one.source for one in made])
                for number, (mutant, (outcome, test)) in enumerate(zip(made, outcomes, strict=True), 1):
                    counts[outcome] += 1
                    if outcome == SURVIVED:
                        survived.append(mutant.change)
                    if self.verbose or outcome == SURVIVED:
                        print(f"{module}:{mutant.line}: {outcome}: {mutant.change}  {test}", flush=True)
                    if number % 25 == 0:
                        print(f"{module}: {number} of {len(made)}", file=sys.stderr, flush=True)
        tempfile.tempdir = None
        return {"killed": counts[KILLED], "timeouts": counts[TIMEOUT], "survived": survived}

    def measure(self, module: str, target: Target) -> None:
        """Judge all mutants of a module, and store the result."""
        measured, made = digest(module, target), target.mutants_of(module)
        began = time.monotonic()
        outcome = self.judge_all(module, target, made)
        wall_s = round(time.monotonic() - began)
        store_result(module, outcome | {"sha256": measured, "mutants": len(made), "wall_s": wall_s})

    def measure_again(self, module: str, target: Target) -> None:
        """Judge again the unlisted survivors of an unchanged module: tests may have been added."""
        results = stored(RESULTS)
        unexplained = [change for one, change in unlisted(results) if one == module]
        made = [mutant for mutant in target.mutants_of(module) if mutant.change in unexplained]
        if not made or module in outdated(results):
            return
        result = results[module]
        outcome = self.judge_all(module, target, made)
        survived = [one for one in result["survived"] if one not in unexplained or one in outcome["survived"]]
        timeouts = result["timeouts"] + outcome["timeouts"]
        killed = result["mutants"] - timeouts - len(survived)
        store_result(module, result | {"survived": survived, "timeouts": timeouts, "killed": killed})


def store_result(module: str, result: dict[str, Any]) -> None:
    store(RESULTS, stored(RESULTS) | {module: result})
    write_page()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("only", nargs="*", help="targets or modules; default all")
    parser.add_argument("--stale", action="store_true", help="only modules not measured as they are now")
    parser.add_argument("--workers", type=count, default=os.cpu_count() or 1)
    parser.add_argument(
        "--verbose", action="store_true", help="print every mutant, and the test that noticed"
    )
    parser.add_argument("--again", action="store_true", help="only what has survived and is not listed")
    parser.add_argument("--quick", action="store_true", help="only the quick tests; the result is not stored")
    parser.add_argument("--list", action="store_true", help="count mutants, run nothing")
    parser.add_argument("--page", action="store_true", help="write the page anew, run nothing")
    parser.add_argument("--coverage", type=Path, help="take branch coverage from this file, run nothing")
    options = parser.parse_args()
    known = {name for target in targets() for name in (target.name, *target.modules)}
    if unknown := [name for name in options.only if name not in known]:
        parser.error(f"there is no target or module {', '.join(unknown)} in tests/mutation/targets.toml")
    old = outdated(stored(RESULTS)) if options.stale else None
    chosen = [
        (target, module)
        for target in targets()
        for module in target.modules
        if not options.only or target.name in options.only or module in options.only
        if old is None or module in old
    ]
    measurement = Measurement(options.workers, options.verbose)
    if options.list:
        for target, module in chosen:
            print(f"{target.name:<16} {module:<36} {len(target.mutants_of(module))} mutants")
        return 0
    if options.quick:
        for target, module in chosen:
            measurement.judge_all(module, target._replace(slow=[]), target.mutants_of(module))
        return 0
    if options.coverage:
        note_coverage(json.loads(options.coverage.read_text(encoding="utf-8")))
        write_page()
        return 0
    if options.page:
        write_page()
    else:
        for target, module in chosen:
            (measurement.measure_again if options.again else measurement.measure)(module, target)
    results = stored(RESULTS)
    for module in outdated(results):
        print(f"{module}: not measured as it is now")
    for module, change in unlisted(results):
        print(f"{module}: survives, and is not listed: {change}")
    return 1 if outdated(results) or unlisted(results) else 0


if __name__ == "__main__":
    sys.exit(main())
