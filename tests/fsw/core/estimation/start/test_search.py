"""The motion behind a batch: found where the samples tell it, as uncertain as it is, a piece at a time."""

from dataclasses import replace
from functools import partial
from math import inf

import numpy as np
import pytest
from batch_samples import BIAS_T, CONFIG, EXCESS, MOVING_PRIORS, STARTS, flight
from cell_samples import CELLS, REFERENCE, cell_filter, cells_taken
from scipy.optimize import least_squares

from fsw.core.algebra.quaternion import conjugate, multiply
from fsw.core.algebra.vector import norm
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.mekf import healthy, start
from fsw.core.estimation.start import first as first_module
from fsw.core.estimation.start import search as search_module
from fsw.core.estimation.start.batch import SPACING_S, SampleBatch, pass_tick
from fsw.core.estimation.start.batch_model import Motions, disturbances, expected, leg, measured, model_of
from fsw.core.estimation.start.batch_sample import UNKNOWN
from fsw.core.estimation.start.first import StartLimits, estimate_from_batch, linear
from fsw.core.estimation.start.motions import flown, in_body
from fsw.core.estimation.start.search import IMPROVED, PIECES, Stage, start_search, work
from fsw.core.packing import pack
from sim.faults.node_kinds import count_doubles, flip

MODEL = model_of(CONFIG, CELLS)
NONE = {0, 1, 2, 3, 4, 5}
LIMITS = StartLimits(3e-6, inf, 0.0)
MOVED_AM2 = (0.02, -0.03, 0.01)


def error(estimate, q, omega):
    """Attitude and rate, rad and rad/s, (6), of the truth less the estimate."""
    turn = np.array(multiply(conjugate(estimate.q_body_from_eci), tuple(q)))
    turn *= np.sign(turn[0])
    return np.concatenate((2.0 * turn[1:], omega - np.array(estimate.omega_body_radps)))


def end_of(search, samples, model=MODEL):
    """What a search ends in, all at once."""
    estimate = None
    while search.stage is not Stage.ENDED:
        assert estimate is None
        estimate = work(search, samples, None, model)
    return estimate


def fitted(samples, model=MODEL):
    """What a search over these samples ends in."""
    return end_of(start_search(samples, model), samples, model)


@pytest.mark.long
@pytest.mark.parametrize(("q", "omega"), STARTS)
def test_over_minutes_three_cells_tell_the_motion(q, omega):
    """Also where only one or two of them ever see the Sun."""
    samples, end, rate = flight(q, omega, 25, unused=(1, 3, 5))
    estimate = fitted(samples)
    off = error(estimate, end, rate)
    assert np.degrees(np.linalg.norm(off[:3])) < 6.0
    nees = off @ np.linalg.solve(estimate.covariance[0:6, 0:6], off)
    assert nees < 16.8  # chi-square of 6, 1 in 100
    assert np.degrees(np.sqrt(estimate.covariance.diagonal()[0:3])).max() < 12.0


def test_three_lit_cells_tell_it_sooner():
    q, omega = STARTS[0]
    samples, end, rate = flight(q, omega, 6, coarse=True)
    assert all(sample.coarse for sample in samples)
    estimate = fitted(samples)
    off = error(estimate, end, rate)
    assert off @ np.linalg.solve(estimate.covariance[0:6, 0:6], off) < 16.8
    assert np.degrees(np.linalg.norm(off[:3])) < 12.0


def test_the_field_alone_does_not():
    samples, _, _ = flight(*STARTS[0], 8, unused=NONE)
    assert fitted(samples) is None


@pytest.mark.long
def test_what_fits_no_motion_is_not_believed():
    """Cells 1 and 3 connected crosswise."""
    samples, _, _ = flight(*STARTS[0], 25)
    crossed = [
        replace(
            sample,
            currents=(*sample.currents[2:3], sample.currents[1], sample.currents[0], *sample.currents[3:]),
        )
        for sample in samples
    ]
    assert fitted(tuple(crossed)) is None


