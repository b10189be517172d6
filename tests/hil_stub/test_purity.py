"""The boards are functions of ticks and frames: no I/O, no clock, no randomness, only the wire of fsw."""

import ast
from pathlib import Path

import pytest

import hil_stub

SOURCES = [
    path
    for path in sorted(Path(hil_stub.__file__).parent.rglob("*.py"))
    if path.name != "__main__.py" and path.parent.name != "process"
]
ALLOWED = {"collections", "dataclasses", "enum", "typing", "math", "fsw.wire", "hil_stub"}


def imported(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            yield node.module


def test_there_are_boards():
    assert {path.stem for path in SOURCES} >= {"interlock", "coil_driver", "magnetometer", "sun_sensor"}


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_a_board_imports_no_world(source):
    names = list(imported(ast.parse(source.read_text())))
    strangers = [n for n in names if not any(n == good or n.startswith(good + ".") for good in ALLOWED)]
    assert strangers == []


def test_the_interlock_has_no_floats():
    source = next(path for path in SOURCES if path.stem == "interlock").read_text()
    for node in ast.walk(ast.parse(source)):
        assert not isinstance(node, ast.Div), "true division"
        assert not (isinstance(node, ast.Constant) and isinstance(node.value, float))
        assert not (isinstance(node, ast.Name) and node.id == "float")
