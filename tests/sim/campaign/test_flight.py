"""A flight without files has the results of ``torquer sil``."""

import json
from itertools import permutations
from math import inf, isnan, nan

import numpy as np
import pytest

from fsw.input.schema import merge
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, MagField, Mode
from sim.campaign.claim import ClaimVerdict
from sim.campaign.flight import FlightResult, Order, digest_of, fly_order, record_scenario
from sim.campaign.in_memory import FrameDigest
from sim.campaign.study import (
    Figure,
    Group,
    campaign,
    describe_order,
    summary_number,
    summary_value,
)
from sim.record import run_dir
from sim.report.conclude import conclude
from sim.scenario.schema import load

FIRE = CoilFire(coil=1, level=-2, duration_ms=3000, seq=7, tick=9).encode()
FIELD = MagField(b_x=1.0, b_y=2.0, b_z=3.0, valid=1).encode()


def digest(*ticks):
    found = FrameDigest()
    for frames in ticks:
        found.take(frames)
    return found


def test_frames_count_in_their_order_and_not_by_tick():
    whole = digest([FIELD, FIRE])
    assert whole.frames == digest([FIELD], [FIRE]).frames
    assert whole.frames != digest([FIRE, FIELD]).frames


def test_a_sensor_frame_changes_all_but_not_the_commands():
    other = Frame(FIELD.can_id, FIELD.data[:-1] + bytes([FIELD.data[-1] ^ 1]))
    before, after = digest([FIELD, FIRE]), digest([other, FIRE])
    assert before.frames != after.frames
    assert before.commands == after.commands != digest([FIELD]).commands


def test_that_of_a_log_is_that_of_its_frames(recorded_run):
    log = recorded_run / run_dir.BUS_LOG
    found = digest_of(log)
    assert found.frames != digest().frames
    assert found.commands != digest().commands
    assert digest_of(log).frames == found.frames


# --- A flight without files has the results of ``torquer sil``

