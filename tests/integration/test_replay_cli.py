"""``torquer replay``: what it finds in logs that were altered, cut short or are none."""

import json
import random
import re
import time
from threading import Thread

import pytest

from fsw.bus.link import LoopLink
from fsw.wire.frame import Frame, crc8, id_register
from fsw.wire.messages import (
    NAMES,
    CoilFire,
    FswBoot,
    MagField,
    NavAttitude,
    PlantBoot,
    PlantEnd,
    Sync,
    TickDone,
)

SHORT = ("microsat", "--seed", "7", "--orbits", "0.05")
TINY = ("microsat", "--seed", "7", "--orbits", "0.005", "--bus", "virtual")
SIGNAL = re.compile(r"tick (\d+): ([A-Z_]+\.[a-z0-9_]+) is (\S+) in the log and (\S+) in the replay")


@pytest.fixture
def copy(copy_of, sil_run):
    """A run of 302 ticks with two pulses, to be altered."""
    return copy_of(sil_run(*SHORT, "--bus", "loop"))


@pytest.fixture
def tiny(copy_of, sil_run):
    """A run of 30 ticks, to be altered."""
    return copy_of(sil_run(*TINY))


def differs(done):
    """(tick, signal) that a replay names first."""
    assert done.code == 1
    assert done.err == ""
    found = SIGNAL.search(done.out.splitlines()[0])
    assert found, done.out
    return int(found[1]), found[2]


def test_an_untouched_log_is_bit_exact(copy, torquer):
    for which in (copy.folder, copy.log):
        done = torquer("replay", which)
        assert (done.code, done.err) == (0, "")
        assert re.fullmatch(r"bit-exact: 302 ticks, \d+ frames, every state CRC equal\n", done.out)


@pytest.mark.long
def test_a_bare_log_needs_a_scenario(copy, torquer, tmp_path):
    bare = copy.log.rename(tmp_path / "bare.log")
    done = torquer("replay", bare)
    assert done.code == 2
    assert "scenario" in done.sentence
    assert torquer("replay", bare, "--scenario", "microsat").code == 0
    assert torquer("replay", bare, "--scenario", str(copy.folder / "scenario.toml")).code == 0
    assert torquer("replay", bare, "--scenario", "posat1").code == 1
    assert differs(torquer("replay", bare, "--scenario", "microsat", "--set", "control.k_w=1e6"))


# --- altered


def first_fired(copy):
    """The tick that was answered with the first pulse."""
    return CoilFire.decode(copy.entries[copy.where(CoilFire)[0]][2].data).tick


def alter(frame, byte, bit, repair):
    data = bytearray(frame.data)
    data[byte] ^= 1 << bit
    if repair:
        data[-1] = crc8(bytes(data[:-1]), id_register(frame.can_id))
    return Frame(frame.can_id, bytes(data))


@pytest.mark.parametrize("repair", [False, True])
@pytest.mark.parametrize("tick", [0, 1, 37, "driven", 301])
def test_one_byte_of_the_field_is_found_in_its_tick(tick, repair, copy, torquer):
    if tick == "driven":  # the magnetometer has no use then
        tick = first_fired(copy) + 2
    byte, bit = random.Random(f"{tick} {repair}").choice([(n, b) for n in range(1, 7) for b in range(8)])
    index = copy.in_tick(tick, MagField)
    copy.entries[index][2] = alter(copy.entries[index][2], byte, bit, repair)
    first, signal = differs(torquer("replay", copy.write()))
    assert first == tick
    assert signal.partition(".")[0] in {
        "NAV_ATTITUDE",
        "NAV_RATE",
        "NAV_QUALITY",
        "NAV_PARAMETER",
        "COIL_FIRE",
        "TICK_DONE",
    }


def test_without_its_scenario_too(copy, torquer, tmp_path):
    index = copy.in_tick(37, MagField)
    copy.entries[index][2] = alter(copy.entries[index][2], 2, 3, repair=True)
    bare = (copy.write() / "bus.log").rename(tmp_path / "bare.log")
    assert differs(torquer("replay", bare, "--scenario", "microsat"))[0] == 37


@pytest.mark.parametrize("byte", range(8))
def test_every_byte_of_a_field_counts(byte, tiny, torquer):
    index = tiny.in_tick(17, MagField)
    for bit in (0, 7) if byte else (0, 4):  # three bits beside the counter and 'valid' mean nothing
        copy = tiny.entries[index][2]
        tiny.entries[index][2] = alter(copy, byte, bit, repair=byte < 7)
        assert differs(torquer("replay", tiny.write()))[0] == 17
        tiny.entries[index][2] = copy


def test_a_sample_that_is_missing_is_found_in_its_tick(copy, torquer):
    del copy.entries[copy.in_tick(50, MagField)]
    assert differs(torquer("replay", copy.write()))[0] == 50


def test_a_tick_that_is_missing_is_found(copy, torquer):
    first, last = copy.in_tick(50, MagField), copy.where(TickDone, tick=50)[0]
    del copy.entries[first : last + 1]
    done = torquer("replay", copy.write())
    assert done.code == 1
    assert "tick 51: " in done.out


