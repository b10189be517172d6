"""Coil faults in closed loop: named by current or by what pulses do, left out, SAFE where one is stuck."""

from dataclasses import replace
from math import acos, degrees

import pytest
from flight_states import altered
from gate_samples import measured

from fsw.core.actuation.actuator import CoilView
from fsw.core.fdir.coils.currents import judge_current
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.fdir.coils.weak_test import NOTHING_OLDER
from fsw.core.fdir.faults import CoilFault
from fsw.core.fdir.sensors.pair import Pair
from fsw.core.telemetry import Event
from fsw.wire.messages import CoilFire, CoilStatus, FswEvent, Mode, TcClear

SETTLED = 620
UNTIL_AGAIN = 3000
"""Ticks within which each coil is fired again."""


def events(said, event):
    return [
        (tick, m.argument) for tick, ms in said for m in ms if isinstance(m, FswEvent) and m.event == event
    ]


def fires(said):
    return [(tick, m.coil) for tick, ms in said for m in ms if isinstance(m, CoilFire)]


def fly(world, ticks, change=lambda inbox: inbox):
    return [(tick, world.step(change)) for tick in range(ticks)]


def current_times(coil, factor):
    """The read-back of one coil, altered as a broken wire or a reversed plug would."""

    def change(inbox):
        frames = []
        for frame in inbox.frames:
            if frame.can_id == CoilStatus.ID:
                status = CoilStatus.decode(frame.data)
                if status.level and status.coil == coil:
                    frames.append(status.replace(current_ma=round(factor * status.current_ma)).encode())
                    continue
            frames.append(frame)
        return inbox.replace(frames=tuple(frames))

    return change


def told_by_driver(**values):
    def change(inbox):
        frames = [
            CoilStatus.decode(f.data).replace(**values).encode() if f.can_id == CoilStatus.ID else f
            for f in inbox.frames
        ]
        return inbox.replace(frames=tuple(frames))

    return change


def error_deg(world):
    q, known = world.plant.truth().q_body_from_orbit, world.state.attitude.q_body_from_orbit
    cosine = abs(sum(a * b for a, b in zip(q, known, strict=True)))
    return 2.0 * degrees(acos(min(1.0, cosine)))


def conduct(plant, coil, ampere):
    """Let a coil carry this current all the time."""
    advance = plant._coils.advance

    def stuck(driven_a, on_s, step_s, held_a):
        on_a, off_a = list(driven_a), list(held_a)
        on_a[coil] = off_a[coil] = ampere
        return advance(tuple(on_a), on_s, step_s, tuple(off_a))

    plant._coils.advance = stuck


@pytest.mark.long
@pytest.mark.requirement("REQ-COIL-01", "REQ-COIL-02", "REQ-COIL-03")
@pytest.mark.parametrize(("factor", "kind"), [(0.0, 1), (0.1, 1), (0.5, 2), (-1.0, 3)])
def test_a_wrong_current_names_the_coil_at_its_second_pulse(make_world, factor, kind):
    world = make_world()
    world.fly(90)
    first = None
    said = []
    while first is None:
        said += fly(world, 1)
        first = next((coil for _, coil in fires(said)), None)
    said = fly(world, UNTIL_AGAIN, current_times(first, factor))
    ((named, argument),) = events(said, Event.COIL_FAULT)
    assert argument == 100 * (first + 1) + kind
    own = [tick for tick, coil in fires(said) if coil == first]
    assert len(own) == 1  # the first pulse went out before
    assert named == own[0] + 2
    assert world.state.health.coils.faults[first] == kind
    assert fires(said)[-1][0] > named
    assert world.state.modes.trips == 0


def teach(world, coil, error, sigma):
    """Let the filter have found this error of a coil's gain."""
    state, layout = world.state.estimator, world.config.estimator.mekf.layout
    errors, covariance = [*state.estimate.parameters.coil_error], state.estimate.covariance.copy()
    errors[4 * coil], place = error, layout.coils.start + 4 * coil
    covariance[place, :] = covariance[:, place] = 0.0
    covariance[place, place] = sigma**2
    parameters = replace(state.estimate.parameters, coil_error=tuple(errors))
    taught = replace(state.estimate, parameters=parameters, covariance=covariance, trace=None)
    world.state = altered(world.state, estimator=replace(state, estimate=taught))


