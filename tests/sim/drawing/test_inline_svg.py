"""A figure as an SVG element for HTML: without metadata, its groups named, its numbers short."""

import re
from xml.etree import ElementTree

import pytest
from matplotlib.figure import Figure

from sim.drawing.canvas import style
from sim.drawing.inline_svg import chart, svg


def drawn(salt):
    with style():
        figure = Figure(figsize=(3.0, 2.0))
        panel = figure.subplots()
        (line,) = panel.plot([0.0, 1.0 / 3.0, 1.0], [0.123456, 2.0, -1.0], marker="o")
        line.set_gid("history-1")
        panel.set_title("Rate & angle")
        return svg(figure, salt)


def parsed(text):
    return ElementTree.fromstring(text.replace("xlink:href", "href"))


@pytest.fixture(scope="module")
def element():
    return parsed(drawn("one"))


def test_it_scales_with_the_page(element):
    assert element.tag == "svg"
    assert set(element.attrib) == {"viewBox"}


def test_nothing_of_it_is_metadata_or_style_of_its_own(element):
    assert {"metadata", "style"}.isdisjoint(part.tag for part in element.iter())


def test_the_name_of_an_artist_is_a_class_and_numbered_groups_have_none(element):
    groups = [part for part in element.iter("g")]
    assert all("id" not in group.attrib for group in groups)
    assert [group.get("class") for group in groups if group.get("class")] == ["history-1"]


def test_every_number_has_two_decimals_at_most(element):
    (line,) = [group.find("path") for group in element.iter("g") if group.get("class") == "history-1"]
    numbers = [word for word in line.get("d").split() if word not in "MLC"]
    assert numbers
    assert all(len(number.partition(".")[2]) <= 2 for number in numbers)


def test_text_stays_text(element):
    assert "Rate & angle" in [text.text for text in element.iter("text")]


@pytest.mark.long
def test_the_same_figure_twice_on_a_page_has_ids_of_its_own():
    ids = [{part.get("id") for part in parsed(drawn(salt)).iter()} - {None} for salt in ("one", "two", "one")]
    assert ids[0]
    assert ids[0].isdisjoint(ids[1])
    assert ids[0] == ids[2]


def test_several_figures_are_panels_and_a_wide_one_may_have_a_narrow_one():
    with style():
        figures = [Figure(figsize=(4.0, 2.0)) for _ in range(2)]
        for figure in figures:
            figure.subplots()
        several, alone = chart("x", figures, "words"), chart("x", figures[0], "words")
        both = chart("x", figures[0], "words", narrow=figures[1])
    assert several.svg.startswith('<div class="panels" style="--panel: 365px"><svg')
    assert several.svg.count("<svg") == 2
    assert alone.svg.startswith("<svg")
    assert both.svg.startswith('<div class="wide"><svg')
    assert '<div class="narrow"><svg' in both.svg
    ids = re.findall(r' id="([^"]+)"', several.svg + both.svg)
    assert len(set(ids)) == len(ids), "no id twice on a page"
