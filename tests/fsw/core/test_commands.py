"""Telecommands: each is carried out whole or refused whole, and acknowledged once."""

from dataclasses import replace
from math import dist

import pytest
from batch_samples import search_under_way
from flight_states import altered
from gate_samples import measured

from fsw.core.commands import HANDLERS, LAW_NAMES, command, decimal
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.fdir.fdir import Health
from fsw.core.fdir.sensors.health import SensorHealth, Watch
from fsw.core.gate.readings import TELECOMMANDS
from fsw.core.laws.interface import OwnLaw, Wheel
from fsw.core.laws.table import LAWS, OWN_NUMBER
from fsw.core.modes import ModeState
from fsw.core.monitors import Monitor
from fsw.core.orbit.elements import RANGES, Elements, Upload
from fsw.core.orbit.ephemeris import advance, with_orbit
from fsw.core.orbit.propagation import element_orbit, sgp4_orbit, state_eci
from fsw.core.packing import pack
from fsw.core.state_bytes import checksum
from fsw.wire.messages import (
    Component,
    Element,
    Gain,
    Mode,
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
)

TICK = 40
WHEEL = Wheel((0.0, 0.0, 1.0), 1e-4, 1e-3, 0.06, 1e-7, 1e-5, 1.0, 4)


@pytest.fixture(scope="module")
def itamsat(digits):
    """The elements as an orbit is made from them."""
    return Elements(*(decimal(*number) for number in digits.values()))


def test_there_is_a_handler_for_each_telecommand():
    assert set(HANDLERS) == set(TELECOMMANDS.values())


class TestMode:
    @pytest.mark.parametrize("mode", [Mode.DETUMBLE, Mode.ACQUIRE, Mode.POINT])
    def test_begins_anew(self, obey, state, mode):
        after, results = obey(altered(state, modes=ModeState(Mode.SAFE, 3, trips=2)), TcMode(mode))
        assert results == [TcAckResult.ACCEPTED]
        assert after.modes == ModeState(mode, TICK, trips=2)

    @pytest.mark.parametrize("violated", [None, Monitor.FIELD_FRESH, Monitor.RATE_BOUNDED])
    @pytest.mark.parametrize("trips", [0, 3, 200])
    @pytest.mark.parametrize("before", Mode)
    def test_safe_is_given_always_and_held(self, obey, state, before, trips, violated):
        start = altered(state, modes=ModeState(before, 7, trips=trips))
        start = altered(start, attitude=start.attitude.invalid())
        after, results = obey(start, TcMode(Mode.SAFE), violated=violated)
        assert results == [TcAckResult.ACCEPTED]
        assert (after.modes.mode, after.modes.held, after.modes.trips) == (Mode.SAFE, True, trips)
        assert after.modes.since_tick == (7 if before is Mode.SAFE else TICK)

    @pytest.mark.parametrize("mode", [Mode.DETUMBLE, Mode.ACQUIRE, Mode.POINT])
    def test_safe_is_not_left_while_a_monitor_is_violated(self, refused, state, mode):
        safe = altered(state, modes=ModeState(Mode.SAFE))
        refused(TcAckResult.NOT_ALLOWED, TcMode(mode), start=safe, violated=Monitor.FIELD_FRESH)

    @pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
    def test_too_fast_a_turn_is_left_to_no_other_mode(self, refused, state, mode):
        safe = altered(state, modes=ModeState(Mode.SAFE))
        refused(TcAckResult.NOT_ALLOWED, TcMode(mode), start=safe, violated=Monitor.RATE_BOUNDED)

    def test_than_detumbling_which_ends_it(self, obey, refused, state, config):
        safe = altered(state, modes=ModeState(Mode.SAFE))
        after, results = obey(safe, TcMode(Mode.DETUMBLE), violated=Monitor.RATE_BOUNDED)
        assert (results, after.modes.mode) == ([TcAckResult.ACCEPTED], Mode.DETUMBLE)
        often = altered(state, modes=ModeState(Mode.SAFE, trips=config.modes.trips_to_stay_safe))
        refused(TcAckResult.NOT_ALLOWED, TcMode(Mode.DETUMBLE), start=often, violated=Monitor.RATE_BOUNDED)

    @pytest.mark.parametrize("mode", [Mode.DETUMBLE, Mode.ACQUIRE, Mode.POINT])
    def test_safe_is_not_left_before_the_trips_are_cleared(self, refused, obey, state, config, mode):
        safe = altered(state, modes=ModeState(Mode.SAFE, trips=config.modes.trips_to_stay_safe))
        refused(TcAckResult.NOT_ALLOWED, TcMode(mode), start=safe)
        after, results = obey(safe, TcClear(), TcMode(mode))
        assert results == [TcAckResult.ACCEPTED] * 2
        assert after.modes == ModeState(mode, TICK)

    @pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
    def test_a_law_that_needs_the_attitude_waits_until_it_is_known(self, refused, state, mode):
        lost = altered(state, attitude=state.attitude.invalid(), modes=ModeState(Mode.DETUMBLE))
        refused(TcAckResult.NOT_ALLOWED, TcMode(mode), start=lost)

    def test_detumbling_needs_no_attitude(self, obey, state):
        lost = altered(state, attitude=state.attitude.invalid())
        after, _ = obey(lost, TcMode(Mode.DETUMBLE))
        assert after.modes.mode is Mode.DETUMBLE

    def test_the_mode_that_is_flown_already_goes_on(self, obey, state):
        assert obey(state, TcMode(Mode.ACQUIRE)) == (state, [TcAckResult.ACCEPTED])

    @pytest.mark.parametrize("mode", range(4, 8))
    def test_there_are_four(self, refused, mode):
        refused(TcAckResult.UNKNOWN, TcMode(mode))


