"""The search: within its budget, never worse than the scenario's gains, the same each time; what is free."""

from math import log
from typing import ClassVar

import pytest

from fsw.core.laws.entry import Aim
from fsw.core.laws.table import LAWS
from sim.design.from_scenario import body_of
from sim.design.theory.search import natural_gains
from sim.errors import HarnessError
from sim.scenario.schema import load
from sim.tuning import search
from sim.tuning.cost import Cost
from sim.tuning.free_gains import FreeGain, as_control, common_gains, flat, own_gains
from sim.tuning.search import confirm, tune

PULSED = {"coils": {"driver": "pulsed"}}


def as_rigid(scenario, seed, orbits):
    """A whole flight that costs what that of the rigid body does."""
    return scenario.control


@pytest.fixture
def bowl(monkeypatch):
    """In place of a flight: a cost that is least at k_w = 1e7 and k_a = 4000, and counts its flights."""
    flown = []

    def flight(scenario, orbits, step_s):
        flown.append((scenario.control.k_w, scenario.control.k_a))
        return scenario.control

    def cost(control, scenario, aim):
        away = abs(control.k_w / 1e7 - 1.0) + abs(control.k_a / 4000.0 - 1.0)
        return Cost(away, 1.0, 0.1)

    monkeypatch.setattr(search, "fly", flight)
    monkeypatch.setattr(search, "cost_of", cost)
    return flown


@pytest.mark.long
def test_it_keeps_to_its_budget_and_finds_the_least(bowl):
    found = tune("microsat", PULSED, "pd", budget=60, whole=as_rigid)
    assert len(bowl) == found.flights <= 60
    assert found.cost.total < 0.2 < found.before.total
    assert found.control["k_w"] == pytest.approx(1e7, rel=0.2)


def test_twice_the_same(bowl):
    assert tune("microsat", PULSED, "pd", budget=20, whole=as_rigid) == tune(
        "microsat", PULSED, "pd", budget=20, whole=as_rigid
    )


def test_a_gain_that_the_law_does_not_use_is_not_searched(monkeypatch, bowl):
    monkeypatch.setattr(search, "cost_of", lambda control, *_: Cost(abs(control.k_w / 1e7 - 1.0), 1.0, 0.1))
    tune("microsat", PULSED, "pd", budget=20, whole=as_rigid)
    searched = [k_a for _, k_a in bowl[3:]]
    assert set(searched) == {load("microsat").control.k_a}


def test_the_scenarios_gains_stay_where_nothing_better_is_found(monkeypatch, bowl):
    monkeypatch.setattr(search, "cost_of", lambda *_: Cost(1.0, None, 5.0))
    found = tune("microsat", PULSED, "pd", budget=8, whole=as_rigid)
    assert (found.control, found.cost) == ({}, found.before)


def test_a_value_that_no_table_allows_is_a_lost_flight(monkeypatch, bowl):
    monkeypatch.setattr(search, "own_gains", lambda law: (FreeGain("gains.lqr.effort", 1e-9, 1e-8),))
    found = tune("microsat", PULSED, "lqr", budget=12, whole=as_rigid)
    assert "gains" not in found.control


@pytest.mark.long
class TestWholeFlights:
    """Whether they bear out what the search has found."""

    @staticmethod
    def refusing(*refused):
        """A whole flight in which k_w near these values fails, and the flights that were flown."""
        flown = []

        def whole(scenario, seed, orbits):
            assert (seed, orbits) == (search.SEED, search.ORBITS)
            flown.append(scenario.control.k_w)
            if any(abs(log(scenario.control.k_w / k_w)) < 0.25 for k_w in refused):
                raise HarnessError("lost")
            return scenario.control

        return whole, flown

    def test_gains_that_fail_there_give_way_to_the_next_best_that_are_not_near_them(self, bowl):
        whole, flown = self.refusing(1e7)
        found = tune("microsat", PULSED, "pd", budget=60, whole=whole)
        assert flown[0] == load("microsat").control.k_w
        assert flown[1] == pytest.approx(1e7, rel=0.2)
        assert abs(log(found.control["k_w"] / 1e7)) >= 0.25
        assert found.cost.total < found.before.total

    def test_where_none_is_better_than_the_scenarios_own_those_stay(self, bowl):
        own = load("microsat").control.k_w

        def whole(scenario, seed, orbits):
            if scenario.control.k_w != own:
                raise HarnessError("lost")
            return scenario.control

        found = tune("microsat", PULSED, "pd", budget=60, whole=whole)
        assert (found.control, found.cost) == ({}, found.before)

    def test_few_are_flown(self, bowl):
        whole, flown = self.refusing(*(1e6 * 1.2**power for power in range(40)))
        tune("microsat", PULSED, "pd", budget=60, whole=whole)
        assert len(flown) <= 1 + search.CANDIDATES


