"""The flight loop: pure, ordered, bound to its tick, and safe when boards fall silent."""

from copy import deepcopy
from itertools import pairwise

import pytest
from flight_states import stepped
from replies import events_of, of

from fsw.core.algebra.vector import dot, norm
from fsw.core.monitors import Monitor
from fsw.core.state_bytes import checksum
from fsw.core.step import boot
from fsw.core.telemetry import Event
from fsw.wire.messages import (
    CLASSES,
    CoilFire,
    CoilRefused,
    CoilStatus,
    FswEvent,
    FswHeartbeat,
    Mode,
    NavAttitude,
    NavParameter,
    NavQuality,
    NavRate,
    SunVector,
    TickDone,
    intact,
)


@pytest.fixture(scope="module")
def flight(make_world):
    """Three hundred undisturbed ticks: (config, inboxes, states before each, outboxes)."""
    world, inboxes, states, outboxes = make_world(), [], [], []
    for _ in range(300):
        states.append(world.state)
        inboxes.append(world.inbox())
        world.state, outbox = stepped(world.state, inboxes[-1], world.config)
        for frame in outbox:
            world.plant.receive(frame)
        world.plant.end_tick()
        outboxes.append(outbox)
    states.append(world.state)
    return world.config, inboxes, states, outboxes


class TestPurity:
    def test_the_same_input_gives_the_same_output_twice(self, flight, snapshot):
        config, inboxes, states, outboxes = flight
        for tick in (0, 1, 99, 100, 101, 299):
            again, outbox = stepped(states[tick], inboxes[tick], config)
            assert outbox == outboxes[tick]
            assert snapshot(again) == snapshot(states[tick + 1])

    def test_what_goes_in_comes_out_unchanged(self, flight, snapshot):
        """State, inbox and config, down to the arrays inside the filter."""
        config, inboxes, states, _ = flight
        estimator = config.estimator.mekf
        arrays = {
            name: getattr(estimator, name).copy()
            for name in (
                "initial_covariance",
                "process_noise",
                "constant",
                "moving",
                "driven",
            )
        }
        for tick in (100, 250):
            state, inbox = states[tick], inboxes[tick]
            before, kept = snapshot(state), deepcopy(inbox)
            stepped(state, inbox, config)
            assert snapshot(state) == before
            assert inbox == kept
        for name, kept in arrays.items():
            assert (getattr(estimator, name) == kept).all()

    def test_a_whole_flight_can_be_flown_again_from_its_inboxes(self, flight, snapshot):
        config, inboxes, states, outboxes = flight
        state = boot(config)
        for inbox, outbox in zip(inboxes, outboxes, strict=True):
            state, again = stepped(state, inbox, config)
            assert again == outbox
        assert snapshot(state) == snapshot(states[-1])

    def test_two_flights_at_once_do_not_disturb_each_other(self, flight, make_world):
        config, inboxes, _, outboxes = flight
        ours, other = boot(config), make_world(seed=11)
        for inbox, outbox in zip(inboxes[:120], outboxes[:120], strict=True):
            other.step()
            ours, again = stepped(ours, inbox, config)
            assert again == outbox


