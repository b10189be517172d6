"""Pulses of which frames were lost, or in which ticks were skipped: no evidence against a sound coil."""

import numpy as np
import pytest
from flight_states import stepped

from fsw.core.algebra.vector import sub
from fsw.core.telemetry import Event
from fsw.wire.messages import CLASSES, CoilFire, CoilStatus, FswEvent

SETTLED = 620


def faults(said):
    return [m.argument for m in said if isinstance(m, FswEvent) and m.event == Event.COIL_FAULT]


def fly(world, ticks, coil, loses_requests, every=1):
    """All messages of so many ticks; of every so-maniest pulse of a coil the bus loses all three reports."""
    said, pulses = [], 0
    for _ in range(ticks):
        inbox, view = world.inbox(), world.state.coil
        lost = pulses and pulses % every == 0 and view.fired.coil == coil
        if lost and view.fired_tick < inbox.tick <= view.fired_tick + 3:
            frames = tuple(frame for frame in inbox.frames if frame.can_id != CoilStatus.ID)
            inbox = inbox.replace(frames=frames)
        world.state, outbox = stepped(world.state, inbox, world.config)
        for frame in outbox:
            own = frame.can_id == CoilFire.ID and CoilFire.decode(frame.data).coil == coil
            pulses += own
            if not (own and loses_requests):
                world.plant.receive(frame)
        world.plant.end_tick()
        said += [CLASSES[frame.can_id].decode(frame.data) for frame in outbox]
    return said, pulses


@pytest.mark.long
@pytest.mark.requirement("REQ-COIL-05")
def test_pulses_whose_requests_were_lost_name_nobody(make_world):
    """Nor did any report tell that nothing was driven: the filter takes them for done."""
    world = make_world()
    world.fly(SETTLED)
    said, pulses = fly(world, 700, 0, loses_requests=True)
    assert faults(said) == []
    assert pulses >= 3


@pytest.mark.long
@pytest.mark.requirement("REQ-COIL-01")
def test_a_coil_that_does_nothing_is_named_though_every_other_pulse_is_in_doubt(make_world):
    world = make_world()
    world.fly(SETTLED)
    world.plant._coils._dipole_per_ampere[0] = 0.0
    said, _ = fly(world, 1500, 0, loses_requests=False, every=2)
    assert faults(said)[:1] == [101]


@pytest.mark.long
@pytest.mark.parametrize("skipped", [1, 2, 3, 5])
def test_the_rate_is_as_uncertain_as_ticks_skipped_in_a_pulse_leave_it(make_world, skipped):
    """The pulse goes on meanwhile: the filter takes it for done, and a part of it for uncertain."""
    world = make_world()
    world.fly(SETTLED)
    while not any(isinstance(m, CoilFire) for m in world.step()):
        pass
    before = world.state.estimator.estimate.covariance[3:6, 3:6]
    lost = []
    for _ in range(skipped):
        lost += world.inbox().frames
        world.plant.end_tick()
    world.step(lambda inbox: inbox.replace(frames=(*lost, *inbox.frames)))
    world.fly(4)
    state, truth = world.state, world.plant.truth()
    assert world.state.estimator.estimate.covariance[3:6, 3:6].trace() > 4.0 * before.trace()
    off_radps = sub(state.attitude.omega_body_orbit_radps, truth.omega_body_orbit_radps)
    covariance = state.estimator.estimate.covariance[3:6, 3:6]
    assert off_radps @ np.linalg.solve(covariance, off_radps) < 16.3
