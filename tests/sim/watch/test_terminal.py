"""What stands on the terminal: every panel, at every stage of a flight, in any room."""

from io import StringIO

import pytest
from rich.console import Console

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilStatus, FswBoot, MagField, Mode, NavAttitude, NavQuality, NavRate, Sync
from sim.watch.flight_view import MOST_UNKNOWN, FlightView
from sim.watch.happening import Occurrence, Weight
from sim.watch.terminal import screen, short_line, show


def text(seen, width=120, height=40):
    console = Console(width=width, height=height, record=True, file=StringIO())
    console.print(screen(seen, "loop:28011", width, height), height=height)
    return console.export_text()


@pytest.fixture
def flying():
    seen = FlightView()
    quality = NavQuality(Mode.POINT, 0.005, 1e-5, 1, 0, 1, 0, 1, 0, 0)
    flight = (
        Sync(7, 1427424417),
        NavAttitude(1, 0.1, 0.0, 0.0),
        NavRate(1, 0.001, 0.0, 0.0),
        quality,
        MagField(1, 20000.0, 0.0, 30000.0),
        CoilStatus(-3, 1, 2000, -400, 100_000, 1),
        CoilStatus(0, 0, 0, 0, 40_000, 1),
        CoilStatus(-3, 1, 2000, -400, 100_000, 1),
        Sync(8, 1427424418),
    )
    for message in flight:
        seen.take(message.encode(), 0.0)
    return seen


def test_it_shows_mode_attitude_coils_sensors_and_pulses(flying):
    shown = text(flying)
    for words in (
        "loop:28011",
        "2015-03-27 02:46:58",
        "tick 8",
        "POINT",
        "attitude valid",
        "level -3, -400 mA",
        "100 s locked",
        "40 s locked",
        "36.1 uT",
        "Sun sensor not used",
        "coil 1 driven at level -3",
        "MAG_FIELD",
    ):
        assert words in shown


def test_frames_of_many_unknown_identifiers_have_one_line_together(flying):
    for can_id in range(MOST_UNKNOWN + 30):
        flying.take(Frame(0x8000_0000 + can_id, b""), 0.0)
    assert "other identifiers" in text(flying)
    assert "30" in text(flying).split("other identifiers")[1].split("\n")[0]


def test_before_anything_came_it_says_that_it_waits():
    shown = text(FlightView())
    assert "waiting for SYNC" in shown
    assert "attitude not valid" in shown
    assert "no mode yet" in shown


@pytest.mark.long
@pytest.mark.parametrize(("width", "height"), [(40, 12), (80, 24), (240, 70), (10, 3)])
def test_any_room_is_enough(flying, width, height):
    lines = text(flying, width, height).splitlines()
    assert len(lines) <= height
    assert max(map(len, lines)) <= width


def test_a_terminal_of_80_columns_shows_every_number_and_whole_pulses(flying):
    shown = text(flying, 80, 24)
    assert "coil 1 driven at level -3, -400 mA" in shown
    for words in (
        "125 kbit/s used",
        "coil 2",
        "refused",
        "off nominal",
        "Sun off prediction",
        "36.1 uT",
    ):
        assert words in shown


def test_a_warning_is_called_one_beside_its_colour():
    warned = Occurrence(1, 3, 1427424417, Weight.WARNING, "fsw: something")
    assert short_line(warned) == "02:46:57  warning: fsw: something"
    assert short_line(warned._replace(weight=Weight.PULSE)) == "02:46:57  fsw: something"


def test_into_a_file_it_is_a_line_for_each_thing_that_happens(capsys):
    seen = FlightView()

    def flight():
        seen.take(FswBoot(0, 1, 5).encode(), 0.0)
        yield
        seen.take(Sync(3, 1427424417).encode(), 0.0)
        seen.take(CoilStatus(2, 0, 2000, 100, 100_000, 1).encode(), 0.0)
        yield
        yield

    show(seen, flight(), "some.log")
    first, second = capsys.readouterr().out.splitlines()
    assert first.endswith("fsw: started")
    assert second == "2015-03-27 02:46:57        tick 3  pulse    coil 0 driven at level +2, 100 mA"
