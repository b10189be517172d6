"""The page shows every result, whatever there is of it, escaped."""

from dataclasses import replace
from html.parser import HTMLParser

import pytest

from sim.campaign.report.analysis import analyse
from sim.campaign.report.page import drawn_tables, write_page
from sim.campaign.results.store import open_results


class Tags(HTMLParser):
    """Counts the elements of a page."""

    def __init__(self, page):
        super().__init__()
        self.seen = []
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        self.seen.append((tag, dict(attributes).get("id")))


@pytest.fixture(scope="module")
def page(campaign_of_40, analysis, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "campaign.html"
    write_page(path, campaign_of_40, analysis, "1.2.3")
    return path.read_text()


@pytest.mark.long
@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.slow
def test_it_is_shown_in_the_dark_without_standing_out_sideways(look, cut_off, tmp_path, page, width):
    (tmp_path / "campaign.html").write_text(page)
    shown = look(tmp_path / "campaign.html", width=width, dark=True)
    assert shown.evaluate("document.documentElement.scrollWidth") <= width
    assert cut_off(shown) == []
    assert (
        shown.evaluate("getComputedStyle(document.querySelector('header')).backgroundColor")
        == "rgb(22, 28, 35)"
    )
    assert shown.locator("svg").first.is_visible()


@pytest.mark.long
def test_pictures_beside_each_other_stand_below_each_other_on_a_narrow_screen(look, tmp_path, page):
    (tmp_path / "campaign.html").write_text(page)
    for width, rows in ((390, 1), (1400, 2)):
        shown = look(tmp_path / "campaign.html", width=width)
        boxes = [one.bounding_box() for one in shown.locator("#chart-indices svg").all()]
        assert len(boxes) == 2
        assert len({round(box["x"]) for box in boxes}) == rows
        assert all(box["x"] >= 0 and box["x"] + box["width"] <= width for box in boxes)


@pytest.mark.long
def test_a_wide_picture_has_a_narrow_one(look, tmp_path, page):
    (tmp_path / "campaign.html").write_text(page)
    for width, seen in ((390, [False, True]), (1400, [True, False])):
        shown = look(tmp_path / "campaign.html", width=width)
        assert [one.is_visible() for one in shown.locator("#chart-worst-runs svg").all()] == seen


@pytest.mark.long
def test_it_has_all_sections_and_pictures(page):
    seen = Tags(page).seen
    sections = [name for tag, name in seen if tag == "section"]
    assert sections == [
        "requirements", "scenario", "failures", "figures", "indices", "worst", "sensitivity", "drawn",
        "convergence",
    ]  # fmt: skip
    charts = [name for tag, name in seen if tag == "figure"]
    assert charts == [
        f"chart-{name}"
        for name in ("distributions", "cumulative", "indices", "worst-runs", "scatter", "convergence")
    ]
    assert sum(tag == "svg" for tag, _ in seen) == 2 * 2 + 2 + 6 + 2 * 2, "a panel each, and two narrow ones"


@pytest.mark.long
def test_it_says_what_was_flown_and_escapes_it(page):
    for words in ("40 of 40 runs of 0.02 orbits", "seed 11", "torquer 1.2.3", "25 of 40 succeed", "2 failed"):
        assert words in page
    assert "run 7: &lt;too&gt; fast" in page
    assert "<too>" not in page


@pytest.mark.long
def test_a_campaign_too_short_to_be_judged_says_so_beside_its_verdict(small, done_row, tmp_path):
    campaign = replace(small, requirements=())
    with open_results(tmp_path, campaign) as results:
        results.add(done_row(3))
        found = analyse(campaign, results)
    write_page(tmp_path / "page.html", campaign, found, "1.2.3")
    page = (tmp_path / "page.html").read_text()
    assert "succeed" not in page
    assert "1 of 1 keep the limits of the coils" in page
    assert "2 of 3 requirements of the scenario not judged" in page


@pytest.mark.long
def test_it_is_the_same_each_time(page, campaign_of_40, analysis, tmp_path):
    write_page(tmp_path / "again.html", campaign_of_40, analysis, "1.2.3")
    assert (tmp_path / "again.html").read_text() == page


@pytest.mark.long
@pytest.mark.parametrize(("done", "failed"), [((3,), ()), ((), (3,))])
def test_few_runs_are_no_error(small, done_row, failed_row, tmp_path, done, failed):
    with open_results(tmp_path, small) as results:
        for run in done:
            results.add(done_row(run))
        for run in failed:
            results.add(failed_row(run))
        found = analyse(small, results)
    write_page(tmp_path / "page.html", small, found, "1.2.3")
    seen = Tags((tmp_path / "page.html").read_text()).seen
    assert (("section", "figures") in seen) == bool(done)
    assert (("section", "failures") in seen) == bool(failed)


@pytest.mark.long
def test_runs_that_have_not_settled_have_their_reasons(campaign_of_40, unsettled, tmp_path):
    write_page(tmp_path / "page.html", campaign_of_40, unsettled, "1.2.3")
    shown = (tmp_path / "page.html").read_text()
    assert "6 of 12 runs have not settled to the end of their flight" in shown
    assert "5 of 12, as run 7" in shown
    assert "estimate, mismatch &lt;of&gt; 7" in shown


# --- What is drawn is listed by the section of the scenario, each number with its distribution


def test_each_section_has_its_list(campaign_of_40, analysis):
    tables = {table.caption: table for table in drawn_tables(campaign_of_40, analysis)}
    assert list(tables) == sorted(tables)
    assert {"body", "coils", "disturbance", "initial", "magnetometer", "onboard table estimator", "sun"} == {
        *tables
    }
    assert [row[:2] for row in tables["body"].rows] == [
        (f"body inertia, component {number} [kg m²]", "normal, times the scenario's") for number in (1, 2, 3)
    ]
    assert len(tables["disturbance"].rows) == 4, "three components and the length"
    assert tables["sun"].rows[0][1] == "correlated"


def test_a_text_has_its_choice_and_no_numbers(campaign_of_40, analysis):
    (row,) = next(one for one in drawn_tables(campaign_of_40, analysis) if one.caption == "coils").rows
    assert row == ("coils backoff", "choice of 2", "–", "–", "–")


def test_numbers_are_those_of_the_runs_that_were_flown(campaign_of_40, analysis):
    (row,) = next(one for one in drawn_tables(campaign_of_40, analysis) if one.caption == "initial").rows
    assert row == ("initial angle [deg]", "uniform", "0", "19.5", "39")


def test_nothing_drawn_is_no_list(campaign_of_40, analysis):
    assert drawn_tables(campaign_of_40, replace(analysis, input_words={})) == []
