"""Measuring mutants, on a repository of one module: what is noticed, what survives, what has grown old."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOLS = ("argument_types.py", "mutate.py", "mutants.py", "mutation_page.py", "mutation_tests.py")
MODULE = '''"""A limit."""

LIMIT = 3


def clipped(value: int) -> int:
    if value > LIMIT:
        return LIMIT
    return value
'''
TESTS = """from fsw.limit import clipped


def test_within():
    assert clipped(2) == 2


def test_beyond():
    assert clipped(5) == 3
"""
SAME = "if value > LIMIT: -> if value >= LIMIT:"


class Repository:
    """A small one, with the tools in it."""

    def __init__(self, root):
        self.root = root
        for name in TOOLS:
            self.write(f"tools/{name}", (ROOT / "tools" / name).read_text())
        self.write("fsw/__init__.py", "")
        self.write("fsw/limit.py", MODULE)
        self.write("tests/test_limit.py", TESTS)
        self.write("tests/mutation/survivors.toml", "")
        self.write("docs/mutation.md", "")
        self.write(
            "tests/mutation/targets.toml",
            '[limits]\nmodules = ["fsw/limit.py"]\nquick = ["tests/test_limit.py"]\nslow = []\n',
        )

    def write(self, name, text):
        (self.root / name).parent.mkdir(parents=True, exist_ok=True)
        (self.root / name).write_text(text)

    def mutate(self, *options):
        command = [sys.executable, str(self.root / "tools/mutate.py"), "--workers", "1", *options]
        return subprocess.run(command, check=False, capture_output=True, text=True, timeout=100)

    @property
    def result(self):
        return json.loads((self.root / "tests/mutation/results.json").read_text())["fsw/limit.py"]

    @property
    def row(self):
        (row,) = [
            line for line in (self.root / "docs/mutation.md").read_text().splitlines() if "| limits |" in line
        ]
        return row


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    repository = Repository(tmp_path_factory.mktemp("repository"))
    return repository, repository.mutate()


@pytest.fixture
def repository(measured, tmp_path):
    """The one that has been measured, to be changed."""
    shutil.copytree(measured[0].root, tmp_path, dirs_exist_ok=True)
    copied = Repository.__new__(Repository)
    copied.root = tmp_path
    return copied


@pytest.mark.long
def test_what_no_test_notices_is_told_and_is_a_failure(measured):
    repository, done = measured
    assert (repository.result["mutants"], repository.result["killed"]) == (5, 4)
    assert repository.result["survived"] == [SAME]
    assert f"survives, and is not listed: {SAME}" in done.stdout
    assert done.returncode == 1
    assert repository.row == "| limits | `fsw/limit.py` | 5 | 4 | 0 | 0 | 1 |"
    assert "**not listed**" in (repository.root / "docs/mutation.md").read_text()


def list_survivor(repository):
    repository.write(
        "tests/mutation/survivors.toml",
        f'[[survivor]]\nmodule = "fsw/limit.py"\nchange = "{SAME}"\nreason = "equal is the limit too"\n',
    )


@pytest.mark.long
def test_a_survivor_with_a_reason_is_none(repository):
    list_survivor(repository)
    assert repository.mutate("--page").returncode == 0
    assert repository.row == "| limits | `fsw/limit.py` | 5 | 4 | 0 | 1 | 0 |"
    assert "equal is the limit too" in (repository.root / "docs/mutation.md").read_text()


@pytest.mark.long
def test_tests_that_have_been_added_are_tried_on_what_survived(repository):
    tests = (repository.root / "tests/test_limit.py").read_text()
    repository.write("tests/test_limit.py", tests + "    assert type(clipped(3.0)) is float\n")
    assert repository.mutate("--again").returncode == 0
    assert repository.row == "| limits | `fsw/limit.py` | 5 | 5 | 0 | 0 | 0 |"


@pytest.mark.long
def test_a_module_that_has_changed_since_is_told_and_is_a_failure(repository):
    list_survivor(repository)
    repository.write("fsw/limit.py", MODULE.replace("LIMIT = 3", "LIMIT = 4"))
    done = repository.mutate("--page")
    assert (done.returncode, done.stdout) == (1, "fsw/limit.py: not measured as it is now\n")
    assert repository.row == "| limits | `fsw/limit.py` (changed since) | 5 | 4 | 0 | 1 | 0 |"


@pytest.mark.parametrize("option", ["--quick", "--list", "--again"])
def test_a_name_that_is_of_nothing_is_told_and_is_no_success(repository, option):
    done = repository.mutate("limits", "fsw/limit", option)
    assert (done.returncode, done.stdout) == (2, "")
    assert "there is no target or module fsw/limit in" in done.stderr


@pytest.mark.parametrize("name", ["results.json", "targets.toml", "survivors.toml"])
def test_a_file_that_is_cut_short_is_told_in_a_sentence_and_left(repository, name):
    repository.write(f"tests/mutation/{name}", '[limits\nx = "')
    done = repository.mutate("--page")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"tests/mutation/{name} cannot be read: ")
    assert done.stderr.count("\n") == 1
    assert (repository.root / "tests/mutation" / name).read_text() == '[limits\nx = "'


@pytest.mark.long
def test_a_module_that_has_never_been_measured_is_a_failure(repository):
    repository.write("tests/mutation/results.json", "{}")
    assert repository.mutate("--page").returncode == 1
    assert repository.row == "| limits | `fsw/limit.py` | not measured | | | | |"


def test_what_has_survived_of_a_module_that_was_never_measured_is_nothing_to_try_again(repository):
    repository.write("tests/mutation/results.json", "{}")
    done = repository.mutate("--again")
    assert (done.returncode, done.stdout) == (1, "fsw/limit.py: not measured as it is now\n")
    assert done.stderr == ""


@pytest.mark.long
def test_tests_that_fail_by_themselves_measure_nothing(repository):
    repository.write("fsw/limit.py", MODULE.replace("LIMIT = 3", "LIMIT = 4"))
    done = repository.mutate("--stale")
    assert done.returncode != 0
    assert "tests/test_limit.py::test_beyond" in done.stderr
    assert repository.result["mutants"] == 5
    assert "(changed since)" not in repository.row, "the page is of before"


def test_branch_coverage_is_taken_over_into_the_page(repository):
    summary = {"num_statements": 7, "num_branches": 2, "percent_covered_display": "100"}
    repository.write("coverage.json", json.dumps({"files": {"fsw/limit.py": {"summary": summary}}}))
    assert repository.mutate("--coverage", str(repository.root / "coverage.json")).returncode == 0
    assert "| `fsw/limit.py` | 7 | 2 | 100 % |" in (repository.root / "docs/mutation.md").read_text()
