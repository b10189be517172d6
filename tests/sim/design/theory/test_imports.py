"""Gain design stands on the ground alone: numpy, scipy and itself."""

import ast
import sys
from pathlib import Path

import pytest

import sim.design.theory

MODULES = sorted(Path(sim.design.theory.__file__).parent.glob("*.py"))


def imported(source):
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import(names=names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(module=module, level=0):
                yield module


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_a_module_imports_numpy_scipy_and_its_neighbours(path):
    other = [
        name
        for name in imported(path.read_text())
        if name.partition(".")[0] not in {"numpy", "scipy", *sys.stdlib_module_names}
        and not name.startswith(("sim.design.theory", "sim.value_types"))
    ]
    assert other == []


def test_there_are_modules_to_look_at():
    assert len(MODULES) > 6
