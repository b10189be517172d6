"""Plant and flight software started by hand, in two terminals, in either order."""

import json
import time
from random import Random

import can
import pytest

from fsw.bus.link import LoopLink
from fsw.bus.loop import frame_of
from fsw.wire.messages import FswBoot, PlantBoot, PlantEnd, Sync, TickDone

pytestmark = pytest.mark.long

OPTIONS = ("--seed", "7", "--orbits", "0.05")


@pytest.mark.parametrize(
    ("first", "plant_command"), [("plant", ("sim.plant",)), ("fsw", ("torquer", "plant"))]
)
@pytest.mark.slow
def test_either_may_start_first(first, plant_command, port, start, wait_for, sil_run, tmp_path):
    run = tmp_path / "run"
    words = {
        "plant": (*plant_command, "microsat", "--bus", f"loop:{port}", *OPTIONS, "--out", run),
        "fsw": ("torquer", "fsw", "microsat", "--bus", f"loop:{port}"),
    }
    second = {"plant": "fsw", "fsw": "plant"}[first]
    nodes = {first: start(*words[first])}
    wait_for(nodes[first], f"{first} on loop:{port}")
    time.sleep(1.0)  # whatever the first one says now, the other one misses
    nodes[second] = start(*words[second])
    plant, fsw = nodes["plant"].wait(), nodes["fsw"].wait()
    assert (plant.code, plant.out) == (0, "")
    assert plant.err.endswith(f"run: {run}\n")
    assert (fsw.code, fsw.out, fsw.err) == (0, "", f"fsw on loop:{port}\n")
    whole = sil_run("microsat", *OPTIONS, "--bus", "loop")
    assert (run / "bus.log").read_bytes() == (whole / "bus.log").read_bytes()
    assert {path.name for path in run.iterdir()} == {path.name for path in whole.iterdir()}
    own, reference = (json.loads((path / "run.json").read_text()) for path in (run, whole))
    assert own.pop("flown")["ticks"] == reference.pop("flown")["ticks"]
    for run in (own, reference):
        del run["digests"]["summary.json"]  # it tells how long the flight took
    assert own == reference
    assert own["complete"] is True


@pytest.mark.slow
def test_on_a_bench_one_flight_software_flies_run_after_run(port, start, wait_for, tmp_path):
    """No PLANT_END ends it; it boots for the plant that comes next, so that both runs have the same log."""
    fsw = start("torquer", "fsw", "microsat", "--bus", f"loop:{port}", "--bench")
    wait_for(fsw, f"fsw on loop:{port}")
    runs = [tmp_path / "one", tmp_path / "two"]
    for run in runs:
        plant = start("torquer", "plant", "microsat", "--bus", f"loop:{port}", *OPTIONS, "--out", run).wait()
        assert plant.code == 0, plant.err
    assert fsw.process.poll() is None
    assert (runs[0] / "bus.log").read_bytes() == (runs[1] / "bus.log").read_bytes()


@pytest.mark.slow
def test_a_stranger_who_forges_sync_and_the_end_does_not_stop_the_flight(port, start, torquer, bus, tmp_path):
    """One that is strange, two that are not, and ends of any count: every tick is flown, and replays."""
    run, random = tmp_path / "run", Random(4)
    forged = [
        lambda: [Sync(random.getrandbits(32), 0).encode()],
        lambda: [Sync(at := random.getrandbits(31), 0).encode(), Sync(at + 1, 0).encode()],
        lambda: [PlantEnd(random.getrandbits(24), counter=random.getrandbits(4)).encode()],
    ]
    stranger = LoopLink(port)
    fsw = start("torquer", "fsw", "microsat", "--bus", f"loop:{port}")
    plant = start("torquer", "plant", "microsat", "--bus", f"loop:{port}", *OPTIONS, "--out", run)
    tick = 0
    while tick < 270:
        frame = stranger.receive(120.0)
        assert frame is not None, "the flight has stopped"
        if frame.can_id == TickDone.ID and TickDone.decode(frame.data).tick == tick + 1:
            tick += 1
            if tick > 10 and random.random() < 0.2:
                stranger.send(random.choice(forged)())
    ended = plant.wait()
    assert ended.code == 1, "all is flown, but not alone"
    assert "a second sender is on the bus: SYNC (180) from tick " in ended.err
    assert fsw.wait().code == 0
    assert torquer("replay", run).out.startswith("bit-exact: ")
    done = {TickDone.decode(frame.data).tick for frame in bus(run).frames if frame.can_id == TickDone.ID}
    assert done >= set(range(270))


@pytest.mark.slow
def test_sil_is_a_guest_where_others_host_the_bus(port, torquer, bus, tmp_path):
    run = tmp_path / "run"
    with can.Bus(interface="loop", channel=port) as listener:
        assert torquer("sil", "--orbits", "0.02", "--bus", f"loop:{port}", "--out", run).code == 0
        received = []
        while not received or received[-1].can_id != PlantEnd.ID:
            message = listener.recv(120.0)
            assert message is not None, "it never ended"
            received.append(frame_of(message))
    boots = [index for index, frame in enumerate(received) if frame.can_id == FswBoot.ID]
    flown = received[boots[-1] :]
    while flown[1].can_id == PlantBoot.ID:  # asked for the boot that was on its way
        del flown[1]
    assert flown == bus(run).frames


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("fsw", "--bus", "can0"), "can0"),
        (("fsw", "nowhere"), "nowhere"),
        (("plant", "--bus", "virtual"), "virtual"),
        (("plant", "--set", "time.tick_hz=0"), "time.tick_hz"),
        (("plant", "--pace", "fast"), "--pace fast"),
        (("plant", "--orbits", "nan"), "--orbits nan"),
        (("board", "coil", "--bus", "can0"), "can0"),
        (("board", "coil", "--levels-ma", "3", "2", "1", "--bus", "loop"), "--levels-ma"),
        (("board", "wheel", "--bus", "loop"), "wheel"),
    ],
)
def test_a_wrong_option_is_one_sentence(words, named, port, torquer):
    bus = () if "--bus" in words else ("--bus", f"loop:{port}")
    done = torquer(*words, *bus)
    assert (done.code, done.out) == (2, "")
    assert named in done.sentence


def test_a_table_that_is_not_there_is_one_sentence(port, start):
    done = start("fsw", "--table", "nowhere.toml", "--bus", f"loop:{port}").wait()
    assert (done.code, done.out) == (2, "")
    assert done.sentence.startswith("fsw: ")
    assert "nowhere.toml" in done.sentence


def test_without_a_plant_the_flight_software_waits_and_ends_with_the_bus(port, start):
    listener = LoopLink(port)
    fsw = start("torquer", "fsw", "microsat", "--bus", f"loop:{port}")
    assert listener.receive(120.0).can_id == FswBoot.ID
    assert listener.receive(1.5) is None
    assert fsw.process.poll() is None
    listener.close()
    assert fsw.wait().code == 0
