"""Telecommands in the flight loop: acknowledged in the answer to their tick, and never beyond the limits."""

from collections import Counter
from dataclasses import replace
from random import Random

import pytest
from flight_states import altered

from fsw.core.commands import LAW_NAMES
from fsw.core.estimation import estimator
from fsw.core.estimation.parameters import component_places
from fsw.core.gate.readings import TELECOMMANDS
from fsw.core.modes import ModeState
from fsw.core.orbit.ephemeris import advance, with_orbit
from fsw.core.state_bytes import checksum
from fsw.wire.messages import (
    CoilFire,
    CoilRefused,
    Component,
    Element,
    FswEvent,
    Mode,
    NavParameter,
    NavQuality,
    TcAck,
    TcAckResult,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
    TickDone,
)


def with_telecommands(*messages):
    frames = tuple(message.encode() for message in messages)
    return lambda inbox: inbox.replace(frames=(*frames, *inbox.frames))


def of(kind, messages):
    return [message for message in messages if type(message) is kind]


class TestInTheLoop:
    def test_the_answer_to_the_tick_tells_before_it_is_done(self, make_world):
        world = make_world()
        world.fly(5)
        replies = world.step(with_telecommands(TcSpin(2**-7, 3), TcMode(7, 4)))
        assert of(TcAck, replies) == [
            TcAck(TcAckResult.ACCEPTED, TcSpin.ID, 3, 5, counter=0),
            TcAck(TcAckResult.UNKNOWN, TcMode.ID, 4, 5, counter=1),
        ]
        assert type(replies[-1]) is TickDone
        assert world.state.setpoint.spin_radps == 2**-7
        assert of(TcAck, world.step()) == []

    def test_a_broken_one_has_no_answer_and_no_effect(self, make_world):
        world, other = make_world(), make_world()
        frame = TcMode(Mode.SAFE).encode()
        broken = frame.replace(data=bytes((frame.data[0] ^ 0x20,)) + frame.data[1:])
        replies = world.step(lambda inbox: inbox.replace(frames=(broken, *inbox.frames)))
        assert of(TcAck, replies) == []
        other.step()
        expected = altered(other.state, gate=replace(other.state.gate, rejected=1))
        assert checksum(world.state) == checksum(expected)

    def test_a_safe_that_the_ground_asked_for_lasts_until_it_asks_for_more(self, make_world):
        world = make_world()
        world.fly(60)
        assert world.state.modes.mode is not Mode.SAFE
        replies = world.step(with_telecommands(TcMode(Mode.SAFE)))
        assert [(e.event, e.argument) for e in of(FswEvent, replies)] == [(1, Mode.SAFE)]
        quiet = [message for replies in world.fly(150) for message in replies]
        assert of(CoilFire, quiet) == []
        assert {quality.mode for quality in of(NavQuality, quiet)} == {Mode.SAFE}
        replies = world.step(with_telecommands(TcMode(Mode.DETUMBLE, 1)))
        assert of(CoilFire, replies)  # the coils have long been ready, and the same tick obeys
        assert world.state.modes.mode is Mode.DETUMBLE

    def test_trips_that_keep_it_safe_are_forgotten_by_the_ground(self, make_world, without):
        world = make_world()
        world.fly(10)
        stuck = ModeState(Mode.SAFE, trips=world.config.modes.trips_to_stay_safe)
        world.state = altered(world.state, modes=stuck)
        world.fly(30)
        assert world.state.modes.mode is Mode.SAFE
        replies = world.step(with_telecommands(TcClear()))
        assert of(FswEvent, replies) == []
        world.fly(30)
        assert world.state.modes.mode is not Mode.SAFE

    def test_an_orbit_is_flown_from_the_next_tick_on(self, make_world, elements):
        world, other = make_world(), make_world()
        for one in (world, other):
            one.fly(25)
        turned = elements(raan_deg=(374208, -4))
        replies = world.step(with_telecommands(*turned, TcOrbitLoad()))
        other.step()
        assert [ack.result for ack in of(TcAck, replies)] == [TcAckResult.ACCEPTED] * 10
        assert world.state.attitude == other.state.attitude
        model = with_orbit(world.config.ephemeris, world.state.orbit)
        for _ in range(60):
            world.step()
            other.step()
            assert world.state.ephemeris == advance(None, world.state.tick, model)
        assert world.state.attitude != other.state.attitude

    def test_telecommands_beyond_what_the_gate_looks_at_are_counted_as_unread(self, make_world):
        world = make_world()
        replies = world.step(with_telecommands(*(TcClear(n & 0xF) for n in range(80))))
        assert len(of(TcAck, replies)) == 64
        assert world.state.gate.overrun > 0


