"""The offset of the read-back: a current of coils that are off, which is none."""

from dataclasses import replace

import pytest
from flight_states import altered
from gate_samples import measured

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.read_back import ReadBackConfig, remove_offset
from fsw.core.gate.measurements import CoilReport
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.state_bytes import checksum
from fsw.wire.messages import CoilStatus

CONFIG = ReadBackConfig(off_ma=2.5, died_away_ticks=5)
TICK = 1000
FIRED = CoilView(fired_tick=TICK, fired=Pulse(1, -3))


def left(current_ma, tick=TICK + 5, level=0, view=FIRED):
    readings = measured(coil=CoilStatus(level, 1, 0, current_ma, 0, 7))
    remove_offset(readings, view, tick, CONFIG)
    assert readings.coil == CoilReport(level, 1, 0, readings.coil.current_ma, 0, 7)
    return readings.coil.current_ma


@pytest.mark.parametrize(("current_ma", "kept"), [(0, 0), (1, 0), (-2, 0), (3, 3), (-3, -3), (400, 400)])
def test_what_a_board_may_read_of_coils_that_are_off_is_no_current(current_ma, kept):
    assert left(current_ma) == kept
    assert left(current_ma, tick=3, view=CoilView()) == kept, "before the first request"


def test_the_current_of_a_driven_coil_stays():
    assert left(2, level=-3) == 2


def test_a_current_that_dies_away_stays():
    assert [left(2, tick=TICK + after) for after in range(6)] == [2, 2, 2, 2, 2, 0]
    assert left(2, view=replace(FIRED, driven_level=1)) == 2, "in the tick after one in which it was driven"


def test_without_a_report_there_is_nothing_to_leave_out():
    nothing = measured()
    remove_offset(nothing, FIRED, TICK, CONFIG)
    assert nothing.coil is None


def test_what_is_flown_with_an_offset_is_what_is_flown_without(make_world):
    """Until the first pulse, but for what the gate keeps of the frames; 1 mA of 25 mA at level 1."""

    def shifted(inbox):
        return inbox.replace(frames=tuple(map(with_offset, inbox.frames)))

    sound, other = make_world(), make_world()
    sound.fly(95)
    other.fly(95, shifted)
    assert sound.state.estimator.estimate is not None
    assert checksum(altered(other.state, gate=sound.state.gate)) == checksum(sound.state)


def with_offset(frame):
    if frame.can_id != CoilStatus.ID:
        return frame
    status = CoilStatus.decode(frame.data)
    return status.replace(current_ma=status.current_ma + 1).encode()
