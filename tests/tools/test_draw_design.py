"""tools/draw_design.py: the pictures of docs/design.md show the modes and rooms that there are."""

import importlib.util
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fsw.core.modes import TABLE
from fsw.wire.messages import Mode

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def draw():
    spec = importlib.util.spec_from_file_location("draw_design", ROOT / "tools" / "draw_design.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def texts(svg):
    return [element.text for element in ElementTree.fromstring(svg).iter() if element.tag.endswith("text")]


def arrows(svg):
    return [element for element in ElementTree.fromstring(svg).iter() if "marker-end" in element.attrib]


def test_the_mode_diagram_has_every_mode_and_transition_of_the_table(draw):
    shown = texts(draw.modes())
    assert {mode.name for mode in Mode} <= set(shown)
    conditions = [text.partition(" for ")[0].replace(" ", "_") for text in shown]
    for row in TABLE:
        assert conditions.count(row.condition.name.lower()) == sum(
            other.condition == row.condition for other in TABLE
        )
    assert len(arrows(draw.modes())) == len({(row.source, row.target) for row in TABLE})


@pytest.mark.long
@pytest.mark.parametrize("package", ["fsw", "hil_stub", "sim"])
def test_the_house_has_every_room_of_a_package(draw, package):
    rooms = {path.stem for path in (ROOT / package).iterdir() if path.name[0] not in "._"}
    rooms -= {path.stem for path in (ROOT / package).iterdir() if path.is_file() and path.suffix != ".py"}
    assert rooms <= set(texts(draw.packages()))


def test_an_import_that_a_longer_path_implies_is_left_out(draw):
    imports = {"a": {"b", "c"}, "b": {"c"}, "c": set()}
    assert list(draw.implied_left_out(imports)) == [("a", "b"), ("b", "c")]


@pytest.mark.long
def test_a_picture_that_does_not_fit_the_source_is_stale(draw, monkeypatch, capsys):
    monkeypatch.setattr(draw, "modes", lambda: "<svg/>\n")
    assert draw.main(["--check"]) == 1
    assert "docs/modes.svg" in capsys.readouterr().err
