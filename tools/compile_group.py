"""Compiles the flight code: the modules of ``GROUP``, by mypyc and the C compiler, to one library.

    python tools/compile_group.py [--check]

It is put into fsw/_compiled. What is up to date stays; of the C files only those that have changed are
compiled again. Without a C compiler, Python's headers or mypyc it says so, and all runs interpreted: exit
code 0, as nothing is lost but speed. With --check nothing is built: exit code 1 if the flight code does not
run compiled.
"""

import argparse
import ast
import io
import json
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any
from zlib import crc32

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from fsw.compiled import (
    ABI,
    FOLDER,
    LIBRARY,
    MANIFEST,
    STARTER,
    Build,
    BuildError,
    source_digest,
    standing,
)
from sim.record.whole_file import replace_file, replace_text, replacing

GROUP = (
    "fsw/core/**/*.py",
    "fsw/wire/*.py",
    "fsw/node.py",
    "hil_stub/**/*.py",
    "sim/audit/auditor.py",
    "sim/audit/driver_judge.py",
    "sim/audit/log_clock.py",
    "sim/audit/pulse_judge.py",
    "sim/audit/recorder_judge.py",
    "sim/audit/status_ticks.py",
    "sim/audit/unreported_time.py",
    "sim/audit/whole_entries.py",
    "sim/campaign/in_memory.py",
    "sim/plant/**/*.py",
    "sim/flight/flight_loop.py",
    "sim/flight/fsw_answers.py",
    "sim/flight/virtual_bus.py",
    "sim/record/bus_log.py",
    "sim/record/estimates.py",
    "sim/record/inbox_order.py",
    "sim/record/log_index.py",
)
"""What is compiled, as one group: calls within it are direct, a call into it or out of it costs."""
INTERPRETED = ("hil_stub/__main__.py", "hil_stub/process/*.py", "sim/plant/__main__.py")
"""Within those, what stays interpreted: command lines, whose functions click decorates."""
OPTIMISATION = ("-O2", "-g0", "-fno-fast-math", "-ffp-contract=off", "-fvisibility=hidden")
"""No contraction: a product and a sum are rounded each by itself, as Python does it."""
UNWARNED = ("-w",)
"""Generated code: its warnings are of no use here."""
PATIENCE_S = 2.0
"""A build that takes longer says what it does."""
SCRATCH = "build/compiled"
SETTINGS = """[mypy]
mypy_path = {root}
ignore_missing_imports = True
follow_imports = silent
"""
"""Of mypy: errors are those of the group alone, and of what it needs to know; ``make lint`` is strict."""
STARTER_C = """
#include <Python.h>

static PyObject *start(PyObject *self, PyObject *capsule)
{
    PyObject *(*init)(void) = (PyObject *(*)(void))PyCapsule_GetPointer(capsule, PyCapsule_GetName(capsule));
    return init == NULL ? NULL : init();
}

static PyMethodDef methods[] = {{"start", start, METH_O, NULL}, {NULL, NULL, 0, NULL}};
static PyModuleDef module = {PyModuleDef_HEAD_INIT, "STARTER", NULL, -1, methods, NULL, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit_STARTER(void) { return PyModule_Create(&module); }
"""


class CompileError(Exception):
    """The group cannot be compiled; the message says why."""


def group_sources(root: Path = ROOT) -> list[str]:
    """The sources of the group; packages' ``__init__`` stay interpreted."""
    found = {path for pattern in GROUP for path in root.glob(pattern) if path.name != "__init__.py"}
    left_out = {path for pattern in INTERPRETED for path in root.glob(pattern)}
    return sorted(path.relative_to(root).as_posix() for path in found - left_out)


def closure(sources: Sequence[str], root: Path = ROOT) -> list[str]:
    """These and all modules of ours that they import, whose constants may be compiled into them."""
    found, ahead = set(sources), list(sources)
    while ahead:
        imported = {path for path in _imported(root / ahead.pop(), root) if path not in found}
        found |= imported
        ahead += imported
    return sorted(found)


def _imported(path: Path, root: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_bytes())):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module is not None and not node.level:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        for name in names:
            relative = f"{name.replace('.', '/')}.py"
            if (root / relative).is_file():
                yield relative


