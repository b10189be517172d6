"""The digest of a flight in memory is that of its log; one bit of one frame changes it."""

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, MagField
from sim.campaign.frame_digest import FrameDigest, digest_of
from sim.record import run_dir

FIRE = CoilFire(coil=1, level=-2, duration_ms=3000, seq=7, tick=9).encode()
FIELD = MagField(b_x=1.0, b_y=2.0, b_z=3.0, valid=1).encode()


def digest(*ticks):
    found = FrameDigest()
    for frames in ticks:
        found.take(frames)
    return found


def test_frames_count_in_their_order_and_not_by_tick():
    whole = digest([FIELD, FIRE])
    assert whole.frames == digest([FIELD], [FIRE]).frames
    assert whole.frames != digest([FIRE, FIELD]).frames


def test_a_sensor_frame_changes_all_but_not_the_commands():
    other = Frame(FIELD.can_id, FIELD.data[:-1] + bytes([FIELD.data[-1] ^ 1]))
    before, after = digest([FIELD, FIRE]), digest([other, FIRE])
    assert before.frames != after.frames
    assert before.commands == after.commands != digest([FIELD]).commands


def test_that_of_a_log_is_that_of_its_frames(recorded_run):
    log = recorded_run / run_dir.BUS_LOG
    found = digest_of(log)
    assert found.frames != digest().frames
    assert found.commands != digest().commands
    assert digest_of(log).frames == found.frames