class TestConfirm:
    """Gains of an earlier day stay where today's whole flights bear them out."""

    GOOD: ClassVar[dict[str, float]] = {"k_w": 1.2e7, "k_a": 4100.0}  # costs 0.225 of the bowl

    @pytest.mark.parametrize("total", [0.225, 0.21, 0.3])
    def test_what_still_flies_so_stays_without_a_search(self, bowl, total):
        found = confirm("microsat", PULSED, "pd", self.GOOD, total, budget=20, whole=as_rigid)
        assert (found.control, found.flights, bowl) == (self.GOOD, 0, [])
        assert found.cost.total == pytest.approx(0.225)

    def test_what_flies_worse_than_it_did_is_searched_again(self, bowl):
        fair = {"k_w": 2e7, "k_a": 6000.0}
        found = confirm("microsat", PULSED, "pd", fair, 0.2, budget=20, whole=as_rigid)
        assert found == tune("microsat", PULSED, "pd", budget=20, whole=as_rigid)

    def test_where_the_search_finds_none_that_are_better_the_best_known_stay(self, bowl):
        found = confirm("microsat", PULSED, "pd", self.GOOD, 0.2, budget=4, whole=as_rigid)
        assert (found.control, found.flights) == (self.GOOD, 4)
        assert found.cost.total == pytest.approx(0.225)

    def test_what_is_worse_than_the_scenarios_own_is_searched_again(self, bowl):
        far = {"k_w": 9e7, "k_a": 400.0}
        found = confirm("microsat", PULSED, "pd", far, 9.0, budget=20, whole=as_rigid)
        assert found.flights > 0
        assert found.control != far

    def test_the_scenarios_own_stay_where_they_are_as_good_as_they_were(self, bowl):
        own = load("microsat").control
        total = abs(own.k_w / 1e7 - 1.0) + abs(own.k_a / 4000.0 - 1.0)
        found = confirm("microsat", PULSED, "pd", {}, total, budget=20, whole=as_rigid)
        assert (found.control, found.cost, found.flights) == ({}, found.before, 0)

    def test_what_fails_today_is_searched_again(self, bowl):
        def whole(scenario, seed, orbits):
            if scenario.control.k_w == self.GOOD["k_w"]:
                raise HarnessError("lost")
            return scenario.control

        found = confirm("microsat", PULSED, "pd", self.GOOD, 0.225, budget=20, whole=whole)
        assert found.flights > 0


class TestFreeGains:
    def test_the_common_ones_span_those_of_the_map_of_gains(self):
        natural = natural_gains(body_of(load("microsat")))
        k_w, k_a = common_gains(load("microsat"))
        assert k_w.low < natural.k_w < k_w.high
        assert k_a.low < natural.k_a < k_a.high

    def test_own_ones_are_those_that_say_how_hard(self):
        assert [gain.key for gain in own_gains("mpc")] == ["gains.mpc.effort"]
        assert {gain.key for gain in own_gains("three_term")} == {
            "gains.three_term.k_h",
            "gains.three_term.k_spin",
        }
        assert own_gains("pd") == ()

    def test_how_much_a_law_may_compute_is_not_searched(self):
        assert {gain.key for gain in own_gains("nmpc_damping")} == {
            f"gains.nmpc_damping.{name}" for name in ("weight", "effort", "gamma")
        }

    @pytest.mark.parametrize("law", LAWS)
    def test_of_every_law_they_are_positive_and_have_room(self, law):
        for gain in own_gains(law):
            assert 0.0 < gain.low < gain.high
        assert isinstance(LAWS[law].aim, Aim)

    def test_they_become_the_keys_of_control(self):
        free = (FreeGain("k_w", 1.0, 2.0), FreeGain("gains.lqr.effort", 0.1, 0.2))
        control = as_control(free, (1.23456789, 0.15))
        assert control == {"k_w": 1.23457, "gains": {"lqr": {"effort": 0.15}}}
        assert flat(control) == {"k_w": 1.23457, "gains.lqr.effort": 0.15}