@pytest.mark.long
def test_a_weak_coil_beside_an_estimate_that_is_not_proven_leaves_the_attitude(make_world):
    """The coil is judged once the estimate is proven: what the filter knows of it must not keep that away."""
    world = make_world(
        coils={"dipole_scale": [1.0, 0.4, 1.0]}, flight={"uncertainty": {"coil_gain_percent": 5.0}}
    )
    world.fly_until_valid()
    teach(world, 1, -0.6, 0.02)
    world.state.health.sensors.pair = Pair()
    world.fly(1)
    assert not world.state.attitude.valid
    assert world.fly_until_valid() < 300
    said = fly(world, 600)
    assert [argument for _, argument in events(said, Event.COIL_FAULT)] == [202]
    assert error_deg(world) < 2.0


@pytest.mark.long
def test_a_coil_that_was_mended_and_cleared_is_taken_for_sound(make_world):
    """The gain of 0.4 that it had is not what it has now: the filter would blame it once more."""
    world = make_world(flight={"uncertainty": {"coil_gain_percent": 5.0}})
    world.fly_until_valid()
    teach(world, 0, 0.01, 0.005)
    teach(world, 1, -0.6, 0.02)
    coils = world.state.health.coils
    coils.faults, coils.until_retest = (0, CoilFault.WEAK, 0), (0, 21600, 0)
    world.fly(5)
    world.step(lambda inbox: inbox.replace(frames=(*inbox.frames, TcClear(counter=1).encode())))
    errors = world.state.estimator.estimate.parameters.coil_error
    assert errors[0] == pytest.approx(0.01, abs=2e-3), "of the others nothing is forgotten"
    assert errors[4] == 0.0
    said = fly(world, 900)
    assert 1 in [coil for _, coil in fires(said)]
    assert events(said, Event.COIL_FAULT) == []
    assert world.state.attitude.valid


@pytest.mark.requirement("REQ-COIL-05")
def test_a_coil_that_was_not_fired_is_not_judged(make_world):
    """Before the first request, after one that was refused, and after a plant has started anew."""
    config = make_world().config
    pulses, health = config.coils.pulses, CoilHealth()
    off = measured(coil=CoilStatus(0, 0, 0, 0, 0, 0))
    for view in (CoilView(), CoilView(fired_tick=700)):
        for age in range(pulses.pulse_ticks + 1):
            tick = view.fired_tick + age
            judge_current(health, view, off, False, tick, config.fdir.coils)
            assert health == CoilHealth()


@pytest.mark.long
def test_a_single_wrong_current_names_nobody(make_world):
    world = make_world()
    world.fly(90)
    said = []
    while not fires(said):
        said = fly(world, 1)
    coil = fires(said)[0][1]
    assert events(fly(world, 10, current_times(coil, 0.0)), Event.COIL_FAULT) == []
    assert world.state.health.coils.nats[coil] == pytest.approx(0.5 * world.config.fdir.coils.weak.threshold)
    said = fly(world, UNTIL_AGAIN)
    assert coil in {fired for _, fired in fires(said)}
    assert events(said, Event.COIL_FAULT) == []
    assert world.state.health.coils.nats == (0.0, 0.0, 0.0)


@pytest.mark.long
@pytest.mark.requirement("REQ-COIL-05")
def test_a_coil_that_is_named_is_not_fired_before_its_time_or_until_the_ground_clears_it(make_world):
    world = make_world()
    world.fly(SETTLED)
    coils = world.state.health.coils
    coils.faults, coils.until_retest = (1, 0, 3), (2000, 0, 2000)
    said = fly(world, 900)
    assert {coil for _, coil in fires(said)} == {1}
    world.step(lambda inbox: inbox.replace(frames=(*inbox.frames, TcClear(counter=3).encode())))
    assert world.state.health.coils.faults == (0, 0, 0)
    assert {coil for _, coil in fires(fly(world, 900))} & {0, 2}


