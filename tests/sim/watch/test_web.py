"""The page of the live view: for this machine alone, and what comes over its websocket."""

import http.client
import json
import re
import socket
import threading

import pytest
import uvicorn
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from fsw.wire.messages import CoilStatus, FswBoot, Sync
from sim.errors import HarnessError
from sim.watch.flight_view import FlightView
from sim.watch.source import Batch
from sim.watch.web import WEBSOCKETS, LiveView, application, listening


class Flight:
    """A source whose name could break a page."""

    name = "</title><script>alert(1)</script>"
    waits_for = "waits for <b>somebody</b>"

    def batches(self):
        yield Batch([(FswBoot(0, 1, 5).encode(), 0.0), (Sync(0, 1427424417).encode(), 0.0)], 0.0)
        frames = [Sync(1, 1427424418).encode(), CoilStatus(-2, 2, 2000, -100, 100_000, 1).encode()]
        yield Batch([(frame, 1.0) for frame in frames], 1.0)


@pytest.fixture
def view():
    return LiveView(Flight(), FlightView())


@pytest.fixture
def port(view):
    """Of a server of the page, until the end of the test."""
    server = uvicorn.Server(uvicorn.Config(application(view), log_level="error", ws=WEBSOCKETS))
    with listening(0) as listener:
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        yield listener.getsockname()[1]
        server.should_exit = True
        thread.join(10.0)


def get(port, host=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10.0)
    connection.request("GET", "/", headers={"Host": host} if host else {})
    response = connection.getresponse()
    return response.status, response.read().decode()


def connected(port, origin):
    return connect(f"ws://127.0.0.1:{port}/live", origin=origin, open_timeout=10.0)


@pytest.mark.long
def test_the_page_loads_nothing_from_elsewhere_and_escapes_its_source(port):
    status, page = get(port)
    assert status == 200
    assert "<script>alert(1)" not in page
    assert "default-src &#39;none&#39;" in page
    assert "connect-src ws://127.0.0.1:* ws://localhost:*" in page
    assert not re.findall(r"<(?:script|link|img)[^>]*(?:src|href)=|@import|url\(", page)


@pytest.mark.long
@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example"])
def test_another_host_name_is_refused(port, host):
    assert get(port, host)[0] == 400


@pytest.mark.long
@pytest.mark.parametrize("origin", [None, "http://evil.example", "null"])
def test_the_websocket_is_for_its_own_page_alone(port, origin):
    with pytest.raises((InvalidStatus, ConnectionClosed)), connected(port, origin) as live:
        live.recv(5.0)


@pytest.mark.long
def test_a_page_gets_all_that_was_seen_and_then_what_is_new(view, port):
    view.read()
    with connected(port, f"http://127.0.0.1:{port}") as live:
        first, second = (json.loads(live.recv(5.0)) for _ in range(2))
    assert first["state"]["tick"] == 1
    assert first["state"]["level_2"] == -2
    assert first["lockout_ms"] == [None, None, 100_000]
    assert [words for *_, words in first["happenings"]] == [
        "fsw: started",
        "coil 2 driven at level -2, -100 mA",
    ]
    assert [sample[0] for sample in first["samples"]] == [1427424417]
    assert (second["happenings"], second["samples"]) == ([], [])


def test_what_ends_the_source_is_kept(view):
    class Broken(Flight):
        def batches(self):
            yield Batch([], 0.0)
            raise HarnessError("line 3 is not a candump line")

    view.source = Broken()
    view.read()
    assert str(view.failure) == "line 3 is not a candump line"


def test_a_port_that_is_taken_is_named():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        with (
            pytest.raises(HarnessError, match=f"--port {other.getsockname()[1]}"),
            listening(other.getsockname()[1]),
        ):
            pass


@pytest.mark.long
@pytest.mark.parametrize("width", [390, 1400])
@pytest.mark.slow
def test_a_browser_draws_attitude_series_and_events_as_they_come(look, view, port, width):
    page = look(f"http://127.0.0.1:{port}/", width)
    page.get_by_text("waits for <b>somebody</b>").wait_for()
    view.read()
    page.get_by_text("coil 2 driven at level -2, -100 mA").wait_for()
    assert page.locator("#happenings tr").count() == 2
    assert "level -2" in page.locator("#coils").inner_text()
    assert page.evaluate("document.querySelectorAll('#charts canvas').length") == 3
    for words in ("m: dipole that the coils are driven to, A m²", "T: its torque in the field, m × B, N m"):
        assert words in page.locator(".key").inner_text()
    pixels = "canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer"
    colours = page.locator("#attitude").evaluate(f"canvas => new Set(new Uint32Array({pixels})).size")
    assert colours > 4
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator(".badges .note").count() == 0, "nothing to be warned of"


@pytest.mark.long
def test_before_the_first_frame_it_says_what_it_waits_for_and_nothing_of_a_flight(look, view, port):
    page = look(f"http://127.0.0.1:{port}/")
    page.get_by_text("waits for <b>somebody</b>").wait_for()
    assert page.locator(".badges li").count() == 0
    assert not page.locator("section").first.is_visible(), "there is nothing to show yet"
    view._view.take(FswBoot(0, 1, 5).encode(), 0.0)
    page.get_by_text("1 frames, waits for SYNC").wait_for()


@pytest.mark.long
def test_the_axes_of_its_charts_have_names_and_units(look, view, port):
    page = look(f"http://127.0.0.1:{port}/")
    page.get_by_text("waits for").wait_for()
    charts = page.locator("#charts [role=img]").evaluate_all("all => all.map((one) => one.ariaLabel)")
    assert charts == [
        "Attitude: angle [deg] over time [UTC]",
        "Rate: rate [deg/s] over time [UTC]",
        "Measured against predicted: angle [deg] over time [UTC]",
    ]


@pytest.mark.long
def test_labels_of_arrows_that_point_the_same_way_stand_below_each_other(look, view, port):
    page = look(f"http://127.0.0.1:{port}/")
    heights = page.evaluate(
        "(() => { const placed = labelPlaces();"
        " return [placed(50, 20, 15), placed(55, 22, 15), placed(52, 21, 15), placed(150, 20, 15)]; })()"
    )
    assert heights[3] == heights[0] == 20, "what stands beside is no hindrance"
    assert min(heights[1] - heights[0], heights[2] - heights[1]) >= 12


@pytest.mark.long
def test_many_events_leave_the_messages_in_sight(look, view, port):
    page = look(f"http://127.0.0.1:{port}/")
    page.evaluate("document.getElementById('happenings').innerHTML = '<tr><td>x</td></tr>'.repeat(200)")
    assert page.evaluate("document.documentElement.scrollHeight") < 4000


@pytest.mark.long
def test_a_page_whose_server_is_gone_says_so(look, view):
    with listening(0) as listener:
        port = listener.getsockname()[1]
        server = uvicorn.Server(uvicorn.Config(application(view), log_level="error", ws=WEBSOCKETS))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        page = look(f"http://127.0.0.1:{port}/")
        page.get_by_text("waits for <b>somebody</b>").wait_for()
        server.force_exit = server.should_exit = True
        thread.join(10.0)
    page.get_by_text("not connected to torquer watch").wait_for()
    page.close()