MATCHED = {
    "sensors": {
        "magnetometer": {"misalignment_deg": [0.0, 0.0, 0.0]},
        "sun": {"misalignment_deg": [0.0, 0.0, 0.0]},
    },
    "disturbance": {"residual_dipole_am2": [0.0, 0.0, 0.0]},
    "flight": {
        "uncertainty": {
            "residual_dipole_am2": 0.0,
            "magnetometer_misalignment_deg": 0.0,
            "sun_misalignment_deg": 0.0,
        }
    },
}
"""As the table says, but for bias and torque, which the filter estimates."""
BIAS_NT, TORQUE_NM = (150.0, -250.0, 100.0), (3e-8, -2e-8, 1e-8)
"""The plant's."""


def deviation(state, config):
    """By component that is carried, its standard deviation."""
    variances = state.estimator.estimate.covariance.diagonal()
    return {
        number: float(variances[place]) ** 0.5
        for number, place in component_places(config.estimator.mekf.layout).items()
    }


@pytest.fixture(scope="class")
def frozen_flight(make_world):
    """Bias and torque loaded wrong and frozen for twenty minutes, then estimated for half an hour.

    They are wrong by less than two deviations: by more, what is measured would dispute the sensors.
    Returns the world, the states while frozen, and the messages of that time.
    """
    world = make_world(**MATCHED)
    world.fly(300)
    bias, torque = TcParameter(Component.MAG_BIAS_X, -9, 700, 0), TcParameter(Component.TORQUE_Y, -9, 60, 1)
    replies = world.step(with_telecommands(bias, torque, TcFreeze(1)))
    assert [ack.result for ack in of(TcAck, replies)] == [TcAckResult.ACCEPTED] * 3
    states, messages = [world.state], []
    for _ in range(1200):
        messages += world.step()
        states.append(world.state)
    world.step(with_telecommands(TcFreeze(0, 1)))
    world.fly(1800)
    return world, states, messages


class TestFrozenParameters:
    @pytest.mark.long
    def test_keep_their_values_while_attitude_and_rate_are_estimated(self, frozen_flight):
        _, states, _ = frozen_flight
        first, last = states[0].estimator.estimate, states[-1].estimator.estimate
        assert all(state.estimator.estimate.parameters == first.parameters for state in states)
        assert (first.parameters.mag_bias_t[0], first.parameters.torque_body_nm[1]) == (7e-7, 6e-8)
        assert last.q_body_from_eci != first.q_body_from_eci
        assert states[-1].estimator.restarts == 0

    @pytest.mark.long
    def test_deviations_stay_but_for_the_walk(self, frozen_flight):
        world, states, _ = frozen_flight
        first, last = deviation(states[0], world.config), deviation(states[-1], world.config)
        for number in first:
            assert first[number] < last[number] < 1.01 * first[number] + 1e-9

    @pytest.mark.long
    def test_are_reported_as_they_were_loaded(self, frozen_flight):
        _, _, messages = frozen_flight
        reported = {(m.component, m.exponent, m.value) for m in of(NavParameter, messages)}
        loaded = {(m, e, v) for m, e, v in reported if m in (Component.MAG_BIAS_X, Component.TORQUE_Y)}
        assert loaded == {(Component.MAG_BIAS_X, -11, 70000), (Component.TORQUE_Y, -11, 6000)}
        assert len(of(NavParameter, messages)) == 120
        assert {number for number, _, _ in reported} == set(range(6))

    def test_after_it_the_estimate_converges(self, frozen_flight):
        world, states, _ = frozen_flight
        found, sigma = world.state.estimator.estimate.parameters, deviation(world.state, world.config)
        before = deviation(states[-1], world.config)
        true = [*(1e-9 * bias for bias in BIAS_NT), *TORQUE_NM]
        for number, (value, wanted) in enumerate(
            zip([*found.mag_bias_t, *found.torque_body_nm], true, strict=True)
        ):
            assert abs(value - wanted) < 3.5 * sigma[number]
        assert sigma[Component.MAG_BIAS_X] < 0.1 * before[Component.MAG_BIAS_X]
        assert sigma[Component.TORQUE_Y] < 0.1 * before[Component.TORQUE_Y]

    def test_a_loaded_value_outlasts_modes_and_a_restart_of_the_filter(self, make_world, without):
        world = make_world(**MATCHED)
        world.fly(120)
        world.step(with_telecommands(TcParameter(Component.MAG_BIAS_X, -9, 170), TcMode(Mode.SAFE)))
        estimator.restart(world.state.estimator)
        while world.state.estimator.estimate is None:
            world.step()
        assert world.state.estimator.estimate.parameters.mag_bias_t == (1.7e-7, 0.0, 0.0)
        sigma = deviation(world.state, world.config)
        assert sigma[Component.MAG_BIAS_X] == sigma[Component.MAG_BIAS_Y] == pytest.approx(5e-7 / 3**0.5)


def random_telecommand(random, counter, digits):
    """Intact, its values anything; now and then the sensible ones."""
    kind = random.choice([*TELECOMMANDS.values()])
    message = kind.decode(random.randbytes(kind.LENGTH)).replace(counter=counter)
    if kind is TcOrbitElement and random.random() < 0.7:
        element = random.choice([*Element])
        mantissa, exponent = digits[element]
        message = TcOrbitElement(element, exponent, mantissa + random.randrange(-3, 4), counter)
    if kind is TcLaw and random.random() < 0.9:
        message = TcLaw(random.choice([*LAW_NAMES]), counter)
    if kind is TcParameter and random.random() < 0.7:
        value = random.randrange(-(2**31), 2**31)
        message = TcParameter(random.randrange(6), random.choice([-15, -17, -18]), value, counter)
    if kind is TcGain and random.random() < 0.5:
        message = TcGain(random.randrange(3), random.randrange(-3, 5), random.randrange(2**20), counter)
    return message


@pytest.mark.long
@pytest.mark.parametrize(
    ("seed", "settings"),
    [
        (1, {}),
        (2, {}),
        (3, {"knowledge": "perfect"}),
        (4, {"knowledge": "perfect", "coils": {"backoff": "per_coil"}}),
        (5, {"coils": {"driver": "continuous", "max_dipole_am2": 0.2}}),
    ],
)
def test_whatever_the_ground_sends_the_limits_are_kept(make_world, digits, seed, settings):
    """Five hundred ticks of random telecommands against the boards' own interlock."""
    world, random = make_world(seed=seed, **settings), Random(seed)
    counters, answers, refusals, fires = Counter(), Counter(), 0, 0
    for _ in range(500):
        sent = []
        for _ in range(random.choice([0, 0, 1, 2, 12])):
            message = random_telecommand(random, 0, digits)
            counters[message.ID] += 1
            sent.append(message.replace(counter=counters[message.ID] & 0xF))

        def reports(inbox, sent=sent):
            nonlocal refusals
            refusals += any(frame.can_id == CoilRefused.ID for frame in inbox.frames)
            return with_telecommands(*sent)(inbox)

        replies = world.step(reports)
        acks = of(TcAck, replies)
        assert [(ack.command, ack.command_counter) for ack in acks] == [(m.ID, m.counter) for m in sent]
        answers.update(TcAckResult(ack.result) for ack in acks)
        fires += len(of(CoilFire, replies))
        assert world.state.modes.mode is not Mode.SAFE or not of(CoilFire, replies)
        for fire in of(CoilFire, replies):
            assert fire.duration_ms == 3000
            assert 1 <= abs(fire.level) <= 3
    assert refusals == 0
    assert fires > 0 or "driver" in settings.get("coils", {})
    assert set(answers) | {TcAckResult.NOT_ALLOWED} == {*TcAckResult} - {TcAckResult.REPEATED}
