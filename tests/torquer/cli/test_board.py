"""``torquer board``: a board by hand, with the options of ``python -m hil_stub``."""

import pytest

from fsw.wire.messages import (
    CLASSES,
    CoilBoot,
    CoilDipoleStatus,
    CoilStatus,
    MagBoot,
    MagField,
    SunBoot,
    SunVector,
)

pytestmark = pytest.mark.long

BOARDS = {
    "coil": (CoilBoot, CoilStatus),
    "dipole": (CoilBoot, CoilStatus, CoilDipoleStatus),
    "magnetometer": (MagBoot, MagField),
    "sun": (SunBoot, SunVector),
}


@pytest.mark.parametrize("board", BOARDS)
def test_each_board_boots_on_the_bus_speaks_and_ends_with_ctrl_c(bus, start, board):
    node = start("board", board)
    frames = [bus.receive(120.0) for _ in BOARDS[board]]
    assert tuple(CLASSES[frame.can_id] for frame in frames) == BOARDS[board]
    node.interrupt()
    assert node.wait() == (0, f"on {bus.spec}\n")