class TestOutbox:
    def test_tick_done_comes_last_once_and_names_tick_and_checksum(self, flight):
        _, inboxes, states, outboxes = flight
        for inbox, state, outbox in zip(inboxes, states[1:], outboxes, strict=True):
            assert [frame.can_id == TickDone.ID for frame in outbox] == [False] * (len(outbox) - 1) + [True]
            assert TickDone.decode(outbox[-1].data) == TickDone(inbox.tick, checksum(state))

    def test_the_request_comes_first(self, flight):
        *_, outboxes = flight
        fires = [outbox for outbox in outboxes if any(frame.can_id == CoilFire.ID for frame in outbox)]
        assert fires
        assert all(outbox[0].can_id == CoilFire.ID for outbox in fires)

    def test_the_first_request_answers_the_report_that_its_coil_is_free(self, flight):
        """A full back-off after the boot at tick 0, and not a tick more: the demand is there all along."""
        _, inboxes, _, outboxes = flight
        fires = [tick for tick, outbox in enumerate(outboxes) if outbox[0].can_id == CoilFire.ID]
        first = CoilFire.decode(outboxes[fires[0]][0].data)
        reports = [
            (tick, CoilStatus.decode(frame.data))
            for tick, inbox in enumerate(inboxes)
            for frame in inbox.frames
            if frame.can_id == CoilStatus.ID
        ]
        free = [tick for tick, status in reports if status.coil == first.coil and not status.lockout_ms]
        assert fires[0] == free[0]
        assert 100 <= fires[0] < 103, "each coil reports in every third tick"
        assert all(later - sooner >= 103 for sooner, later in pairwise(fires))

    def test_every_frame_is_intact(self, flight):
        *_, outboxes = flight
        assert all(intact(frame) for outbox in outboxes for frame in outbox)

    def test_reports_come_at_their_rates(self, flight):
        *_, outboxes = flight
        for tick, outbox in enumerate(outboxes):
            ids = [frame.can_id for frame in outbox]
            assert ids.count(NavAttitude.ID) == ids.count(NavRate.ID) == 1
            assert ids.count(NavQuality.ID) == (tick % 10 == 0)
            assert ids.count(NavParameter.ID) == (tick % 10 == 0)
            assert ids.count(FswHeartbeat.ID) == (tick % 60 == 0)

    def test_each_message_s_counter_rises_by_one(self, flight):
        *_, outboxes = flight
        counters = {}
        for outbox in outboxes:
            for frame in outbox[:-1]:
                counters.setdefault(frame.can_id, []).append(CLASSES[frame.can_id].decode(frame.data).counter)
        assert len(counters) == 7
        for counted in counters.values():
            assert counted == [n % 16 for n in range(len(counted))]

    def test_what_is_told_is_what_the_state_holds(self, flight):
        _, _, states, outboxes = flight
        for state, outbox in zip(states[1:], outboxes, strict=True):
            messages = [CLASSES[frame.can_id].decode(frame.data) for frame in outbox]
            (nav,), (rate,) = of(NavAttitude, messages), of(NavRate, messages)
            assert nav.values()[1:4] == pytest.approx(state.attitude.q_body_from_orbit[1:], abs=2**-16)
            assert rate.values()[1:4] == pytest.approx(state.attitude.omega_body_orbit_radps, abs=2**-19)
            assert bool(nav.valid) is bool(rate.valid) is state.attitude.valid


