"""Code is told from other code by the text of all that a flight follows from."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from sim.campaign.code_digest import FLIGHT_CODE, NOT_FLOWN, WORDS, code_digest, program
from sim.campaign.flight import Order, fly_order
from sim.errors import HarnessError
from sim.fault_table.campaign import FAULT_CODE
from sim.scenario.schema import parse_settings


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A copy of all that a flight follows from."""
    copied, here = tmp_path_factory.mktemp("project"), Path(__file__).parents[3]
    for part in FLIGHT_CODE:
        if (here / part).is_dir():
            shutil.copytree(here / part, copied / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            (copied / part).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(here / part, copied / part)
    return copied


IMPORTED = """
import sys
from sim.campaign.flight import Order, fly_order
from sim.fault_table import case
fly_order(Order("microsat", {}, 3, 0.01))
project = {"fsw", "hil_stub", "sim", "torquer"}
print(*(module.__file__ for name, module in sys.modules.items() if name.split(".")[0] in project))
"""
ONLY_SHOWN = ("sim/console.py", "sim/drawing", "sim/errors.py", "sim/progress.py", "sim/sizing")
"""What a flight imports and no figure follows from."""


def test_it_is_the_same_for_the_same_code_elsewhere(project):
    assert code_digest.__wrapped__(project=project) == code_digest()


@pytest.mark.parametrize("part", FLIGHT_CODE)
def test_it_is_another_where_a_line_of_any_part_is(project, part):
    file = project / part if part.endswith(".py") else next((project / part).rglob("*.py"))
    before, content = code_digest.__wrapped__((part,), project), file.read_bytes()
    file.write_bytes(content + b"CHANGED = 1\n")
    assert code_digest.__wrapped__((part,), project) != before
    file.write_bytes(content)


def test_words_for_readers_are_no_code():
    one = (
        '"""A module."""\n\nX = 1  # now\n\n\ndef f():\n    """Nothing."""\n    # why\n    return "# text"\n'
    )
    other = one.replace("A module.", "Another.\n\nIn two lines.\n").replace("Nothing.", "A text.")
    assert program(one) == program(other.replace("  # now", "").replace("    # why\n", ""))


@pytest.mark.parametrize(
    ("code", "changed"),
    [
        ("x = 1\n", "x = 2\n"),
        ('x = "# a"\n', 'x = "# b"\n'),
        ('x = """a\n# b\n"""\n', 'x = """a\n# c\n"""\n'),
        ("if a:\n    b()\nc()\n", "if a:\n    b()\n    c()\n"),
        ('f("a")\n', 'f("b")\n'),
    ],
)
def test_all_that_is_executed_is_code(code, changed):
    assert program(code) != program(changed)


def test_a_file_that_no_flight_imports_may_change(project):
    before = code_digest.__wrapped__(("sim/scenario",), project)
    (project / "sim/scenario/keys/page.py").write_text("CHANGED = 1\n")
    assert code_digest.__wrapped__(("sim/scenario",), project) == before


@pytest.mark.long
def test_it_is_of_all_that_a_flight_imports():
    here = Path(__file__).parents[3]
    ran = subprocess.run([sys.executable, "-c", IMPORTED], capture_output=True, text=True, check=True)
    imported = [Path(file).relative_to(here) for file in ran.stdout.split()]
    imported = [file for file in imported if file.name != "__init__.py"]
    parts = [Path(part) for part in (*FAULT_CODE, *ONLY_SHOWN)]
    assert len(imported) > 200
    assert not [file for file in imported if not any(file.is_relative_to(part) for part in parts)]
    assert not [file for file in imported if any(file.is_relative_to(part) for part in NOT_FLOWN)]


def test_no_figure_of_a_flight_follows_from_the_words_that_tell_why(monkeypatch):
    missed = 'requirement=[{index="ape",at_most_deg=0.01,by_orbit=0.05,last_orbits=0.05}]'
    order = Order("microsat", parse_settings((missed,)), 3, 0.06)
    summary = fly_order(order).summary
    assert [one["verdict"] for one in summary["requirements"]] == ["failed"]
    monkeypatch.setattr("sim.report.requirements.judge.reasons", lambda missed, evidence: [])
    without = fly_order(order).summary
    for one in (summary, without):
        one["requirements"][0]["reasons"] = one["wall_seconds"] = one["realtime_factor"] = None
    assert without == summary


def test_the_words_are_asked_for_by_nothing_but_the_verdict(project):
    names = [part.removesuffix(".py").replace("/", ".") for part in WORDS]
    for file in project.rglob("*.py"):
        if file.relative_to(project).as_posix() not in (*WORDS, "sim/report/requirements/judge.py"):
            assert not [name for name in names if f"{name} import" in file.read_text()], file


def test_a_part_that_is_not_there_is_told(tmp_path):
    with pytest.raises(HarnessError, match="fsw: holds no code"):
        code_digest.__wrapped__(project=tmp_path)
