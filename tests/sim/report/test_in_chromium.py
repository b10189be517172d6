"""The report as a browser shows it: every chart is drawn, zoomed, read, put out and printed."""

import re

import pytest

from sim.scenario.schema import load

pytestmark = pytest.mark.long

CHARTS = ("pointing", "modes", "rates", "estimate", "raster", "duty", "field_and_dipole", "torques")

COLOURS = """canvas => {
    const {width, height} = canvas;
    const pixels = new Uint32Array(canvas.getContext("2d").getImageData(0, 0, width, height).data.buffer);
    return new Set(pixels).size;
}"""
"""How many colours a canvas shows; an empty one has one."""


@pytest.fixture(scope="module")
def report(tmp_path_factory, made_run):
    """The report of a whole flight."""
    folder = tmp_path_factory.mktemp("run")
    events = [{"t_s": 91.0, "node": "FSW", "event": 1, "severity": 0, "argument": 2}]
    made_run(events=events).write(folder)
    return folder / "report.html"


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.slow
def test_nothing_is_cut_off_on_a_narrow_screen(look, cut_off, report, dark):
    page = look(report, width=390, dark=dark)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert cut_off(page) == []
    gaps, levels = (one.bounding_box() for one in page.locator("#chart-gaps_and_levels svg").all())
    assert levels["y"] >= gaps["y"] + gaps["height"]


def spans(page):
    """The part of the flight that each chart shows, in seconds, each once."""
    return page.evaluate(
        "[...new Set(charts.plots.map(({plot}) => [plot.scales.x.min, plot.scales.x.max]"
        ".map((x) => Math.round(x * flight.time.unit_s)).join(' ')))]"
    )


def over(page, chart):
    """Left, top, width and height of the area in which a chart is drawn."""
    area = page.locator(f"#chart-{chart} .u-over").first
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    return box["x"], box["y"], box["width"], box["height"]


def drag(page, chart, begin, end):
    left, top, width, height = over(page, chart)
    page.mouse.move(left + begin * width, top + height / 2)
    page.mouse.down()
    page.mouse.move(left + end * width, top + height / 2, steps=4)
    page.mouse.up()


def values(page, chart):
    return page.locator(f"#chart-{chart} .legend .value").all_inner_texts()


@pytest.mark.slow
def test_every_chart_is_drawn_and_takes_the_place_of_its_picture(look, report):
    page = look(report)
    for chart in CHARTS:
        figure = page.locator(f"#chart-{chart}")
        drawn = [canvas.evaluate(COLOURS) for canvas in figure.locator("canvas").all()]
        assert drawn
        assert min(drawn) > 5
        assert not figure.locator(".picture").is_visible()
    for view in ("attitude-view", "track-view"):
        assert page.locator(f"#{view}").evaluate(COLOURS) > 20
    for chart in ("zoom", "gaps_and_levels"):
        assert page.locator(f"#chart-{chart} svg").first.is_visible()


@pytest.mark.slow
def test_a_drag_zooms_all_charts_and_a_double_click_shows_all_again(look, report):
    page = look(report)
    (whole,) = spans(page)
    drag(page, "pointing", 0.25, 0.5)
    (part,) = spans(page)
    begin, end = map(int, part.split())
    assert (begin, end) == (pytest.approx(1750, abs=20), pytest.approx(3500, abs=20))
    left, top, width, height = over(page, "torques")
    page.mouse.dblclick(left + width / 2, top + height / 2)
    assert spans(page) == [whole] == ["0 7000"]


@pytest.mark.slow
def test_buttons_and_keys_zoom_and_move_too(look, report):
    page = look(report)
    page.get_by_role("button", name="Zoom in").click()
    (part,) = spans(page)
    begin, end = map(int, part.split())
    assert end - begin == 3500
    page.get_by_role("button", name="Later").click()
    assert spans(page) == [f"{begin + 875} {end + 875}"]
    page.locator("#chart-rates .canvas").first.focus()
    page.keyboard.press("+")
    (nearer,) = spans(page)
    begin, end = map(int, nearer.split())
    assert end - begin == 1750
    page.keyboard.press("0")
    assert spans(page) == ["0 7000"]


def test_the_cursor_tells_the_values_of_that_time_in_all_charts(look, report):
    page = look(report)
    left, top, width, height = over(page, "pointing")
    page.mouse.move(left + 0.5 * width, top + height / 2)
    assert page.evaluate("clock.state.t_s") == pytest.approx(3500, abs=15)
    shown = [float(value) for value in values(page, "pointing")]
    assert shown[1] == pytest.approx(40.0 * 2.718 ** (-3500 / 3000), rel=0.01)
    assert values(page, "modes") == ["–", "–", "–", "on"]
    assert values(page, "raster")[1].startswith("level ")
    assert re.match(r"3(49|50)\d s · 0\.58 orbits", page.locator("#time-bar output").inner_text())
    assert "from nominal" in page.locator("#attitude-words").inner_text()


