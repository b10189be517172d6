"""A page that a command writes says what its template says, or the next run loses it."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TEMPLATES = sorted((ROOT / "tools").glob("*.md.j2"))


def prose(text):
    """The lines without figures: neither of a table nor with something that the template computes."""
    return [line for line in text.splitlines() if line and not ("{" in line or line.startswith("|"))]


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda path: path.name)
def test_the_page_has_the_prose_of_its_template(template):
    page = (ROOT / "docs" / template.name.removesuffix(".j2")).read_text(encoding="utf-8").splitlines()
    expected = prose(template.read_text(encoding="utf-8"))
    assert len(expected) > 3
    assert [line for line in expected if line not in page] == []


def test_sizing_has_no_line_beside_its_template():
    """A page without lists by figures: each of its lines is one of the template, or has a figure."""
    template = (ROOT / "tools" / "sizing.md.j2").read_text(encoding="utf-8")
    page = (ROOT / "docs" / "sizing.md").read_text(encoding="utf-8")
    computed = ("Measured by `make sizing`", "Up to a floor of", "10 orbits each with", "drawn at random:")
    kept = prose(template)
    assert [line for line in prose(page) if line not in kept and not line.startswith(computed)] == []
