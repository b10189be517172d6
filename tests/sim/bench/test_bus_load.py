"""Bits of a frame on the wire, against the standard's bounds and a second way to count."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.wire.frame import EXTENDED_FLAG, REMOTE_FLAG, Frame
from sim.bench import bus_load
from sim.bench.bus_load import frame_bits

frames = st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8))


def test_the_crc_is_that_of_can():
    """CRC-15/CAN of the digits 1 to 9 is 0x059E (catalogue of parametrised CRC algorithms)."""
    bits = "".join(f"{byte:08b}" for byte in b"123456789")
    assert int(bus_load._with_crc(bits)[-15:], 2) == 0x059E


@given(frames)
def test_a_frame_lies_between_the_bounds(frame):
    """47 + 8 n bits, and at most one stuff bit in four of the 34 + 8 n that are stuffed."""
    plain = 47 + 8 * len(frame.data)
    assert plain <= frame_bits(frame) <= plain + (34 + 8 * len(frame.data) - 1) // 4


@given(frames)
def test_stuff_bits_are_what_a_receiver_takes_out(frame):
    """A second way: stuff with text, and count what was put in."""
    bits = bus_load._with_crc(bus_load._header_and_data(frame))
    stuffed = ""
    for bit in bits:
        stuffed += bit
        if stuffed[-5:] in ("00000", "11111"):
            stuffed += "1" if bit == "0" else "0"
    assert frame_bits(frame) == len(stuffed) + 13


def test_some_frames_by_hand():
    quiet = Frame(0x2AA, b"")  # 0 01010101010 0 0 0 0000 then CRC
    assert bus_load._header_and_data(quiet) == "0" + "01010101010" + "000" + "0000"
    assert bus_load._header_and_data(Frame(1 | REMOTE_FLAG, bytes(3))) == "0" + "00000000001" + "100" + "0011"
    extended = bus_load._header_and_data(Frame(0x1234_5678 | EXTENDED_FLAG, b"\xff"))
    assert extended == "0" + "10010001101" + "11" + "000101011001111000" + "0" + "00" + "0001" + "11111111"
    assert frame_bits(Frame(0, bytes(8))) > 47 + 64 + 15, "zeros need many stuff bits"


@pytest.mark.parametrize("length", range(9))
def test_a_longer_frame_takes_longer(length):
    assert frame_bits(Frame(0x2AA, b"\x55" * length)) >= 47 + 8 * length
