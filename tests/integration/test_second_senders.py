"""Another sender on the bus of ``torquer sil``: refused before the flight, named in it, and the run fails."""

import json
from threading import Event, Thread

import pytest

from fsw.bus.link import LoopLink
from fsw.wire.frame import EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    CoilFire,
    CoilStatus,
    FswBoot,
    MagField,
    NavAttitude,
    NavRate,
    PlantBoot,
    PlantEnd,
    Sync,
    TcSpin,
    TickDone,
)
from sim.report import conclude

pytestmark = pytest.mark.long

EPOCH = 1_427_424_417
AT = 40
FLIGHT = ("microsat", "--seed", "7", "--orbits", "0.1")
"""A second or two: a stranger on a busy machine has time to speak."""


@pytest.fixture(autouse=True)
def no_report(monkeypatch):
    """Drawing takes longer than the flights."""
    monkeypatch.setattr(conclude, "write_report", lambda path, *rest: path.write_text(""))


class Stranger:
    """Hosts the bus; answers messages that it hears with frames of its own."""

    def __init__(self, port, answer):
        self._link = LoopLink(port)
        self._answer = answer
        self._over = Event()
        self._thread = Thread(target=self._run)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *error):
        self._over.set()
        self._thread.join()
        self._link.close()

    def _run(self):
        while not self._over.is_set():
            frame = self._link.receive(0.05)
            if frame is not None and frame.can_id in CLASSES:
                self._link.send(self._answer(CLASSES[frame.can_id].decode(frame.data)))


def once(message, *frames):
    """Answer that message, only the first time that it is received."""
    left = [list(frames)]
    return lambda received: left.pop() if received == message and left else []


SYNC = Sync(AT, EPOCH + AT)


@pytest.mark.parametrize(
    "forged",
    [
        TickDone(AT, 7),
        FswBoot(0, 1, 0),
        Sync(10**6, EPOCH + AT + 1),
        PlantEnd(AT),
        MagField(1, 20000.0, 0.0, -30000.0),
    ],
    ids=lambda message: f"{type(message).__name__}-{message.values()[0]}",
)
@pytest.mark.slow
def test_one_frame_in_flight_fails_the_run_and_is_named(forged, port, torquer, tmp_path):
    run = tmp_path / "run"
    with Stranger(port, once(SYNC, forged.encode())):
        done = torquer("sil", *FLIGHT, "--bus", f"loop:{port}", "--out", run)
    assert done.code == 1
    run_json = json.loads((run / "run.json").read_text())
    (sender,) = [one for one in run_json["second_senders"] if one["id"] == f"{forged.ID:03X}"]
    assert sender["tick"] >= AT - 1
    assert "a second sender is on the bus" in done.sentence
    assert f"{sender['message']} ({sender['id']}) at tick {sender['tick']}" in done.sentence
    if "flown" in run_json:  # a PLANT_END may have ended the flight software
        assert json.loads((run / "summary.json").read_text())["second_senders"] == run_json["second_senders"]
        again = torquer("report", run)
        assert (again.code, again.sentence) == (1, done.sentence)


@pytest.mark.slow
def test_a_forged_answer_is_at_least_a_replay_that_is_not_exact(port, torquer, tmp_path):
    with Stranger(port, once(SYNC, NavAttitude(1, 0.1, 0.2, 0.3).encode())):
        done = torquer("sil", *FLIGHT, "--bus", f"loop:{port}", "--out", tmp_path / "run")
    assert done.code == 1
    assert "NAV_ATTITUDE" in done.sentence


@pytest.mark.slow
def test_the_ground_is_no_second_sender(port, torquer, tmp_path):
    with Stranger(port, once(SYNC, TcSpin(0.01).encode())):
        done = torquer("sil", *FLIGHT, "--bus", f"loop:{port}", "--out", tmp_path / "run")
    assert (done.code, done.err) == (0, "")
    assert "second_senders" not in json.loads((tmp_path / "run" / "summary.json").read_text())


@pytest.mark.slow
def test_noise_fails_nothing_and_the_log_replays_with_it(port, torquer, bus, tmp_path):
    """Some of it meets the plant's own frames: which came first the answers tell."""
    noise = (
        Frame(MagField.ID, b"\0"),
        Frame(0x7FF, b"\xde\xad"),
        Frame(0x12345678 | EXTENDED_FLAG, b"\1\2"),
        Frame(CoilStatus.ID | REMOTE_FLAG, b""),
        Frame(CoilFire.ID, bytes(8)),
    )
    run = tmp_path / "run"
    with Stranger(port, lambda received: noise if isinstance(received, Sync | NavRate) else ()):
        done = torquer("sil", *FLIGHT, "--bus", f"loop:{port}", "--out", run)
    assert (done.code, done.err) == (0, "")
    assert sum(frame.can_id == 0x7FF for frame in bus(run).frames) > 100
    assert torquer("replay", run).code == torquer("replay", run, "--plant").code == 0


@pytest.mark.parametrize(("command", "boot"), [("plant", "PLANT_BOOT (500)"), ("fsw", "FSW_BOOT (510)")])
def test_a_bus_on_which_a_node_waits_is_refused(command, boot, port, start, torquer, tmp_path):
    hub = LoopLink(port)
    node = start("torquer", command, "microsat", "--bus", f"loop:{port}")
    assert hub.receive(120.0) is not None, "it is there"
    done = torquer("sil", *FLIGHT, "--bus", f"loop:{port}", "--out", tmp_path / "run")
    hub.close()
    assert (done.code, done.out) == (2, "")
    assert f"torquer: loop:{port} is in use: {boot}" in done.sentence
    assert not (tmp_path / "run").exists()
    node.process.kill()


@pytest.mark.slow
def test_a_board_that_waits_there_is_named_in_the_flight(port, start, torquer, tmp_path):
    hub = LoopLink(port)
    board = start("hil_stub", "magnetometer", "--bus", f"loop:{port}")
    assert hub.receive(120.0) is not None, "it is there"
    done = torquer("sil", *FLIGHT, "--bus", f"loop:{port}", "--out", tmp_path / "run")
    hub.close()
    assert done.code == 1
    assert "MAG_FIELD (110) from tick " in done.sentence
    board.process.kill()


@pytest.mark.slow
def test_of_two_flights_at_once_no_two_succeed(port, start, torquer, tmp_path):
    words = ("torquer", "sil", "microsat", "--orbits", "0.1", "--bus", f"loop:{port}", "--out")
    flights = [start(*words, tmp_path / name) for name in ("one", "other")]
    ended = [flight.wait() for flight in flights]
    for flight in ended:
        if flight.code:
            assert "second sender" in flight.sentence or "is in use" in flight.sentence
    codes = sorted(flight.code for flight in ended)
    assert codes in ([0, 2], [1, 1], [1, 2]), ended


def test_a_plant_by_hand_ends_at_once_where_another_flies(port, start, tmp_path):
    hub = LoopLink(port)
    plant = start("torquer", "plant", "--bus", f"loop:{port}", "--out", tmp_path / "run")
    assert hub.receive(120.0).can_id == PlantBoot.ID
    hub.send([Sync(701, EPOCH + 701).encode()])
    ended = plant.wait()
    hub.close()
    assert ended.code == 1
    assert "torquer: another plant sent SYNC before the flight began" in ended.err