def test_clearing_forgets_trips_and_faults_and_nothing_else(obey, state):
    faulty = altered(
        state, health=Health(SensorHealth(Watch(fault=3), Watch(fault=2)), CoilHealth(faults=(1, 2, 3)))
    )
    after, results = obey(faulty, TcClear())
    assert results == [TcAckResult.ACCEPTED]
    assert after == altered(state, modes=replace(state.modes, trips=0), health=Health())


class TestLaw:
    def test_every_law_has_a_number_of_its_own_that_fits(self):
        assert {LAWS[name].number: name for name in LAWS} == LAW_NAMES
        assert len(LAW_NAMES) == len(LAWS)
        assert all(0 <= number < 256 for number in LAW_NAMES)

    @pytest.mark.parametrize("name", LAWS)
    def test_begins_without_a_memory(self, obey, state, config, name):
        start = altered(state, setpoint=replace(state.setpoint, law="bdot" if name == "pd" else "pd"))
        wheels = replace(config.control, wheel_body_nms=(0.0, 0.0, 0.05), wheel=WHEEL)
        after, results = obey(start, TcLaw(LAWS[name].number), config=replace(config, control=wheels))
        assert results == [TcAckResult.ACCEPTED]
        assert after == altered(start, setpoint=replace(start.setpoint, law=name), memory=())

    def test_the_law_that_flies_already_goes_on_with_its_memory(self, obey, state):
        assert obey(state, TcLaw(LAWS[state.setpoint.law].number)) == (state, [TcAckResult.ACCEPTED])

    def test_of_ones_own_has_the_last_number(self, obey, state, config):
        own = OwnLaw("mine", LAWS["pd"].acquire, LAWS["pd"].point)
        with_own = replace(config, control=replace(config.control, own=own))
        after, results = obey(state, TcLaw(OWN_NUMBER), config=with_own)
        assert results == [TcAckResult.ACCEPTED]
        assert after == altered(state, setpoint=replace(state.setpoint, law="mine"), memory=())
        back, _ = obey(after, TcLaw(LAWS[state.setpoint.law].number), config=with_own)
        assert back.setpoint == state.setpoint

    def test_that_plans_pulses_is_none_of_a_continuous_driver(self, refused, config):
        continuous = replace(config, control=replace(config.control, pulsed=False))
        refused(TcAckResult.UNKNOWN, TcLaw(LAWS["pulse_mpc"].number), config=continuous)

    @pytest.mark.parametrize("law", ["dual_spin", "wheel_relay", "two_coils", "pitch_wheel"])
    def test_that_holds_or_drives_a_wheel_is_none_of_a_satellite_without(self, refused, law):
        refused(TcAckResult.UNKNOWN, TcLaw(LAWS[law].number))

    def test_that_turns_the_body_about_axis_3_is_none_of_another_wheel(self, refused, config):
        wheel = replace(WHEEL, axis_body=(0.0, 1.0, 0.0))
        across = replace(config, control=replace(config.control, wheel=wheel))
        refused(TcAckResult.UNKNOWN, TcLaw(LAWS["pitch_wheel"].number), config=across)

    @pytest.mark.parametrize("number", [*sorted(set(range(256)) - set(LAW_NAMES))[::23], 255])
    def test_that_is_not_there(self, refused, number):
        refused(TcAckResult.UNKNOWN, TcLaw(number))


class TestSpin:
    @pytest.mark.parametrize("spin", [0.02, -0.05, 0.1, -0.1, 0.0])
    def test_is_the_new_one(self, obey, state, spin):
        sent = TcSpin.decode(TcSpin(spin).encode().data)
        after, results = obey(state, sent)
        on_the_wire = round(spin * 2**19) / 2**19
        if abs(on_the_wire) > 0.1:
            assert results == [TcAckResult.OUT_OF_RANGE]
        else:
            assert results == [TcAckResult.ACCEPTED]
            assert after == altered(state, setpoint=replace(state.setpoint, spin_radps=on_the_wire))

    @pytest.mark.parametrize("spin", [0.1 + 2**-19, -0.1 - 2**-19, 0.125, -0.125])
    def test_beyond_what_may_be_asked_for(self, refused, spin):
        refused(TcAckResult.OUT_OF_RANGE, TcSpin(spin))


class TestGain:
    @pytest.mark.parametrize("gain", Gain)
    @pytest.mark.parametrize(
        ("mantissa", "exponent", "value"), [(62694, 2, 6.2694e6), (16149, -1, 1614.9), (0, 0, 0.0)]
    )
    def test_is_exactly_the_decimal_number(self, obey, state, gain, mantissa, exponent, value):
        after, results = obey(state, TcGain(gain, exponent, mantissa))
        assert results == [TcAckResult.ACCEPTED]
        assert after == altered(state, setpoint=replace(state.setpoint, **{gain.name.lower(): value}))

    @pytest.mark.parametrize("gain", range(3, 16))
    def test_that_is_not_there(self, refused, gain):
        refused(TcAckResult.UNKNOWN, TcGain(gain, 0, 1))

    @pytest.mark.parametrize("mantissa", [-1, -(2**31)])
    def test_that_is_negative(self, refused, mantissa):
        refused(TcAckResult.OUT_OF_RANGE, TcGain(Gain.K_A, -5, mantissa))

    @pytest.mark.parametrize("gain", Gain)
    @pytest.mark.parametrize(("mantissa", "exponent"), [(1, 15), (1_000_001, 6), (2**31 - 1, 127)])
    def test_that_no_satellite_needs(self, refused, gain, mantissa, exponent):
        refused(TcAckResult.OUT_OF_RANGE, TcGain(gain, exponent, mantissa))

    def test_at_the_bound(self, obey, state):
        _, results = obey(state, TcGain(Gain.K_W, 12, 1))
        assert results == [TcAckResult.ACCEPTED]


