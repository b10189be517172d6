"""A digest that distinguishes the code of one flight from that of another: all that is loaded for it.

That is the module which flies, what it imports, whatever these import in turn, data files beside them, the
versions of Python and of the libraries that compute, and whether the filter's kernel is built. Nothing of the
project is listed by hand.
"""

import ast
import hashlib
import io
import platform
import tokenize
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import sim
from fsw.compiled import KERNEL

PROJECT = Path(sim.__file__).resolve().parents[1]
PACKAGES = ("fsw", "hil_stub", "sim", "torquer")
FLIGHT = "sim.campaign.flight"
"""What flies a scenario in memory, audits it and computes its figures."""
DATA = (".toml", ".dbc", ".json", ".c")
LIBRARIES = ("filterpy", "numpy", "scipy", "sgp4")


@cache
def code_digest(module: str = FLIGHT, project: Path = PROJECT) -> str:
    """A digest that is the same for the same programs and data, whatever their comments and docstrings.

    Args:
        module: the one that is run.
        project: the folder of the packages.
    """
    digest = hashlib.sha256(platform.python_version().encode())
    for library in LIBRARIES:
        digest.update(version(library).encode())
    digest.update(b"kernel" if find_spec(KERNEL) else b"filterpy")
    for file in loaded_files(module, project):
        digest.update(file.relative_to(project).as_posix().encode() + _content(file))
    return digest.hexdigest()[:16]


def loaded_files(module: str, project: Path = PROJECT) -> tuple[Path, ...]:
    """The files of a module and of all that it imports, at once or later, and the data beside them."""
    waiting, found = [module], set[Path]()
    while waiting:
        name = waiting.pop()
        parts = name.split(".")
        files = [_file_of(parts[:count], project) for count in range(1, len(parts) + 1)]
        for file in files if parts[0] in PACKAGES else []:
            if file is not None and file not in found:
                found.add(file)
                waiting += _imported(file)
    folders = {file.parent for file in found} - {project / package for package in PACKAGES}
    return tuple(sorted(found | {data for folder in folders for data in _data(folder)}))


def _file_of(parts: list[str], project: Path) -> Path | None:
    path = project.joinpath(*parts)
    files = (path.with_suffix(".py"), path / "__init__.py")
    return next((file for file in files if file.is_file()), None)


def _data(folder: Path) -> Iterator[Path]:
    """Data in a folder, and in folders below it that hold nothing else."""
    for path in folder.iterdir():
        if path.suffix in DATA and not path.name.startswith("."):  # an editor's own
            yield path
        elif path.is_dir() and {file.name for file in path.glob("*.py")} <= {"__init__.py"}:
            yield from _data(path)


@cache
def _imported(file: Path) -> tuple[str, ...]:
    """The names of what a file imports; those of functions and classes are names of no module."""
    found: list[str] = []
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = node.module or ""
            found += [module, *(f"{module}.{alias.name}" for alias in node.names)]
    return tuple(found)


@cache
def _content(file: Path) -> bytes:
    return file.read_bytes() if file.suffix in DATA else program(file.read_text(encoding="utf-8"))


def program(source: str) -> bytes:
    """The lines of a module without comments and without statements that are only a string."""
    lines: list[str | None] = list(source.splitlines())
    for node in ast.walk(ast.parse(source)):
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            end = node.end_lineno or node.lineno
            lines[node.lineno - 1 : end] = [None] * (end + 1 - node.lineno)
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        row, column = token.start
        line = lines[row - 1] if token.type == tokenize.COMMENT else None
        if line is not None:
            lines[row - 1] = line[:column].rstrip() or None
    return "\n".join(line for line in lines if line is not None).encode()
