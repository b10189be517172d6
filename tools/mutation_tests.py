"""Runs the tests of one module on many versions of it: in a copy of the repository, each in a forked child.

Most of the time goes into start-up, not into the tests. So the child is forked off a process that has
imported the libraries, and every module of the project that does not need the mutated one; tests that are
quick or have noticed mutants before come first; a failure is reported by its name alone.
"""

import ast
import gc
import os
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest

ROOT = Path(__file__).resolve().parents[1]
COPIED = (
    "fsw",
    "hil_stub",
    "sim",
    "tests",
    "tools",
    "docs",
    "examples",
    "pyproject.toml",
    "README.md",
    "Makefile",
)
PACKAGES = ("fsw", "hil_stub", "sim")
LOADED = "loaded.txt"
"""In the copy: names of the modules that the tests have imported."""

LEAST_TIMEOUT_S = 10.0
TIMEOUT_RATIO = 8.0
"""A mutant is stopped, and counts as noticed, when the tests take this many times as long as without it."""

KILLED, SURVIVED, TIMEOUT = "killed", "survived", "timeout"

UNUSED_PLUGINS = ("cacheprovider", "xdist", "unraisableexception", "hypothesispytest")
OPTIONS = ["-x", "-q", "--tb=no", "--assert=plain", *(f"-pno:{plugin}" for plugin in UNUSED_PLUGINS)]


class PytestOrder:
    """Plugin of pytest: runs the most promising tests first, and writes the outcome of each to a file.

    Args:
        seconds: how long each takes.
        noticed: how often each has failed so far.
        outcomes: file for the outcomes.
    """

    def __init__(self, seconds: dict[str, float], noticed: Counter[str], outcomes: Path) -> None:
        self._seconds, self._noticed, self._outcomes = seconds, noticed, outcomes

    def pytest_collection_modifyitems(self, items: "list[pytest.Item]") -> None:
        items.sort(
            key=lambda item: (self._seconds.get(item.nodeid, 0.0) + 1e-3) / (1 + self._noticed[item.nodeid])
        )

    def pytest_runtest_logreport(self, report: "pytest.TestReport") -> None:
        if report.when == "call" or report.failed:
            with self._outcomes.open("a", encoding="utf-8") as file:
                file.write(f"{report.nodeid} {not report.failed} {report.duration:.4f}\n")


class Stage:
    """Tests that are run together, with the time that each takes and the mutants that it has noticed."""

    def __init__(self, tests: list[str]) -> None:
        self._tests = tests
        self._noticed = Counter[str]()
        self._seconds: dict[str, float] = {}
        self.timeout_s = 0.0
        self.last_failed = ""

    def run(self, folder: Path, timeout_s: float, first: bool = False) -> str:
        """Run them on the copy in the folder; the first run leaves compiled modules for the next ones."""
        outcomes = folder / "outcomes.txt"
        outcomes.unlink(missing_ok=True)
        child = os.fork()
        if child == 0:
            os.setsid()
            code = 1
            try:
                code = _in_child(
                    folder, self._tests, PytestOrder(self._seconds, self._noticed, outcomes), first
                )
            finally:
                os._exit(code)
        code, late = _wait(child, timeout_s)
        self._learn(outcomes)
        if late:
            return TIMEOUT
        return SURVIVED if code == 0 else KILLED

    def _learn(self, outcomes: Path) -> None:
        self.last_failed = "the tests cannot be collected"
        for line in outcomes.read_text(encoding="utf-8").splitlines() if outcomes.exists() else ():
            test, passed, seconds = line.rsplit(maxsplit=2)
            self.last_failed = test  # unless another follows
            if passed == "True":
                self._seconds[test] = float(seconds)
            else:
                self._noticed[test] += 1


