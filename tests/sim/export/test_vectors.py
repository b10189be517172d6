"""Golden vectors: replayed by hand through the flight software they give what they hold."""

import json
import struct

import pytest

from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.frame import Frame
from fsw.wire.messages import FswBoot, PlantBoot, Sync, TickDone
from sim.errors import HarnessError
from sim.export.source import open_source
from sim.export.vectors import BEFORE, IN, MAGIC, OUT, RECORD, TICK, tick_vectors, write_vectors
from sim.record.candump import LogEntry
from sim.scenario.schema import flight_table, load, parse_settings

TICKS = 400


def frame_of(text):
    number, _, data = text.partition("#")
    return Frame(int(number, 16), bytes.fromhex(data))


def test_the_flight_software_answers_each_line_as_the_line_says(flight, tmp_path):
    out = tmp_path / "run.jsonl"
    assert write_vectors(open_source(flight.folder), out, force=False) == (TICKS, [])
    head, boot, *lines = map(json.loads, out.read_text().splitlines())
    assert (head["format"], head["scenario"], head["tick_hz"]) == ("torquer-vectors/1", "microsat", 1)
    node = FlightNode(flight_config(flight_table(load("microsat", parse_settings(("coils.backoff_s=20",))))))
    assert (boot["tick"], boot["out"]) == (BEFORE, [text_of(node.start())])
    for tick, line in enumerate(lines):
        assert line["tick"] == tick
        answers = [answer for text in line["in"] for answer in node.receive(frame_of(text))]
        assert [text_of(answer) for answer in answers] == line["out"]
    assert len(lines) == TICKS


def text_of(frame):
    return f"{frame.can_id:03X}#{frame.data.hex().upper()}"


def test_the_binary_form_holds_the_same(flight, tmp_path):
    source = open_source(flight.folder)
    write_vectors(source, tmp_path / "run.bin", force=False)
    write_vectors(source, tmp_path / "run.jsonl", force=False)
    content = (tmp_path / "run.bin").read_bytes()
    assert content.startswith(MAGIC)
    found, frames = [], {IN: [], OUT: []}
    for kind, length, can_id, data in RECORD.iter_unpack(content[len(MAGIC) :]):
        if kind == TICK:
            tick, incoming, outgoing = struct.unpack("<iHH", data)
            assert (incoming, outgoing) == (len(frames[IN]), len(frames[OUT]))
            found.append({"tick": tick, "in": frames[IN], "out": frames[OUT]})
            frames = {IN: [], OUT: []}
        else:
            frames[kind].append(text_of(Frame(can_id, data[:length])))
    assert found == [json.loads(line) for line in (tmp_path / "run.jsonl").read_text().splitlines()[1:]]


def test_a_log_that_was_cut_gives_the_ticks_that_it_holds(cut, tmp_path):
    ticks, notes = write_vectors(open_source(cut), tmp_path / "run.jsonl", force=False)
    assert 0 < ticks < TICKS
    assert "cut short" in notes[0]


def entries(*frames):
    return (LogEntry(line, 0, "loop", frame) for line, frame in enumerate(frames, 1))


def sync(tick):
    return Sync(tick, tick).encode()


BOOT, ASKED = FswBoot(0, 1, 0).encode(), PlantBoot(0, 1, 0).encode()


def test_a_sync_that_is_repeated_is_no_tick():
    done = [TickDone(tick, 0).encode() for tick in range(2)]
    found = list(tick_vectors(entries(BOOT, sync(0), sync(0), done[0], sync(1), done[1])))
    assert [(one.tick, len(one.incoming), one.outgoing) for one in found] == [
        (-1, 0, [BOOT]),
        (0, 1, [done[0]]),
        (1, 1, [done[1]]),
    ]


def test_a_flight_that_was_late_is_refused():
    late = entries(BOOT, sync(0), sync(1), TickDone(0, 0).encode())
    with pytest.raises(HarnessError, match="line 4: tick 0 is answered in tick 1: vectors are of a flight"):
        list(tick_vectors(late))


def test_a_tick_done_that_is_damaged_answers_no_tick():
    damaged = Frame(TickDone.ID, b"\x07")
    (_, vector) = tick_vectors(entries(BOOT, sync(0), damaged))
    assert vector.outgoing == [damaged]


def test_frames_of_others_are_written_as_candump_writes_them(tmp_path):
    texts = ["00000123#01", "20000004#0000000000000000", "123#R", text_of(sync(0))]
    log = tmp_path / "bus.log"
    log.write_text("".join(f"(0000000000.000000) can0 {text}\n" for text in texts))
    write_vectors(open_source(log), tmp_path / "run.jsonl", force=False)
    *_, tick = map(json.loads, (tmp_path / "run.jsonl").read_text().splitlines())
    assert tick["in"] == texts


def test_another_suffix_is_refused(flight, tmp_path):
    with pytest.raises(HarnessError, match=r"its suffix must be \.jsonl or \.bin"):
        write_vectors(open_source(flight.folder), tmp_path / "run.csv", force=False)