class TestTicks:
    def test_a_tick_that_repeats_or_goes_back_is_counted_and_not_answered(self, flight):
        config, inboxes, states, _ = flight
        for tick in (150, 149, 0):
            after, outbox = stepped(states[151], inboxes[tick], config)
            assert outbox == ()
            assert after.ignored_syncs == states[151].ignored_syncs + 1
            assert after.tick == 150

    def test_nothing_else_changes(self, flight, snapshot):
        config, inboxes, states, _ = flight
        after, _ = stepped(states[151], inboxes[150], config)
        before, now = snapshot(states[151]), snapshot(after)
        assert {path for path in now if before.get(path) != now[path]} == {
            "state.ignored_syncs",
            "state.syncs.doubted.0",
        }

    def test_the_flight_goes_on_after_it(self, flight):
        """Only the count differs, and with it the checksum."""
        config, inboxes, states, outboxes = flight
        disturbed, _ = stepped(states[151], inboxes[150], config)
        _, outbox = stepped(disturbed, inboxes[151], config)
        assert outbox[:-1] == outboxes[151][:-1]
        assert outbox[-1] != outboxes[151][-1]

    def test_a_lost_sync_is_flown_over(self, make_world):
        """The boards' frames of both ticks come with the second SYNC."""
        world = make_world()
        world.fly_until_valid()
        before = world.state.tick
        lost = world.inbox()
        world.plant.end_tick()
        replies = world.step(lambda inbox: inbox.replace(frames=lost.frames + inbox.frames))
        assert of(TickDone, replies)[0].tick == before + 2
        assert world.state.gate.rejected == world.state.gate.missed == 0
        assert world.state.estimator.restarts == 0
        assert world.state.attitude.valid
        world.fly(20)
        assert world.state.estimator.rejected_total == 0

    def test_after_a_long_silence_the_filter_begins_anew(self, make_world):
        world = make_world()
        world.fly(150)
        for _ in range(90):
            world.inbox()
            world.plant.end_tick()
        assert world.step() == []
        replies = world.step()
        assert of(TickDone, replies)[0].tick == 241
        assert world.state.estimator.restarts == 1
        assert (Event.FILTER_RESTARTED, 1) in [(m.event, m.argument) for m in of(FswEvent, replies)]

    def test_a_start_in_the_middle_of_a_flight_waits_out_a_full_back_off(self, make_world):
        """fsw boots at tick 150 while the board is long ready: no request before tick 250."""
        world = make_world()
        for _ in range(150):
            world.inbox()
            world.plant.end_tick()
        ticks = world.fly(160)
        fires = [tick for tick, replies in enumerate(ticks, 150) if of(CoilFire, replies)]
        assert fires
        assert fires[0] >= 250

    @pytest.mark.parametrize("error_s", [1, -3600])
    def test_a_clock_that_is_off_is_an_event_and_nothing_more(self, flight, error_s):
        config, inboxes, states, outboxes = flight
        state, reports, fires = states[100], [], []
        for inbox in inboxes[100:130]:
            state, outbox = stepped(state, inbox.replace(unix_time_s=inbox.unix_time_s + error_s), config)
            reports += [FswEvent.decode(f.data) for f in outbox if f.can_id == FswEvent.ID]
            fires.append([f for f in outbox if f.can_id == CoilFire.ID])
        assert [(m.event, m.argument) for m in reports if m.event == Event.TIME_MISMATCH] == [
            (Event.TIME_MISMATCH, error_s)
        ]
        assert fires == [[f for f in outbox if f.can_id == CoilFire.ID] for outbox in outboxes[100:130]]

    def test_the_clock_at_a_higher_rate(self, make_world):
        """unix_time_s = epoch + tick // tick_hz: at 4 Hz it stands for four ticks, and that is right."""
        world = make_world(time={"tick_hz": 4})
        assert [e for e in events_of(world.fly(41)) if e[1] == Event.TIME_MISMATCH] == []

    @pytest.mark.requirement("REQ-TRIP-10")
    @pytest.mark.parametrize(("off_s", "refused"), [(60, False), (-60, False), (61, True), (-600, True)])
    def test_another_time_than_the_table_s_is_refused_after_two_minutes(self, make_world, off_s, refused):
        """By the time of the table field, Sun and orbit are computed: at another they are not these."""
        world = make_world()
        tripped = []
        for tick in range(122):
            replies = world.step(lambda inbox: inbox.replace(unix_time_s=inbox.unix_time_s + off_s))
            tripped += [(tick, *e[1:]) for e in events_of([replies]) if e[1] == Event.MONITOR_TRIPPED]
        assert tripped == ([(120, Event.MONITOR_TRIPPED, Monitor.TIME_AGREES)] if refused else [])
        assert (world.state.modes.mode is Mode.SAFE) is refused

    @pytest.mark.requirement("REQ-TRIP-10")
    @pytest.mark.parametrize("hidden", [False, True], ids=["the bus tells it", "the bus hides it"])
    def test_by_another_time_than_the_table_s_no_sensor_is_judged(self, make_world, hidden):
        """Field and Sun contradict each other then: that isolates a sensor only if the time agrees."""
        world = make_world(flight={"time": {"epoch_utc": "2015-03-27T02:56:57Z"}})
        off_s = 600 if hidden else 0
        replies = world.fly(900, lambda inbox: inbox.replace(unix_time_s=inbox.unix_time_s + off_s))
        isolated = [event for event in events_of(replies) if event[1] == Event.SENSOR_ISOLATED]
        assert (isolated != []) is hidden


class TestFastTumble:
    """17 deg/s at 1 Hz, 0.3 rad a tick: the filter cannot follow, and waits."""

    def test_no_estimate_starts_again_and_again_and_none_is_valid(self, make_world):
        world = make_world(initial={"rate_degps": [10.0, 10.0, 10.0]})
        replies, valid = [], []
        for _ in range(900):
            replies.append(world.step())
            valid.append(world.state.attitude.valid)
        starts = [event for event in events_of(replies) if event[1] == Event.FILTER_STARTED]
        assert len(starts) <= 2, "one before a second sample shows the tumble"
        assert not any(valid)

    def test_one_that_has_been_slow_for_a_minute_starts(self, make_world):
        world = make_world()
        world.state.estimator.wait_ticks = 60
        began = [world.step() and world.state.estimator.estimate is not None for _ in range(62)]
        assert began.index(True) in (59, 60)


