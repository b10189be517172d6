"""Claims on PoSAT-1: which flights they fly, what they compare, and when they fail."""

import numpy as np
import pytest

from sim.campaign.claim import ClaimVerdict, Threshold
from sim.campaign.flight import FlightResult
from sim.record.estimates import EstimateRecorder
from sim.scenario.schema import load
from sim.validate.consat import posat1

STARTS = 12
SOUND = {"m2_until_settled": 4.0, "of_full_scale": 0.001}


def flight(order, settle, limits_ok=True, figures=None):
    axis1 = {} if settle is None else {"settle_orbits_5deg": settle}
    return FlightResult(order, {"limits_ok": limits_ok, "axis1_deg": axis1}, SOUND | (figures or {}))


def judged(pulses, free=(3.0,) * STARTS, energy=(2.0,) * STARTS, figures=None):
    """The outcomes of libration by the last word of their ids; figures of the flights with pulses."""
    study = posat1.libration()
    settle = [*pulses, *free, *energy]
    kinds = [figures] * STARTS + [None] * 2 * STARTS
    flights = [
        flight(task.args[0], one, figures=kind)
        for task, one, kind in zip(study.tasks, settle, kinds, strict=True)
    ]
    return {o.claim.id.rpartition(".")[2]: o for o in study.conclude(flights)}


def failed(outcomes):
    return {name for name, outcome in outcomes.items() if outcome.verdict is ClaimVerdict.FAIL}


class TestLibration:
    def test_twelve_starts_by_three_laws(self):
        orders = [task.args[0] for task in posat1.libration().tasks]
        starts = [str(order.overrides["orbit"]) + str(order.overrides["initial"]) for order in orders]
        assert len(set(starts[:STARTS])) == STARTS
        assert starts[:STARTS] == starts[STARTS : 2 * STARTS] == starts[2 * STARTS :]
        assert all("coils" not in order.overrides for order in orders[:STARTS])
        laws = [load(order.scenario, order.overrides) for order in orders[::STARTS]]
        assert [one.control.law for one in laws] == ["predictive", "predictive", "rate_damping"]
        assert [one.coils.driver for one in laws] == ["pulsed", "continuous", "continuous"]
        assert {one.initial.angle_deg for one in laws} == {60.0}
        assert len({order.orbits for order in orders}) == 1, "none has less time to leave the band again"

    def test_what_the_fitted_levels_give_does_not_count(self):
        outcomes = judged([2.0] * STARTS, figures={"m2_until_settled": 5.0})
        assert outcomes["median"].verdict is ClaimVerdict.FITTED
        assert not failed(outcomes)

    def test_the_paper_s_figure_stands_beside_what_all_starts_give(self):
        outcome = judged([1.0] * 5 + [2.0] * 6 + [3.5], figures={"m2_until_settled": 5.0})["median"]
        assert outcome.claim.high == 3.0
        spread = outcome.spread
        assert (spread.flights, spread.meet, spread.least, spread.most) == (12, 11, 1.0, 3.5)

    @pytest.mark.parametrize(
        ("pulses", "free", "energy", "failing"),
        [
            ([3.1] * 12, [3.0] * 12, [2.0] * 12, {"median"}),
            ([2.0] * 11 + [4.6], [3.0] * 12, [2.0] * 12, {"all"}),
            ([2.5] * 12, [2.1] * 12, [2.0] * 12, {"restricted"}),
            ([2.5] * 12, [3.0] * 12, [1.2] * 12, {"energy_law"}),
            ([2.0] * 12, [3.0] * 12, [4.1] * 12, {"energy_law"}),
        ],
    )
    def test_each_comparison_can_fail(self, pulses, free, energy, failing):
        assert failed(judged(pulses, free, energy, {"m2_until_settled": 5.0})) == failing

    def test_one_that_never_settles_fails(self):
        assert "all" in failed(judged([2.0] * 11 + [None], figures={"m2_until_settled": 5.0}))

    def test_a_law_that_dissipates_less_than_the_energy_law_fails(self):
        assert failed(judged([2.0] * 12, figures={"m2_until_settled": 3.9})) == {"dissipation"}

    def test_a_bound_that_acts_fails(self):
        study = posat1.libration()
        flights = [flight(task.args[0], 2.0) for task in study.tasks]
        flights[15] = flight(study.tasks[15].args[0], 2.0, figures={"of_full_scale": 1.0})
        names = {o.claim.id for o in study.conclude(flights) if o.verdict is ClaimVerdict.FAIL}
        assert names == {"posat1.unbounded_free"}

    def test_limits_that_are_broken_fail(self):
        study = posat1.libration()
        flights = [flight(task.args[0], 2.0) for task in study.tasks]
        flights[3] = flight(study.tasks[3].args[0], 2.0, limits_ok=False)
        names = {o.claim.id for o in study.conclude(flights) if o.verdict is ClaimVerdict.FAIL}
        assert names == {"posat1.limits"}


def estimates(ticks):
    return EstimateRecorder(ticks).estimates()


class TestEffort:
    def truth(self, angles_deg, m):
        half = 0.5 * np.radians(np.asarray(angles_deg, dtype=float))
        q = np.zeros((len(half), 4))
        q[:, 0], q[:, 3] = np.cos(half), np.sin(half)
        return {"q_body_from_orbit": q, "m_body_am2": np.asarray(m, dtype=float)}

    def test_counts_until_it_has_left_the_band_for_the_last_time(self):
        angles_deg, m = [60.0, 4.0, 6.0, 4.9], [[1, 2, 0], [3, 0, 0], [0, 0, -2], [9, 0, 0]]
        truth = self.truth([*angles_deg, *[1.0] * 599], [*m, *[[0, 9, 0]] * 599])
        found = posat1.effort(load("posat1"), truth, estimates(603))
        assert found["m2_until_settled"] == pytest.approx(1 + 4 + 9 + 4)

    def test_counts_the_whole_flight_where_it_has_not_been_seen_to_stay(self):
        truth = self.truth([60.0, *[1.0] * 599], [[1, 0, 0]] * 600)
        found = posat1.effort(load("posat1"), truth, estimates(600))
        assert found["m2_until_settled"] == pytest.approx(600)

    def test_the_largest_component_is_told_of_the_full_scale(self):
        scenario = load("posat1", posat1.FREE)
        truth = self.truth([1.0, 1.0], [[0, -500.0, 3.0], [1.0, 1.0, 1.0]])
        assert posat1.effort(scenario, truth, estimates(2))["of_full_scale"] == pytest.approx(0.25)


def test_the_final_spin_is_that_of_the_last_tick():
    truth = {"omega_body_orbit_radps": np.array([[0.5, 0.0, 0.0], [0.0197, 0.1, 0.2]])}
    assert posat1.final_spin(load("posat1-spinup"), truth, estimates(2))["spin_error"] == pytest.approx(3e-4)


class TestSpin:
    def test_the_fitted_tilt_does_not_count_and_the_deviation_does(self):
        thresholds = {figure.id: figure.threshold for figure in posat1.spin().figures}
        assert thresholds["tilt"] is thresholds["all"] is Threshold.FITTED
        assert thresholds["deviation"] is Threshold.PAPER

    def test_twelve_phases_of_the_spin_up_by_the_paper_s_figures(self):
        study = posat1.spin_up()
        assert len({str(order.overrides) for order in study.orders}) == 12
        printed = {figure.id: (figure.high, figure.threshold) for figure in study.figures}
        assert printed["time"] == (19.2, Threshold.PAPER)
        assert printed["pulses"] == (12.0, Threshold.PAPER)
        assert printed["error"] == (5e-4, Threshold.PAPER)
