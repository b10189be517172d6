"""The page of mutation testing, docs/mutation.md, from the results and the reasons of the survivors."""

import hashlib
import json
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any, NamedTuple

from mutants import Mutant, mutants

ROOT = Path(__file__).resolve().parents[1]
HERE = ROOT / "tests" / "mutation"
PAGE = ROOT / "docs" / "mutation.md"
RESULTS, COVERAGE = HERE / "results.json", HERE / "coverage.json"

TEXT = """# Mutation testing

Each mutant is a module with one small change, and the tests of the module are run: one must fail. The changes
replace operators, comparisons, constants, conditions and loops, and omit statements, assignments to state,
keyword arguments and return values; in the laws, the methods on the ground and the models of field and
torques a sign alone is changed, of a sum, a minus or a product. `make mutation` measures and writes this
page; the tests of each module are in `tests/mutation/targets.toml`, the reasons for survivors in
`tests/mutation/survivors.toml`. Tests that run too long count as failed. A module that has changed since its
measurement is marked as such, and `make mutation` measures it again.

{verdict}.

| part | module | mutants | noticed | too long | survived, listed | survived, not listed |
|---|---|---|---|---|---|---|
{rows}

## Survivors

{survivors}

## Branch coverage

By the tests that mirror the modules, without flights and proofs; measured by `make coverage`, which fails
below 100 %.

| module | statements | branches | covered |
|---|---|---|---|
{coverage}
"""


class Target(NamedTuple):
    """A group of modules, and the tests for it; ``signs``: signs alone are changed."""

    name: str
    modules: list[str]
    quick: list[str]
    slow: list[str]
    signs: bool = False

    def mutants_of(self, module: str) -> list[Mutant]:
        """Of a module as it is now."""
        return list(mutants((ROOT / module).read_text(encoding="utf-8"), signs=self.signs))

    def stages_of(self, module: str) -> list[list[str]]:
        """The tests for a module: `{mirror}` is the file that mirrors it, `{folder}` the folder of that."""
        folder = Path("tests", module).parent
        mirror = folder / f"test_{Path(module).name}"
        places = {"mirror": mirror if (ROOT / mirror).exists() else folder, "folder": folder}
        return [[test.format(**places) for test in stage] for stage in (self.quick, self.slow)]


def _read(path: Path, parse: Callable[[str], dict[str, Any]]) -> dict[str, Any]:
    """Its content; one that cannot be read ends the command with exit code 2."""
    try:
        return parse(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        print(f"{path.relative_to(ROOT)} cannot be read: {error}", file=sys.stderr)
        raise SystemExit(2) from None


def targets() -> list[Target]:
    tables = _read(HERE / "targets.toml", tomllib.loads)
    return [
        Target(name, _modules(table["modules"]), table["quick"], table["slow"], table.get("signs", False))
        for name, table in tables.items()
    ]


def _modules(patterns: list[str]) -> list[str]:
    """Paths in the repository, of modules that define something."""
    found = [path for pattern in patterns for path in sorted(ROOT.glob(pattern))]
    return [
        path.relative_to(ROOT).as_posix() for path in found if path.name not in ("__init__.py", "table.py")
    ]


def survivors() -> dict[tuple[str, str], str]:
    """The reason for each listed (module, change)."""
    listed = _read(HERE / "survivors.toml", tomllib.loads)
    return {(one["module"], one["change"]): one["reason"] for one in listed.get("survivor", [])}


def stored(path: Path) -> dict[str, Any]:
    return _read(path, json.loads) if path.exists() else {}


def store(path: Path, results: dict[str, Any]) -> None:
    """Replace the file at once, so that a kill leaves what was measured before."""
    with NamedTemporaryFile("w", dir=path.parent, delete=False, encoding="utf-8") as written:
        written.write(json.dumps(results, indent=2, sort_keys=True) + "\n")
    Path(written.name).replace(path)


def digest(module: str, target: Target) -> str:
    """The digest of the module and of the mutants that it has now."""
    source = (ROOT / module).read_text(encoding="utf-8")
    made = "".join(f"{mutant.line} {mutant.change}\n" for mutant in target.mutants_of(module))
    return hashlib.sha256((source + made).encode()).hexdigest()


def outdated(results: dict[str, Any]) -> list[str]:
    """Modules that have not been measured as they are now."""
    return [
        module
        for target in targets()
        for module in target.modules
        if results.get(module, {}).get("sha256") != digest(module, target)
    ]


def unlisted(results: dict[str, Any]) -> list[tuple[str, str]]:
    """(module, change) that survives without a reason."""
    listed = survivors()
    made = [(m, change) for target in targets() for m in target.modules for change in _survived(results, m)]
    return [one for one in made if one not in listed]


def write_page() -> None:
    results, listed = stored(RESULTS), survivors()
    old = outdated(results)
    rows, reasons = [], []
    for target in targets():
        for module in target.modules:
            rows.append(_row(target.name, module, results.get(module), listed, module in old))
            for change in _survived(results, module):
                reasons.append(
                    f"- `{module}`: `{change}`  \n  {listed.get((module, change), '**not listed**')}"
                )
    coverage = [
        f"| `{module}` | {one['statements']} | {one['branches']} | {one['percent']} % |"
        for module, one in sorted(stored(COVERAGE).items())
    ]
    text = TEXT.format(
        verdict=_verdict(results, old),
        rows="\n".join(rows),
        survivors="\n".join(reasons) or "None.",
        coverage="\n".join(coverage),
    )
    PAGE.write_text(text, encoding="utf-8")


def _verdict(results: dict[str, Any], old: list[str]) -> str:
    modules = [module for target in targets() for module in target.modules]
    measured = [module for module in modules if module in results]
    made = sum(results[module]["mutants"] for module in measured)
    left = f"{made} mutants, {len(unlisted(results))} that no test notices and no reason lists"
    changed, missing = len(set(old) & set(measured)), len(modules) - len(measured)
    return f"{left}; of {len(modules)} modules {changed} changed since, {missing} not measured"


def note_coverage(measured: dict[str, Any]) -> None:
    """Store what ``coverage json`` has measured."""
    by_module = {}
    for module, one in measured["files"].items():
        summary = one["summary"]
        if summary["num_statements"]:
            by_module[Path(module).as_posix()] = {
                "statements": summary["num_statements"],
                "branches": summary["num_branches"],
                "percent": summary["percent_covered_display"],
            }
    store(COVERAGE, by_module)


def _survived(results: dict[str, Any], module: str) -> list[str]:
    survived: list[str] = results.get(module, {}).get("survived", [])
    return survived


def _row(
    part: str, module: str, result: dict[str, Any] | None, listed: dict[tuple[str, str], str], old: bool
) -> str:
    if result is None:
        return f"| {part} | `{module}` | not measured | | | | |"
    listed_changes = [change for change in result["survived"] if (module, change) in listed]
    numbers = (result["mutants"], result["killed"], result["timeouts"], len(listed_changes))
    cells = " | ".join(map(str, (*numbers, len(result["survived"]) - len(listed_changes))))
    return f"| {part} | `{module}`{' (changed since)' if old else ''} | {cells} |"
