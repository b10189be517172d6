"""Which Sun cell is faulty: dead, stuck, too bright; and that a sound one is not called so."""

from copy import deepcopy
from dataclasses import replace
from math import radians

import numpy as np
import pytest
from cell_samples import CELLS, Q_BODY_FROM_ECI, REFERENCE, cell_filter, cells_taken
from with_values import with_values

from fsw.core.algebra.quaternion import multiply, normalise, rotate
from fsw.core.algebra.vector import cross, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.prediction import sunlit
from fsw.core.estimation.cells.update import NO_CELLS
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.fdir.evidence import weights
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.cell_evidence import CellEvidence
from fsw.core.fdir.sensors.cells import (
    CellWatch,
    cell_changes,
    cell_faults,
    disproves,
    forget_accusations,
    forget_isolated,
    is_contradicted,
    is_doubtful,
    judge_cells,
    unusable_cells,
)
from fsw.core.fdir.sensors.watch import Watch

CONFIG = cell_filter()
WEIGHTS = weights(40.0, 1.0)
SEEN = light(REFERENCE.r_eci_m, REFERENCE.sun_eci, CELLS.albedo)
LIT = sunlit(Q_BODY_FROM_ECI, SEEN, CELLS)
DARK = [cell for cell in range(6) if cell not in LIT]
ENOUGH = 40
STILL_TICKS = 46
"""While the first lit cell's current moves by ``STILL`` and a step of the bus."""


def ideal(q=Q_BODY_FROM_ECI):
    s, e = rotate(q, SEEN.s_eci), rotate(q, SEEN.e_eci)
    return [
        max(0.0, float(np.dot(normal, s))) + SEEN.earth * (0.5 + 0.5 * float(np.dot(normal, e))) ** 2
        for normal in CELLS.normals_body
    ]


def judge(health, evidence, config=CONFIG):
    """A copy of the cells after this tick."""
    health = deepcopy(list(health))
    judge_cells(health, evidence, WEIGHTS, config)
    return health


def attitude(tick):
    """A slow turn, so that currents change."""
    return normalise(multiply(Q_BODY_FROM_ECI, (1.0, 0.0008 * tick, -0.0006 * tick, 0.0005 * tick)))


def proven(q, config=CONFIG, sigma_deg=1.0):
    """An estimate that is right, and sure of the attitude within 1 deg."""
    estimate = mekf.start(q, (0.0,) * 3, config)
    covariance = estimate.covariance.copy()
    covariance[0:3, 0:3] = radians(sigma_deg) ** 2 * np.eye(3)
    return with_values(estimate, covariance=covariance)


def watched_coarse(change, step, declared, ticks):
    """As ``watched``, of cells without noise whose currents are multiples of a step; which were still."""
    config, health, still = cell_filter(replace(CELLS, step=declared)), [], set()
    for tick in range(ticks):
        q = attitude(tick)
        estimate = proven(q, config)
        currents = change([step * round(one / step) for one in ideal(q)])
        usable = [None if cell in unusable_cells(health) else one for cell, one in enumerate(currents)]
        estimate, used = cells_taken(estimate, usable, SEEN, config)
        health = judge(health, CellEvidence(currents, used, estimate, SEEN, False, True, False), config)
        still |= {cell for cell, one in enumerate(health) if one.still}
    return health, still


def watched(
    change,
    ticks=ENOUGH,
    health=None,
    *,
    sure=True,
    seen=SEEN,
    shadow=False,
    turning=True,
    first=0,
    begun=False,
):
    """The cells after so many ticks of an estimate that is right; ``change`` makes the currents wrong."""
    health = [] if health is None else health
    random = np.random.default_rng(3)
    for tick in range(first, first + ticks):
        q = attitude(tick) if turning else Q_BODY_FROM_ECI
        estimate = proven(q)
        currents = [max(0.0, one + 0.01 * random.normal()) if seen else 0.0 for one in ideal(q)]
        currents = change(list(currents))
        usable = [None if cell in unusable_cells(health) else one for cell, one in enumerate(currents)]
        estimate, used = cells_taken(estimate, usable, seen, CONFIG)
        evidence = CellEvidence(currents, used, estimate, seen, shadow, sure, begun)
        health = judge(health, evidence)
    return health


def set_to(cell, value):
    def change(currents):
        currents[cell] = value
        return currents

    return change


