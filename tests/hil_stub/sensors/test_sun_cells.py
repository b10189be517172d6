"""The board of the Sun cells."""

from math import inf, nan

import pytest

from fsw.wire.messages import SunBoot, SunCells, SunHeartbeat
from hil_stub.sensors.sun_cells import SunCellBoard

CURRENTS = (0.5, 0.0078125, 1.25)


def sent(board, tick, currents=CURRENTS, valid=True):
    return board.begin_tick(tick, currents, valid)


def sample(frames):
    return next(SunCells.decode(frame.data) for frame in frames if frame.can_id == SunCells.ID)


def test_boots_once_and_then_sends_a_sample_each_tick():
    board = SunCellBoard(1)
    said = [[frame.can_id for frame in sent(board, tick)] for tick in range(3)]
    assert said == [[SunBoot.ID, SunCells.ID], [SunCells.ID], [SunCells.ID]]


def test_what_is_not_there_reads_zero():
    assert sample(sent(SunCellBoard(1), 0)) == SunCells(1, 0.5, 0.0078125, 1.25, 0.0, 0.0, 0.0, counter=0)


def test_the_counter_rises():
    board = SunCellBoard(1)
    assert [sample(sent(board, tick)).counter for tick in range(20)] == [tick % 16 for tick in range(20)]


def test_beyond_the_range_it_sends_the_end():
    read = sample(sent(SunCellBoard(1), 0, (2.5, -0.1, inf)))
    assert (read.valid, read.cell_1, read.cell_2, read.cell_3) == (1, 1.9921875, 0.0, 1.9921875)


@pytest.mark.parametrize(("currents", "valid"), [((0.5, nan), True), ((0.5, 0.6), False)])
def test_what_is_not_sound_has_no_currents(currents, valid):
    read = sample(sent(SunCellBoard(1), 0, currents, valid))
    assert read.values()[:7] == (0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_tick_that_does_not_rise_is_ignored():
    board = SunCellBoard(1)
    sent(board, 5)
    assert sent(board, 5) == sent(board, 4) == []


def test_beats_every_minute():
    board = SunCellBoard(2)
    beats = [tick for tick in range(300) if any(f.can_id == SunHeartbeat.ID for f in sent(board, tick))]
    assert beats == [120, 240]


def test_has_six_inputs():
    with pytest.raises(ValueError, match="inputs for 6 cells, not 7"):
        sent(SunCellBoard(1), 0, (0.0,) * 7)
