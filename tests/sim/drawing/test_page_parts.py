"""A page of a header and sections: what is empty is left out, what is text stays text."""

import pytest
from markupsafe import Markup

from sim.drawing.page_parts import Chart, PageHeader, PageSection, Table, TableCell, Tile, sections_page

HEADER = PageHeader(
    "Kind of page", "a <name>", ("one", "two"), [("good", "✓ kept")], [Tile("tile", "5", "note")]
)


def test_the_header_says_what_it_is_about():
    page = sections_page(HEADER, [])
    assert "<title>a &lt;name&gt;: kind of page</title>" in page
    for words in (
        "Kind of page",
        "one · two",
        '<li class="good">✓ kept</li>',
        "<dd>5<small>note</small></dd>",
    ):
        assert words in page


def test_a_section_has_its_tables_charts_and_text():
    picture = Chart("x", Markup("<svg></svg>"), "words")
    section = PageSection(
        "here", "Title", "note", (Table(("head",), [("cell",)]),), (picture,), "text < text"
    )
    page = sections_page(HEADER, [section])
    for words in (
        '<section id="here">',
        "<p>note</p>",
        '<td class="short">cell</td>',
        "<svg></svg>",
        "text &lt; text",
    ):
        assert words in page
    assert "data-chart" not in page.partition("<main>")[2]


def test_a_table_breaks_its_heads_behind_underscores_and_no_short_cell():
    table = Table(("a_long_<name>",), [("3.006e-08",), ("x" * 22,), ("a sentence that is rather long",)])
    page = sections_page(HEADER, [PageSection("here", "Title", "", (table,))])
    for words in (
        "<th>a_<wbr>long_<wbr>&lt;name&gt;</th>",
        '<td class="short">3.006e-08</td>',
        f"<td>{'x' * 22}</td>",
        '<td class="long">a sentence',
    ):
        assert words in page


def test_a_cell_may_have_a_style_and_a_link_whose_address_stays_whole():
    cell = TableCell("<b>", "bad", "a_b/c.html")
    page = sections_page(HEADER, [PageSection("here", "Title", "", (Table((cell,), [(cell, "plain")]),))])
    assert '<th><a href="a_b/c.html">&lt;b&gt;</a></th>' in page
    assert '<td class="bad"><a href="a_b/c.html">&lt;b&gt;</a></td>' in page
    assert '<td class="short">plain</td>' in page


def test_a_table_of_many_columns_and_few_rows_may_be_cards_with_the_heads_in_its_cells():
    head = ("first", "second", "a <b>", "fourth", "fifth")
    page = sections_page(
        HEADER, [PageSection("here", "Title", "", (Table(head, [("1", "2", "3", "4", "5")]),))]
    )
    assert '<table class="cards">' in page
    assert '<td class="short">1</td><td class="short" data-head="second">2</td>' in page
    assert 'data-head="a &lt;b&gt;"' in page
    sentence = "a sentence that is rather long"
    for rows in ([("1", "2", "3", "4", sentence)], [("1", "2", "3", "4", "5")] * 13, []):
        page = sections_page(HEADER, [PageSection("here", "Title", "", (Table(head, rows),))])
        assert "data-head" not in page.partition("<main>")[2]


def test_what_is_empty_is_left_out():
    page = sections_page(PageHeader("Kind", "name"), [PageSection("here", "Title")])
    body = page.partition("<main>")[2]
    for words in ("<p></p>", "<pre", "<table", "tiles", "time-bar", "application/json"):
        assert words not in body


def test_a_number_that_json_has_not_is_no_page():
    chart = Chart("x", Markup(""), "words", {"panels": [{"y": float("nan")}]})
    with pytest.raises(ValueError, match="JSON"):
        sections_page(HEADER, [PageSection("here", "Title", charts=(chart,))], time={"end_s": 1.0})
