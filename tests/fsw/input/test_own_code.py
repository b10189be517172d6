"""User code: found without being executed, executed only as it was named, each fault one sentence."""

import hashlib
import sys
from pathlib import Path
from types import ModuleType

import pytest

from fsw.input import own_code
from fsw.input.own_code import display, find, given_as, in_file, is_running, load, short_name
from fsw.input.schema import TableError

GROUP = "torquer.laws"


@pytest.fixture
def source(tmp_path):
    """Writes code into a file, and returns its absolute reference and the digest."""

    def write(text, name="law"):
        path = tmp_path / "mine.py"
        path.write_text(text, encoding="utf-8")
        return f"{path}:{name}", hashlib.sha256(path.read_bytes()).hexdigest()

    return write


def sentence(reference, sha256=None):
    with pytest.raises(TableError) as caught:
        load(reference, sha256, GROUP)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("reference", "file", "name"),
    [
        ("a.py:law", True, "law"),
        ("dir/a b.py:law_2", True, "law_2"),
        (r"C:\sat\a.py:law", True, "law"),
        ("installed", False, "installed"),
        ("a.py", False, "a.py"),
        ("a.py:2law", False, "a.py:2law"),
        ("a.py:law.point", False, "a.py:law.point"),
        ("object __main__:law", False, "law"),
        ("object laws:make.<locals>.law", False, "law"),
        ("object __main__:<lambda>", False, "<lambda>"),
    ],
)
def test_a_reference_is_of_a_file_or_a_name(reference, file, name):
    assert (in_file(reference), short_name(reference)) == (file, name)


def test_finding_code_does_not_execute_it(source, tmp_path):
    reference, sha256 = source(f"open({str(tmp_path / 'trace')!r}, 'w')\nlaw = 1\n")
    assert find("mine.py:law", tmp_path, GROUP) == (reference, sha256)
    assert not (tmp_path / "trace").exists()
    assert load(reference, sha256, GROUP) == 1
    assert (tmp_path / "trace").exists()


def test_a_relative_path_counts_against_the_folder(source, tmp_path, monkeypatch):
    reference, _ = source("law = 1\n")
    monkeypatch.chdir("/")
    found = find("mine.py:law", tmp_path, GROUP)
    assert found is not None
    assert found.reference == reference


def test_each_load_is_fresh(source):
    reference, sha256 = source("law = []\n")
    load(reference, sha256, GROUP).append(1)
    assert load(reference, sha256, GROUP) == []


def test_a_dataclass_may_have_annotations_of_the_future(source):
    text = (
        "from __future__ import annotations\nfrom dataclasses import dataclass\n"
        "@dataclass(frozen=True, slots=True)\nclass law:\n    k: float = 1.0\n"
    )
    assert load(*source(text), GROUP)(2.0).k == 2.0


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("law = \n", "line 1: invalid syntax"),
        ("other = 1\n", "there is no law in it"),
        ("\nraise ValueError('no')\n", "line 2: ValueError: no"),
        ("def f():\n    import nothing_like_this\nf()\n", "line 2: ModuleNotFoundError: No module named"),
        ("raise SystemExit(3)\n", "line 1: SystemExit: 3"),
        ("class E(Exception):\n    def __str__(self):\n        1 / 0\nraise E\n", "E: without a text"),
        ("raise ValueError('x' * 10000)\n", f"ValueError: {'x' * own_code.LONGEST_ERROR}"),
        ("\0", "null bytes"),
    ],
)
def test_what_is_wrong_with_a_file(source, text, what):
    reference, _ = source(text)
    found = sentence(reference)
    assert found.startswith(reference.rpartition(":")[0])
    assert what in found


def test_a_missing_file(tmp_path):
    assert "cannot be read (No such file" in sentence(f"{tmp_path}/none.py:law")
    with pytest.raises(TableError, match="cannot be read"):
        find("none.py:law", tmp_path, GROUP)


def test_another_source_than_the_one_that_was_named(source):
    _, before = source("law = 1\n")
    reference, after = source("law = 2\n")
    found = sentence(reference, before)
    assert before[:16] in found
    assert after[:16] in found


def test_an_entry_point_that_is_not_installed():
    assert find("nobody_has_this", Path(), GROUP) is None
    assert "not installed" in sentence("nobody_has_this")


def test_a_reference_is_displayed_without_its_folders():
    assert display("/home/somebody/a.py:law") == "law of a.py"
    assert display("installed") == "installed"
    assert display("object __main__:law") == "law of __main__, given as an object"


def test_what_was_given_as_an_object_is_told_from_a_file():
    assert given_as("object a.b:f.<locals>.law") == ("a.b", "f.<locals>.law")
    assert given_as("object a.py:law") is None
    assert given_as("installed") is None


def test_the_script_that_runs_is_not_executed_again_but_where_it_is_asked_for(source, monkeypatch):
    reference, sha256 = source("law = []\n")
    script = ModuleType("__main__")
    script.__file__ = reference.rpartition(":")[0]
    monkeypatch.setitem(sys.modules, "__main__", script)
    assert is_running(reference)
    assert "there is no law in it yet: define it above the call" in sentence(reference)
    script.law = [1]
    assert load(reference, sha256, GROUP) is script.law
    assert load(reference, sha256, GROUP, afresh=True) == []
    del script.__file__
    assert not is_running(reference)


def test_a_file_that_asks_for_itself_and_one_that_flies(source):
    text = "from fsw.input.own_code import load, refuse_while_loading\n"
    own_code.refuse_while_loading("fly")
    reference, _ = source(f"{text}load(__file__ + ':law', None, '')\nlaw = 1\n")
    assert "asks for what it defines while it is loaded for it: put the call under" in sentence(reference)
    reference, _ = source(f"{text}refuse_while_loading('fly')\nlaw = 1\n")
    assert "line 2: TableError: fly: a file that is loaded for what it defines flies" in sentence(reference)
    own_code.refuse_while_loading("fly")


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """A package as pip installs it, with an entry point; returns its folder."""
    package = tmp_path / "somebodys_laws"
    package.mkdir()
    (package / "__init__.py").write_text(f"open({str(tmp_path / 'trace')!r}, 'w')\n")
    (package / "one.py").write_text("law = 'theirs'\n")
    info = tmp_path / "somebodys_laws-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: somebodys-laws\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{GROUP}]\ntheirs = somebodys_laws.one:law\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield package
    for name in [name for name in sys.modules if name.startswith("somebodys_laws")]:
        del sys.modules[name]


def test_an_entry_point_is_found_without_importing_its_package(installed, tmp_path):
    found = find("theirs", Path(), GROUP)
    assert found.reference == "theirs"
    assert not (tmp_path / "trace").exists()
    assert load("theirs", found.sha256, GROUP) == "theirs"


def test_every_module_of_its_package_counts_in_the_digest(installed):
    before = find("theirs", Path(), GROUP).sha256
    (installed / "two.py").write_text("")
    assert find("theirs", Path(), GROUP).sha256 != before
