"""Frames as python-can's messages, and back."""

from hypothesis import given
from hypothesis import strategies as st

from fsw.bus.can_message import frame_of, message_of
from fsw.wire.frame import Frame

standard_ids = st.integers(0, 0x7FF)
data = st.binary(max_size=8)
frames = st.one_of(
    st.builds(Frame, standard_ids, data),
    st.builds(Frame, standard_ids.map(0x4000_0000.__or__), st.integers(0, 8).map(bytes)),
    st.builds(Frame, st.integers(0x8000_0000, 0x9FFF_FFFF), data),
    st.builds(Frame, st.integers(0xC000_0000, 0xDFFF_FFFF), st.integers(0, 8).map(bytes)),
    st.builds(Frame, st.integers(0x2000_0000, 0x2000_07FF), st.just(bytes(8))),
)


@given(frames)
def test_a_frame_survives_the_way_through_a_message(frame):
    assert frame_of(message_of(frame)) == frame


def test_a_message_bears_what_python_can_users_expect():
    message = message_of(Frame(0x9234_5678, b"\x01\x02"), 12.5, "loop")
    assert (message.arbitration_id, message.is_extended_id, message.timestamp) == (0x1234_5678, True, 12.5)
    assert (message.channel, message.dlc, bytes(message.data), message.is_rx) == (
        "loop",
        2,
        b"\x01\x02",
        True,
    )
    remote = message_of(Frame(0x4000_0123, bytes(5)))
    assert (remote.is_remote_frame, remote.dlc, bytes(remote.data)) == (True, 5, b"")