def dead(*cells):
    def change(currents):
        return [0.0 if cell in cells else one for cell, one in enumerate(currents)]

    return change


def sound(currents):
    return currents


def faults(health):
    return [one.watch.fault for one in health]


@pytest.mark.long
def test_sound_cells_are_not_accused():
    health = watched(sound, 300)
    assert faults(health) == [0] * 6
    assert all(one.watch.nats < 3.0 for one in health)


@pytest.mark.parametrize("cell", LIT)
def test_a_dead_cell_is_found_while_it_should_be_lit(cell):
    health = watched(set_to(cell, 0.0))
    assert health[cell].watch.fault == SensorFault.STRENGTH
    assert faults(health).count(0) == 5
    assert unusable_cells(health) == (cell,)


@pytest.mark.parametrize("cell", DARK)
def test_a_dead_cell_in_the_dark_looks_as_it_should(cell):
    assert faults(watched(set_to(cell, 0.0))) == [0] * 6


def test_one_that_is_bright_with_the_sun_behind_it_is_found():
    s = rotate(Q_BODY_FROM_ECI, SEEN.s_eci)
    behind = min(range(6), key=lambda cell: np.dot(CELLS.normals_body[cell], s))
    health = watched(set_to(behind, 0.9), turning=False)
    assert health[behind].watch.fault == SensorFault.STRENGTH
    assert faults(health).count(0) == 5


@pytest.mark.parametrize(("shadow", "fault"), [(True, SensorFault.UNLIT), (False, 0)])
def test_light_in_the_shadow_counts_where_the_shadow_is_certain(shadow, fault):
    health = watched(set_to(2, 0.3), seen=None, shadow=shadow)
    assert faults(health) == [0, 0, fault, 0, 0, 0]


def in_shadow(change, ticks, health=None):
    return watched(change, ticks, health, seen=None, shadow=True, sure=False)


@pytest.mark.long
def test_a_cell_that_is_dark_in_the_shadow_more_often_than_bright_is_no_lamp():
    """As in a message of nonsense, of which those ticks count in which at most two of six cells are lit."""
    random = np.random.default_rng(7)
    health = in_shadow(lambda currents: [random.choice((0.0, 0.0, 0.6)) for _ in range(6)], 600)
    assert faults(health) == [0] * 6


@pytest.mark.long
def test_a_lamp_that_goes_out_is_readmitted_by_the_shadow_alone():
    lamp = in_shadow(set_to(4, 0.3), ENOUGH)
    assert faults(lamp) == [0, 0, 0, 0, SensorFault.UNLIT, 0]
    assert faults(in_shadow(sound, 100, lamp))[4] == SensorFault.UNLIT
    assert faults(in_shadow(sound, 140, lamp)) == [0] * 6
    assert faults(in_shadow(set_to(4, 0.3), 600, lamp))[4] == SensorFault.UNLIT


@pytest.mark.long
@pytest.mark.parametrize("fault", [SensorFault.STRENGTH, SensorFault.FROZEN, SensorFault.REFUSED])
def test_the_shadow_says_nothing_for_a_cell_that_fails_in_the_light(fault):
    """A dead cell is dark there, as it should be."""
    health = [CellWatch(Watch(fault if cell == 1 else 0)) for cell in range(6)]
    assert faults(in_shadow(sound, 600, health))[1] == fault


@pytest.mark.long
def test_a_stuck_cell_is_put_aside_as_soon_as_its_prediction_has_moved():
    """Though what it shows is near enough for the filter to take it."""
    cell = LIT[0]
    stuck = set_to(cell, ideal()[cell])
    unused = next(ticks for ticks in range(1, 200) if cell in unusable_cells(watched(stuck, ticks)))
    assert STILL_TICKS < unused < 2 * STILL_TICKS
    health = watched(stuck, unused + ENOUGH)
    assert health[cell].watch.fault == SensorFault.FROZEN
    assert faults(health).count(0) == 5


def test_a_current_that_rightly_stays_is_not_stuck():
    health = watched(set_to(LIT[0], ideal()[LIT[0]]), 200, turning=False)
    assert faults(health) == [0] * 6