class TestStuck:
    @pytest.mark.requirement("REQ-COIL-04")
    @pytest.mark.parametrize(("coil", "ampere"), [(0, 0.4), (1, -0.4), (2, 0.4), (1, 0.05)])
    @pytest.mark.interpreted
    def test_a_coil_that_conducts_by_itself_leads_to_safe_and_its_torque_names_it(
        self, make_world, coil, ampere
    ):
        world = make_world()
        world.fly(SETTLED)
        conduct(world.plant, coil, ampere)
        said = fly(world, 240)
        ((tripped, monitor),) = events(said, Event.MONITOR_TRIPPED)
        ((named, argument),) = events(said, Event.COIL_FAULT)
        assert (monitor, argument) == (7, 100 * (coil + 1) + 4)
        assert tripped < 8
        assert named <= 150  # of fifty phases of the fault table the slowest took 145 s
        assert world.state.modes.mode is Mode.SAFE
        assert world.state.attitude.usable
        assert error_deg(world) < 4.0
        assert events(said, Event.FILTER_RESTARTED) == []

    @pytest.mark.parametrize(
        ("coils", "matrix", "coil", "ampere"),
        [
            ({"wiring": [1, -2, 3]}, [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], 0, 0.3),
            ({"wiring": [1, -2, 3]}, [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], 1, -0.3),
            ({"dipole_scale": [1.0, 1.0, 2.5]}, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.5]], 2, 0.3),
        ],
        ids=["beside an output of the other sense", "of an output of the other sense", "with another gain"],
    )
    @pytest.mark.interpreted
    def test_it_is_named_by_what_the_calibration_has_of_it(self, make_world, coils, matrix, coil, ampere):
        world = make_world(coils=coils, flight={"calibration": {"coils": {"matrix": matrix}}})
        world.fly(SETTLED)
        conduct(world.plant, coil, ampere)
        assert [argument for _, argument in events(fly(world, 120), Event.COIL_FAULT)] == [
            100 * (coil + 1) + 4
        ]
        assert world.state.attitude.valid
        assert error_deg(world) < 4.0

    @pytest.mark.interpreted
    def test_until_then_no_attitude_is_called_valid_and_after_it_the_current_is_reckoned_with(
        self, make_world
    ):
        world = make_world()
        world.fly(SETTLED)
        while world.state.coil.idle_ticks != 5:  # after a pulse
            world.fly(1)
        conduct(world.plant, 2, -0.4)
        valid = []
        while not any(world.state.health.coils.faults):
            valid.append(world.state.attitude.valid)
            world.fly(1)
        stuck_ticks = world.config.fdir.coils.stuck_ticks
        assert valid == [True] * (stuck_ticks + 1) + [False] * (len(valid) - stuck_ticks - 1)
        world.fly(400)
        assert world.state.attitude.valid
        assert error_deg(world) < 4.0

    @pytest.mark.requirement("REQ-COIL-04", "REQ-COIL-05")
    @pytest.mark.interpreted
    def test_it_is_named_too_if_it_begins_in_the_pulse_of_another(self, make_world):
        world = make_world()
        world.fly(SETTLED)
        while not world.state.coil.driven_level:
            world.fly(1)
        coil = (world.state.coil.fired.coil + 1) % 3
        conduct(world.plant, coil, 0.4)
        assert [argument for _, argument in events(fly(world, 240), Event.COIL_FAULT)] == [
            100 * (coil + 1) + 4
        ]

    @pytest.mark.long
    @pytest.mark.requirement("REQ-COIL-04")
    @pytest.mark.parametrize("flown", [90, 106, 700], ids=["before any pulse", "after one", "settled"])
    def test_a_current_that_turns_nothing_leads_to_safe_and_names_nobody(self, make_world, flown):
        world = make_world()
        world.fly(flown)
        said = fly(world, 120, told_by_driver(level=0, current_ma=400))
        ((tripped, monitor),) = events(said, Event.MONITOR_TRIPPED)
        assert (tripped, monitor) == (world.config.fdir.coils.stuck_ticks - 1, 7)
        assert events(said, Event.COIL_FAULT) == []
        assert world.state.modes.mode is Mode.SAFE
        assert not world.state.attitude.valid

    @pytest.mark.requirement("REQ-COIL-04")
    def test_a_level_that_nobody_asked_for_trips_in_its_second_tick_and_is_named_when_it_lasts(
        self, make_world
    ):
        world = make_world()
        world.fly(90)
        said = fly(world, 60, told_by_driver(level=2, coil=1, current_ma=100))
        assert events(said, Event.MONITOR_TRIPPED) == [(1, 7)]
        assert events(said, Event.COIL_FAULT) == [(world.config.fdir.coils.stuck_ticks - 1, 204)]
        assert world.state.modes.mode is Mode.SAFE

    def test_it_stays_safe_while_it_lasts_and_not_for_ever(self, make_world):
        world = make_world()
        world.fly(90)
        fly(world, 200, told_by_driver(level=0, current_ma=-30))
        assert world.state.modes.mode is Mode.SAFE
        fly(world, 20)
        assert world.state.modes.mode is not Mode.SAFE
        assert world.state.modes.trips == 1

    def test_the_rest_of_a_pulse_of_an_earlier_boot_is_not_a_stuck_driver(self, make_world):
        world = make_world()
        world.fly(30)
        said = fly(world, 3, told_by_driver(level=3, coil=2, current_ma=400))
        said += fly(world, 60)
        assert events(said, Event.COIL_FAULT) == []

    def test_a_current_that_decays_is_not_stuck(self, make_world):
        world = make_world()
        world.fly(90)
        said = []
        for _ in range(20):
            said += fly(world, 2, told_by_driver(level=0, current_ma=60))
            said += fly(world, 2)
        assert events(said, Event.COIL_FAULT) == events(said, Event.MONITOR_TRIPPED) == []


