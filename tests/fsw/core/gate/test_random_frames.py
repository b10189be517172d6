"""The decode gate under random frames: none is taken unless it is intact."""

from dataclasses import replace
from random import Random

import pytest
from gate_samples import admitted, taken
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.core.gate.readings import (
    INBOX_LIMIT,
    INPUT_MESSAGES,
    TELECOMMANDS,
    GateState,
    Readings,
)
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    intact,
)

pytestmark = pytest.mark.long


def random_frame(random):
    """Nearly right: listened identifiers and right lengths often, flags and nonsense now and then."""
    can_id = random.choice([*INPUT_MESSAGES, *TELECOMMANDS, *CLASSES, random.getrandbits(11)])
    if random.random() < 0.1:
        can_id |= random.choice([EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG])
    known = CLASSES.get(can_id)
    length = known.LENGTH if known is not None and random.random() < 0.8 else random.randrange(9)
    return Frame(can_id, random.randbytes(length))


def test_of_ten_thousand_random_frames_none_is_taken_unless_intact():
    random, state, kept = Random(20000), GateState(), 0
    for _ in range(10_000):
        frame = random_frame(random)
        readings, after = admitted(frame, state=state)
        accepted = [one for one in (*taken(readings), *readings.telecommands) if one is not None]
        if accepted:
            kept += 1
            assert intact(frame)
            assert accepted == [CLASSES[frame.can_id].decode(frame.data)]
            assert after.rejected == state.rejected
        elif frame.can_id in (*INPUT_MESSAGES, *TELECOMMANDS) or not intact(frame):
            assert after == replace(state, rejected=state.rejected + 1)
        state = after
    assert 0 < kept < 10_000 / 100  # a CRC of 8 bits lets one in 256 pass


@given(
    st.lists(
        st.builds(
            Frame,
            st.integers(0, 2**32 - 1) | st.sampled_from([*INPUT_MESSAGES, *TELECOMMANDS]),
            st.binary(max_size=64),
        ),
        max_size=80,
    )
)
@settings(max_examples=200, deadline=None)
def test_no_content_raises_and_every_frame_is_accounted_for(inbox):
    readings, state = admitted(*inbox)
    assert isinstance(readings, Readings)
    assert state.overrun == max(0, len(inbox) - INBOX_LIMIT)
    assert state.rejected <= len(inbox)
    assert all(-1 <= counter <= 15 for counter in state.counters)
