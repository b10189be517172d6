"""Records: the 16 bytes of a frame on CAN sockets and on the loop bus."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.bus import can_frame
from fsw.wire.frame import Frame

frames = st.builds(Frame, st.integers(0, 2**32 - 1), st.binary(max_size=8))


@pytest.mark.long
@given(st.lists(frames))
def test_frames_survive_packing(sent):
    assert list(can_frame.unpack(can_frame.pack_all(sent))) == sent


def test_a_record_is_laid_out_like_a_can_frame_of_the_kernel():
    packed = can_frame.pack(Frame(0x80000123, b"\x11\x22\x33"))
    assert packed == (0x80000123).to_bytes(4, "little") + b"\x03\0\0\0" + b"\x11\x22\x33\0\0\0\0\0"


def test_nine_bytes_are_refused_not_cut():
    with pytest.raises(ValueError, match="at most 8 data bytes, not 9"):
        can_frame.pack(Frame(0x123, bytes(9)))
