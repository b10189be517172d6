"""A bus that delays or breaks frames beside sound pulses: nothing trips, and the pulses go on."""

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, CoilRefused, CoilStatus, FswEvent

FLOWN_S = 400


def fires(said):
    return [m for ms in said for m in ms if isinstance(m, CoilFire)]


def events(said):
    return [m for ms in said for m in ms if isinstance(m, FswEvent)]


@pytest.fixture
def world(make_world):
    world = make_world()
    world.fly(90)
    return world


@pytest.mark.long
def test_reports_of_the_coil_driver_may_come_a_tick_late(world):
    held = []

    def late(inbox):
        statuses = [frame for frame in inbox.frames if frame.can_id == CoilStatus.ID]
        others = [frame for frame in inbox.frames if frame.can_id != CoilStatus.ID]
        before, held[:] = list(held), statuses
        return inbox.replace(frames=(*before, *others))

    said = world.fly(FLOWN_S, late)
    assert len(fires(said)) >= 3
    assert world.state.modes.trips == 0
    assert world.state.health.coils.faults == (0, 0, 0)


@pytest.mark.parametrize("noise", [b"\x11\x22\x33\x44\x55\x66\x77", b"\x00\x00\x01"], ids=["other", "short"])
def test_a_broken_frame_beside_a_request_is_not_the_request(world, noise):
    said = []
    for _ in range(FLOWN_S):
        said.append(world.step())
        if fires(said[-1:]):
            world.plant.receive(Frame(CoilFire.ID, noise))
    assert len(fires(said)) >= 3
    assert world.state.modes.trips == 0


@pytest.mark.interpreted
def test_a_request_that_is_broken_itself_is_asked_for_again(world):
    """The damaged frame is refused, and nothing is driven."""
    refused = []

    def told(inbox):
        refused.extend(frame for frame in inbox.frames if frame.can_id == CoilRefused.ID)
        return inbox

    receive = world.plant.receive
    world.plant.receive = lambda frame: receive(
        frame.replace(data=bytes([frame.data[0] ^ 0x10]) + frame.data[1:])
        if frame.can_id == CoilFire.ID
        else frame
    )
    said = world.fly(FLOWN_S, told)
    assert len(refused) == len(fires(said)) >= 3
    assert world.state.modes.trips == 0
    assert world.state.coil.fired.level == 0, "it does not count as driven"