def compiler_words() -> list[str]:
    """The C compiler as it compiles for this Python.

    Raises:
        CompileError: it, or Python's header, is not there.
    """
    folders = [sysconfig.get_path("include"), sysconfig.get_path("platinclude")]
    if not any(Path(folder, "Python.h").is_file() for folder in folders):
        raise CompileError(f"Python's header {folders[0]}/Python.h is not there")
    values = [sysconfig.get_config_var(name) for name in ("CC", "CFLAGS", "CCSHARED")]
    if sys.platform == "win32" or not values[0]:
        raise CompileError("on this system it is not known how")
    words = [word for value in values for word in shlex.split(value or "")]
    if shutil.which(words[0]) is None:
        raise CompileError(f"there is no C compiler {words[0]}")
    return [*words, *OPTIMISATION, *UNWARNED, *(f"-I{folder}" for folder in dict.fromkeys(folders))]


def mypy_version() -> str:
    """The version of the mypy that compiles; empty where there is none."""
    try:
        return version("mypy")
    except PackageNotFoundError:
        return ""


def is_current(sources: Sequence[str], words: Sequence[str], root: Path = ROOT) -> bool:
    """Whether the build that is there is of these sources, by this compiler and mypy."""
    try:
        build = Build(root)
        build.check()
    except BuildError:
        return False
    manifest = build.manifest
    same = (manifest["compiler"], manifest["mypy"]) == (list(words), mypy_version())
    return same and list(manifest["modules"]) == [_module(source) for source in sources]


def _module(source: str) -> str:
    return source.removesuffix(".py").replace("/", ".")


def build(say: Callable[[str], None], root: Path = ROOT) -> int:
    """Build the group unless the build is current; the number of its modules.

    Raises:
        CompileError: it cannot be compiled.
    """
    sources, words = group_sources(root), compiler_words()
    if is_current(sources, words, root):
        return len(sources)
    digests = {path: source_digest(root / path) for path in closure(sources, root)}
    scratch = root / SCRATCH
    scratch.mkdir(parents=True, exist_ok=True)
    say(f"{len(sources)} modules into C")
    files, folders = generate(sources, scratch, root)
    starter = scratch / f"{STARTER}.c"
    starter.write_text(STARTER_C.replace("STARTER", STARTER))
    words += [f"-I{folder}" for folder in folders]
    objects = compile_all([*files, starter], words, scratch, say)
    say("linked")
    library = f"{LIBRARY}{ABI}"
    _link(objects, scratch / library)
    _put(root, scratch / library, {
        "abi": ABI,
        "mypy": mypy_version(),
        "compiler": compiler_words(),
        "library": library,
        "library_crc": crc32((scratch / library).read_bytes()),
        "modules": [_module(source) for source in sources],
        "sources": digests,
    })  # fmt: skip
    return len(sources)


def generate(sources: Sequence[str], scratch: Path, root: Path) -> tuple[list[Path], list[str]]:
    """The C files of the group, and the folders of their headers.

    Raises:
        CompileError: mypyc is not there, or refuses a module.
    """
    try:
        from mypyc.build import mypycify  # noqa: PLC0415  (not needed where nothing is compiled)
    except ImportError as error:
        raise CompileError(f"mypyc is not there ({error})") from None
    settings = scratch / "mypy.ini"
    settings.write_text(SETTINGS.format(root=root))
    said, before = io.StringIO(), Path.cwd()
    os.chdir(root)  # the paths in tracebacks begin at the root
    try:
        with redirect_stdout(said):
            library = mypycify(
                ["--config-file", str(settings), *sources],
                target_dir=str(scratch),
                multi_file=True,
                group_name=LIBRARY.removesuffix("__mypyc"),
            )[0]
    except SystemExit:
        raise CompileError(f"mypyc refuses:\n{said.getvalue().strip()}") from None
    finally:
        os.chdir(before)
    return [Path(path) for path in library.sources], list(library.include_dirs)