@pytest.mark.long
def test_a_coarse_cell_may_stay_for_a_step_longer():
    cells, step = set(LIT), 0.12
    _, undeclared = watched_coarse(sound, step, 0.0, 300)
    health, still = watched_coarse(sound, step, step, 300)
    assert undeclared & cells
    assert still == set()
    assert faults(health) == [0] * 6


@pytest.mark.long
def test_a_stuck_coarse_cell_is_found_all_the_same():
    cell, step = LIT[1], 0.12
    stuck = set_to(cell, step * round(ideal()[cell] / step))
    health, still = watched_coarse(stuck, step, step, 300)
    assert cell in still
    assert health[cell].watch.fault == SensorFault.FROZEN


def test_an_excess_that_no_bound_allows_is_found():
    estimate = proven(Q_BODY_FROM_ECI)
    cell, excess = LIT[1], [0.0] * 6
    excess[cell] = 4.1 * CELLS.excess_sigma
    estimate = with_values(estimate, parameters=with_values(estimate.parameters, cell_excess=tuple(excess)))
    health = []
    for number in range(ENOUGH):
        currents = [one + 0.001 * (number % 7) for one in ideal()]
        _, used = cells_taken(estimate, currents, SEEN, CONFIG)
        evidence = CellEvidence(currents, used, estimate, SEEN, False, True, False)
        health = judge(health, evidence)
    assert health[cell].watch.fault == SensorFault.STRENGTH
    assert faults(health).count(0) == 5


@pytest.mark.parametrize("cell", LIT)
def test_none_is_accused_before_the_estimate_is_proven(cell):
    assert faults(watched(set_to(cell, 0.0), sure=False)) in ([], [0] * 6)


def test_where_most_are_refused_it_is_not_clear_that_a_cell_is_wrong():
    estimate = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
    currents = [one + 0.9 if cell in LIT else one for cell, one in enumerate(ideal())]
    health = []
    for _ in range(ENOUGH):
        _, used = cells_taken(estimate, currents, SEEN, CONFIG)
        assert len(used.refused) == len(LIT)
        health = judge(health, CellEvidence(currents, used, estimate, SEEN, False, True, False))
    assert faults(health) == [0] * 6


def test_no_single_sample_isolates():
    health = watched(set_to(LIT[0], 0.0), 20)
    assert faults(health) == [0] * 6
    assert health[LIT[0]].watch.nats > 5.0


class TestASecondCell:
    """Two do not fail within one estimate: it is the estimate that is wrong."""

    def test_one_cell_says_nothing_of_the_estimate(self):
        health = watched(dead(LIT[0]))
        assert faults(health).count(0) == 5
        assert not is_contradicted(health)
        assert not is_doubtful(health, WEIGHTS)

    def test_another_makes_it_doubtful_by_half_of_what_isolates_that_one(self):
        first = watched(dead(LIT[0]))
        little = watched(dead(LIT[0], LIT[1]), 10, first)
        half = watched(dead(LIT[0], LIT[1]), 20, first)
        assert (is_doubtful(little, WEIGHTS), is_doubtful(half, WEIGHTS)) == (False, True)
        assert not is_contradicted(half)

    def test_isolated_too_it_contradicts_the_estimate(self):
        health = watched(dead(LIT[0], LIT[1]), ENOUGH, watched(dead(LIT[0])))
        assert faults(health).count(0) == 4
        assert is_contradicted(health)

    def test_of_one_that_an_estimate_before_has_named_the_next_knows_nothing(self):
        begun = watched(dead(LIT[0]), 1, watched(dead(LIT[0])), begun=True)
        assert begun[LIT[0]].watch.fault
        health = watched(dead(LIT[0], LIT[1]), ENOUGH, begun)
        assert faults(health).count(0) == 4
        assert not is_contradicted(health)

    def test_the_estimate_ends_once_though_the_board_is_silent_then(self):
        """No message shows anything of the cells: the contradiction was of the estimate that has ended."""
        health = watched(dead(LIT[0], LIT[1]), ENOUGH, watched(dead(LIT[0])))
        ended = CellEvidence((), NO_CELLS, None, SEEN, False, False, True)
        after = judge(health, ended)
        assert faults(after) == faults(health)
        assert not is_contradicted(after)
        silent = with_values(ended, estimate=proven(Q_BODY_FROM_ECI), new=False)
        assert judge(health, silent) == health, "while it lives nothing changes"

    def test_what_is_seen_in_the_shadow_is_no_estimate_s(self):
        first = watched(set_to(2, 0.3), seen=None, shadow=True)
        assert first[2].watch.fault
        health = watched(dead(LIT[1]), ENOUGH, first)
        assert health[LIT[1]].watch.fault
        assert not is_contradicted(health)

    @pytest.mark.long
    def test_one_that_is_readmitted_counts_no_longer(self):
        again = watched(sound, 300, watched(dead(LIT[0])))
        health = watched(dead(LIT[1]), ENOUGH, again)
        assert faults(health).count(0) == 5
        assert not is_contradicted(health)


