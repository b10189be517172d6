"""A coil that was isolated is tried again: what has passed is believed, what has not, one pulse finds."""

from dataclasses import replace

import pytest
from changed import changed

from fsw.core.estimation.loaded import load
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.fdir.coils.retest import GAINS, TRIED, retest
from fsw.core.fdir.coils.weak_test import NOTHING_OLDER, Older
from fsw.core.fdir.faults import CoilFault
from fsw.core.telemetry import Event
from fsw.wire.messages import CoilFire, CoilStatus, FswEvent

SETTLED, AGAIN_S = 620, 400.0


@pytest.fixture
def world(make_world):
    world = make_world(flight={"fdir": {"coil_retest_s": AGAIN_S}})
    world.fly(SETTLED)
    return world


def isolate(world, *faults, until=(0, 0, 0)):
    coils = world.state.health.coils
    coils.faults, coils.until_retest = faults, until


def without_current(coil):
    def change(inbox):
        frames = []
        for frame in inbox.frames:
            told = CoilStatus.decode(frame.data) if frame.can_id == CoilStatus.ID else None
            cut = told is not None and told.coil == coil and told.level
            frames.append(told.replace(current_ma=0).encode() if cut else frame)
        return inbox.replace(frames=tuple(frames))

    return change


def fly(world, ticks, change=lambda inbox: inbox):
    said = [(tick, message) for tick in range(ticks) for message in world.step(change)]
    events = [(m.event, m.argument) for _, m in said if isinstance(m, FswEvent)]
    return events, [tick for tick, m in said if isinstance(m, CoilFire) and m.coil == 1]


@pytest.mark.requirement("REQ-COIL-06")
class TestInFlight:
    @pytest.mark.long
    def test_a_coil_whose_fault_has_passed_is_used_again(self, world):
        isolate(world, 0, CoilFault.OPEN, 0, until=(0, int(AGAIN_S), 0))
        events, fired = fly(world, 3000)
        assert events.count((Event.COIL_READMITTED, 201)) == 1
        assert Event.COIL_FAULT not in dict(events)
        assert fired[0] >= AGAIN_S - 1
        assert len(fired) > 3
        assert world.state.health.coils.faults == (0, 0, 0)
        assert world.state.health.coils.nats[1] == 0.0

    @pytest.mark.long
    def test_one_that_is_still_faulty_costs_one_pulse_each_time(self, world):
        isolate(world, 0, CoilFault.OPEN, 0, until=(0, int(AGAIN_S), 0))
        events, fired = fly(world, 3000, without_current(1))
        again = events.count((Event.COIL_READMITTED, 201))
        assert again >= 2
        assert len(fired) == again
        assert events.count((Event.COIL_FAULT, 201)) >= again - 1

    @pytest.mark.long
    def test_one_whose_pulses_do_too_little_takes_two_small_ones_at_most(self, make_world):
        """Its current is right; of an unknown coil four such pulses are needed."""
        world = make_world(
            coils={"dipole_scale": [1.0, 0.2, 1.0]}, flight={"fdir": {"coil_retest_s": AGAIN_S}}
        )
        world.fly(260)
        isolate(world, 0, CoilFault.WEAK, 0, until=(0, int(AGAIN_S), 0))
        events, fired = fly(world, 1500)
        readmitted, named = events
        assert readmitted == (Event.COIL_READMITTED, 202)
        assert named in ((Event.COIL_FAULT, 201), (Event.COIL_FAULT, 202))  # a fifth is near to either
        assert 1 <= len(fired) <= 2

    @pytest.mark.long
    def test_one_that_conducts_by_itself_is_not_tried(self, world):
        isolate(world, 0, CoilFault.STUCK, 0, until=(0, 5, 0))
        events, fired = fly(world, 600)
        assert (events, fired) == ([], [])
        assert world.state.health.coils.faults == (0, CoilFault.STUCK, 0)


@pytest.mark.long
class TestTime:
    @pytest.fixture
    def config(self, world):
        return world.config.fdir.coils

    def test_it_is_the_one_of_the_table_in_ticks(self, config):
        assert config.retest_ticks == AGAIN_S

    @pytest.mark.parametrize("fault", TRIED)
    def test_the_coil_comes_back_when_it_is_over_and_half_of_the_evidence_stays(self, world, config, fault):
        health, estimator = CoilHealth((0, 0, fault), until_retest=(7, 9, 2)), world.state.estimator
        before = estimator.copy()
        retest(health, estimator, True, config)
        assert (health.faults, health.until_retest, estimator) == ((0, 0, fault), (6, 8, 1), before)
        retest(health, estimator, True, config)
        half = (0.0, 0.0, 0.5 * config.weak.threshold)
        older = (NOTHING_OLDER, NOTHING_OLDER, Older(kept=0.5 * config.weak.threshold))
        assert (health.faults, health.nats, health.older) == ((0, 0, 0), half, older)
        assert estimator.estimate.trace is None

    def test_not_while_the_estimate_could_not_tell(self, world, config):
        health = CoilHealth((CoilFault.WEAK, 0, 0))
        retest(health, world.state.estimator, False, config)
        assert health == CoilHealth((CoilFault.WEAK, 0, 0))


@pytest.mark.long
def test_what_the_filter_has_learnt_of_its_gain_is_forgotten(make_world):
    world = make_world(flight={"uncertainty": {"coil_gain_percent": 5.0}})
    world.fly(SETTLED)
    config, state = world.config.fdir.coils, world.state.estimator
    place = config.mekf.layout.coils.start
    errors = (0.01, 0.0, 0.0, 0.0, -0.4, 0.0, 0.0, 0.0, 0.02)
    parameters = replace(state.estimate.parameters, coil_error=errors)
    learnt = replace(state, estimate=replace(state.estimate, parameters=parameters))
    after = learnt.copy()
    retest(CoilHealth((0, CoilFault.WEAK, 0)), after, True, config)
    assert after.estimate.parameters.coil_error == (0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.02)
    variances = after.estimate.covariance.diagonal()[place : place + 9 : 4]
    prior = config.mekf.initial_covariance[place + 4, place + 4]
    assert variances[1] == prior
    assert variances[0] < prior
    assert after.first is None, "the next start is that of any filter"
    given = changed(learnt, load, GAINS[1], 0.03, config.mekf)
    again = given.copy()
    retest(CoilHealth((0, CoilFault.WEAK, 0)), again, True, config)
    assert again.estimate.parameters.coil_error[4] == 0.03, "what the ground has set stays"
    assert (again.first, again.loaded) == (given.first, (GAINS[1],))
    kept = replace(learnt, frozen=True)
    retest(CoilHealth((0, CoilFault.WEAK, 0)), kept, True, config)
    assert kept.estimate.parameters.coil_error == errors
    assert len(set(GAINS)) == 3