class TestOrbit:
    def test_elements_are_kept_aside_and_fly_nothing(self, obey, state, elements, itamsat):
        after, results = obey(state, *elements())
        assert results == [TcAckResult.ACCEPTED] * 9
        assert after == altered(state, upload=Upload(itamsat, 0x1FF))

    def test_are_loaded_at_once(self, obey, state, config, elements, itamsat):
        after, results = obey(state, *elements(raan_deg=(500000, -4)), TcOrbitLoad())
        wanted = replace(itamsat, raan_deg=50.0)
        assert results[-1] is TcAckResult.ACCEPTED
        assert (after.orbit, after.upload) == (wanted, Upload())
        assert after.ephemeris == advance(None, TICK, with_orbit(config.ephemeris, wanted))
        assert after.ephemeris != state.ephemeris
        assert after == altered(state, orbit=wanted, ephemeris=after.ephemeris)

    def test_samples_of_the_orbit_before_are_no_part_of_a_start(self, obey, state, elements):
        searching = altered(state, estimator=replace(state.estimator, batch=search_under_way()))
        loaded, _ = obey(searching, *elements(), TcOrbitLoad())
        assert loaded.estimator == state.estimator
        refused, _ = obey(searching, *elements(raan_deg=None), TcOrbitLoad())
        assert refused.estimator.batch.samples == searching.estimator.batch.samples
        assert pack(refused.estimator) == pack(searching.estimator)

    @pytest.mark.parametrize("missing", Element)
    def test_not_before_all_have_come(self, refused, missing, elements):
        sent = elements(**{missing.name.lower(): None})
        refused(TcAckResult.INCOMPLETE, *sent, TcOrbitLoad())

    def test_a_second_load_needs_all_of_them_again(self, refused, elements):
        refused(TcAckResult.INCOMPLETE, *elements(), TcOrbitLoad(), TcOrbitLoad(1))

    @pytest.mark.parametrize(
        "wrong",
        [
            {"eccentricity": (9, -1)},  # through the Earth
            {"motion_revpday": (199, -1)},  # below the ground
            {"bstar": (9, -1), "epoch_day": (10_000, 0)},  # decayed long ago
        ],
    )
    def test_that_is_none_keeps_the_old_one_and_can_be_mended(
        self, obey, refused, state, wrong, digits, elements, itamsat
    ):
        refused(TcAckResult.OUT_OF_RANGE, *elements(**wrong), TcOrbitLoad())
        mended = [
            TcOrbitElement(Element[name.upper()], *reversed(digits[Element[name.upper()]])) for name in wrong
        ]
        after, results = obey(state, *elements(**wrong), TcOrbitLoad(), *mended, TcOrbitLoad(1))
        assert results[-1] is TcAckResult.ACCEPTED
        assert after.orbit == itamsat

    @pytest.mark.parametrize("element", Element)
    def test_an_element_that_cannot_be_is_refused_alone(self, obey, refused, state, element):
        low, high = RANGES[element]
        for mantissa in (-(2**31), 2**31 - 1):
            refused(TcAckResult.OUT_OF_RANGE, TcOrbitElement(element, 0, mantissa))
        middle = round(1000.0 * (low + high) / 2.0)
        assert obey(state, TcOrbitElement(element, -3, middle))[1] == [TcAckResult.ACCEPTED]

    @pytest.mark.parametrize("element", range(9, 16))
    def test_there_are_nine(self, refused, element):
        refused(TcAckResult.UNKNOWN, TcOrbitElement(element, 0, 0))

    def test_the_same_numbers_are_the_same_orbit_as_two_lines(self, tle, itamsat):
        lines, numbers = sgp4_orbit(*tle["ITAMSAT"]), element_orbit(itamsat)
        for hours in (0, 1, 24, 240):
            unix_s = 1427424416 + 3600 * hours
            (r, v), (r2, v2) = state_eci(lines, unix_s), state_eci(numbers, unix_s)
            assert dist(r, r2) < 0.01
            assert dist(v, v2) < 1e-5

    @pytest.mark.parametrize("slow", [6.39, 1.0, 0.0])
    def test_deep_space_is_no_orbit_for_this_field(self, slow, itamsat):
        with pytest.raises(ValueError, match=r"225 minutes|refuses"):
            element_orbit(replace(itamsat, motion_revpday=slow))


class TestAcknowledgement:
    def test_each_in_its_order_and_by_its_own_counter(self, obey, state):
        sent = (TcSpin(0.01, 5), TcSpin(0.12, 6), TcSpin(-0.02, 7), TcLaw(99, 1))
        after, results = obey(state, *sent)
        assert results == [
            TcAckResult.ACCEPTED,
            TcAckResult.OUT_OF_RANGE,
            TcAckResult.ACCEPTED,
            TcAckResult.UNKNOWN,
        ]
        assert after.setpoint.spin_radps == -0.02

    def test_a_repeated_one_is_not_carried_out_again_but_answered(self, state, config):
        repeated = measured(repeated=(TcMode(Mode.SAFE, 4), TcClear(9)))
        acks = [TcAck(TcAckResult.REPEATED, *sent, TICK) for sent in ((TcMode.ID, 4), (TcClear.ID, 9))]
        before = pack(state)
        assert command(state, repeated, None, config) == acks
        assert pack(state) == before

    def test_no_telecommand_no_answer(self, state, config):
        before = pack(state)
        assert command(state, measured(), Monitor.FIELD_FRESH, config) == []
        assert pack(state) == before

    @pytest.mark.parametrize(
        "sent",
        [
            TcMode(Mode.SAFE),
            TcClear(),
            TcLaw(2),
            TcSpin(2**-9),
            TcGain(Gain.K_I, 0, 7),
            TcOrbitElement(Element.RAAN_DEG, -4, 364208, 3),
            TcParameter(Component.MAG_BIAS_Y, -9, 130),
            TcFreeze(1),
        ],
        ids=lambda message: type(message).__name__,
    )
    def test_what_was_carried_out_shows_in_the_checksum(self, obey, state, sent):
        after, _ = obey(state, sent)
        assert checksum(after) != checksum(state)
