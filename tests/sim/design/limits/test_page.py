"""Page and picture, from invented figures."""

from math import inf
from xml.etree import ElementTree

import pytest

from sim.design.limits.page import Agreement, draw, page
from sim.design.limits.sweep import BOUND, QUANTITIES, Line, all_orders, orders_of

FLOWN = {order.key: 0.4 if order.law == BOUND else 0.5 for order in all_orders()}
LOST = [order.key for order in orders_of(QUANTITIES[0].settings[-1], Line("mpc"))]
AGREEMENTS = [Agreement("`mpc`, no torque", 0.25, (0.24, 0.26))]


def test_the_page_has_each_quantity_and_what_pulses_add():
    text = page(FLOWN | dict.fromkeys(LOST, inf), AGREEMENTS, "here")
    assert "| 160 | 0.4 | > 20 | 0.5 | 0.4 | 0.5 | 0.5 |" in text
    assert "| 0 | 0.4 | 0.5 | 0.5 | 0.4 | 0.5 | 0.5 |" in text
    assert "add 0.3 deg by `mpc`" in text
    assert "| `mpc`, no torque | 0.250 | 0.240, 0.260 |" in text
    assert f"{len(FLOWN)} of {len(FLOWN)} flights and bounds" in text
    for quantity in QUANTITIES:
        assert f"### {quantity.title}" in text


def test_no_line_of_prose_is_longer_than_it_should_be():
    prose = [line for line in page(FLOWN, AGREEMENTS, "here").splitlines() if not line.startswith("|")]
    assert max(map(len, prose)) <= 135


@pytest.mark.long
def test_the_picture_names_its_axes_with_units(tmp_path):
    path = tmp_path / "picture.svg"
    draw(FLOWN | dict.fromkeys(LOST, inf), path)
    drawn = "\n".join(ElementTree.parse(path).getroot().itertext())
    for text in ("pointing error, RMS [deg]", "no torque", *(one.label for one in QUANTITIES)):
        assert text in drawn