class TestSettled:
    """A step that still promises much ends where the linear equations do not hold."""

    def passes(self, samples, away):
        """What the search ends in, and how often a motion so far, deg, from the best was carried through."""
        best = self.carried(samples)
        turn = np.zeros((1, MODEL.prior.size))
        turn[0, 0:3] = np.radians(away) / np.sqrt(3.0)
        search = best.copy()
        search_module._pass_again(search, Stage.CARRY, best.motions.changed(turn), samples[0], MODEL)
        return end_of(search, samples), search.steps + 1

    def carried(self, samples):
        search = start_search(samples, MODEL)
        while search.stage is not Stage.CARRY:
            work(search, samples, None, MODEL)
        return search

    @pytest.mark.long
    def test_a_motion_that_is_not_the_best_goes_through_the_samples_again(self):
        samples, q, omega = flight(*STARTS[0], 25)
        estimate, count = self.passes(samples, 12.0)
        straight, once = self.passes(samples, 0.0)
        assert once < count <= search_module.CARRIED
        sigmas = np.sqrt(straight.covariance.diagonal()[0:6])
        assert (abs(error(estimate, q, omega) - error(straight, q, omega)) / sigmas).max() < 0.5

    @pytest.mark.interpreted
    def test_one_that_goes_on_and_on_is_none(self, monkeypatch):
        samples, _, _ = flight(*STARTS[0], 25)
        monkeypatch.setattr(search_module, "SETTLED", -1.0)
        assert self.passes(samples, 0.0) == (None, search_module.CARRIED)


@pytest.mark.long
def test_what_it_finds_of_the_parameters_goes_into_the_filter_with_what_is_left():
    samples, _, _ = flight(*STARTS[0], 25)
    estimate, parts = fitted(samples), CONFIG.layout
    bias = np.array(estimate.parameters.mag_bias_t)
    assert np.linalg.norm(bias - BIAS_T) < np.linalg.norm(BIAS_T)
    assert np.abs(estimate.covariance[0:3, parts.dipole]).max() > 0.0
    np.testing.assert_array_equal(estimate.covariance, estimate.covariance.T)
    assert (
        np.linalg.eigvalsh(
            estimate.covariance / np.outer(*2 * [np.sqrt(estimate.covariance.diagonal())])
        ).min()
        > 0.0
    )
    assert np.abs(estimate.covariance[0:3, parts.cells]).max() > 0.0
    assert np.abs(estimate.covariance[0:3, parts.cell_gain]).max() > 0.0
    assert np.abs(estimate.covariance[parts.cells, parts.earth_light]).max() > 0.0


@pytest.mark.long
def test_what_it_finds_of_the_cells_is_nearer_to_the_truth_than_the_table():
    samples, q, _ = flight(*STARTS[0], 25)
    known = fitted(samples).parameters
    direct = np.maximum(0.0, np.array(CELLS.normals_body) @ in_body(q[None], np.array(REFERENCE.sun_eci))[0])
    lit = direct > 0.2
    beyond = np.array(known.cell_excess) + np.array(known.cell_gain) * direct
    assert np.linalg.norm((beyond - EXCESS)[lit]) < np.linalg.norm(EXCESS[lit])


@pytest.mark.long
def test_fewer_cells_than_there_may_be_leave_the_others_as_they_were():
    few = replace(CELLS, normals_body=CELLS.normals_body[:5], full_sun=CELLS.full_sun[:5], shades=((),) * 5)
    samples, _, _ = flight(*STARTS[0], 25)
    samples = tuple([replace(sample, currents=sample.currents[:5]) for sample in samples])
    known = fitted(samples, model_of(cell_filter(few, **MOVING_PRIORS), few)).parameters
    assert len(known.cell_excess) == len(known.cell_gain) == 6
    assert known.cell_excess[5] == known.cell_gain[5] == 0.0
    assert all(known.cell_excess[:5])


@pytest.mark.long
@pytest.mark.parametrize(("q", "omega"), STARTS)
def test_the_errors_of_the_cells_are_not_counted_once_more(q, omega):
    """The last sample again, which the attitude rests on already, makes it little surer."""
    samples, _, _ = flight(q, omega, 25)
    last, estimate = samples[-1], fitted(samples)
    seen = light(last.r_eci_m, last.s_eci, CELLS.albedo)
    after, used = cells_taken(estimate, last.currents, seen, CONFIG)
    assert len(used.taken) >= 2
    before, now = (np.linalg.eigvalsh(one.covariance[0:3, 0:3])[-1] for one in (estimate, after))
    assert now > 0.8**2 * before


