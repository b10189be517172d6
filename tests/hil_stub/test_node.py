"""What every board does beside its work, by itself."""

import pytest

from fsw.wire.messages import CoilBoot, CoilHeartbeat
from hil_stub.node import Node


def node(tick_hz=1, **options):
    return Node(CoilBoot, CoilHeartbeat, tick_hz, **options)


@pytest.mark.parametrize("tick_hz", [0, -1])
def test_a_rate_is_positive(tick_hz):
    with pytest.raises(ValueError, match="tick_hz must be a positive integer"):
        node(tick_hz)


@pytest.mark.interpreted
@pytest.mark.parametrize("tick_hz", [1.0, True, "1"])
def test_a_rate_is_an_integer(tick_hz):
    """Compiled, the type is checked before: a TypeError, but True is 1."""
    with pytest.raises(ValueError, match="tick_hz must be a positive integer"):
        node(tick_hz)


def test_before_the_first_tick_nothing_is_said():
    silent = node()
    assert (silent.tick, silent.boot(), silent.heartbeat()) == (None, [], [])


@pytest.mark.parametrize("crc", [0, 7])
def test_the_boot_is_told_in_the_first_tick_alone(crc, read):
    board = node(table_crc=crc) if crc else node()
    assert board.advance(1000) == 0
    assert read(board.boot()) == [CoilBoot(reason=0, version=1, table_crc=crc)]
    assert board.advance(1001) == 1
    assert board.boot() == []


def test_a_heartbeat_tells_nothing_that_it_is_not_told(read):
    board = node()
    board.advance(1000)
    assert board.heartbeat() == []
    for tick in range(1001, 1060):
        board.advance(tick)
        assert board.heartbeat() == []
    board.advance(1060)
    (beat,) = read(board.heartbeat())
    assert beat == CoilHeartbeat(state=0, rejects=0, slips=0, tick=1060, counter=0)
    assert board.heartbeat() == [], "once"
