"""Settings of all tests, and the browser of those that look at pages.

Property tests take the same examples each time (profile ``ci``), so that a failure is there again on the next
run and on the next machine. With ``HYPOTHESIS_PROFILE=dev`` they look for new ones.
"""

import os
import signal
from collections import defaultdict
from pathlib import Path
from shutil import which
from zlib import crc32

import pytest
from compiled_guard import refuse_patches
from hypothesis import settings

from fsw.compiled import SWITCH, standing

os.environ["TORQUER_CACHE"] = ""
"""What a test flies, it flies."""

settings.register_profile("ci", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("dev", deadline=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # as of any command that a shell script runs with "&"; the processes that tests interrupt would inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)

EXAMPLES = Path(__file__).parents[1] / "examples"
"""Their tests, which a user copies with them, fly for many seconds and carry no mark of ours."""

MARKS = {
    "long": ("pytest.mark.long",),
    "paced": ("pytest.mark.paced",),
    "alone": ("pytest.mark.alone",),
    "interpreted": ("pytest.mark.interpreted", "interpreted_alone()"),
}
"""One of them stands in the very file that has such tests: see ``test_structure.py``."""

refuse_patches(standing().modules)


def pytest_addoption(parser):
    parser.addoption(
        "--sample",
        action="store_true",
        help="of the long tests none that is slow, and one case of each function",
    )


def pytest_report_header():
    return f"flight code {standing()}"


def pytest_configure(config):
    """Who does not say which tests to run gets those that are not long; who names a file gets all of it."""
    chosen = any(config.getoption(name, None) for name in ("markexpr", "keyword", "lf", "ff"))
    if config.args_source is pytest.Config.ArgsSource.TESTPATHS and not chosen:
        config.option.markexpr = "not long"


def pytest_ignore_collect(collection_path, config):
    """Who wants tests of some marks alone need not import files that have none."""
    wanted = [MARKS[word] for word in config.option.markexpr.split(" and ") if word in MARKS]
    if not wanted or not collection_path.name.startswith("test_"):
        return None
    if wanted == [MARKS["long"]] and collection_path.is_relative_to(EXAMPLES):
        return None
    text = collection_path.read_text(encoding="utf-8")
    return None if all(any(mark in text for mark in marks) for marks in wanted) else True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    for item in items:
        if "chromium" in getattr(item, "fixturenames", ()):
            item.add_marker("chromium")
        if item.path.is_relative_to(EXAMPLES):
            item.add_marker("long")
        if standing().modules and item.get_closest_marker("interpreted"):
            item.add_marker(pytest.mark.skip(f"make test runs it with {SWITCH}=1"))
    if config.getoption("sample"):
        left_out = set(outside_sample(items))
        config.hook.pytest_deselected(items=[item for item in items if item in left_out])
        items[:] = [item for item in items if item not in left_out]


def outside_sample(items):
    """Of the long tests those that are slow, and all cases of a function but one, always the same."""
    cases = defaultdict(list)
    for item in items:
        if item.get_closest_marker("long") and not item.get_closest_marker("whole"):
            cases[item.nodeid.partition("[")[0]].append(item)
    found = []
    for function, those in cases.items():
        chosen = those[crc32(function.encode()) % len(those)]
        found += [item for item in those if item is not chosen or item.get_closest_marker("slow")]
    return found


@pytest.fixture(scope="module")
def chromium():
    """A headless Chromium, driven by playwright."""
    path = which("chromium")
    if path is None:
        if os.environ.get("TORQUER_REQUIRE_CHROMIUM") == "1":
            pytest.fail("there is no chromium, but TORQUER_REQUIRE_CHROMIUM=1 requires it")
        pytest.skip("there is no chromium: make test-chromium runs this test where there is one")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=["--no-sandbox"])  # root has no sandbox
        yield browser
        browser.close()


CUT_OFF = """[...document.querySelectorAll(".scroll")]
    .filter((each) => each.clientWidth > 0 && each.scrollWidth > each.clientWidth + 1)
    .map((each) => `${each.closest("[id]").id} ${each.scrollWidth}`)"""
"""The parts of a page of which a screen shows one end only, until they are scrolled."""


@pytest.fixture(scope="session")
def cut_off():
    """Which parts of a page are cut off at the side of the screen."""
    return lambda page: page.evaluate(CUT_OFF)


@pytest.fixture
def look(chromium):
    """Opens a page by path or address: what the browser complains of, or asks for more, fails the test."""
    complaints, contexts = [], []

    def open_page(path, width=1400, dark=False, scripts=True):
        context = chromium.new_context(
            viewport={"width": width, "height": 900},
            color_scheme="dark" if dark else "light",
            java_script_enabled=scripts,
        )
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: complaints.append(request.url))
        address = path if isinstance(path, str) else path.as_uri()
        page.goto(address)
        assert complaints.pop(0) == address
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []
