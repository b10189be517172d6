"""A digest of the code that judges flights, which is no part of the code that flies them."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from sim.campaign.code_digest import FLIGHT_CODE, PROJECT, code_digest
from sim.errors import HarnessError

JUDGES = ("sim/commissioning", "sim/design", "sim/validate")
"""Folders whose modules make claims, and figures from flights."""


@cache
def judging_digest(module: str) -> str:
    """A digest that is the same for the same programs, whatever their comments and docstrings.

    Args:
        module: the one that makes the studies, by its whole name; what it imports of JUDGES counts too.

    Raises:
        HarnessError: it is not one of JUDGES, so that its changes would go unnoticed.
    """
    files = judging_files(module)
    if not files:
        raise HarnessError(f"{module}: a module that judges is one of {', '.join(JUDGES)}")
    return code_digest(files)


def judging_files(module: str) -> tuple[str, ...]:
    """The files of a module and of all that it imports, without those that are flight code."""
    waiting, found = [module], set[Path]()
    while waiting:
        file = _file_of(waiting.pop())
        if file is not None and file not in found:
            found.add(file)
            waiting += _imported(file)
    return tuple(sorted(file.relative_to(PROJECT).as_posix() for file in found))


def _file_of(name: str) -> Path | None:
    """The file of a module; None where it is none of JUDGES, or flight code."""
    path = PROJECT.joinpath(*name.split("."))
    files = [file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()]
    judges = [file for file in files if _is_in(file, JUDGES) and not _is_in(file, FLIGHT_CODE)]
    return judges[0] if judges else None


def _is_in(file: Path, parts: tuple[str, ...]) -> bool:
    return any(file.is_relative_to(PROJECT / part) for part in parts)


def _imported(file: Path) -> Iterator[str]:
    """The names of what a file imports; those of functions and classes are names of no module."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
