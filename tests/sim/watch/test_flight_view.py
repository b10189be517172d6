"""What frames show: the latest of each, what happened, and a sample a second."""

from math import cos, radians, sin

import pytest

from fsw.core.algebra.quaternion import conjugate
from fsw.core.events import Event
from fsw.core.fdir.faults import CoilFault
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilDipoleStatus,
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    FswBoot,
    FswEvent,
    MagBoot,
    MagField,
    Mode,
    NavAttitude,
    NavQuality,
    NavRate,
    PlantBoot,
    PlantEnd,
    Severity,
    SunBoot,
    SunVector,
    Sync,
    WheelBoot,
)
from sim.scenario.schema import load
from sim.watch.coil_torque import craft_of
from sim.watch.directions import Around
from sim.watch.flight_view import MOST_HAPPENINGS, MOST_UNKNOWN, FlightView
from sim.watch.happening import Weight
from sim.watch.snapshot import snapshot

UNIX_S = 1427424417
B_ORBIT_T, SUN_ORBIT = (1e-5, -2e-5, 3e-5), (0.6, 0.0, 0.8)


@pytest.fixture
def seen():
    return FlightView(lambda tick: Around(B_ORBIT_T, SUN_ORBIT))


def take(seen, *messages):
    for message in messages:
        seen.take(message.encode(), 0.0)


def turned(deg, valid=1):
    """Turned about the radius: a vector b is then (b1, c b2 + s b3, -s b2 + c b3) in body axes."""
    return NavAttitude(valid, sin(radians(deg / 2.0)), 0.0, 0.0)


def quality(mode=Mode.POINT, **flags):
    values = {"mag_used": 1, "sun_used": 1, "mag_blanked": 0, "eclipse": 0, "estimate_valid": 1}
    return NavQuality(
        mode=mode, sigma3_attitude=radians(0.4), sigma3_rate=1e-5, tripped=0, trips=0, **(values | flags)
    )


def words(seen):
    return [happening.words for happening in seen.happenings]


