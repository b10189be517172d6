"""summary.json of flights made up: each number by a second formula."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.events import Event
from fsw.wire.messages import CoilRefused, FswEvent, Mode, PlantEvent, TickDone
from sim.record.candump import LogEntry
from sim.record.estimates import Estimates
from sim.report.figures.estimate_error import nees, within_3sigma
from sim.report.figures.performance import perform
from sim.report.summary import MAX_EVENTS, BusTally, summarise, summary_text
from sim.scenario.schema import load, orbit_period_s, parse_settings

TICKS = 2400
ORBIT_RATE = 1.04e-3


class Made:
    """A made-up flight: truth and estimates that differ by known errors."""

    def __init__(self, error_rad, rate_error=None, covariance=None):
        ticks = len(error_rad)
        random = np.random.default_rng(4)
        self.truth = {
            "t_s": np.arange(ticks, dtype=float),
            "q_body_from_orbit": Rotation.random(ticks, random).as_quat(scalar_first=True),
            "omega_body_orbit_radps": random.normal(0.0, 1e-3, (ticks, 3)),
            "lit": np.ones(ticks),
        }
        rate_error = np.zeros((ticks, 3)) if rate_error is None else rate_error
        true = Rotation.from_quat(self.truth["q_body_from_orbit"], scalar_first=True)
        # q_true = q_est (x) dq: ours multiply from the left to the right as scipy's do
        estimated = true * Rotation.from_rotvec(error_rad).inv()
        normal_true = true.as_matrix().transpose(0, 2, 1)[:, :, 2]
        omega = self.truth["omega_body_orbit_radps"] + ORBIT_RATE * normal_true - rate_error
        normal_estimated = estimated.as_matrix().transpose(0, 2, 1)[:, :, 2]
        self.estimates = Estimates(
            q_body_from_orbit=estimated.as_quat(scalar_first=True),
            omega_body_orbit_radps=omega - ORBIT_RATE * normal_estimated,
            omega_body_radps=omega,
            covariance=np.tile(np.eye(6) * 1e-6 if covariance is None else covariance, (ticks, 1, 1)),
            valid=np.ones(ticks, dtype=bool),
            mode=np.full(ticks, int(Mode.POINT)),
        )

    def summary(self, audit, settings=(), tally=None):
        scenario = load("microsat", parse_settings(settings))
        performance = perform(scenario, self.truth, self.estimates)
        return summarise(scenario, {"seed": 1}, performance, audit, tally or BusTally(0))


def error_of(degrees_by_tick):
    """Errors of given size about ever changing axes."""
    axes = np.random.default_rng(9).normal(size=(len(degrees_by_tick), 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return np.radians(degrees_by_tick)[:, None] * axes


class TestEstimate:
    def test_error_rms_and_max_from_convergence_on(self, audit):
        size = np.full(TICKS, 0.5)
        size[:300] = 10.0
        size[900:1200], size[1500] = 1.0, 1.9
        made = Made(error_of(size))
        made.truth["lit"][1000:] = 0.0
        summary = made.summary(audit)
        assert summary["converged_at_s"] == 300.0
        errors = summary["estimate_deg"]
        assert errors["rms_sunlit"] == pytest.approx(np.sqrt(np.mean(size[300:1000] ** 2)), rel=1e-9)
        assert errors["rms_eclipse"] == pytest.approx(np.sqrt(np.mean(size[1000:] ** 2)), rel=1e-9)
        assert errors["max"] == pytest.approx(1.9, rel=1e-9)

    def test_convergence_is_the_first_tick_of_ten_minutes_below_two_degrees(self, audit):
        size = np.full(TICKS, 1.0)
        size[:100] = 5.0
        size[650] = 2.01  # 550 s are not enough
        assert Made(error_of(size)).summary(audit)["converged_at_s"] == 651.0
        size[650], size[700] = 1.99, 2.01  # exactly 600 s are
        assert Made(error_of(size)).summary(audit)["converged_at_s"] == 100.0

    def test_what_comes_after_convergence_counts_however_bad(self, audit):
        size = np.full(TICKS, 1.0)
        size[2000:] = 30.0
        summary = Made(error_of(size)).summary(audit)
        assert summary["converged_at_s"] == 0.0
        assert summary["estimate_deg"]["max"] == pytest.approx(30.0)

    def test_convergence_counts_in_seconds(self, audit):
        size = np.full(TICKS, 1.0)
        size[:100] = 5.0
        assert Made(error_of(size)).summary(audit, ("time.tick_hz=2",))["converged_at_s"] == 50.0
        assert "converged_at_s" not in Made(error_of(size)).summary(audit, ("time.tick_hz=4",))

    def test_without_convergence_no_error_is_told(self, audit):
        summary = Made(error_of(np.full(TICKS, 2.5))).summary(audit)
        assert not {"estimate_deg", "converged_at_s", "nees_mean"} & set(summary)

    def test_before_the_first_estimate_nothing_has_converged(self, audit):
        made = Made(error_of(np.full(TICKS, 1.0)))
        made.estimates.q_body_from_orbit[:200] = np.nan
        assert made.summary(audit)["converged_at_s"] == 200.0

    def test_a_filter_that_begins_anew_leaves_no_nan_in_the_summary(self, audit, strict):
        made = Made(error_of(np.full(TICKS, 1.0)))
        for history in (
            made.estimates.q_body_from_orbit,
            made.estimates.omega_body_radps,
            made.estimates.covariance,
        ):
            history[1700:1720] = np.nan
        summary = strict(json.dumps(made.summary(audit)))
        assert summary["estimate_deg"]["rms_sunlit"] == pytest.approx(1.0)
        assert summary["nees_mean"] > 0.0

    def test_a_flight_in_the_light_alone_has_no_error_in_eclipse(self, audit):
        summary = Made(error_of(np.full(TICKS, 1.0))).summary(audit)
        assert set(summary["estimate_deg"]) == {"rms_sunlit", "max", "within_3sigma"}


class TestWithin3Sigma:
    """Sigma is 1, 2 and 3 mrad about the body axes; the limits are 3, 6 and 9 mrad."""

    COVARIANCE = np.diag([1e-6, 4e-6, 9e-6, 1e-10, 1e-10, 1e-10])
    INSIDE = (0.00299, -0.00598, 0.00897)

    def made(self, **errors_by_ticks):
        error = np.tile(self.INSIDE, (TICKS, 1))
        for axis, ticks, size in errors_by_ticks.values():
            error[ticks, axis] = size
        return Made(error, covariance=self.COVARIANCE)

    def part(self, made, audit):
        return made.summary(audit)["estimate_deg"]["within_3sigma"]

    def test_each_axis_is_compared_with_its_own_sigma(self, audit):
        assert self.part(self.made(), audit) == 1.0
        for axis, size in enumerate((0.00301, -0.00602, 0.00903)):
            made = self.made(beyond=(axis, slice(600), size))
            assert self.part(made, audit) == pytest.approx(1.0 - 600 / TICKS)
            expected = np.ones((TICKS, 3), dtype=bool)
            expected[:600, axis] = False
            np.testing.assert_array_equal(within_3sigma(made.truth, made.estimates), expected)

    def test_a_tick_counts_where_all_axes_are_inside(self, audit):
        made = self.made(first=(0, slice(0, 600), 0.004), third=(2, slice(300, 900), -0.01))
        assert self.part(made, audit) == pytest.approx(1.0 - 900 / TICKS)

    def test_what_is_before_convergence_does_not_count(self, audit):
        made = self.made(late=(1, slice(600), 0.1))
        assert made.summary(audit)["converged_at_s"] == 600.0
        assert self.part(made, audit) == 1.0

    def test_what_is_not_called_valid_does_not_count(self, audit):
        made = self.made(beyond=(1, slice(600), 0.01))
        made.estimates.valid[:900] = False
        assert self.part(made, audit) == 1.0
        made.estimates.valid[:900], made.estimates.valid[900:] = True, False
        assert self.part(made, audit) == pytest.approx(1.0 / 3.0)

    def test_a_tick_without_an_estimate_does_not_count(self, audit):
        made = self.made(beyond=(1, slice(600), 0.01))
        made.estimates.q_body_from_orbit[1200:1800] = np.nan
        made.estimates.covariance[1200:1800] = np.nan
        assert self.part(made, audit) == pytest.approx(2.0 / 3.0)

    def test_without_a_covariance_it_is_unknown(self, audit, strict):
        made = self.made()
        made.estimates.covariance[:] = np.nan
        assert strict(json.dumps(made.summary(audit)))["estimate_deg"]["within_3sigma"] is None


class TestNees:
    COVARIANCE = np.array(
        [
            [4.0, 1.0, 0.5, 0.3, 0.1, 0.0],
            [1.0, 3.0, 0.7, 0.0, 0.4, 0.2],
            [0.5, 0.7, 2.0, 0.1, 0.0, 0.5],
            [0.3, 0.0, 0.1, 1.5, 0.2, 0.1],
            [0.1, 0.4, 0.0, 0.2, 1.0, 0.3],
            [0.0, 0.2, 0.5, 0.1, 0.3, 2.5],
        ]
    ) * np.outer([1e-3] * 3 + [1e-5] * 3, [1e-3] * 3 + [1e-5] * 3)

    def errors(self, ticks):
        return np.random.default_rng(7).multivariate_normal(np.zeros(6), self.COVARIANCE, ticks)

    def test_is_the_squared_error_weighed_by_the_inverse_covariance(self):
        error = self.errors(200)
        made = Made(error[:, :3], error[:, 3:], self.COVARIANCE)
        expected = [e @ np.linalg.inv(self.COVARIANCE) @ e for e in error]
        np.testing.assert_allclose(nees(made.truth, made.estimates), expected, rtol=1e-4)

    def test_of_an_honest_filter_is_six_on_average(self, audit):
        """Six states: chi-square of mean 6 and variance 12."""
        error = self.errors(TICKS)
        summary = Made(error[:, :3], error[:, 3:], self.COVARIANCE).summary(audit)
        assert summary["nees_mean"] == pytest.approx(6.0, abs=4.0 * np.sqrt(12.0 / TICKS))

    def test_of_one_that_is_too_sure_is_more(self, audit):
        error = self.errors(TICKS)
        summary = Made(error[:, :3], error[:, 3:], self.COVARIANCE / 4.0).summary(audit)
        assert summary["nees_mean"] == pytest.approx(24.0, rel=0.05)

    @pytest.mark.parametrize(
        "singular", [np.zeros((6, 6)), np.outer(np.arange(1.0, 7.0), np.arange(1.0, 7.0))]
    )
    def test_is_unknown_where_the_covariance_is_singular_and_only_there(self, singular):
        error = self.errors(10)
        made = Made(error[:, :3], error[:, 3:], self.COVARIANCE)
        expected = nees(made.truth, made.estimates)
        made.estimates.covariance[4] = singular
        expected[4] = np.nan
        np.testing.assert_array_equal(nees(made.truth, made.estimates), expected)

    @pytest.mark.parametrize("unknown", [np.nan, np.inf])
    def test_an_unknown_covariance_beside_a_singular_one_leaves_the_others(self, unknown):
        error = self.errors(10)
        made = Made(error[:, :3], error[:, 3:], self.COVARIANCE)
        expected = nees(made.truth, made.estimates)
        made.estimates.covariance[4], made.estimates.covariance[7] = 0.0, unknown
        expected[[4, 7]] = np.nan
        np.testing.assert_array_equal(nees(made.truth, made.estimates), expected)

    def test_is_unknown_where_rounding_has_made_the_covariance_indefinite(self):
        error = self.errors(10)
        made = Made(error[:, :3], error[:, 3:], self.COVARIANCE)
        made.estimates.covariance[4] *= -1.0
        assert np.isnan(nees(made.truth, made.estimates)).tolist() == [tick == 4 for tick in range(10)]

    def test_is_unknown_where_the_estimate_is(self):
        made = Made(error_of(np.full(10, 1.0)))
        made.estimates.omega_body_radps[3] = np.nan
        assert np.isnan(nees(made.truth, made.estimates)).tolist() == [tick == 3 for tick in range(10)]


class TestSettling:
    def tilted(self, degrees_by_tick):
        made = Made(error_of(np.full(len(degrees_by_tick), 1.0)))
        half = np.radians(degrees_by_tick) / 2.0
        made.truth["q_body_from_orbit"] = np.stack((np.cos(half), 0 * half, 0 * half, np.sin(half)), axis=1)
        return made

    def test_settling_is_after_the_last_excursion_beyond_five_degrees(self, audit):
        tilt = np.full(TICKS, 4.0)
        tilt[:700], tilt[1000] = 60.0, 5.0
        axis1 = self.tilted(tilt).summary(audit)["axis1_deg"]
        period_s = orbit_period_s(load("microsat"))
        assert axis1["settle_orbits_5deg"] == pytest.approx(1001.0 / period_s)

    def test_what_is_not_settled_at_the_end_has_not_settled(self, audit):
        tilt = np.full(TICKS, 1.0)
        tilt[-1] = 5.1
        assert "settle_orbits_5deg" not in self.tilted(tilt).summary(audit)["axis1_deg"]

    @pytest.mark.parametrize(("within_s", "settled"), [(1, False), (599, False), (600, True)])
    def test_what_is_within_only_at_the_last_has_not_been_seen_to_stay(self, audit, within_s, settled):
        tilt = np.full(TICKS, 60.0)
        tilt[-within_s:] = 1.0
        summary = self.tilted(tilt).summary(audit)
        assert ("settle_orbits" in summary["controlled"]) is settled
        assert ("settle_orbits_5deg" in summary["axis1_deg"]) is settled
        text = summary_text(summary)
        assert ("not settled: not under 5 deg for the last 600 s" in text) is not settled

    def test_what_was_always_within_has_settled_at_once(self, audit):
        assert self.tilted(np.full(TICKS, 1.0)).summary(audit)["axis1_deg"]["settle_orbits_5deg"] == 0.0

    def test_the_last_orbit_alone_counts_where_it_says_so(self, audit):
        period = round(orbit_period_s(load("microsat")))
        tilt = np.full(2 * period, 3.0)
        tilt[: period - 1] = 50.0
        axis1 = self.tilted(tilt).summary(audit)["axis1_deg"]
        assert axis1["rms_last_orbit"] == pytest.approx(3.0)
        assert axis1["max_last_orbit"] == pytest.approx(3.0)
        assert axis1["mean_last_orbit"] == pytest.approx(3.0)


class TestSpin:
    def spinning(self, audit, rates, *pulses_at):
        made = Made(error_of(np.full(len(rates), 1.0)))
        made.truth["omega_body_orbit_radps"][:, 0] = rates
        pulse = audit.pulses[0]
        fired = tuple(replace(pulse, start_s=at) for at in pulses_at)
        return made.summary(
            replace(audit, pulses=fired), ("control.law=rate_damping", "control.spin_radps=0.02")
        )

    def test_settles_when_it_last_comes_within_a_milliradian_a_second(self, audit):
        """Not when it first does: it leaves once more."""
        rates = np.concatenate((np.linspace(0.0, 0.0195, 1001), np.full(TICKS - 1001, 0.0201)))
        rates[1010:1020] = 0.0212
        spin = self.spinning(audit, rates, 100, 203, 500, 1500)["spin_radps"]
        assert spin["reference"] == 0.02
        assert spin["settle_s_1e-3"] == 1020
        assert spin["pulses_to_settle"] == 3
        assert spin["mean_last_orbit"] == pytest.approx(rates.mean())
        assert spin["max_dev_last_orbit"] == pytest.approx(0.02)

    def test_a_spin_that_is_never_reached_has_not_settled(self, audit):
        spin = self.spinning(audit, np.full(TICKS, 0.01))["spin_radps"]
        assert "settle_s_1e-3" not in spin
        left = np.full(TICKS, 0.02)
        left[-1] = 0.0211
        assert "settle_s_1e-3" not in self.spinning(audit, left)["spin_radps"], "out again at the end"
        left[:-599], left[-599:] = 0.0, 0.02
        assert "settle_s_1e-3" not in self.spinning(audit, left)["spin_radps"], "reached just before the end"
        assert spin["max_dev_last_orbit"] == pytest.approx(0.01)


class TestTally:
    EPOCH_US = 1_427_424_417_000_000

    def entry(self, frame, seconds=0.0):
        return LogEntry(1, self.EPOCH_US + round(seconds * 1e6), "vcan0", frame)

    def test_events_of_all_nodes_with_their_time(self):
        tally = BusTally(self.EPOCH_US)
        tally.take(self.entry(FswEvent(2, 4, 17, -5).encode(), 17.25))
        tally.take(self.entry(PlantEvent(1, 9, 18, 3).encode(), 18.0))
        tally.take(self.entry(TickDone(18, 1).encode(), 18.0))
        shown = ("t_s", "node", "event", "name", "severity", "severity_name", "argument", "text")
        assert [tuple(event[key] for key in shown) for event in tally.events] == [
            (17.25, "FSW", 4, "MONITOR_TRIPPED", 2, "ERROR", -5, "monitor tripped: number -5"),
            (18.0, "PLANT", 9, None, 1, "WARNING", 3, "event 9 (3)"),
        ]

    def test_all_events_are_counted_and_the_first_kept_and_the_cut_is_said(self, audit):
        tally = BusTally(self.EPOCH_US)
        for tick in range(MAX_EVENTS + 1):
            tally.take(self.entry(FswEvent(1, 1, tick, 3).encode(), tick))
            if tick == MAX_EVENTS - 1:
                whole = Made(error_of(np.full(10, 1.0))).summary(audit, tally=tally)
                assert (whole["event_count"], len(whole["events"])) == (MAX_EVENTS, MAX_EVENTS)
                assert "events " not in summary_text(whole)
        assert (tally.event_count, len(tally.events)) == (MAX_EVENTS + 1, MAX_EVENTS)
        summary = Made(error_of(np.full(10, 1.0))).summary(audit, tally=tally)
        assert summary["event_count"] == MAX_EVENTS + 1
        assert "201; the first 200 of 201 events are in summary.json" in summary_text(summary)

    def test_refusals_are_counted_but_for_broken_ones(self):
        tally = BusTally(self.EPOCH_US)
        for seq in range(3):
            tally.take(self.entry(CoilRefused(1, seq, 8, 0).encode()))
        broken = CoilRefused(1, 4, 8, 0).encode()
        tally.take(self.entry(broken.replace(data=broken.data[:-1] + b"\0")))
        assert (tally.refused, tally.events) == (3, [])

    def test_a_broken_event_is_none(self):
        tally = BusTally(self.EPOCH_US)
        frame = FswEvent(2, 4, 17, -5).encode()
        tally.take(self.entry(frame.replace(data=frame.data[:-1] + b"\0")))
        assert tally.events == []

    def test_isolated_units_are_named_once_in_the_order_of_their_isolation(self, audit):
        tally = BusTally(self.EPOCH_US)
        for event, argument in (
            (Event.COIL_FAULT, 203),
            (Event.SENSOR_ISOLATED, 204),
            (Event.SENSOR_READMITTED, 204),
            (Event.SENSOR_ISOLATED, 201),
            (Event.MODE_CHANGED, 100),
        ):
            tally.take(self.entry(FswEvent(2, event, 17, argument).encode()))
        assert tally.isolated == ["coil 1", "sun sensor"]
        made = Made(error_of(np.full(TICKS, 1.0)))
        assert made.summary(audit, tally=tally)["isolated"] == ["coil 1", "sun sensor"]

    def test_no_other_node_isolates(self):
        tally = BusTally(self.EPOCH_US)
        tally.take(self.entry(PlantEvent(1, Event.SENSOR_ISOLATED, 18, 101).encode()))
        assert tally.isolated == []

    def test_a_unit_that_is_isolated_after_a_flood_of_events_counts(self):
        tally = BusTally(self.EPOCH_US)
        for number in range(1000):
            tally.take(self.entry(FswEvent(0, Event.TIME_MISMATCH, 0, number).encode()))
        tally.take(self.entry(FswEvent(2, Event.SENSOR_ISOLATED, 17, 106).encode()))
        assert tally.isolated == ["magnetometer"]

    def test_a_flood_of_events_is_kept_to_the_first(self):
        tally = BusTally(self.EPOCH_US)
        for number in range(1000):
            tally.take(self.entry(FswEvent(0, 1, 0, number).encode()))
        assert [event["argument"] for event in tally.events] == list(range(200))


def test_a_flight_without_a_tick_has_a_summary_too(audit):
    empty = {
        "t_s": np.zeros(0),
        "q_body_from_orbit": np.zeros((0, 4)),
        "omega_body_orbit_radps": np.zeros((0, 3)),
        "lit": np.zeros(0),
    }
    made = Made(error_of(np.full(1, 1.0)))
    performance = perform(load("microsat"), empty, made.estimates)
    summary = summarise(load("microsat"), {"seed": 1}, performance, audit, BusTally(0))
    assert (summary["ticks"], summary["sim_seconds"]) == (0, 0.0)
    assert "pointing_deg" not in summary
    assert summary_text(summary)