def compile_all(
    files: Sequence[Path], words: Sequence[str], scratch: Path, say: Callable[[str], None]
) -> list[Path]:
    """The object files, compiled on all processors; what was compiled before from the same text is kept.

    Raises:
        CompileError: the compiler refuses one.
    """
    folder = scratch / "objects"
    folder.mkdir(exist_ok=True)
    common = sha256("\0".join([ABI, mypy_version(), *words]).encode())
    for header in sorted(scratch.glob("*.h")):
        common.update(header.read_bytes())
    objects = {}
    for file in files:
        digest = common.copy()
        digest.update(file.name.encode() + file.read_bytes())
        objects[file] = folder / f"{file.stem}.{digest.hexdigest()[:16]}.o"
    for path in {*folder.iterdir()} - {*objects.values()}:
        path.unlink()
    missing = sorted((file for file, to in objects.items() if not to.exists()), key=_size, reverse=True)
    once = _read_headers_once(words, scratch) if missing else []

    def compile_one(file: Path) -> None:
        with replacing(objects[file]) as part:
            _run([*words, *once, "-c", str(file), "-o", str(part)])

    with ThreadPoolExecutor(_processors()) as pool:
        try:
            for number, _ in enumerate(pool.map(compile_one, missing), 1):
                say(f"{number} of {len(missing)} C files compiled")
        finally:
            pool.shutdown(cancel_futures=True)
    return list(objects.values())


def _read_headers_once(words: Sequence[str], scratch: Path) -> list[str]:
    """Compile the headers of the group, which all files include; the option that uses that."""
    headers = scratch / "headers"
    headers.write_text("".join(f'#include "{path}"\n' for path in sorted(scratch.glob("__native_*.h"))))
    _run([*words, "-x", "c-header", str(headers), "-o", f"{headers}.gch"])
    return ["-include", str(headers)]


def _size(path: Path) -> int:
    return path.stat().st_size


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _link(objects: Sequence[Path], library: Path) -> None:
    words = shlex.split(sysconfig.get_config_var("LDSHARED") or "cc -shared")
    _run([*words, *map(str, objects), "-o", str(library)])


def _run(words: Sequence[str]) -> None:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise CompileError(f"{words[0]} ended with exit code {done.returncode}:\n{done.stderr.strip()}")


def _put(root: Path, library: Path, manifest: dict[str, Any]) -> None:
    """Put library and manifest where they are used; whoever looks meanwhile finds no build."""
    folder = root / FOLDER
    folder.mkdir(exist_ok=True)
    (folder / MANIFEST).unlink(missing_ok=True)
    for path in folder.iterdir():
        path.unlink()
    replace_file(folder / library.name, library.read_bytes())
    replace_text(folder / MANIFEST, json.dumps(manifest, indent=1) + "\n")


class Progress:
    """Says what is done, once the build takes longer than ``PATIENCE_S``: on a terminal, in one line."""

    def __init__(self) -> None:
        self._began_s = time.monotonic()
        self._is_shown = False

    def __call__(self, words: str) -> None:
        """Take what is done now."""
        if sys.stderr.isatty():
            print(f"\r\033[KCompiling the flight code: {words}", end="", file=sys.stderr, flush=True)
        elif not self._is_shown and time.monotonic() - self._began_s > PATIENCE_S:
            print("Compiling the flight code (some minutes the first time)", file=sys.stderr, flush=True)
        else:
            return
        self._is_shown = True

    def end(self, words: str) -> None:
        """The last words."""
        print(f"\r\033[K{words}" if self._is_shown and sys.stderr.isatty() else words, file=sys.stderr)

    @property
    def elapsed_s(self) -> float:
        """Since the beginning."""
        return time.monotonic() - self._began_s


def main() -> int:
    """Build, or check."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="build nothing: does it run compiled?")
    if parser.parse_args().check:
        print(standing())
        return int(bool(standing().reason))
    progress = Progress()
    try:
        modules = build(progress)
    except CompileError as error:
        progress.end(f"The flight code is not compiled, and runs interpreted: {error}")
        return 0
    if progress.elapsed_s > PATIENCE_S:
        progress.end(f"Compiled {modules} modules of the flight code in {progress.elapsed_s:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