def test_last_ticks_that_are_missing_before_the_end_mark_are_found(copy, torquer):
    del copy.entries[copy.in_tick(300, MagField) : copy.where(PlantEnd)[0]]
    assert differs(torquer("replay", copy.write())) == (299, "PLANT_END.ticks")
    assert torquer("replay", copy.folder, "--plant").code == 1


@pytest.mark.long
def test_an_end_in_the_middle_is_not_the_end(copy, torquer):
    """Though it fits: through the plant the flight goes on, and the flight software would have told of it."""
    last = copy.where(PlantEnd)[0]
    ticks = PlantEnd.decode(copy.entries[last][2].data).ticks
    index = copy.in_tick(150, MagField)
    stamp, channel, _ = copy.entries[index]
    copy.entries.insert(index, [stamp, channel, PlantEnd(150).encode()])
    done = torquer("replay", copy.write(), "--plant")
    assert f"plant reproduced: {ticks} ticks" in done.out
    assert torquer("replay", copy.folder).out.startswith("differs: tick 150: the next frame is ")


def test_a_command_that_was_altered_is_told_as_one(copy, torquer):
    index = copy.where(CoilFire)[0]
    fired = CoilFire.decode(copy.entries[index][2].data)
    copy.change(index, level=-fired.level)
    done = torquer("replay", copy.write())
    assert differs(done) == (first_fired(copy), "COIL_FIRE.level")
    assert done.out.startswith("differs: ")


@pytest.mark.parametrize("message", [CoilFire, NavAttitude, TickDone, FswBoot])
def test_an_answer_that_is_missing_or_doubled_is_found(message, copy, torquer):
    index = copy.where(message)[-1]
    entry = copy.entries.pop(index)
    missing = torquer("replay", copy.write())
    assert missing.code == 1
    assert missing.out.startswith("differs: tick ")
    copy.entries.insert(index, entry)
    copy.entries.insert(index if index else copy.in_tick(1, MagField), entry)
    doubled = torquer("replay", copy.write())
    assert doubled.code == 1
    assert doubled.out.startswith("differs: tick ")


def other_platform(folder):
    run = json.loads((folder / "run.json").read_text())
    run["platform"]["cpu"] = "another"
    (folder / "run.json").write_text(json.dumps(run))


@pytest.mark.parametrize(
    ("message", "signal", "steps", "elsewhere"),
    [
        (NavAttitude, "q_x", 1, 0),
        (NavAttitude, "q_x", -1, 0),
        (NavAttitude, "q_x", 2, 1),
        (NavAttitude, "valid", None, 1),
        (TickDone, "state_crc", None, 0),
    ],
)
def test_the_last_bit_of_telemetry_may_differ_on_another_platform(
    message, signal, steps, elsewhere, copy, torquer
):
    index = copy.where(message)[60]
    value = getattr(message.decode(copy.entries[index][2].data), signal)
    copy.change(index, **{signal: value ^ 1 if steps is None else value + steps * 2.0**-16})
    folder = copy.write()
    assert differs(torquer("replay", folder)) == (60, f"{NAMES[message.ID]}.{signal}")
    other_platform(folder)
    done = torquer("replay", folder)
    assert done.code == elsewhere
    assert done.out.startswith("differs" if elsewhere else "command-exact, not bit-exact")


def test_a_recorder_may_have_heard_the_nodes_look_for_each_other(copy, torquer, tmp_path):
    boot, asking = copy.entries[0], [copy.entries[0][0], "loop", PlantBoot(0, 1, 0).encode()]
    copy.entries[:1] = [asking, boot, asking, asking, boot]
    bare = (copy.write() / "bus.log").rename(tmp_path / "candump.log")
    done = torquer("replay", bare, "--scenario", "microsat")
    assert (done.code, done.err) == (0, "")
    assert done.out.startswith("bit-exact: 302 ticks")


def test_a_line_that_is_none_is_named(copy, torquer):
    lines = copy.log.read_text().splitlines(keepends=True)
    lines[700] = lines[700].replace("#", "%")
    copy.log.write_text("".join(lines))
    done = torquer("replay", copy.folder)
    assert done.code == 2
    assert "line 701" in done.sentence


# --- cut short


@pytest.mark.long
@pytest.mark.slow
def test_cut_anywhere_it_says_where_it_ends(tiny, torquer):
    whole = tiny.log.read_bytes()
    ends = [place + 1 for place, byte in enumerate(whole) if byte == ord("\n")]
    chosen = random.Random(4)
    cuts = {*ends[-16:-1], *range(ends[-3], len(whole)), *chosen.sample(range(ends[0], len(whole)), 40)}
    for cut in sorted(cuts):
        tiny.log.write_bytes(whole[:cut])
        done = torquer("replay", tiny.folder)
        assert done.code == 1, cut
        lines = sum(end <= cut for end in ends)
        last = sum(tiny.entries[index][2].can_id == Sync.ID for index in range(lines)) - 1
        how = "without its end mark" if cut in ends else "inside a line"
        last_line = f"incomplete: the log ends {how} after line {lines}, at tick {max(last, 0)}\n"
        assert done.out.endswith(last_line), cut
        assert done.out.startswith("bit-exact: "), cut


