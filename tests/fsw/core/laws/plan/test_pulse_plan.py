"""The search among pulses, against every sequence that there is."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from fsw.core.laws.lqr import LqrGains, schedule
from fsw.core.laws.plan.cost_to_go import cost_to_go
from fsw.core.laws.plan.orbit_ahead import sight
from fsw.core.laws.plan.pulse_model import NO_PULSE, Pulse, PulseModel, choices, kicks
from fsw.core.laws.plan.riccati import regulator_problem
from fsw.core.laws.pulse_mpc import BARRED, SEQUENCES, Opportunity, _least, first_pulse

INERTIA = ((1.02, 0.03, -0.05), (0.03, 1.85, 0.02), (-0.05, 0.02, 1.95))
INVERSE = tuple(map(tuple, np.linalg.inv(INERTIA).tolist()))
PROBLEM = regulator_problem(INERTIA, (0.001, -0.002, 0.003), 1.04e-3, 2.1e-5, 103.0, 0.01, 0.001)
LEVELS, PULSE_S = (0.5, 2.0, 8.0), 3.0
SHARED = PulseModel(*choices(LEVELS, PULSE_S, INVERSE), 103, 1, PROBLEM, 6, sight([103.0], 6000.0))
READY = (0, 0, 0)


def opportunities(random, count, model=SHARED):
    """With fields, drifts and costs to go that have nothing to do with each other."""
    ahead = []
    for _ in range(count):
        root = random.normal(size=(6, 6)) * np.repeat([3e3, 3.0], 3)[:, None]
        b_t = random.normal(size=3) * 3e-5
        rest = random.normal(size=(6, 4)) * np.repeat([1e9, 1e6], 3)[:, None]
        rest[:, 3] *= 1e-7
        drift = random.normal(size=6) * np.repeat([1e-5, 1e-3], 3)
        ahead.append(Opportunity(kicks(model, b_t), drift, np.hstack([root @ root.T, rest])))
    return ahead


def states(random):
    return np.concatenate([random.normal(size=6) * np.repeat([1e-4, 0.05], 3), random.normal(size=3) * 1e-7])


def allowed(sequence, model, waits):
    """Whether each coil of a sequence has rested."""
    free_at = list(waits)
    for step, pulse in enumerate(sequence):
        if pulse.level:
            if step < free_at[pulse.coil]:
                return False
            free_at[pulse.coil] = step + model.rest
    return True


def by_trying_all(state, ahead, model, waits):
    x0, d = np.array(state[:6]), np.array(state[6:])
    f, g = model.problem.free[:, :6], model.problem.free[:, 6:]
    found = []
    for sequence in product(model.pulses, repeat=len(ahead)):
        if not allowed(sequence, model, waits):
            continue
        x, total = x0, 0.0
        for pulse, opportunity in zip(sequence, ahead, strict=True):
            total += x @ (model.problem.cost * x)
            kick = opportunity.kicks[model.pulses.index(pulse)]
            x = f @ (x + np.concatenate([kick, np.zeros(3)])) + g @ d + opportunity.drift
        cost = ahead[-1].cost
        total += x @ cost[:, :6] @ x + 2.0 * x @ (cost[:, 6:9] @ d + cost[:, 9])
        found.append((total, sequence[0]))
    return min(found, key=lambda one: one[0])[1]


class TestChoices:
    def test_are_none_and_each_level_of_each_coil_with_either_sign(self):
        assert SHARED.pulses[0] == NO_PULSE
        assert len(set(SHARED.pulses)) == 19
        assert set(SHARED.pulses[1:]) == {
            Pulse(coil, level) for coil in range(3) for level in (-3, -2, -1, 1, 2, 3)
        }

    @pytest.mark.parametrize("place", range(19))
    def test_turn_the_body_as_pulse_and_field_do(self, place):
        (coil, level), b_t = SHARED.pulses[place].values(), np.array([1.7e-5, -2.3e-5, 3.1e-5])
        m = np.zeros(3)
        m[coil] = np.sign(level) * (0.0, *LEVELS)[abs(level)]
        expected = np.linalg.solve(INERTIA, PULSE_S * np.cross(m, b_t))
        assert kicks(SHARED, b_t)[place] == pytest.approx(expected, rel=1e-12, abs=1e-20)


@pytest.mark.parametrize("seed", range(30))
@pytest.mark.parametrize("count", [1, 2])
def test_no_sequence_is_better(seed, count):
    """So far ahead no sequence is left out."""
    random = np.random.default_rng(seed)
    state, ahead = states(random), opportunities(random, count)
    assert first_pulse(state, ahead, SHARED, READY) == by_trying_all(state, ahead, SHARED, READY)


@pytest.mark.parametrize("waits", [(0, 1, 1), (1, 0, BARRED), (BARRED, 1, 0), (0, BARRED, BARRED)])
def test_a_coil_that_rests_or_is_barred_is_not_fired(waits):
    taking_turns = replace(SHARED, rest=3)
    chosen = set()
    for seed in range(30):
        random = np.random.default_rng(seed)
        state, ahead = states(random), opportunities(random, 2)
        pulse = first_pulse(state, ahead, taking_turns, waits)
        assert pulse == by_trying_all(state, ahead, taking_turns, waits)
        chosen.add(pulse.coil)
        assert not pulse.level or waits[pulse.coil] == 0
    assert waits.index(0) in chosen


def test_that_the_same_coil_rests_changes_what_comes_first():
    """Else the search would not know of it."""
    firsts = []
    for rest in (1, 3):
        model = replace(SHARED, rest=rest)
        random = np.random.default_rng(7)
        cases = [(states(random), opportunities(random, 2)) for _ in range(40)]
        firsts.append([first_pulse(state, ahead, model, READY) for state, ahead in cases])
    assert firsts[0] != firsts[1]


def test_a_body_at_rest_is_left_alone():
    """None wins among equals."""
    random = np.random.default_rng(11)
    still = [one._replace(drift=np.zeros(6)) for one in opportunities(random, 4)]
    still = [one._replace(cost=np.hstack([one.cost[:, :9], np.zeros((6, 1))])) for one in still]
    assert first_pulse([0.0] * 9, still, SHARED, READY) == NO_PULSE


def test_nothing_ahead_is_no_pulse():
    assert first_pulse([0.1] * 9, [], SHARED, READY) == NO_PULSE


@pytest.mark.long
def test_of_more_sequences_than_go_on_one_of_the_best_is_found():
    """Of 6859: what it leaves to gain of what the best of them gains."""
    assert SEQUENCES < 19**2
    missed = []
    for seed in range(12):
        random = np.random.default_rng(seed)
        state, ahead = states(random), along_an_orbit(random, 3)
        first = first_pulse(state, ahead, SHARED, READY)
        fixed = ahead[0]._replace(kicks=np.tile(ahead[0].kicks[SHARED.pulses.index(first)], (19, 1)))
        best = cost_of_best(state, ahead)
        nothing = cost_of_best(state, [one._replace(kicks=np.zeros((19, 3))) for one in ahead])
        missed.append((cost_of_best(state, [fixed, *ahead[1:]]) - best) / (nothing - best))
    assert np.median(missed) < 1e-9
    assert max(missed) < 0.15


def along_an_orbit(random, count):
    """With the field of a polar orbit and the cost to go that belongs to it."""
    table = schedule(INERTIA, (0.0, 0.0, 0.0), 1.04e-3, 1.72, 2.1e-5, LqrGains(effort=0.001))
    u = random.uniform(0.0, 2.0 * np.pi) + 1.04e-3 * 103.0 * np.arange(count)
    fields = 2.1e-5 * np.stack([-2.0 * np.sin(u), np.cos(u), np.full(count, 0.15)], axis=-1)
    last = np.hstack([table.costs[0], np.zeros((6, 1))])
    costs = [*cost_to_go(PROBLEM, fields, np.zeros((count, 6)), last)[1:], last]
    return [
        Opportunity(kicks(SHARED, b_t), np.zeros(6), cost) for b_t, cost in zip(fields, costs, strict=True)
    ]


def cost_of_best(state, ahead):
    """By trying all."""
    x0, d = np.array(state[:6]), np.array(state[6:])
    f, g = PROBLEM.free[:, :6], PROBLEM.free[:, 6:]
    x, total = x0[None, :], np.zeros(1)
    for opportunity in ahead:
        total = np.repeat(total + (x * x * PROBLEM.cost).sum(axis=1), 19)
        kicked = np.repeat(x, 19, axis=0)
        kicked[:, :3] += np.tile(opportunity.kicks, (len(x), 1))
        x = kicked @ f.T + g @ d + opportunity.drift
    p, slope = ahead[-1].cost[:, :6], ahead[-1].cost[:, 6:9] @ d + ahead[-1].cost[:, 9]
    return float((total + np.einsum("ni,ij,nj->n", x, p, x) + 2.0 * x @ slope).min())


@pytest.mark.parametrize("seed", range(20))
def test_so_many_sequences_go_on_of_costs_that_all_differ(seed):
    costs = np.random.default_rng(seed).permutation(400).astype(float)
    assert sorted(costs[_least(costs)].tolist()) == list(range(SEQUENCES))


@pytest.mark.parametrize("seed", range(4))
def test_so_many_sequences_go_on_and_of_equal_ones_the_first(seed):
    """Among costs of which many are equal, and some barred."""
    random = np.random.default_rng(seed)
    costs = random.integers(0, 60, 400).astype(float)
    costs[random.integers(0, 400, 40)] = np.inf
    places = sorted(range(400), key=lambda place: (costs[place], place))[:SEQUENCES]
    assert sorted(_least(costs).tolist()) == sorted(places)
    assert np.sum(costs == costs[places[-1]]) > np.sum(costs[places] == costs[places[-1]])
