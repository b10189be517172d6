"""The compiled group: what is in it, what is built again, what is said where nothing can be built."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import compile_group
import pytest
from compile_group import (
    FOLDER,
    GROUP,
    INTERPRETED,
    MANIFEST,
    ROOT,
    CompileError,
    closure,
    compile_all,
    compiler_words,
    group_sources,
)

SMALL = '''"""One function whose bits a contracted product would change, one constant of a module outside."""

from typing import Final

from fsw.outside import LIMIT

LARGEST: Final = LIMIT


def remainder(a: float, b: float, c: float) -> float:
    return a * b + c


def reached(value: float) -> bool:
    return value >= LIMIT
'''
RUN = """
import json, random
from fsw import small
from fsw.compiled import standing
draw = random.Random(7).uniform
triples = [(draw(-1, 1), draw(-1, 1), draw(-1, 1)) for _ in range(1000)]
print(json.dumps([standing().code, [small.remainder(*t).hex() for t in triples], small.reached(3.0)]))
"""


def can_compile():
    try:
        compiler_words()
        import mypyc  # noqa: F401  whether it is there
    except (CompileError, ImportError):
        return False
    return shutil.which(compiler_words()[0]) is not None


needs_compiler = pytest.mark.skipif(not can_compile(), reason="there is no C compiler, or no mypyc")


def test_every_pattern_of_the_group_names_sources():
    for pattern in (*GROUP, *INTERPRETED):
        assert [path for path in ROOT.glob(pattern) if path.is_file()], pattern


def test_packages_themselves_are_not_compiled():
    sources = group_sources()
    assert sources == sorted(set(sources))
    assert all((ROOT / source).is_file() for source in sources)
    assert not [source for source in sources if source.endswith(("__init__.py", "__main__.py"))]


def test_the_sources_are_the_group_and_what_it_imports(tmp_path):
    (tmp_path / "fsw").mkdir()
    (tmp_path / "fsw" / "one.py").write_text("import math\nfrom fsw import two\n")
    (tmp_path / "fsw" / "two.py").write_text("def f():\n    from fsw.three import X\n")
    (tmp_path / "fsw" / "three.py").write_text("import fsw.one\nX = 1\n")
    (tmp_path / "fsw" / "four.py").write_text("import fsw.one\n")
    assert closure(["fsw/one.py"], tmp_path) == ["fsw/one.py", "fsw/three.py", "fsw/two.py"]


class TestWithoutWhatItNeeds:
    @pytest.fixture(autouse=True)
    def no_build(self, monkeypatch):
        monkeypatch.setattr(compile_group, "is_current", lambda *given: False)
        monkeypatch.setattr(sys, "argv", ["compile_group"])

    def said(self, capsys):
        assert compile_group.main() == 0
        return capsys.readouterr().err

    def test_a_header(self, monkeypatch, capsys, tmp_path):
        monkeypatch.setattr(compile_group.sysconfig, "get_path", lambda name: str(tmp_path))
        assert self.said(capsys) == (
            "The flight code is not compiled, and runs interpreted: "
            f"Python's header {tmp_path}/Python.h is not there\n"
        )

    def test_a_compiler(self, monkeypatch, capsys):
        monkeypatch.setattr(
            compile_group.sysconfig, "get_config_var", lambda name: "no-such-compiler -pthread"
        )
        assert self.said(capsys) == (
            "The flight code is not compiled, and runs interpreted: there is no C compiler no-such-compiler\n"
        )

    @pytest.mark.long
    def test_mypyc(self, monkeypatch, capsys):
        monkeypatch.setitem(sys.modules, "mypyc.build", None)
        assert "runs interpreted: mypyc is not there" in self.said(capsys)


@pytest.mark.long
@needs_compiler
class TestCompiling:
    @pytest.fixture
    def files(self, tmp_path):
        names = [tmp_path / f"{name}.c" for name in "abc"]
        for path in names:
            path.write_text(f"int {path.stem}(void) {{ return 1; }}\n")
        (tmp_path / "common.h").write_text("#define ONE 1\n")
        return names

    def compiled(self, files, words=()):
        """How many files were compiled, by what was said."""
        said = []
        objects = compile_all(files, [*compiler_words(), *words], files[0].parent, said.append)
        assert all(path.is_file() for path in objects)
        assert sorted(objects) == sorted((files[0].parent / "objects").iterdir()), "no old one is left"
        return len(said)

    def test_is_done_again_for_what_has_changed_alone(self, files):
        assert self.compiled(files) == 3
        assert self.compiled(files) == 0
        files[1].write_text("int b(void) { return 2; }\n")
        assert self.compiled(files) == 1

    def test_and_for_all_after_a_change_of_headers_or_flags(self, files):
        self.compiled(files)
        (files[0].parent / "common.h").write_text("#define ONE 2\n")
        assert self.compiled(files) == 3
        assert self.compiled(files, ["-DTWO=2"]) == 3

    def test_what_the_compiler_refuses_is_an_error(self, files):
        files[2].write_text("int c(void) { return }\n")
        with pytest.raises(CompileError, match=r"exit code 1:\n.*c\.c"):
            self.compiled(files)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("small")
    (root / "fsw").mkdir()
    for name in ("__init__.py", "compiled.py"):
        shutil.copy(ROOT / "fsw" / name, root / "fsw")
    (root / "fsw" / "small.py").write_text(SMALL)
    (root / "fsw" / "outside.py").write_text("from typing import Final\n\nLIMIT: Final = 2.0\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compile_group, "GROUP", ("fsw/small.py",))
        assert compile_group.build(lambda words: None, root) == 1
        yield root


@needs_compiler
@pytest.mark.long
class TestSmallGroup:
    def run(self, root, **environment):
        done = subprocess.run(
            [sys.executable, "-c", RUN],
            env={**os.environ, "TORQUER_INTERPRETED": "", "PYTHONPATH": str(root), **environment},
            cwd=root,
            capture_output=True,
            text=True,
            check=True,
        )
        return json.loads(done.stdout)

    @pytest.mark.slow
    def test_flies_compiled_to_the_bits_of_the_interpreted_one(self, root):
        code, bits, reached = self.run(root)
        assert (code, reached) == ("compiled", True)
        assert self.run(root, TORQUER_INTERPRETED="1") == ["interpreted", bits, reached]

    def test_says_what_it_was_built_from(self, root):
        manifest = json.loads((root / FOLDER / MANIFEST).read_text())
        assert manifest["modules"] == ["fsw.small"]
        assert list(manifest["sources"]) == ["fsw/outside.py", "fsw/small.py"]
        assert "-ffp-contract=off" in manifest["compiler"]
        assert "-ffast-math" not in manifest["compiler"]
        assert manifest["mypy"].startswith("2.")

    def test_is_not_built_again(self, root):
        said = []
        assert compile_group.build(said.append, root) == 1
        assert said == []

    def test_is_stale_once_a_constant_outside_has_changed(self, root):
        outside = root / "fsw" / "outside.py"
        before = outside.read_text()
        outside.write_text(before.replace("2.0", "4.0"))
        code, _, reached = self.run(root)
        outside.write_text(before)
        assert (code, reached) == ("interpreted", False)

    def test_is_built_again_after_an_edit(self, root):
        source = root / "fsw" / "small.py"
        source.write_text(SMALL.replace("a * b + c", "a * b - c"))
        _, interpreted, _ = self.run(root)
        said = []
        compile_group.build(said.append, root)
        assert said
        code, bits, _ = self.run(root)
        assert (code, bits) == ("compiled", interpreted)

    def test_what_mypyc_refuses_is_named(self, root, tmp_path):
        shutil.copytree(root, tmp_path / "copy")
        (tmp_path / "copy" / "fsw" / "small.py").write_text("class A(int):\n    pass\n")
        with pytest.raises(CompileError, match=r"mypyc refuses:\nfsw/small.py:1: error"):
            compile_group.build(lambda words: None, tmp_path / "copy")


def test_whether_it_runs_compiled_is_asked_by_ci(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["compile_group", "--check"])
    code = compile_group.main()
    assert capsys.readouterr().out.startswith("interpreted: " if code else "compiled: ")
    assert Path(FOLDER).parts == ("fsw", "_compiled")