OVERRIDES = {
    "body": {"inertia_kgm2": [[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]},
    "initial": {"axis": [0.5, -0.7, 0.4], "rate_degps": [0.05, -0.07, 0.04]},
    "sensors": {"magnetometer": {"bias_nt": [150.0, -250.0, 100.0]}},
    "disturbance": {"torque_nm": [3e-8, -2e-8, 1e-8], "residual_dipole_am2": [0.003, 0.002, -0.004]},
    "flight": {"modes": {"settle_s": 20.0}},
}
ORBITS = 300 / (86400.0 / 14.30166407)
COMBINED = ("median", "mean", "worst")
UNTIMED = {"wall_seconds", "realtime_factor", "replay", "code", "algebra"}


def final_row(scenario, truth, estimates):
    return {"rows": float(len(truth["t_s"])), "known": float(np.isfinite(estimates.covariance[-1]).all())}


@pytest.fixture(scope="module")
def flown():
    return fly_order(Order("microsat", OVERRIDES, seed=5, orbits=ORBITS, measure=final_row))


@pytest.mark.long
def test_the_summary_is_that_of_the_run_directory(flown, fly_run):
    path = fly_run()
    expected = {key: value for key, value in conclude(path).items() if key not in UNTIMED}
    ours = {key: value for key, value in flown.summary.items() if key not in UNTIMED}
    assert json.loads(json.dumps(ours)) == expected
    assert expected["pulses"]["total"] == 2
    assert expected["events"]


@pytest.mark.long
def test_its_audit_sees_what_the_board_drove(flown, fly_run):
    assert flown.summary["limits_ok"] is True
    fast = fly_order(
        Order("microsat", merge(OVERRIDES, {"coils": {"backoff_s": 20.0}}), seed=5, orbits=ORBITS)
    )
    assert fast.summary["min_gap_s"]["any"] < 100.0
    assert run_dir.read_run(fly_run())["ticks"] == flown.summary["ticks"]


def test_it_is_judged_by_the_limits_of_its_own_scenario():
    quick = {"coils": {"backoff_s": 20.0, "pulse_s": 1.0}}
    record = record_scenario(load("microsat", merge(OVERRIDES, quick)), 5, ORBITS / 4)
    assert (record.audit.limits.pulse_us, record.audit.limits.backoff_us) == (1_000_000, 20_000_000)
    assert record.summary()["min_gap_s"]["any"] < 100.0
    assert record.summary()["limits_ok"] is True


def test_its_telecommands_are_sent_and_its_events_have_their_time_in_the_flight():
    sent = [{"at_s": 40.0, "message": "TC_MODE", "mode": "SAFE"}]
    summary = record_scenario(load("microsat", {**OVERRIDES, "telecommand": sent}), 5, ORBITS / 5).summary()
    changes = [(event["t_s"], event["argument"]) for event in summary["events"] if event["event"] == 1]
    assert changes[-1] in ((40.0, Mode.SAFE), (41.0, Mode.SAFE))
    assert summary["mode_final"] == "SAFE"


def test_statuses_that_break_on_their_way_are_not_held_against_the_board():
    broken = [{"kind": "corruption", "at_s": 5.0, "parameters": {"part": 0.5}}]
    record = record_scenario(load("microsat", {**OVERRIDES, "fault": broken}), 5, ORBITS / 5)
    assert record.tally.refused == 0
    assert record.summary()["limits_ok"] is True


def test_further_figures_are_taken_from_its_histories(flown):
    assert flown.figures == {"rows": 300.0, "known": 1.0}


def test_numbers_of_a_summary():
    flight = FlightResult(Order("x"), {"a": {"b": 2, "text": "c"}, "ok": True}, {})
    assert summary_number(flight, "a.b") == 2.0
    assert summary_number(flight, "ok") == 1.0
    assert summary_value("a.missing", inf)(flight) == inf
    assert np.isnan(summary_number(flight, "a.b.c"))
    assert np.isnan(summary_number(flight, "a.text"))


def test_a_label_tells_what_is_special():
    order = Order("posat1", {"orbit": {"raan_deg": 60.0}, "initial": {"axis": [0, 1.23456, 0]}}, seed=3)
    assert describe_order(order) == "posat1, seed 3, orbit.raan_deg=60, initial.axis=[0, 1.235, 0]"


def test_an_order_with_a_name_goes_by_it():
    assert describe_order(Order("microsat", {"time": {"tick_hz": 2}}, seed=3, name="mine")) == "mine"


class TestFigures:
    def outcome(self, values, **how):
        orders = tuple(Order("x", seed=seed) for seed in range(len(values)))
        other = (Order("y"),)
        figure = Figure("f", "what", "deg", summary_value("v", nan), group="mine", **how)
        study = campaign("s", "who", (Group("other", other), Group("mine", orders)), (figure,))
        assert len(study.tasks) == len(values) + 1
        flights = [FlightResult(order, {"v": value}, {}) for order, value in zip(orders, values, strict=True)]
        return study.conclude([FlightResult(other[0], {"v": -1e9}, {}), *flights])[0]

    def test_the_worst_flight_counts_and_is_identified(self):
        outcome = self.outcome([1.0, 4.0, 3.0], high=3.5)
        assert (outcome.ours, outcome.verdict.value, outcome.where) == (4.0, "FAIL", "worst: x, seed 1: 4")
        assert self.outcome([1.0, 4.0, 3.0], low=1.5).ours == 1.0
        assert self.outcome([1.0, 4.0, 3.0], low=0.9, high=10.0).ours == 1.0

    def test_the_median_and_the_mean(self):
        assert self.outcome([1.0, 9.0, 3.0], of="median", high=3.0).verdict.value == "PASS"
        assert self.outcome([1.0, 9.0, 2.0], of="mean", high=3.9).verdict.value == "FAIL"

    def test_a_flight_without_the_figure_fails(self):
        outcome = self.outcome([1.0, nan, 2.0], high=3.0)
        assert outcome.verdict.value == "FAIL"
        assert outcome.where == "no figure in 1 of 3 flights: x, seed 1"

    @pytest.mark.parametrize("of", COMBINED)
    @pytest.mark.parametrize("values", [*permutations([nan, 1.0, 2.0, 3.0])])
    def test_what_is_no_number_hides_in_no_combination(self, of, values):
        """Wherever it stands among the flights: sorting would not tell."""
        outcome = self.outcome(list(values), of=of, high=5.0)
        assert outcome.verdict is ClaimVerdict.FAIL
        assert isnan(outcome.ours)
        assert outcome.where == f"no figure in 1 of 4 flights: x, seed {values.index(nan)}"
        assert (outcome.spread.meet, outcome.spread.most) == (3, inf)

    def test_a_median_or_mean_of_fewer_flights_than_the_claim_is_made_for_is_no_verdict(self):
        orders = tuple(Order("x", seed=seed) for seed in range(3))
        figures = [Figure(of, "what", "deg", summary_value("v", nan), of, high=2.5) for of in COMBINED]
        for made_for, verdicts in (
            (0, ["PASS", "FAIL", "FAIL"]),
            (3, ["PASS", "FAIL", "FAIL"]),
            (4, ["too few to judge", "too few to judge", "FAIL"]),
        ):
            study = campaign("s", "who", (Group("", orders),), figures, "satellites", made_for)
            flights = [
                FlightResult(order, {"v": v}, {}) for order, v in zip(orders, (1.0, 2.0, 9.0), strict=True)
            ]
            assert [outcome.verdict.value for outcome in study.conclude(flights)] == verdicts
        few = study.conclude(flights)[0]
        assert (few.ours, few.where) == (2.0, "3 of the 4 satellites that it is claimed for")
        flights[1] = FlightResult(orders[1], {}, {})
        assert {outcome.verdict for outcome in study.conclude(flights)} == {ClaimVerdict.FAIL}

    def test_one_that_never_settles_is_worst_but_may_be_beyond_the_median(self):
        assert self.outcome([1.0, inf, 2.0], high=3.0).verdict.value == "FAIL"
        assert self.outcome([1.0, inf, 2.0], of="median", high=3.0).ours == 2.0

    def test_only_flights_that_count_are_judged(self):
        outcome = self.outcome([1.0, 9.0, 2.0], high=3.0, counts=lambda flight: flight.summary["v"] < 5.0)
        assert (outcome.verdict, outcome.ours) == (ClaimVerdict.PASS, 2.0)

    def test_without_a_flight_that_counts_there_is_no_verdict(self):
        outcome = self.outcome([1.0, 9.0], high=3.0, counts=lambda flight: False)
        assert outcome.verdict is ClaimVerdict.ABSENT