TURNED_DEG = 180.0


def misjudged(sigma_deg, ticks=ENOUGH, health=(), *, sure=True, on_trial=False):
    """Sound cells by an estimate that is turned from the truth, and as uncertain as it says."""
    half = radians(0.5 * TURNED_DEG)
    s = rotate(Q_BODY_FROM_ECI, SEEN.s_eci)
    about = unit(cross(max(CELLS.normals_body, key=lambda normal: float(np.dot(normal, s))), s))
    turn = (float(np.cos(half)), *(float(np.sin(half)) * np.array(about)))
    estimate, health = proven(multiply(Q_BODY_FROM_ECI, turn), sigma_deg=sigma_deg), list(health)
    for number in range(ticks):
        currents = [one + 0.001 * (number % 7) for one in ideal()]
        evidence = CellEvidence(currents, NO_CELLS, estimate, SEEN, False, sure, False, on_trial)
        health = judge(health, evidence)
    return health


class TestUncertain:
    """An attitude that may be off by as much as the cells seem to be says nothing of them."""

    def test_one_that_says_it_is_certain_accuses_sound_cells(self):
        assert faults(misjudged(1.0)) != [0] * 6

    @pytest.mark.parametrize("sigma_deg", [20.0, 37.0])
    def test_one_that_says_how_uncertain_it_is_accuses_none(self, sigma_deg):
        health = misjudged(sigma_deg, 10 * ENOUGH)
        assert [one.watch.nats for one in health] == [0.0] * 6

    @pytest.mark.parametrize("cell", LIT)
    def test_a_dead_cell_is_found_by_one_that_is_certain_enough(self, cell):
        health = []
        for _ in range(ENOUGH):
            currents = ideal()
            currents[cell] = 0.0
            evidence = CellEvidence(
                currents, NO_CELLS, proven(Q_BODY_FROM_ECI, sigma_deg=2.5), SEEN, False, True, False
            )
            health = judge(health, evidence)
        seen = float(np.dot(CELLS.normals_body[cell], rotate(Q_BODY_FROM_ECI, SEEN.s_eci)))
        assert faults(health)[cell] == (SensorFault.STRENGTH if seen > 0.3 else 0)

    def test_on_trial_it_isolates_none_and_is_disproven(self):
        health = misjudged(1.0, 16, sure=False, on_trial=True)
        assert faults(health) == [0] * 6
        assert disproves(health, WEIGHTS)
        assert not disproves(misjudged(1.0, 14, sure=False, on_trial=True), WEIGHTS)

    def test_on_trial_it_readmits_none(self):
        isolated = [CellWatch(Watch(SensorFault.STRENGTH if cell == LIT[0] else 0)) for cell in range(6)]
        for number in range(300):
            currents = [one + 0.001 * (number % 7) for one in ideal()]
            evidence = CellEvidence(
                currents, NO_CELLS, proven(Q_BODY_FROM_ECI), SEEN, False, False, False, True
            )
            isolated = judge(isolated, evidence)
        assert faults(isolated)[LIT[0]] == SensorFault.STRENGTH
        assert not disproves(isolated, WEIGHTS)

    def test_what_it_has_shown_is_forgotten_of_cells_in_use_alone(self):
        health = [CellWatch(Watch(SensorFault.UNLIT, 3.0)), CellWatch(Watch(0, 5.0))]
        forget_accusations(health)
        assert [one.watch.nats for one in health] == [3.0, 0.0]


@pytest.mark.long
def test_one_that_is_right_again_is_readmitted_after_a_while():
    dead = watched(set_to(LIT[0], 0.0))
    assert watched(sound, 60, dead)[LIT[0]].watch.fault
    assert faults(watched(sound, 300, dead)) == [0] * 6