class TestLinear:
    """At half the square of the angle times the field equal to the noise of a sample, 2e-7 T."""

    FIELD_T = (0.0, 0.0, 4e-5)

    @pytest.mark.parametrize(("sigma_rad", "holds"), [(0.0995, True), (0.1005, False)])
    def test_the_second_order_term_is_to_be_below_the_noise_of_the_field(self, sigma_rad, holds):
        assert linear(self.estimate(np.diag((0.01**2, sigma_rad**2, 0.02**2))), self.FIELD_T, CONFIG) is holds

    def test_about_the_worst_axis(self):
        axes = np.linalg.qr(np.arange(9.0).reshape(3, 3) + np.eye(3))[0]
        turned = axes @ np.diag((0.01**2, 0.1005**2, 0.02**2)) @ axes.T
        assert turned.diagonal().max() < 0.0995**2
        assert not linear(self.estimate(turned), self.FIELD_T, CONFIG)

    @staticmethod
    def estimate(attitude):
        begun_at = start(tuple(STARTS[0][0]), (0.0, 0.0, 0.0), CONFIG)
        covariance = begun_at.covariance.copy()
        covariance[0:3, 0:3] = attitude
        return replace(begun_at, covariance=covariance)


@pytest.mark.long
@pytest.mark.parametrize("bad", [float("nan"), 1e300])
def test_damaged_samples_give_none(bad):
    samples, _, _ = flight(*STARTS[0], 25)
    broken = replace(samples[4], field_t=(bad, 0.0, 0.0))
    assert fitted((*samples[:4], broken, *samples[5:])) is None


def left_over(numbers, q, samples):
    """What each of n motions leaves of all samples and priors, in standard deviations, and where it ends."""
    count = len(numbers)
    motions = Motions(np.tile(q, (count, 1)), np.zeros((count, MODEL.prior.size - 3))).changed(numbers)
    q, omega, parts = motions.q, motions.numbers[:, 0:3], []
    for number, sample in enumerate(samples):
        if number:
            after = leg(samples[number - 1], sample)
            q, omega = flown(q, omega, after, disturbances(motions), CONFIG.rotor)
        values, weights = measured(sample, MODEL)
        parts.append((expected(Motions(q, motions.numbers), sample, MODEL).values - values) * weights)
    return np.hstack((*parts, motions.numbers[:, 3:] / MODEL.prior[6:])), q[0], omega[0]


@pytest.mark.long
@pytest.mark.parametrize(("q", "omega"), STARTS[:2])
def test_it_ends_where_least_squares_of_all_samples_at_once_end(q, omega):
    """Which another method finds from the true motion, with all residuals in one vector."""
    samples, _, _ = flight(q, omega, 25, unused=(1, 3, 5))
    estimate = fitted(samples)
    first = np.concatenate((np.zeros(3), omega, np.zeros(MODEL.prior.size - 6)))
    size = 0.01 * np.concatenate((MODEL.differences, MODEL.prior[18:]))

    def slopes(x):
        there = left_over(x + np.diag(size), q, samples)[0]
        back = left_over(x - np.diag(size), q, samples)[0]
        return (0.5 * (there - back) / size[:, None]).T

    whole = least_squares(lambda x: left_over(x[None], q, samples)[0][0], first, slopes, x_scale="jac")
    _, end, rate = left_over(whole.x[None], q, samples)
    sigmas = np.sqrt(estimate.covariance.diagonal()[0:6])
    assert np.abs(error(estimate, end, rate) / sigmas).max() < 0.1


def ticks_of(samples):
    """For each tick of 1 s field and currents, nothing between the samples, and the models."""
    for number, sample in enumerate(samples):
        r, b = sample.r_eci_m, sample.b_eci_t
        reference = REFERENCE.replace(r_eci_m=r, b_eci_t=b, radius_m=norm(r))
        if number:
            for _ in range(round(SPACING_S) - 1):
                yield None, (), reference
        currents = tuple([None if one == UNKNOWN else one for one in sample.currents])
        yield sample.field_t, currents, reference


def started(samples, after_tick=lambda batch: None):
    """By single ticks, over each of which a dipole is driven: the batch, and the estimate that it gives."""
    batch = SampleBatch()
    for field, currents, reference in ticks_of(samples):
        pass_tick(batch, MOVED_AM2, 1.0)
        estimate = estimate_from_batch(batch, field, currents, reference, LIMITS, CONFIG)
        after_tick(batch)
        if estimate is not None:
            return batch, estimate
    return batch, None


@pytest.fixture(scope="module")
def samples():
    """Enough for a search, and for what comes while it is under way."""
    return flight(*STARTS[1], 27, unused=(0, 1, 3), driven_am2=MOVED_AM2)[0]


@pytest.fixture(scope="module")
def batches(samples):
    """The batch after each tick."""
    found = []
    started(samples, lambda batch: found.append(batch.copy()))
    return found


