"""The mode table: legal as a table, and every transition to the tick."""

from dataclasses import replace
from math import cos, pi, radians, sin

import pytest

from fsw.core.estimation.attitude import Attitude
from fsw.core.modes import TABLE, ModeCondition, ModeConfig, ModeState, advance, judge_conditions
from fsw.table.sections import ModesTable
from fsw.wire.messages import Mode

DWELL_TICKS = (30, 0, 302, 60, 0, 61, 300, 600, 0, 62, 301, 601)
"""Different for every row that has one, so that no row can stand in for another."""
CONFIG = ModeConfig(
    dwell_ticks=DWELL_TICKS,
    slow_radps=radians(0.3),
    fast_radps=radians(0.6),
    near_cosine=cos(radians(20.0)),
    far_cosine=cos(radians(40.0)),
    axis_only=False,
    trips_to_stay_safe=3,
)
QUIET = (False,) * len(ModeCondition)
START = 1000
ROWS = [
    pytest.param(index, row, id=f"{row.source.name}-{row.condition.name}") for index, row in enumerate(TABLE)
]


def only(*conditions):
    return tuple([condition in conditions for condition in ModeCondition])


def long_in(mode):
    """In this mode, every condition to leave it has held for long."""
    return ModeState(mode, held_since=[0 if row.source is mode else -1 for row in TABLE])


def fly(state, situations, start=START, config=CONFIG):
    """The mode after each tick."""
    modes = []
    for tick, situation in enumerate(situations, start):
        advance(state, situation, tick, config)
        modes.append(state.mode)
    return modes


class TestTable:
    def test_every_condition_is_used(self):
        assert {row.condition for row in TABLE} == set(ModeCondition)

    def test_dwell_times_exist_in_the_onboard_table(self):
        assert {row.dwell for row in TABLE} - {"none_s"} <= set(ModesTable.model_fields)

    def test_no_row_stays_where_it_is_and_none_stands_twice(self):
        assert all(row.source is not row.target for row in TABLE)
        assert len({(row.source, row.condition) for row in TABLE}) == len(TABLE)

    def test_every_mode_is_reached_from_safe(self):
        reached = {Mode.SAFE}
        for _ in Mode:
            reached |= {row.target for row in TABLE if row.source in reached}
        assert reached == set(Mode)

    def test_every_mode_but_safe_trips_to_safe_before_anything_else_and_at_once(self):
        for mode in set(Mode) - {Mode.SAFE}:
            first = next(row for row in TABLE if row.source is mode)
            assert (first.target, first.dwell) == (Mode.SAFE, "none_s")
            assert first.condition is ModeCondition.TRIPPED

    def test_losing_the_attitude_is_the_business_of_every_mode_that_needs_it(self):
        sources = {row.source for row in TABLE if row.condition is ModeCondition.LOST_ATTITUDE}
        assert sources == {Mode.ACQUIRE, Mode.POINT}

    def test_safe_is_left_towards_detumble_alone(self):
        assert [row.target for row in TABLE if row.source is Mode.SAFE] == [Mode.DETUMBLE]


@pytest.mark.parametrize(("index", "row"), ROWS)
class TestEveryTransition:
    def test_after_its_dwell_and_not_one_tick_sooner(self, index, row):
        dwell = DWELL_TICKS[index]
        modes = fly(ModeState(row.source), [only(row.condition)] * (dwell + 1))
        assert modes == [row.source] * dwell + [row.target]

    def test_the_new_mode_begins_afresh(self, index, row):
        state = ModeState(row.source, since_tick=17)
        for tick in range(START, START + DWELL_TICKS[index] + 1):
            advance(state, only(row.condition), tick, CONFIG)
        assert (state.mode, state.since_tick) == (row.target, START + DWELL_TICKS[index])
        assert set(state.held_since) == {-1}

    def test_nothing_else_is_taken_on_this_condition(self, index, row):
        for mode in Mode:
            if any(other.source is mode and other.condition == row.condition for other in TABLE):
                continue
            assert set(fly(ModeState(mode), [only(row.condition)] * 700)) == {mode}

    def test_a_lost_sync_does_not_stretch_the_dwell(self, index, row):
        """Dwell is in ticks of the clock, not in steps."""
        state = ModeState(row.source)
        advance(state, only(row.condition), START, CONFIG)
        if DWELL_TICKS[index]:
            assert state.mode is row.source
            advance(state, only(row.condition), START + DWELL_TICKS[index], CONFIG)
        assert state.mode is row.target