@pytest.mark.long
def test_one_that_stays_dead_is_not():
    dead = watched(set_to(LIT[0], 0.0))
    assert watched(set_to(LIT[0], 0.0), 400, dead)[LIT[0]].watch.fault == SensorFault.STRENGTH


def flown(state, health, gain, ticks):
    """Ticks of an estimate that is sure of its attitude, with this gain of the lit cell that stays so."""
    random = np.random.default_rng(5)
    for tick in range(ticks):
        q = attitude(tick)
        estimate = with_values(state.estimate, q_body_from_eci=q)
        currents = [max(0.0, one + 0.01 * random.normal()) for one in ideal(q)]
        currents[LIT[1]] *= gain
        usable = [None if cell in unusable_cells(health) else one for cell, one in enumerate(currents)]
        _, used = cells_taken(estimate, usable, SEEN, CONFIG)
        evidence = CellEvidence(currents, used, estimate, SEEN, False, True, False)
        before, health = cell_faults(health), judge(health, evidence)
        forget_isolated(state, before, health, CONFIG)
    return state, health


class TestGain:
    """A cell whose gain, as the filter has learnt it, no bound allows."""

    LEARNT = 0.5

    def learnt(self):
        estimate, place = proven(Q_BODY_FROM_ECI), CONFIG.layout.cell_gain.start + LIT[1]
        covariance, gains = estimate.covariance.copy(), [0.02] * 6
        covariance[place, place], gains[LIT[1]] = 0.01**2, self.LEARNT
        parameters = with_values(estimate.parameters, cell_gain=tuple(gains))
        return EstimatorState(with_values(estimate, parameters=parameters, covariance=covariance))

    def test_is_isolated_and_its_gain_forgotten(self):
        state, health = flown(self.learnt(), [], 1.0 + self.LEARNT, ENOUGH)
        assert health[LIT[1]].watch.fault == SensorFault.STRENGTH
        assert faults(health).count(0) == 5
        gains, place = state.estimate.parameters.cell_gain, CONFIG.layout.cell_gain.start + LIT[1]
        assert [gain for cell, gain in enumerate(gains) if cell != LIT[1]] == [0.02] * 5
        assert gains[LIT[1]] == 0.0
        assert state.estimate.covariance[place, place] == CONFIG.initial_covariance[place, place]

    @pytest.mark.long
    def test_right_again_it_comes_back_under_the_same_estimate(self):
        isolated = flown(self.learnt(), [], 1.0 + self.LEARNT, ENOUGH)
        assert flown(*isolated, 1.0, 60)[1][LIT[1]].watch.fault
        state, health = flown(*isolated, 1.0, 300)
        assert faults(health) == [0] * 6
        assert faults(flown(state, health, 1.0, 60)[1]) == [0] * 6, "and stays"

    @pytest.mark.long
    def test_as_wrong_as_before_it_does_not(self):
        isolated = flown(self.learnt(), [], 1.0 + self.LEARNT, ENOUGH)
        assert flown(*isolated, 1.0 + self.LEARNT, 600)[1][LIT[1]].watch.fault == SensorFault.STRENGTH

    def test_while_parameters_are_frozen_nothing_is_forgotten(self):
        frozen = with_values(self.learnt(), frozen=True)
        before = frozen.estimate
        _, health = flown(frozen, [], 1.0 + self.LEARNT, ENOUGH)
        assert health[LIT[1]].watch.fault
        assert frozen.estimate is before


def test_changes_are_told_by_cell():
    before = cell_faults([CellWatch(), CellWatch(Watch(2, 1.0)), CellWatch()])
    after = cell_faults([CellWatch(Watch(4)), CellWatch(), CellWatch()])
    assert cell_changes(before, after) == [(0, 0, 4), (1, 2, 0)]
    assert cell_changes((), after) == [(0, 0, 4)]
    assert cell_changes((), ()) == []


def test_cells_that_are_forgotten_are_readmitted():
    before = cell_faults([CellWatch(), CellWatch(Watch(2, 1.0)), CellWatch(Watch(4))])
    assert cell_changes(before, ()) == [(1, 2, 0), (2, 4, 0)]


def test_without_cells_there_is_no_health_of_them():
    assert judge([], CellEvidence((), NO_CELLS, None, None, False, False, True)) == []
