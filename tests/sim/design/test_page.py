"""The page of gains: pictures, figures and the verdict."""

import pytest

from sim.design.analysis import picture_maps
from sim.design.command import design_page

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def page(searched):
    scenario, analysis, _ = searched
    return design_page(analysis, scenario, picture_maps(analysis))


@pytest.mark.slow
def test_it_holds_the_pictures_and_all_figures(page):
    for words in ('id="chart-gains"', 'id="chart-robustness"', "multipliers of the first row", "✓ stable"):
        assert words in page
    assert len(page) < 1_000_000


@pytest.mark.parametrize("width", [390, 1400])
def test_it_is_shown_in_the_dark_without_standing_out_sideways(look, cut_off, tmp_path, page, width):
    (tmp_path / "design.html").write_text(page, encoding="utf-8")
    shown = look(tmp_path / "design.html", width=width, dark=True)
    assert shown.locator("#chart-gains svg").first.is_visible()
    assert cut_off(shown) == []
    assert shown.evaluate("document.documentElement.scrollWidth") <= width