@pytest.mark.parametrize("cut", [1, 5, 30, 46])
def test_cut_in_its_first_line_it_says_so(cut, tiny, torquer):
    tiny.log.write_bytes(tiny.log.read_bytes()[:cut])
    for words in (("replay",), ("replay", "--plant"), ("check",)):
        done = torquer(*words[:1], tiny.folder, *words[1:])
        assert done.code != 0
        assert "line 1" in done.out + done.err


def test_a_cut_log_goes_through_the_plant_as_far_as_it_goes(copy, torquer):
    whole = copy.log.read_bytes()
    for cut in (len(whole) // 2, len(whole) - 1):
        copy.log.write_bytes(whole[:cut])
        done = torquer("replay", copy.folder, "--plant")
        assert done.code == 1
        index, binding, incomplete = done.out.splitlines()
        assert index.startswith(f"index: truncated: the log has {cut} bytes, its index covers ")
        assert binding.startswith("MISMATCH bus.log is not the run's own: ")
        assert re.fullmatch(r"incomplete: .* at tick \d+", incomplete)


# --- no log at all


NO_LOGS = {
    "empty": b"",
    "newline": b"\n",
    "text": b"hello\n",
    "png": b"\x89PNG\r\n\x1a\n\0\0",
    "zeros": bytes(5000),
    "long": b"x" * 10_000_000,
    "json": b'{"a": 1}\n',
    "almost": b"(1.0)\n",
}


@pytest.mark.parametrize("content", NO_LOGS.values(), ids=NO_LOGS)
def test_a_file_that_is_no_log_is_named(content, torquer, tmp_path):
    log = tmp_path / "some.file"
    log.write_bytes(content)
    for command in ("replay", "check"):
        done = torquer(command, log)
        assert (done.code, done.out) == (2, "")
        assert str(log) in done.sentence


@pytest.mark.parametrize("command", ["replay", "check", "report"])
@pytest.mark.parametrize("name", ["nowhere", "."])
def test_what_is_no_run_is_named(command, name, torquer, tmp_path):
    done = torquer(command, tmp_path / name)
    assert (done.code, done.out) == (2, "")
    assert str(tmp_path) in done.sentence


# --- through the plant


@pytest.mark.long
def test_recorded_commands_through_the_plant_give_its_frames(copy, torquer):
    done = torquer("replay", copy.folder, "--plant")
    assert (done.code, done.out) == (0, "plant reproduced: 302 ticks, every frame equal\n")


def test_a_sample_that_the_plant_did_not_send_is_found(copy, torquer):
    index = copy.in_tick(50, MagField)
    copy.change(index, b_x=MagField.decode(copy.entries[index][2].data).b_x + 2.0)
    done = torquer("replay", copy.write(), "--plant")
    assert done.code == 1
    assert done.out.startswith("differs: tick 50: MAG_FIELD is ")


def test_a_command_that_is_missing_shows_in_the_coil(copy, torquer):
    fired = first_fired(copy)
    del copy.entries[copy.where(CoilFire)[0]]
    done = torquer("replay", copy.write(), "--plant")
    assert done.code == 1
    assert done.out.startswith(f"differs: tick {fired + 1}: ")


def test_the_plant_needs_the_seed(copy, torquer):
    (copy.folder / "run.json").unlink()
    done = torquer("replay", copy.folder, "--plant")
    assert (done.code, done.out) == (2, "")
    assert "run.json" in done.sentence


# --- onto a bus


@pytest.mark.long
def test_a_log_is_played_onto_a_bus_at_its_own_pace(sil_run, torquer, bus, port):
    run = sil_run("microsat", "--set", "time.tick_hz=10", "--orbits", "0.0002", "--bus", "virtual")
    listener = LoopLink(port)
    received, times = [], []

    def listen():
        while not received or received[-1].can_id != PlantEnd.ID:
            frame = listener.receive(120.0)
            if frame is None:
                break
            received.append(frame)
            times.append(time.monotonic())

    thread = Thread(target=listen)
    thread.start()
    done = torquer("replay", run, "--onto", f"loop:{port}")
    thread.join()
    listener.close()
    assert (done.code, done.err) == (0, "")
    assert received == bus(run).frames
    assert 1.15 < times[-1] - times[0] < 2.5, "12 ticks of 0.1 s"


def test_a_bus_that_is_none_is_named(copy, torquer):
    done = torquer("replay", copy.folder, "--onto", "can0")
    assert (done.code, done.out) == (2, "")
    assert "can0" in done.sentence


def test_a_log_that_pauses_for_longer_than_anybody_waits_is_not_played(copy, torquer, port):
    copy.entries[1][0] += 10**13
    copy.write()
    done = torquer("replay", copy.folder, "--onto", f"loop:{port}")
    assert done.code == 2
    assert "it pauses for 1" in done.sentence