@pytest.mark.parametrize(("index", "row"), [row for row in ROWS if DWELL_TICKS[row.values[0]]])
def test_one_tick_without_the_condition_starts_the_dwell_anew(index, row):
    dwell = DWELL_TICKS[index]
    situations = [only(row.condition)] * dwell + [QUIET] + [only(row.condition)] * (dwell + 1)
    assert fly(ModeState(row.source), situations) == [row.source] * (2 * dwell + 1) + [row.target]


@pytest.mark.parametrize("mode", Mode)
def test_without_any_condition_no_mode_is_left(mode):
    assert set(fly(ModeState(mode), [QUIET] * 3000)) == {mode}


def test_a_trip_wins_over_everything_else():
    everything = only(*set(ModeCondition) - {ModeCondition.CLEAR})
    for mode in (Mode.DETUMBLE, Mode.ACQUIRE, Mode.POINT):
        assert fly(long_in(mode), [everything]) == [Mode.SAFE]


def test_being_fast_wins_over_being_near():
    assert fly(long_in(Mode.ACQUIRE), [only(ModeCondition.FAST, ModeCondition.NEAR)]) == [Mode.DETUMBLE]


class TestTrips:
    def test_a_trip_is_counted_once_while_it_lasts(self):
        state = ModeState(Mode.POINT)
        for tick in range(50):
            advance(state, only(ModeCondition.TRIPPED), tick, CONFIG)
        assert (state.mode, state.trips) == (Mode.SAFE, 1)

    def test_a_violation_in_safe_keeps_it_there_and_is_no_trip(self):
        state = ModeState(Mode.SAFE, trips=1)
        advance(state, only(ModeCondition.TRIPPED), START, CONFIG)
        assert (state.mode, state.trips) == (Mode.SAFE, 1)

    def test_safe_is_left_after_the_first_and_the_second_trip_but_never_after_the_third(self):
        state = ModeState()
        for trip in (1, 2, 3):
            state.mode = Mode.POINT
            advance(state, only(ModeCondition.TRIPPED), START * trip, CONFIG)
            assert (state.mode, state.trips) == (Mode.SAFE, trip)
            attitude = Attitude((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0, True)
            modes = set()
            for tick in range(START * trip + 1, START * trip + 900):
                advance(state, judge_conditions(attitude, 0.0, False, True, state, CONFIG), tick, CONFIG)
                modes.add(state.mode)
            assert (Mode.DETUMBLE in modes) is (trip < 3)
        assert modes == {Mode.SAFE}


def known(angle_deg=0.0, rate_degps=0.0, axis=(0.48, 0.64, 0.6)):
    half = radians(angle_deg) / 2.0
    omega = tuple(radians(rate_degps) * c for c in (0.6, -0.48, 0.64))
    return Attitude((cos(half), *(sin(half) * c for c in axis)), omega, 0.01, 1e-4, True)


def judged(attitude, tripped=False, config=CONFIG, spin_radps=0.0, has_field=True, **state):
    holding = judge_conditions(attitude, spin_radps, tripped, has_field, ModeState(**state), config)
    assert len(holding) == len(ModeCondition)
    return {condition.name.lower() for condition in ModeCondition if holding[condition]}


def holding(attitude):
    return judge_conditions(attitude, 0.0, False, True, ModeState(), CONFIG)


class TestConditions:
    @pytest.mark.parametrize(
        ("rate_degps", "expected"),
        [
            (0.0, "slow"),
            (0.299, "slow"),
            (0.301, ""),
            (0.45, ""),
            (0.599, ""),
            (0.601, "fast"),
            (20.0, "fast"),
        ],
    )
    def test_rate(self, rate_degps, expected):
        assert judged(known(30.0, rate_degps)) - {"clear"} == set(expected.split())

    @pytest.mark.parametrize(
        ("omega_degps", "expected"),
        [
            ((1.2, 0.0, 0.0), "slow"),
            ((1.0, 0.0, 0.0), "slow"),
            ((1.4, 0.25, -0.05), ""),
            ((0.5, 0.0, 0.0), "fast"),
            ((0.0, 0.0, 0.0), "fast"),
            ((-1.2, 0.0, 0.0), "fast"),
            ((0.0, 1.2, 0.0), "fast"),
            ((1.2, 0.0, 0.7), "fast"),
        ],
    )
    def test_a_rate_counts_beside_the_spin_that_is_wanted(self, omega_degps, expected):
        """Wanted are 1.2 deg/s about body axis 1: that alone is no rate, none is too much of one."""
        turning = known(30.0, 0.0).replace(omega_body_orbit_radps=tuple(radians(w) for w in omega_degps))
        assert judged(turning, spin_radps=radians(1.2)) - {"clear"} == set(expected.split())

    @pytest.mark.parametrize(
        ("angle_deg", "expected"),
        [(0.0, "near"), (19.9, "near"), (20.1, ""), (39.9, ""), (40.1, "far"), (90.0, "far"), (180.0, "far")],
    )
    def test_angle(self, angle_deg, expected):
        assert judged(known(angle_deg, 0.45)) - {"clear"} == set(expected.split())

    @pytest.mark.parametrize(
        ("angle_deg", "expected"), [(0.0, "near"), (19.9, "near"), (20.1, ""), (39.9, ""), (40.1, "far")]
    )
    def test_angle_of_the_first_axis_alone(self, angle_deg, expected):
        """A turn about the vertical does not count; one about a horizontal axis does."""
        config = replace(CONFIG, axis_only=True)
        tilted = known(angle_deg, 0.45, axis=(0.0, 0.6, -0.8))
        assert judged(tilted, config=config) - {"clear"} == set(expected.split())
        about_vertical = known(150.0, 0.45, axis=(1.0, 0.0, 0.0))
        assert judged(about_vertical, config=config) - {"clear"} == {"near"}

    def test_the_sign_of_the_quaternion_is_the_same_attitude(self):
        attitude = known(10.0, 0.45)
        mirrored = attitude.replace(q_body_from_orbit=tuple(-c for c in attitude.q_body_from_orbit))
        assert judged(mirrored) == judged(attitude)
        assert judged(mirrored, config=replace(CONFIG, axis_only=True)) == judged(
            attitude, config=replace(CONFIG, axis_only=True)
        )

    def test_an_attitude_that_is_not_valid_says_nothing_but_that(self):
        for rate in (0.0, 1.0):
            for angle in (0.0, 90.0):
                assert judged(known(angle, rate).invalid()) == {"clear", "lost_attitude"}

    def test_without_a_field_and_an_attitude_nothing_can_act(self):
        lost = known().invalid()
        assert judged(lost, has_field=False) == {"lost_attitude", "blind"}
        assert judged(known(30.0, 0.45), has_field=False) == {"clear"}

    def test_tripped_and_clear(self):
        assert judged(known(30.0, 0.45), tripped=False) == {"clear"}
        assert judged(known(30.0, 0.45), tripped=True) == {"tripped"}
        assert judged(known(30.0, 0.45), trips=2) == {"clear"}
        assert judged(known(30.0, 0.45), trips=3) == set()


class TestHysteresis:
    @pytest.mark.parametrize("mode", [Mode.DETUMBLE, Mode.ACQUIRE])
    def test_a_rate_that_wavers_about_one_threshold_changes_nothing(self, mode):
        for threshold_degps in (0.3, 0.6):
            wavering = [holding(known(30.0, threshold_degps + 0.01 * sin(n))) for n in range(3000)]
            assert set(fly(ModeState(mode), wavering)) == {mode}

    @pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
    def test_an_angle_that_wavers_about_one_threshold_changes_nothing(self, mode):
        for threshold_deg in (20.0, 40.0):
            wavering = [holding(known(threshold_deg + sin(n), 0.1)) for n in range(3000)]
            assert set(fly(ModeState(mode), wavering)) == {mode}

    def test_between_the_thresholds_every_mode_stays(self):
        between = holding(known(30.0, 0.45))
        for mode in (Mode.DETUMBLE, Mode.ACQUIRE, Mode.POINT):
            assert set(fly(ModeState(mode), [between] * 3000)) == {mode}

    def test_a_slow_swing_through_both_thresholds_goes_there_and_back_once(self):
        swing = [holding(known(30.0 - 30.0 * cos(pi * n / 5000.0), 0.1)) for n in range(10000)]
        modes = fly(ModeState(Mode.ACQUIRE), swing)
        changes = [b for a, b in zip([Mode.ACQUIRE, *modes], modes, strict=False) if a is not b]
        assert changes == [Mode.POINT, Mode.ACQUIRE, Mode.POINT]
