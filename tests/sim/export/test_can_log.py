"""``.blf`` and ``.asc``, read again by python-can: every frame, in order, at its time."""

import can
import pytest

from fsw.bus.python_can import frame_of
from fsw.wire.frame import Frame
from sim.errors import HarnessError
from sim.export.command import write_asc, write_blf
from sim.export.mcap import write_mcap
from sim.export.source import open_source


@pytest.mark.long
def test_blf_holds_every_frame_to_the_microsecond(flight, exported):
    with can.BLFReader(exported("blf")) as reader:
        messages = list(reader)
    assert [frame_of(message) for message in messages] == [entry.frame for entry in flight.entries]
    assert [round(1e6 * message.timestamp) for message in messages] == [
        entry.timestamp_us for entry in flight.entries
    ]


def test_asc_holds_every_frame_at_its_time_from_the_first(flight, exported):
    with can.ASCReader(exported("asc")) as reader:
        messages = list(reader)
    first_us = flight.entries[0].timestamp_us
    assert [frame_of(message) for message in messages] == [entry.frame for entry in flight.entries]
    assert [round(1e6 * message.timestamp) for message in messages] == [
        entry.timestamp_us - first_us for entry in flight.entries
    ]


@pytest.mark.parametrize(("write", "reader"), [(write_blf, can.BLFReader), (write_asc, can.ASCReader)])
def test_frames_of_strangers_are_kept(tmp_path, write, reader):
    log = tmp_path / "any.log"
    log.write_text("(1700000000.000250) can7 18DAF110#0102\n(1700000001.500000) can7 123#R\n")
    assert "no end mark" in write(open_source(log), tmp_path / "out", lambda done: None)[0]
    with reader(tmp_path / "out", relative_timestamp=True) as opened:
        messages = list(opened)
    assert [frame_of(message) for message in messages] == [
        Frame(0x98DAF110, b"\x01\x02"),
        Frame(0x40000123, b""),
    ]
    assert messages[1].timestamp - messages[0].timestamp == pytest.approx(1.49975, abs=5e-7)


def exported_to(tmp_path, write, *lines):
    log = tmp_path / "any.log"
    log.write_text("".join(f"{line}\n" for line in lines))
    return write(open_source(log), tmp_path / "out", lambda done: None)


@pytest.mark.parametrize(("write", "reader"), [(write_blf, can.BLFReader), (write_asc, can.ASCReader)])
def test_a_frame_stamped_before_the_first_is_noted(tmp_path, write, reader):
    notes = exported_to(tmp_path, write, "(1700000010.000000) c 110#01", "(1700000001.000000) c 111#02")
    assert "1 frame stamped earlier than the first" in notes[-1]
    with reader(tmp_path / "out") as opened:
        first, second = opened
    assert first.timestamp == second.timestamp


@pytest.mark.parametrize("write", [write_blf, write_asc])
@pytest.mark.parametrize("channel", ["can65534", "can65535", "can" + 40 * "9", "loop"])
def test_any_name_of_a_bus_is_written(tmp_path, write, channel):
    exported_to(tmp_path, write, f"(1700000010.000000) {channel} 110#01")


@pytest.mark.parametrize("write", [write_blf, write_asc, write_mcap])
def test_a_time_beyond_all_formats_is_refused(tmp_path, write):
    with pytest.raises(HarnessError, match="line 2 is stamped later than the year 2200"):
        exported_to(tmp_path, write, "(0000000000.000000) c 110#01", "(999999999999.000000) c 110#01")