class TestEvents:
    def test_of_an_undisturbed_flight(self, flight):
        """Each change once, and nothing while it lasts."""
        _, _, states, outboxes = flight
        reports = [
            (tick, message.event, message.argument)
            for tick, outbox in enumerate(outboxes)
            for message in (FswEvent.decode(f.data) for f in outbox if f.can_id == FswEvent.ID)
        ]
        assert reports[0] == (0, Event.FILTER_STARTED, 0)
        modes = [(tick, Mode(argument)) for tick, event, argument in reports if event == Event.MODE_CHANGED]
        assert [mode for _, mode in modes[:2]] == [Mode.DETUMBLE, Mode.ACQUIRE]
        assert modes[0][0] == 5, "recovered"
        proven = [state.attitude.valid for state in states[1:]].index(True)
        assert 129 <= proven < 200, "and a sample that fits little is no proof"
        assert modes[1][0] == proven + 20, "settled: slow for so long, once that is known"
        assert len(reports) == 1 + len(modes)

    def test_a_refusal_is_told_with_its_reason(self, make_world):
        world = make_world()
        world.fly(10)
        refused = CoilRefused(coil=1, seq=7, reason=8, tick=9, counter=4).encode()
        replies = world.step(lambda inbox: inbox.replace(frames=(*inbox.frames, refused)))
        assert [(m.event, m.argument) for m in of(FswEvent, replies)] == [(Event.REQUEST_REFUSED, 8)]
        assert world.state.coil.refusals == 1
        assert of(FswEvent, world.step()) == []


def test_without_an_attitude_the_measured_field_is_what_control_works_with(make_world, without):
    """B-dot: the torque asked for is normal to the field that was measured in body axes."""
    world = make_world(initial={"rate_degps": [0.5, -0.7, 0.4]})
    for _ in range(40):
        world.step(without(SunVector))
        owed, b = world.state.pulses.pending_impulse_body_nms, world.state.sample.b_body_t
        if any(owed):
            break
    assert world.state.modes.mode is Mode.DETUMBLE
    assert not world.state.attitude.valid
    assert abs(dot(owed, b)) < 1e-9 * norm(owed) * norm(b)


class TestPerfectKnowledge:
    def test_the_attitude_is_the_plant_s(self, make_world):
        world = make_world(knowledge="perfect")
        for _ in range(50):
            truth = world.plant.truth()
            world.step()
            estimate = world.state.attitude
            assert estimate.valid
            assert estimate.q_body_from_orbit == pytest.approx(truth.q_body_from_orbit, abs=3e-5)
            assert estimate.omega_body_orbit_radps == pytest.approx(truth.omega_body_orbit_radps, abs=2e-6)
        assert world.state.estimator.estimate is None

    def test_in_every_attitude_no_monitor_trips(self, make_world):
        """Half turns too, where the wire's rounding makes the vector part longer than one."""
        for axis in ([1.0, 1.0, 1.0], [0.6, -0.48, 0.64], [0.0, 0.0, 1.0], [-3.0, 1.0, 2.0]):
            world = make_world(
                knowledge="perfect", initial={"axis": axis, "angle_deg": 180.0, "rate_degps": [0.0, 0.0, 0.0]}
            )
            world.fly(30)
            assert world.state.modes.trips == 0


class TestLateSamples:
    """After a pulse the field is not used for as long as a sample may be late."""

    @pytest.mark.parametrize(("latency_s", "late_ticks"), [(0.0, 0), (1.0, 1), (2.5, 3)])
    def test_the_field_is_used_again_when_no_sample_can_be_of_the_pulse(
        self, make_world, latency_s, late_ticks
    ):
        world = make_world(flight={"telemetry": {"quality_s": 1.0}, "uncertainty": {"latency_s": latency_s}})
        while not world.state.coil.driven_level:
            world.step()
        reports = []
        while world.state.coil.idle_ticks < 8:
            (quality,) = of(NavQuality, world.step())
            assert quality.mag_used != quality.mag_blanked
            if world.state.coil.idle_ticks:
                reports.append(quality.mag_blanked)
        assert reports == [1] * late_ticks + [0] * (8 - late_ticks)