class TestByTicks:
    @pytest.mark.long
    def test_the_motion_is_found_and_carried_to_the_tick_with_the_samples_that_came_meanwhile(self, samples):
        batch, estimate = started(samples)
        assert len(batch.samples) > 22
        assert batch.search is None
        known = flight(*STARTS[1], len(batch.samples), driven_am2=MOVED_AM2)
        off = error(estimate, *known[1:])
        assert off @ np.linalg.solve(estimate.covariance[0:6, 0:6], off) < 16.8
        assert np.degrees(np.linalg.norm(off[:3])) < 6.0

    @pytest.mark.long
    def test_it_is_what_it_is_at_once(self, samples, batches):
        """From the samples that were there when it began, then on through the rest."""
        batch, estimate = started(samples)
        searched = next(one.search.searched for one in batches if one.search)
        assert searched < len(batch.samples)
        at_once = end_of(start_search(batch.samples[:searched], MODEL), batch.samples)
        sigmas = np.sqrt(at_once.covariance.diagonal()[0:6])
        there = error(at_once, estimate.q_body_from_eci, np.array(estimate.omega_body_radps))
        assert (abs(there) / sigmas).max() < 0.01  # the first steps were with fewer samples
        np.testing.assert_allclose(np.sqrt(estimate.covariance.diagonal()[0:6]), sigmas, rtol=0.01)

    @pytest.mark.interpreted
    def test_no_tick_does_more_than_its_pieces(self, samples, monkeypatch):
        legs = []
        monkeypatch.setattr(search_module, "flown", partial(noted, legs))
        tick_ends, passes = [], []

        def tick_over(batch):
            tick_ends.append(len(legs))
            passes.append(None if batch.search is None else (batch.search.stage, batch.search.steps))

        started(samples, tick_over)
        by_tick = np.diff([0, *tick_ends])
        assert by_tick.max() == PIECES
        assert max(legs) == 19 * IMPROVED
        assert sum(tick > 0 for tick in by_tick) > 60
        begins = [one != other for one, other in zip(passes[1:], passes, strict=False)]
        assert all(by_tick[1:][begins] <= PIECES)
        assert {one[0] for one in passes if one} == set(Stage) - {Stage.ENDED}

    @pytest.mark.interpreted
    def test_an_estimate_too_uncertain_for_the_filter_is_left_for_more_samples(self, samples, monkeypatch):
        asked = []

        def only_the_second(estimate, b_eci_t, config):
            asked.append(estimate)
            return len(asked) > 1

        monkeypatch.setattr(first_module, "linear", only_the_second)
        whole = flight(*STARTS[1], 40, unused=(0, 1, 3), driven_am2=MOVED_AM2)[0]
        batch, estimate = started(whole)
        assert estimate is asked[1]
        assert len(batch.samples) > len(samples)

    @pytest.mark.interpreted
    def test_of_as_many_samples_as_there_can_be_it_is_taken(self, monkeypatch):
        monkeypatch.setattr(first_module, "linear", lambda *_: False)
        monkeypatch.setattr(first_module, "MOST", 21)
        batch, estimate = started(flight(*STARTS[1], 40, unused=(0, 1, 3), driven_am2=MOVED_AM2)[0])
        assert estimate is not None
        assert len(batch.samples) < 30

    def test_a_gap_ends_it(self, batches):
        batch = next(one for one in batches if one.search).copy()
        for _ in range(61):
            pass_tick(batch, MOVED_AM2, 1.0)
        assert batch == SampleBatch()

    def test_it_goes_on_without_samples_but_starts_nothing_without(self, samples, batches):
        batch = next(one for one in reversed(batches) if one.search).copy()
        assert batch.search.stage is Stage.CARRY
        reference = list(ticks_of(samples))[-1][2]
        for _ in range(30):
            assert estimate_from_batch(batch, None, (), reference, LIMITS, CONFIG) is None
        assert batch.search.at == len(batch.samples) - 1

    def test_every_number_counts(self, batches):
        search = next(one.search for one in batches if one.search and one.search.steps == 2)
        assert search.stage is Stage.IMPROVE
        sound = pack(search)
        for place in range(0, count_doubles(search), 997):
            assert pack(flip(search, place, 3)) != sound

    @pytest.mark.long
    @pytest.mark.filterwarnings("error")
    def test_a_flipped_bit_ends_in_an_estimate_that_is_one_or_none(self, batches):
        batch = next(one for one in batches if one.search and one.search.steps == 12)
        for number in range(0, 64 * count_doubles(batch.search), 64 * 3001 + 13):
            ended = end_of(flip(batch.search, *divmod(number, 64)), batch.samples)
            assert ended is None or healthy(ended)


def noted(legs, q, *others):
    legs.append(len(q))
    return flown(q, *others)