class TestByTheRate:
    """The current is right, the torque is not: turns shorted, or a plug turned round behind the shunt."""

    @pytest.mark.long
    @pytest.mark.requirement("REQ-COIL-01", "REQ-COIL-03")
    @pytest.mark.parametrize(("scale", "named"), [(-1.0, 103), (0.0, 101), (0.3, 102)])
    def test_the_coil_is_named_and_the_estimate_set_right(self, make_world, scale, named):
        world = make_world()
        world.fly(SETTLED)
        world.plant._coils._dipole_per_ampere[0] *= scale
        said = fly(world, 900)
        ((tick, argument),) = events(said, Event.COIL_FAULT)
        assert argument == named
        assert len([t for t, coil in fires(said) if coil == 0 and t < tick]) <= 3
        assert events(said, Event.SENSOR_ISOLATED) == events(said, Event.FILTER_RESTARTED) == []
        assert error_deg(world) < 1.0

    @pytest.mark.long
    @pytest.mark.parametrize("seed", [2, 5])
    def test_what_a_pulse_showed_is_kept_when_the_next_takes_its_place(self, make_world, seed):
        """Three pulses of a coil are traced: the fourth replaces the first, which showed something."""
        world = make_world(seed=seed)
        world.fly(SETTLED)
        world.plant._coils._dipole_per_ampere[0] *= 0.65
        own = 0
        while own < 4:
            assert world.state.health.coils.older[0] == NOTHING_OLDER
            own += sum(coil == 0 for _, coil in fires(fly(world, 1)))
        fly(world, world.config.coils.pulses.pulse_ticks)
        weak = world.config.fdir.coils.weak
        first, *others = [older.nats(weak) for older in world.state.health.coils.older]
        assert 1.0 < first < 0.5 * weak.threshold
        assert max(others) < 0.1 * first

    @pytest.mark.long
    @pytest.mark.requirement("REQ-COIL-05")
    def test_sound_coils_are_not(self, make_world):
        world = make_world(seed=5)
        said = fly(world, 3000)
        assert len(fires(said)) > 15
        assert events(said, Event.COIL_FAULT) == []
        assert set(world.state.estimator.estimate.trace.numbers) == {0, 1, 2}
