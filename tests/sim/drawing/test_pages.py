"""HTML pages of templates: content is escaped, and what a template lacks is an error."""

from html.parser import HTMLParser

import pytest
from jinja2 import UndefinedError
from markupsafe import Markup

from sim.drawing.pages import page

SPECIAL = "<script>\"a\" & 'b'</script>"
FAULTS = {
    "badge": "good",
    "tally": "2 rows",
    "head": ("row",),
    "groups": [("bus", [(("loss",), "good", "pass")])],
}


def text_of(source):
    parser, texts = HTMLParser(), []
    parser.handle_data = texts.append
    parser.feed(source)
    return "".join(texts)


def faults(**changes):
    return page("sim.fault_table", "faults.html", **{**FAULTS, **changes})


def test_text_stays_text():
    source = faults(tally=SPECIAL, head=(SPECIAL,))
    assert source.count("<script") == faults().count("<script")
    assert text_of(source).count(SPECIAL) == 2


def test_markup_is_put_in_as_it_is():
    assert "<b>all</b>" in faults(tally=Markup("<b>all</b>"))


def test_every_page_bears_the_style_of_all():
    assert ".badges li {" in faults()


def test_content_that_is_missing_is_an_error():
    with pytest.raises(UndefinedError, match="'tally' is undefined"):
        page("sim.fault_table", "faults.html", **{name: FAULTS[name] for name in FAULTS if name != "tally"})
