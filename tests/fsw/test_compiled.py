"""Compiled code flies only if it was built from the sources that are there; else all runs interpreted."""

import json
import os
import shutil
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from zlib import crc32

import pytest

from fsw import compiled
from fsw.compiled import (
    FOLDER,
    KERNEL,
    KERNEL_FOLDER,
    KERNEL_SOURCE,
    MANIFEST,
    ROOT,
    SWITCH,
    Build,
    BuildError,
    CodeStanding,
    Finder,
    refuse_stale_kernel,
    standing,
)

SAY = "import {}; from fsw.compiled import standing; print(standing()); print({}.__spec__.loader)"
MODULE = "fsw.core.algebra.vector"


def why_none():
    """Why there is no build of these sources here; empty where there is one."""
    try:
        Build().check()
    except BuildError as error:
        return str(error)
    return ""


needs_build = pytest.mark.skipif(bool(why_none()), reason=why_none())


def answer(root, module=MODULE, **environment):
    """What a process of its own on the packages of a folder says: its standing, and who loaded the module."""
    done = subprocess.run(
        [sys.executable, "-c", SAY.format(module, module)],
        cwd=root,
        env={**os.environ, SWITCH: "0", "PYTHONPATH": str(root), "PYTHONSAFEPATH": "1", **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    said, loader = done.stdout.splitlines()
    return said, "SourceFileLoader" if "SourceFileLoader" in loader else "compiled"


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """The packages as they are built here."""
    folder = tmp_path_factory.mktemp("packages")
    for name in compiled.PACKAGES:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


@pytest.fixture
def tree(packages, tmp_path):
    """The same, to be spoilt: a folder of links, whose ``fsw`` is a copy."""
    shutil.copytree(packages / "fsw", tmp_path / "fsw")
    for name in ("hil_stub", "sim"):
        (tmp_path / name).symlink_to(packages / name)
    return tmp_path


def manifest_of(tree):
    return json.loads((tree / FOLDER / MANIFEST).read_text())


def rewrite(tree, **values):
    (tree / FOLDER / MANIFEST).write_text(json.dumps(manifest_of(tree) | values))


@needs_build
class TestWhatIsBuilt:
    @pytest.mark.long
    def test_flies_compiled(self, tree):
        assert answer(tree) == (f"compiled: {len(manifest_of(tree)['modules'])} modules", "compiled")

    @pytest.mark.parametrize("module", ["sim.plant.rotation", "fsw.core.algebra.vector"])
    def test_whichever_package_comes_first(self, tree, module):
        assert answer(tree, module)[1] == "compiled"

    def test_is_not_used_where_the_environment_says_so(self, tree):
        assert answer(tree, **{SWITCH: "1"}) == (f"interpreted: {SWITCH} is set", "SourceFileLoader")

    def test_is_not_used_once_a_source_has_changed(self, tree):
        source = tree / "fsw" / "wire" / "frame.py"
        source.write_text(source.read_text() + "\n")
        said = "interpreted: fsw/wire/frame.py has changed since the build"
        assert answer(tree) == (said, "SourceFileLoader")

    def test_nor_where_one_is_missing(self, tree):
        """One that nothing imports here."""
        rewrite(tree, sources=manifest_of(tree)["sources"] | {"fsw/absent.py": "0" * 64})
        said = "interpreted: fsw/absent.py has changed since the build"
        assert answer(tree) == (said, "SourceFileLoader")

    def test_is_used_with_a_source_that_is_newer_and_the_same(self, tree):
        for path in manifest_of(tree)["sources"]:
            os.utime(tree / path)
        assert answer(tree)[1] == "compiled"

    @pytest.mark.parametrize(
        "text", ["", "{", "[]", "{}", '{"modules": ["fsw.core.algebra.vector"]}', '{"modules": 7}', "\xff"]
    )
    def test_is_not_used_with_a_manifest_that_is_damaged(self, tree, text):
        (tree / FOLDER / MANIFEST).write_text(text, encoding="latin-1")
        said, loader = answer(tree)
        assert said.startswith(f"interpreted: {FOLDER}/{MANIFEST} is damaged")
        assert loader == "SourceFileLoader"

    def test_nor_by_another_python(self, tree):
        rewrite(tree, abi=".cpython-39-other.so")
        said, loader = answer(tree)
        assert said.startswith("interpreted: built for .cpython-39-other.so, and this Python loads ")
        assert loader == "SourceFileLoader"

    @pytest.mark.long
    @pytest.mark.parametrize(
        "damage",
        [lambda whole: whole[:-1], lambda whole: whole[: len(whole) // 2].ljust(len(whole), b"\0")],
        ids=["cut short", "of the same length"],
    )
    def test_nor_where_the_library_is_damaged(self, tree, damage):
        library = tree / FOLDER / manifest_of(tree)["library"]
        whole = library.read_bytes()
        library.write_bytes(damage(whole))
        assert answer(tree) == (
            f"interpreted: {FOLDER}/{library.name} is not what was built",
            "SourceFileLoader",
        )

    def test_nor_where_it_cannot_be_loaded(self, tree):
        library = tree / FOLDER / manifest_of(tree)["library"]
        library.write_bytes(b"no library")
        rewrite(tree, library_crc=crc32(b"no library"))
        said, loader = answer(tree)
        assert said.startswith(f"interpreted: {FOLDER}/{library.name} cannot be loaded")
        assert loader == "SourceFileLoader"

    def test_is_not_missed_where_there_is_none(self, tree):
        shutil.rmtree(tree / FOLDER)
        assert answer(tree) == ("interpreted: nothing is built", "SourceFileLoader")


def test_other_modules_are_none_of_the_finders_concern():
    assert Finder().find_spec("json") is None
    assert Finder().find_spec("fsw.compiled") is None
    assert Finder().find_spec("fsw.no_such_module") is None


def test_a_standing_in_words():
    assert str(CodeStanding(frozenset("ab"), "")) == "compiled: 2 modules"
    assert CodeStanding(frozenset("ab"), "").code == "compiled"
    assert str(CodeStanding(frozenset(), "nothing is built")) == "interpreted: nothing is built"
    assert CodeStanding(frozenset(), "nothing is built").code == "interpreted"


@pytest.mark.skipif(not standing().modules, reason="nothing is compiled in this run")
class TestGuardOfTests:
    """A patch that no compiled caller would see proves nothing."""

    def test_a_patch_of_a_compiled_function_is_refused(self, monkeypatch):
        from fsw.core.algebra import vector

        with pytest.raises(TypeError, match="mark the test 'interpreted'"):
            monkeypatch.setattr(vector, "cross", None)
        with pytest.raises(TypeError, match=r"^fsw\.core\.algebra\.vector is compiled"):
            monkeypatch.setattr("fsw.core.algebra.vector.cross", None)
        with pytest.raises(TypeError, match=r"^fsw\.core\.algebra\.vector is compiled"):
            monkeypatch.delattr("fsw.core.algebra.vector.cross")

    def test_any_other_is_not(self, monkeypatch):
        monkeypatch.setattr(compiled, "SWITCH", "ANOTHER")
        monkeypatch.setattr(f"{__name__}.SAY", "")


@pytest.mark.interpreted
def test_an_interpreted_test_patches_what_it_likes(monkeypatch):
    from fsw.core.algebra import vector

    monkeypatch.setattr(vector, "cross", None)
    assert vector.cross is None


def test_a_module_lies_beside_its_source_compiled_too():
    from fsw.core.algebra import vector

    file = Path(vector.__file__)
    assert file.parent == ROOT / "fsw" / "core" / "algebra"
    assert file.name.partition(".")[0] == "vector"


# --- A kernel flies only if it was built from the source that is there

KERNEL_BINARY = f"_kalman_kernel{EXTENSION_SUFFIXES[0]}"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A source, and a binary that holds its digest; what is imported stays as it is."""
    monkeypatch.setitem(sys.modules, KERNEL, sys.modules.get(KERNEL))
    monkeypatch.delitem(sys.modules, KERNEL)
    digest = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
    (tmp_path / KERNEL_SOURCE).write_bytes(b"test")
    (tmp_path / KERNEL_BINARY).write_bytes(b"\x7fELF" + digest.encode() + b"\x00")
    return tmp_path


def test_a_kernel_of_this_source_is_imported(folder):
    refuse_stale_kernel(folder)
    assert KERNEL not in sys.modules


def test_one_of_another_source_is_not(folder):
    (folder / KERNEL_SOURCE).write_bytes(b"another")
    refuse_stale_kernel(folder)
    assert sys.modules[KERNEL] is None


@pytest.mark.parametrize("missing", [KERNEL_SOURCE, KERNEL_BINARY])
def test_nothing_is_stale_where_one_of_the_two_is_missing(missing, folder):
    (folder / missing).unlink()
    refuse_stale_kernel(folder)
    assert KERNEL not in sys.modules


@pytest.mark.long
def test_a_flight_with_a_stale_kernel_is_by_filterpy(tmp_path):
    """A whole copy of the package, its source changed by a comment."""
    shutil.copytree(KERNEL_FOLDER.parents[1], tmp_path / "fsw")
    source = tmp_path / "fsw" / "core" / "estimation" / KERNEL_SOURCE
    source.write_text(source.read_text() + "/* changed */\n")
    asked = "from fsw.core.estimation.kalman import Algebra, available; print(available(Algebra.KERNEL))"
    done = subprocess.run(
        [sys.executable, "-c", asked], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "filterpy"
    assert compiled.KERNEL_FOLDER == KERNEL_FOLDER