@pytest.mark.slow
def test_a_series_is_put_out_and_on_by_mouse_and_keyboard(look, report):
    page = look(report)
    item = page.locator("#chart-pointing .legend button").first
    shown = "charts.plots.find(({panel}) => panel.title === 'Pointing error').plot.series[1].show"
    before = page.locator("#chart-pointing canvas").evaluate("canvas => canvas.toDataURL()")
    item.click()
    assert (item.get_attribute("aria-pressed"), page.evaluate(shown)) == ("false", False)
    page.wait_for_timeout(50)
    assert page.locator("#chart-pointing canvas").evaluate("canvas => canvas.toDataURL()") != before
    item.press("Enter")
    assert (item.get_attribute("aria-pressed"), page.evaluate(shown)) == ("true", True)


def test_a_click_on_an_event_shows_its_time(look, report):
    page = look(report)
    page.locator("#events tbody button").first.click()
    assert page.evaluate("clock.state.t_s") == 91.0
    assert values(page, "modes") == ["–", "–", "on", "–"]


@pytest.mark.slow
def test_the_flight_can_be_played(look, report):
    page = look(report)
    page.get_by_label("Pace", exact=True).select_option("1000")
    before = page.locator("#attitude-view").evaluate("canvas => canvas.toDataURL()")
    page.get_by_role("button", name="Play").click()
    page.wait_for_timeout(400)
    page.get_by_role("button", name="Pause").click()
    assert page.evaluate("clock.state.t_s") > 50.0
    assert page.locator("#attitude-view").evaluate("canvas => canvas.toDataURL()") != before


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.slow
def test_it_is_dark_where_the_system_is_until_it_is_switched(look, report, dark):
    page = look(report, dark=dark)

    def paper():
        return page.locator("header").evaluate("each => getComputedStyle(each).backgroundColor")

    light, night = "rgb(255, 255, 255)", "rgb(22, 28, 35)"
    assert paper() == (night if dark else light)
    canvas = page.locator("#chart-pointing canvas").evaluate("canvas => canvas.toDataURL()")
    page.locator("button.theme").click()
    assert paper() == (light if dark else night)
    page.wait_for_timeout(50)
    assert page.locator("#chart-pointing canvas").evaluate("canvas => canvas.toDataURL()") != canvas
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.documentElement).colorScheme") == "light"


@pytest.mark.parametrize("scripts", [True, False])
@pytest.mark.parametrize("width", [390, 1400])
def test_nothing_stands_out_sideways(look, report, width, scripts):
    page = look(report, width=width, scripts=scripts)
    widest = page.locator("header, section, footer, #time-bar, .canvas").evaluate_all(
        "all => Math.max(...all.map((each) => each.getBoundingClientRect().right))"
    )
    assert widest <= width
    assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.slow
def test_without_scripts_and_on_paper_the_pictures_are_shown(look, report):
    paper = look(report)
    paper.emulate_media(media="print")
    for page in (paper, look(report, scripts=False)):
        for chart in (*CHARTS, "track"):
            assert page.locator(f"#chart-{chart} svg").first.is_visible()
            assert not page.locator(f"#chart-{chart} .plot").is_visible()
        assert not page.locator("#time-bar").is_visible()


def test_no_name_of_a_scenario_is_run(look, tmp_path, made_run):
    name = "</script><script>window.broken = 1</script><img src=x onerror='window.broken = 2'>"
    scenario = load("microsat").model_copy(update={"name": name, "summary": name})
    event = {"t_s": 1.0, "node": name, "event": 1, "severity": 0, "argument": 0}
    made_run(ticks=20, pulses=(), scenario=scenario, events=[event]).write(tmp_path)
    page = look(tmp_path / "report.html")
    assert page.evaluate("window.broken") is None
    assert page.locator("h1").inner_text() == name


@pytest.mark.parametrize("ticks", [1, 2])
def test_a_very_short_flight_is_drawn(look, tmp_path, made_run, ticks):
    made_run(ticks=ticks, pulses=()).write(tmp_path)
    page = look(tmp_path / "report.html")
    page.get_by_role("button", name="Zoom in").click()
    page.get_by_role("button", name="Play").click()
    assert page.locator("#chart-pointing canvas").is_visible()
    assert page.locator("#attitude-view").evaluate(COLOURS) > 20


def test_a_pulse_shows_its_dipole_and_its_torque(look, report):
    page = look(report)
    page.evaluate("clock.set({ t_s: 101 })")
    words = page.locator("#attitude-words").inner_text()
    assert re.search(r"coil 0 at level -3 · dipole \S+ m?A m² · torque \S+ [µmn]?N m$", words)
    page.evaluate("clock.set({ t_s: 104 })")
    assert page.locator("#attitude-words").inner_text().endswith("coils off")
    page.evaluate("clock.set({ t_s: 104, playing: true, pace: 300 })")
    assert "dipole" in page.locator("#attitude-words").inner_text(), (
        "played fast, it stays in sight for a while"
    )
    page.evaluate("clock.set({ playing: false })")
    key = page.locator("#motion .key").inner_text()
    assert "m: dipole that the coils are driven to, A m²" in key
    assert "T: its torque in the field, m × B, N m" in key


def test_a_torque_is_the_cross_product_and_sizes_have_their_unit(look, report):
    page = look(report)
    assert page.evaluate("torqueOf([0, 0, 2], [1, 0, 0])") == [0, 2, 0]
    sizes = {8: "8 A m²", 0.2: "200 mA m²", 2.345e-4: "235 µA m²", 5e-9: "5 nA m²", 2e-11: "0.02 nA m²"}
    for size, text in sizes.items():
        assert page.evaluate(f"sizeIn({size}, 'A m²')") == text
