"""The list of requirements: complete, cited by tests, and equal to the document."""

import ast
import re
from pathlib import Path

import pytest

from fsw.core.fdir.faults import CoilFault, SensorFault
from fsw.core.monitors import Monitor
from fsw.core.telemetry import Event
from sim.fault_table.requirements import REQUIREMENTS, document

ROOT = Path(__file__).resolve().parents[3]
NAMED = [
    (Event.MONITOR_TRIPPED, Monitor),
    (Event.SENSOR_ISOLATED, SensorFault),
    (Event.COIL_FAULT, CoilFault),
]
IDS = [requirement.id for requirement in REQUIREMENTS]


def citations(text):
    """The ids in the ``requirement`` marks of a test module's functions and classes."""
    for node in ast.walk(ast.parse(text)):
        for mark in getattr(node, "decorator_list", ()):
            if isinstance(mark, ast.Call) and ast.unparse(mark.func) == "pytest.mark.requirement":
                yield from (argument.value for argument in mark.args)


@pytest.fixture(scope="module")
def cited():
    modules = (ROOT / "tests").rglob("test_*.py")
    return {name for module in modules for name in citations(module.read_text(encoding="utf-8"))}


@pytest.mark.long
@pytest.mark.slow
def test_every_requirement_is_cited_by_a_test(cited):
    assert set(IDS) - cited == set()


@pytest.mark.long
def test_no_test_cites_what_is_no_requirement(cited):
    assert cited - set(IDS) == set()


def test_only_marks_count_as_citations():
    text = (
        "# REQ-TRIP-01\n"
        "@pytest.mark.requirement('REQ-A', 'REQ-B')\n"
        "@other.requirement('REQ-X')\n"
        "def test_a():\n    'REQ-TRIP-02'\n"
    )
    assert list(citations(text)) == ["REQ-A", "REQ-B"]


def test_ids_are_unique_and_of_one_form():
    assert len(set(IDS)) == len(IDS)
    assert all(re.fullmatch(r"REQ-[A-Z]+-\d\d", name) for name in IDS)


@pytest.mark.parametrize(("event", "kinds"), NAMED, ids=[event.name for event, _ in NAMED])
def test_each_argument_of_an_event_has_one_requirement(event, kinds):
    watched = [r.watch for r in REQUIREMENTS if r.event is event and r.watch is not None]
    assert sorted(watched) == sorted(kinds)


def test_the_document_is_up_to_date():
    assert (ROOT / "docs" / "requirements.md").read_text(encoding="utf-8") == document()


def test_the_document_tells_each_requirement_once_and_whole():
    lines = [line for line in document().splitlines() if line.startswith("| REQ-")]
    assert len(lines) == len(REQUIREMENTS)
    for line, requirement in zip(lines, REQUIREMENTS, strict=True):
        cells = [cell.strip() for cell in line.removeprefix("|").removesuffix("|").split("|")]
        assert cells[:3] == [requirement.id, requirement.text, requirement.limit]
        assert cells[4] == (f"`{requirement.event.name}`" if requirement.event else "")
        assert all(cells[:3])
