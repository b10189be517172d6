"""Code is told from other code by the text of all that is loaded for a flight."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from sim.campaign import code_digest as module
from sim.campaign.code_digest import code_digest, loaded_files, program

HERE = Path(__file__).parents[3]
FILES = {
    "sim/__init__.py": "",
    "sim/run.py": '"""Runs."""\nfrom sim.figures import worst\n',
    "sim/figures/__init__.py": "def worst(x):\n    import sim.figures.units\n    return max(x)\n",
    "sim/figures/units.py": "from sim import run\nDEG = 57.3\n",
    "sim/figures/limits.toml": "most = 1.0\n",
    "sim/figures/shipped/__init__.py": "",
    "sim/figures/shipped/one.toml": "a = 1\n",
    "sim/figures/other/__init__.py": "",
    "sim/figures/other/page.py": "LIMIT = 1.0\n",
    "sim/figures/other/page.toml": "a = 1\n",
}
LOADED = [name for name in FILES if "/other/" not in name and name != "sim/figures/shipped/__init__.py"]


@pytest.fixture
def project(tmp_path):
    """A project whose run imports figures, these units when they are asked for, and units the run."""
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.fixture
def digest(project):
    """The digest of the run, read again."""

    def compute():
        for kept in (module._imported, module._content):
            kept.cache_clear()
        return code_digest.__wrapped__("sim.run", project)

    yield compute
    for kept in (module._imported, module._content):
        kept.cache_clear()


def test_what_is_imported_at_once_or_later_is_loaded_and_the_data_beside_it(project):
    found = [file.relative_to(project).as_posix() for file in loaded_files("sim.run", project)]
    assert found == sorted(LOADED)


@pytest.mark.parametrize("name", LOADED[1:])
def test_a_change_of_any_of_them_is_another_digest(project, digest, name):
    before = digest()
    (project / name).write_text(FILES[name] + "LIMIT = 2.0\n")
    assert digest() != before


@pytest.mark.parametrize("name", sorted(FILES.keys() - set(LOADED)))
def test_what_is_not_loaded_may_change(project, digest, name):
    before = digest()
    (project / name).write_text("LIMIT = 2.0\n")
    assert digest() == before


def test_without_the_filter_s_kernel_other_code_flies(digest, monkeypatch):
    before = digest()
    monkeypatch.setattr(module, "find_spec", lambda name: None if "kernel" in name else 1 / 0)
    assert digest() != before


def test_it_is_the_same_for_the_same_code_elsewhere(project, digest, tmp_path_factory):
    other = tmp_path_factory.mktemp("other") / "copy"
    shutil.copytree(project, other)
    assert code_digest.__wrapped__("sim.run", other) == digest()


def test_the_lock_of_an_editor_is_no_data(project, digest):
    before = digest()
    (project / "sim/figures/.#limits.toml").symlink_to("someone@elsewhere.1234")
    assert digest() == before


@pytest.mark.parametrize("library", ["numpy", "sgp4"])
def test_another_version_of_a_library_is_another_digest(digest, monkeypatch, library):
    before, version = digest(), module.version
    monkeypatch.setattr(module, "version", lambda name: "0.0" if name == library else version(name))
    assert digest() != before


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


IMPORTED = """
import sys
from sim.campaign.flight import Order, fly_order
from sim.fault_table import case
fly_order(Order("microsat", {}, 3, 0.01))
project = {"fsw", "hil_stub", "sim", "torquer"}
print(*(module.__file__ for name, module in sys.modules.items() if name.split(".")[0] in project))
from sim.campaign.code_digest import loaded_files
print(*loaded_files("sim.fault_table.case"))
"""
"""In a process of its own: what other tests have patched or cached counts for neither."""


@pytest.mark.long
def test_a_flight_imports_nothing_that_is_not_counted():
    ran = subprocess.run(
        [sys.executable, "-c", IMPORTED],
        capture_output=True,
        text=True,
        check=True,
        env={"TORQUER_INTERPRETED": "1", "PYTHONPATH": str(HERE)},
    )
    imported, counted = (
        {Path(file).resolve() for file in line.split() if file.endswith(".py")}
        for line in ran.stdout.splitlines()
    )
    imported = {file for file in imported if file.name != "__init__.py"}
    assert len(imported) > 200
    assert imported - counted == set()


@pytest.mark.long
def test_scenarios_that_ship_the_bus_and_the_kernel_are_counted():
    names = {file.name for file in loaded_files("sim.campaign.flight")}
    assert {"microsat.toml", "torquer.dbc", "kalman_kernel.c"} <= names
