"""The boards of this plant against the examples of docs/icd.md, which needs no Basilisk."""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest

spec = spec_from_file_location("basilisk_plant_boards", Path(__file__).with_name("boards.py"))
boards = module_from_spec(spec)
sys.modules[spec.name] = boards
spec.loader.exec_module(boards)


def request(tick, *, coil=1, level=-2, seq=7, duration_ms=3000):
    """A COIL_FIRE as the flight software would send it."""
    signals = ((4, 4, level), (8, 2, coil), (16, 8, seq), (24, 8, tick), (32, 16, duration_ms))
    return boards.encode(boards.COIL_FIRE, 7, 5, *signals)


def status(frames):
    """Level, coil, remaining_ms, lockout_ms and seq of the one COIL_STATUS."""
    (data,) = [frame.data for frame in frames if frame.can_id == boards.COIL_STATUS]
    bits = boards.unsigned
    return boards.signed(data, 4, 4), bits(data, 8, 2), bits(data, 10, 12), 10 * bits(data, 34, 14), data[6]


def flown(tick_hz, requested, ticks):
    """The status by tick of a board that gets these requests, by tick."""
    board, found = boards.CoilBoard(tick_hz, 3000, 100_000), {}
    for tick in range(ticks):
        board.enter(tick)
        found[tick] = board.frames(0)
        for frame in requested.get(tick, ()):
            board.receive(frame)
    return found


def test_the_worked_example_of_the_crc():
    assert request(100).data.hex().upper() == "E5010764B80B86"


def test_a_pulse_of_three_seconds():
    found = flown(1, {100: [request(100)]}, 205)
    assert {tick: status(found[tick]) for tick in (101, 102, 103, 104, 105, 106, 200, 202, 203)} == {
        101: (-2, 1, 2000, 102000, 7),
        102: (-2, 1, 1000, 101000, 7),
        103: (-2, 1, 0, 100000, 7),
        104: (0, 2, 0, 99000, 7),
        105: (0, 0, 0, 98000, 7),
        106: (0, 1, 0, 97000, 7),
        200: (0, 2, 0, 3000, 7),
        202: (0, 1, 0, 1000, 7),
        203: (0, 2, 0, 0, 7),
    }


def test_a_pulse_that_ends_within_a_tick():
    found = flown(2, {200: [request(200, duration_ms=2250)]}, 407)
    assert {tick: status(found[tick]) for tick in (201, 204, 205, 206, 400, 405, 406)} == {
        201: (-2, 1, 1750, 101750, 7),
        204: (-2, 1, 250, 100250, 7),
        205: (-2, 1, 0, 99750, 7),
        206: (0, 2, 0, 99250, 7),
        400: (0, 1, 0, 2250, 7),
        405: (0, 0, 0, 0, 7),
        406: (0, 1, 0, 0, 7),
    }


@pytest.mark.parametrize(
    ("tick", "frame", "reason"),
    [
        (99, request(99), 8),
        (100, request(99), 2),
        (100, request(100, coil=3), 4),
        (100, request(100, level=0), 5),
        (100, request(100, level=4), 5),
        (100, request(100, duration_ms=3001), 6),
        (100, request(100, duration_ms=0), 6),
        (100, boards.Frame(boards.COIL_FIRE, request(100).data[:-1] + b"\0"), 1),
    ],
)
def test_a_request_that_is_refused(tick, frame, reason):
    found = flown(1, {tick: [frame]}, tick + 2)[tick + 1]
    (refused,) = [frame for frame in found if frame.can_id == boards.COIL_REFUSED]
    assert (refused.data[2], refused.data[3]) == (reason, tick)
    assert status(found)[0] == 0


def test_a_second_request_is_refused_while_a_coil_is_on_and_a_repeated_one_before_that():
    found = flown(1, {100: [request(100)], 101: [request(101, seq=8), request(101)]}, 103)[102]
    assert [frame.data[2] for frame in found if frame.can_id == boards.COIL_REFUSED] == [7, 3]
    assert status(found) == (-2, 1, 1000, 101000, 7)


@pytest.mark.parametrize(("vector", "valid"), [((2e-5, -4e-5, 0.0), 1), ((7e-5, 0.0, 0.0), 0)])
def test_a_sample_beyond_its_range_is_not_valid(vector, valid):
    board = boards.SensorBoard(boards.MAG_FIELD, boards.MAG_BOOT, boards.MAG_HEARTBEAT, 2e-9, 1)
    booted, sample = board.begin_tick(0, vector, True)
    assert booted == boards.boot(boards.MAG_BOOT)
    assert boards.unsigned(sample.data, 4, 1) == valid
    assert [boards.signed(sample.data, first, 16) for first in (8, 24, 40)] == (
        [10_000, -20_000, 0] if valid else [0, 0, 0]
    )