class TestTime:
    def test_nothing_is_known_before_the_first_sync(self, seen):
        take(seen, turned(10.0))
        assert (seen.tick, seen.unix_s, len(seen.samples)) == (None, None, 0)

    def test_a_second_is_sampled_once_whatever_the_rate_of_ticks(self, seen):
        for tick in range(21):
            take(seen, Sync(tick, UNIX_S + tick // 10))
        assert [sample.unix_s for sample in seen.samples] == [UNIX_S, UNIX_S + 1]

    def test_a_count_that_goes_back_is_told_and_the_series_begin_anew(self, seen):
        take(seen, Sync(5, UNIX_S), Sync(6, UNIX_S + 1), PlantEnd(6), Sync(0, UNIX_S))
        assert words(seen)[-1] == "the count of ticks went back from 6 to 0"
        assert len(seen.samples) == 0
        assert not seen.ended


class TestAttitude:
    def test_a_sample_has_turn_deviation_and_rate(self, seen):
        take(
            seen, Sync(0, UNIX_S), turned(30.0), NavRate(1, 0.003, 0.004, 0.0), quality(), Sync(1, UNIX_S + 1)
        )
        sample = seen.samples[-1]
        assert sample.turn_deg == pytest.approx(30.0, abs=0.01)
        assert sample.sigma3_deg == pytest.approx(0.4, abs=0.01)
        assert sample.rate_degps == pytest.approx(0.2865, abs=1e-3)
        assert seen.mode is Mode.POINT

    def test_where_another_axis_looks_up_the_angle_counts_from_there(self):
        """z up, x ahead: in the nominal attitude the orbit's axes are turned by 120 deg in the body."""
        scenario = load("microsat", {"body": {"up": "z", "ahead": "x"}})
        q1, q2, q3 = conjugate(scenario.body.law_axes.q_law_from_body)[1:]
        nominal = NavAttitude(1, q1, q2, q3)
        for craft, expected_deg in ((craft_of(scenario), 0.0), (None, 120.0)):
            view = FlightView(craft=craft)
            take(view, Sync(0, UNIX_S), nominal, Sync(1, UNIX_S + 1))
            assert view.samples[-1].turn_deg == pytest.approx(expected_deg, abs=0.3)

    def test_what_is_not_valid_is_not_shown(self, seen):
        take(seen, Sync(0, UNIX_S), turned(30.0, valid=0), NavRate(0, 0.003, 0.004, 0.0), quality())
        take(seen, MagField(1, 1e4, 2e4, 3e4), Sync(1, UNIX_S + 1))
        assert seen.attitude is None
        assert seen.samples[-1].turn_deg is None
        assert seen.field_off_deg() is None

    def test_a_mode_that_does_not_exist_is_none(self, seen):
        take(seen, quality(mode=7))
        assert seen.mode is None


class TestSensors:
    """Turned by 30 deg about the radius, and measured 2 deg off in the plane across it."""

    @staticmethod
    def measured(deg):
        _, b2, b3 = B_ORBIT_T
        c, s = cos(radians(30.0 + deg)), sin(radians(30.0 + deg))
        return MagField(1, 1e9 * B_ORBIT_T[0], 1e9 * (c * b2 + s * b3), 1e9 * (-s * b2 + c * b3))

    def test_a_field_as_predicted_is_off_by_nothing_and_a_turned_one_by_its_turn(self, seen):
        take(seen, Sync(0, UNIX_S), turned(30.0), quality(), self.measured(0.0))
        assert seen.field_off_deg() == pytest.approx(0.0, abs=0.05)
        take(seen, self.measured(2.0))
        across = (B_ORBIT_T[1] ** 2 + B_ORBIT_T[2] ** 2) / sum(b * b for b in B_ORBIT_T)
        assert seen.field_off_deg() == pytest.approx(2.0 * across**0.5, abs=0.05)

    def test_one_that_a_coil_disturbs_or_that_is_not_valid_is_not_compared(self, seen):
        on, off = CoilStatus(3, 1, 0, 400, 100_000, 4), CoilStatus(0, 1, 0, 0, 100_000, 4)
        take(seen, Sync(0, UNIX_S), turned(30.0), self.measured(2.0))
        for status, known in ((on, False), (off, False), (off, True)):
            take(seen, status)
            assert (seen.field_off_deg() is not None) is known
        assert "field" in seen.arrows()
        take(seen, self.measured(2.0).replace(valid=0))
        assert seen.field_off_deg() is None
        assert "field" not in seen.arrows()

    def test_the_sun_likewise_and_not_in_the_shadow(self, seen):
        take(seen, Sync(0, UNIX_S), turned(0.0), SunVector(1, 0.6, 0.0, 0.8))
        assert seen.sun_off_deg() == pytest.approx(0.0, abs=0.02)
        seen.around = Around(B_ORBIT_T, None)
        assert seen.sun_off_deg() is None

    def test_without_an_orbit_nothing_is_predicted(self):
        seen = FlightView()
        take(seen, Sync(0, UNIX_S), turned(30.0), quality(), self.measured(0.0))
        assert seen.field_off_deg() is None


class TestCoils:
    def test_a_pulse_happens_once_however_many_ticks_it_lasts(self, seen):
        for remaining_ms in (2000, 1000, 0):
            take(seen, CoilStatus(-3, 1, remaining_ms, -400, 100_000, 4))
        take(seen, CoilStatus(0, 2, 0, 0, 99_000, 4))
        assert seen.coils.pulses == 1
        assert words(seen) == ["coil 1 driven at level -3, -400 mA"]
        assert seen.coils.levels == [0, 0, 0]
        assert seen.coils.lockout_ms == [None, 100_000, 99_000]

    def test_pulses_of_a_coil_without_a_pause_between_them_are_counted_each(self, seen):
        for seq, level in ((4, -3), (4, -3), (5, -3), (5, -3), (6, 2)):
            take(seen, CoilStatus(level, 1, 0, 100 * level, 0, seq))
        assert seen.coils.pulses == 3
        assert words(seen) == [
            *2 * ["coil 1 driven at level -3, -300 mA"],
            "coil 1 driven at level +2, 200 mA",
        ]

    def test_a_board_that_counts_anew_after_a_boot_is_seen_to_drive_again(self, seen):
        for level in (1, 0, 1):
            take(seen, CoilStatus(level, 0, 0, 100 * level, 0, 1))
        assert seen.coils.pulses == 2

    def test_a_refusal_says_why(self, seen):
        take(seen, CoilRefused(2, 7, CoilRefusedReason.LOCKOUT, 33), CoilRefused(2, 7, 77, 33))
        assert words(seen)[0].endswith("coil 2: lockout")
        assert words(seen)[1].endswith("coil 2: reason 77")
        assert seen.coils.refused == 2

    def test_a_coil_that_does_not_exist_is_nobodys(self, seen):
        take(seen, CoilStatus(2, 3, 0, 100, 0, 4))
        assert (seen.coils.pulses, seen.coils.levels) == (0, [0, 0, 0])

    def test_a_continuous_driver_shows_parts_of_its_dipole(self, seen):
        take(seen, CoilDipoleStatus(0.5, -0.25, 0.0))
        assert seen.coils.fractions == (0.5, -0.25, 0.0)


class TestHappenings:
    def test_an_event_is_in_words_and_has_its_weight(self, seen):
        fault = 200 + CoilFault.REVERSED
        take(seen, Sync(9, UNIX_S), FswEvent(Severity.ERROR, Event.COIL_FAULT, 9, fault), FswBoot(0, 1, 5))
        event, boot = seen.happenings
        assert (event.tick, event.weight) == (9, Weight.ERROR)
        assert "coil 1" in event.words
        assert "reversed" in event.words
        assert (boot.weight, boot.words) == (Weight.INFO, "fsw: started")

    def test_every_node_is_seen_to_start(self, seen):
        boots = (CoilBoot, FswBoot, MagBoot, PlantBoot, SunBoot, WheelBoot)
        take(seen, *(boot(0, 1, 5) for boot in boots))
        names = ("coil", "fsw", "mag", "plant", "sun", "wheel")
        assert words(seen) == [f"{name}: started" for name in names]

    def test_unknown_numbers_are_told_as_numbers(self, seen):
        take(seen, FswEvent(9, 250, 0, -1))
        assert seen.happenings[0].weight is Weight.ERROR
        assert "250" in words(seen)[0]

    def test_the_last_are_kept_and_all_are_numbered(self, seen):
        for _ in range(MOST_HAPPENINGS + 5):
            take(seen, FswBoot(0, 1, 5))
        assert len(seen.happenings) == MOST_HAPPENINGS
        assert seen.happenings[-1].number == MOST_HAPPENINGS + 5

    def test_the_end_is_one(self, seen):
        take(seen, PlantEnd(100))
        assert seen.ended


class TestBrokenFrames:
    @pytest.mark.parametrize(
        "frame",
        [
            Frame(CoilStatus.ID, bytes(8)),
            Frame(CoilStatus.ID, bytes(3)),
            Frame(Sync.ID, bytes(2)),
        ],
        ids=["wrong CRC", "wrong length", "without a CRC"],
    )
    def test_are_counted_and_shown_nowhere(self, seen, frame):
        seen.take(frame, 0.0)
        assert (seen.broken, seen.tick, seen.coils.pulses) == (1, None, 0)

    @pytest.mark.parametrize("can_id", [0x7FF, 0x8000_0100, 0x4000_0100, 0x2000_0004])
    def test_unknown_extended_remote_and_error_frames_are_counted_alone(self, seen, can_id):
        seen.take(Frame(can_id, bytes(8)), 0.0)
        assert seen.frames[can_id] == 1
        assert seen.broken == 0

    def test_of_unknown_identifiers_a_few_are_counted_each_and_the_others_together(self, seen):
        for can_id in range(10_000):
            seen.take(Frame(0x8000_0000 + can_id, b""), 0.0)
        seen.take(Frame(0x8000_0000, b""), 0.0)
        take(seen, Sync(0, UNIX_S))
        assert len(seen.frames) == MOST_UNKNOWN + 1
        assert (seen.frames[0x8000_0000], seen.frames[Sync.ID]) == (2, 1)
        assert seen.other_frames == 10_000 - MOST_UNKNOWN
        shown = snapshot(seen, 0, 0)["frames"]
        assert shown[-1] == ("other identifiers", 10_000 - MOST_UNKNOWN)
        assert sum(count for _, count in shown) == 10_002
