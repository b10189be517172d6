"""Shipped scenarios: each flies as it ships and really disturbed, from the same starts; each limit acts."""

import numpy as np
import pytest

from sim.campaign.claim import ClaimVerdict
from sim.campaign.flight import FlightResult
from sim.scenario.schema import load
from sim.validate import shipped
from sim.validate.shipped import CASES, study_of


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.scenario)
class TestCase:
    def loaded(self, case, real):
        return [load(order.scenario, order.overrides) for order in shipped.orders(case, real)]

    def test_as_it_ships_nothing_but_the_start_differs(self, case):
        plain = load(case.scenario)
        for flown in self.loaded(case, real=False):
            assert flown.disturbance == plain.disturbance
            assert flown.flight == plain.flight
            assert (flown.initial.angle_deg != plain.initial.angle_deg) is case.turned

    def test_really_disturbed_it_meets_more_from_the_same_starts_and_its_table_allows_for_it(self, case):
        plain = load(case.scenario)
        for calm, flown in zip(self.loaded(case, False), self.loaded(case, True), strict=True):
            assert calm.initial == flown.initial
            torque, dipole = flown.disturbance.torque_nm, flown.disturbance.residual_dipole_am2
            assert np.linalg.norm(torque) == pytest.approx(case.real.torque_nm)
            assert np.linalg.norm(dipole) == pytest.approx(case.real.dipole_am2)
            assert case.real.torque_nm > np.linalg.norm(plain.disturbance.torque_nm)
            assert case.real.dipole_am2 > np.linalg.norm(plain.disturbance.residual_dipole_am2)
            allowed = flown.flight["uncertainty"]
            assert allowed["torque_nm"] > np.abs(torque).max()
            assert allowed["residual_dipole_am2"] > np.abs(dipole).max()

    def test_a_row_says_how_many_flights_there_are_and_from_where(self, case):
        study = study_of(case)
        start = "from 10 to 60 deg off" if case.turned else "from its own start"
        for figure in study.figures:
            (group,) = (group for group in study.groups if group.name == figure.group)
            assert figure.statement.endswith(f", {start}, all of {len(group.orders)} flights")
            assert ("each in a random direction" in figure.statement) is (figure.group == "real")

    @pytest.mark.parametrize("place", [0, -1], ids=["shipped", "real"])
    @pytest.mark.parametrize("what", ["pointing", "estimate", "settling"])
    def test_each_limit_acts(self, case, place, what):
        study, group = study_of(case), ("shipped", "real")[place]
        values = {"pointing": 1e-3, "estimate": 1e-3, "settling": 1e-3}
        flights = [flight(task.args[0], **values) for task in study.tasks]
        flights[place] = flight(study.tasks[place].args[0], **values | {what: 99.0})
        failed = {o.claim.id for o in study.conclude(flights) if o.verdict is ClaimVerdict.FAIL}
        limits = (case.shipped, case.disturbed)[place]
        limit = {"pointing": limits.pointing_deg, "settling": limits.settle_orbits}.get(what, 1.0)
        assert failed == (set() if limit is None else {f"scenario-{case.scenario}.{what}_{group}"})


def flight(order, pointing, estimate, settling):
    summary = {"controlled": {"rms_last_orbit": pointing, "settle_orbits": settling}}
    return FlightResult(order, summary, {"estimate_deg": estimate})


def test_one_that_never_settles_fails():
    study = study_of(CASES[0])
    flights = [
        FlightResult(task.args[0], {"controlled": {"rms_last_orbit": 0.1}}, {"estimate_deg": 0.1})
        for task in study.tasks
    ]
    failed = {o.claim.id for o in study.conclude(flights) if o.verdict is ClaimVerdict.FAIL}
    assert failed == {
        figure for figure in (o.claim.id for o in study.conclude(flights)) if "settling" in figure
    }
    assert f"{study.id}.settling_shipped" in failed