class Judge:
    """Judges whether the tests notice versions of a module, one after the other; one judge a process.

    Args:
        module: path of the module in the repository.
        stages: tests, as pytest takes them; the next stage is for what the one before lets pass.

    Raises:
        SystemExit: the tests fail on the module as it is.
    """

    def __init__(self, module: str, stages: list[list[str]]) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="copy-"))
        copy_repository(self._folder, COPIED)
        self._path = self._folder / module
        self._source = self._path.read_text(encoding="utf-8")
        _prepare(self._folder)
        self._module = module
        self._stages = [Stage(tests) for tests in stages if tests]

    def _make_ready(self, stage: Stage) -> None:
        """Run the tests twice without a mutant; the first time leaves compiled modules and the order."""
        for first in (True, False):
            began = time.monotonic()
            if stage.run(self._folder, 900.0, first) != SURVIVED:
                raise SystemExit(f"{self._module}: the tests fail without a mutant: {stage.last_failed}")
            stage.timeout_s = max(LEAST_TIMEOUT_S, TIMEOUT_RATIO * (time.monotonic() - began))
            if first:
                self._forget_compiled()
                _import_all_but(self._module, self._folder)

    def judge(self, source: str) -> tuple[str, str]:
        """(outcome, the test that noticed)."""
        for stage in self._stages:
            if not stage.timeout_s:
                self._make_ready(stage)
            self._path.write_text(source, encoding="utf-8")
            outcome = stage.run(self._folder, stage.timeout_s)
            self._path.write_text(self._source, encoding="utf-8")
            if outcome != SURVIVED:
                return outcome, stage.last_failed
        return SURVIVED, ""

    def _forget_compiled(self) -> None:
        """Of the module that changes: two versions may be as long and as old as each other."""
        for compiled in (self._path.parent / "__pycache__").glob(f"{self._path.stem}.*"):
            compiled.unlink()


def copy_repository(folder: Path, names: tuple[str, ...]) -> None:
    for name in names:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (ROOT / name).exists():
            shutil.copy(ROOT / name, folder / name)


def _prepare(folder: Path) -> None:
    """Set up what every child uses."""
    from hypothesis import Phase, settings  # noqa: PLC0415  in the child alone

    settings.register_profile(
        "mutation",
        derandomize=True,
        database=None,
        deadline=None,
        report_multiple_bugs=False,
        phases=[Phase.explicit, Phase.generate],
    )
    os.environ |= {
        "PYTHONPATH": str(folder),
        "HYPOTHESIS_PROFILE": "mutation",
        "TORQUER_INTERPRETED": "1",  # in compiled code no tool sees which lines a test runs
    }
    settings.load_profile("mutation")
    sys.path.insert(0, str(folder))


def _import_all_but(module: str, folder: Path) -> None:
    """Import what children have imported, except that module and whatever imports it, also indirectly."""
    wanted = (folder / LOADED).read_text(encoding="utf-8").split()
    dependent = _dependent_on(module, folder)
    for name in wanted:
        if name not in dependent and name.partition(".")[0] not in ("tests", "conftest", "__main__"):
            with suppress(ImportError):
                import_module(name)
    if early := dependent & set(sys.modules):
        raise SystemExit(f"imported before it was changed: {', '.join(sorted(early))}")
    gc.collect()
    gc.freeze()


def _dependent_on(module: str, folder: Path) -> set[str]:
    """Modules of the project that import that one, and itself."""
    needs = {}
    for package in PACKAGES:
        for path in (folder / package).rglob("*.py"):
            name = ".".join(path.relative_to(folder).with_suffix("").parts).removesuffix(".__init__")
            above = {name.rsplit(".", n)[0] for n in range(1, name.count(".") + 1)}
            needs[name] = above | set(_imported(ast.parse(path.read_text(encoding="utf-8"))))
    dependent = {".".join(Path(module).with_suffix("").parts)}
    while more := {name for name in needs if name not in dependent and needs[name] & dependent}:
        dependent |= more
    return dependent


def _imported(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _in_child(folder: Path, tests: list[str], order: PytestOrder, first: bool) -> int:
    import pytest  # noqa: PLC0415  in the child alone

    sink = os.open(os.environ.get("MUTATION_OUTPUT", os.devnull), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(sink, 1)
    os.dup2(sink, 2)
    os.chdir(folder)
    if not first:
        sys.dont_write_bytecode = True
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    code = int(pytest.main([*OPTIONS, *tests], plugins=[order]))
    if first:
        with (folder / LOADED).open("a", encoding="utf-8") as file:
            file.write("\n".join(sys.modules) + "\n")
    return code


def _wait(child: int, timeout_s: float) -> tuple[int, bool]:
    """(exit code of the child, whether it was stopped after the timeout)."""
    deadline = time.monotonic() + timeout_s
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            _end_group(child)
            return os.waitstatus_to_exitcode(status), False
        if time.monotonic() > deadline:
            _end_group(child)
            os.waitpid(child, 0)
            return -1, True
        time.sleep(0.005)


def _end_group(child: int) -> None:
    """The child, and what its tests have started."""
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
