"""Linear equations of a tick: what they leave of field and cells, and that they make no information."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from cell_samples import (
    CELLS,
    EXCESS,
    Q_BODY_FROM_ECI,
    REFERENCE,
    SEEN,
    begun,
    cell_filter,
)
from changed import changed
from filter_steps import known_of

from fsw.core.algebra.quaternion import from_small_rotation, multiply, normalise, rotate
from fsw.core.algebra.vector import unit
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.prediction import earthlit, prediction, sunlit
from fsw.core.estimation.cells.relinearise import cell_shown, correction, linear_about, relinearise
from fsw.core.estimation.cells.update import update_cells
from fsw.core.estimation.kalman import Cause, Trace
from fsw.core.estimation.measurement import field_prediction
from fsw.core.estimation.parameters import Prior, correct_parameters
from fsw.core.packing import pack

TURNED = {"mag_turn_rad": Prior((0.02, 0.03, 0.015), (0.0,) * 3), "mag_scale": Prior((0.01,) * 3, (0.0,) * 3)}
CONFIG = cell_filter(**TURNED)
PARTS = CONFIG.layout
B_ECI_T = REFERENCE.b_eci_t
BEHIND_Q = normalise((-0.508, -0.673, -0.313, 0.437))
"""Here the Earth lights a cell that the Sun is behind."""


def told(q=Q_BODY_FROM_ECI):
    """An estimate with parameters and a covariance of their own: all errors are correlated."""
    estimate = begun(q)
    size = PARTS.size
    mixed = np.random.default_rng(8).normal(size=(size, size))
    sigma = np.sqrt(CONFIG.initial_covariance.diagonal())
    covariance = sigma[:, None] * (mixed @ mixed.T / size) * sigma
    known = replace(
        estimate.parameters,
        mag_bias_t=(2e-7, -3e-7, 4e-7),
        mag_turn_rad=(0.01, -0.02, 0.015),
        mag_scale=(0.004, -0.006, 0.003),
    )
    return replace(estimate, parameters=known, covariance=covariance)


def added_to(estimate, error):
    """The estimate corrected by an error state, its covariance as it was."""
    turn, rate = error[:3], error[3:6]
    return replace(
        estimate,
        q_body_from_eci=normalise(multiply(estimate.q_body_from_eci, from_small_rotation(tuple(turn)))),
        omega_body_radps=tuple(np.add(estimate.omega_body_radps, rate)),
        parameters=changed(estimate.parameters, correct_parameters, tuple(error), PARTS),
    )


def large_error():
    """A correction by several degrees, and by a standard deviation of each parameter."""
    signs = np.where(np.random.default_rng(2).normal(size=PARTS.size) > 0.0, 1.0, -1.0)
    error = signs * np.sqrt(CONFIG.initial_covariance.diagonal())
    error[:3] = (0.05, -0.08, 0.06)
    return error.tolist()


def whole(estimate, lit):
    """Field and cells, with bias and excess, and their sensitivity: written out again."""
    field, rows = field_prediction(*known_of(estimate), B_ECI_T, CONFIG)
    values, rows = list(field), list(rows)
    for cell in lit:
        value, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        values.append(value + estimate.parameters.cell_excess[cell])
        rows.append(row[0])
    return np.array(values), np.array(rows)


@pytest.mark.parametrize("q", [Q_BODY_FROM_ECI, BEHIND_Q], ids=["three in the Sun", "one behind"])
class TestRelinearised:
    def lit(self, q):
        return (*sunlit(q, SEEN, CELLS), *earthlit(q, SEEN, CELLS))

    def after(self, q):
        before = told(q)
        known = linear_about(before, B_ECI_T, SEEN, CONFIG, CELLS)
        return before, known, changed(added_to(before, large_error()), relinearise, known, CONFIG, CELLS)

    def test_field_and_cells_are_what_the_linear_equations_say(self, q):
        before, _, after = self.after(q)
        values, rows = whole(before, self.lit(q))
        expected = values + rows @ large_error()
        found, _ = whole(after, self.lit(q))
        np.testing.assert_allclose(found, expected, rtol=1e-9)
        without, _ = whole(added_to(before, large_error()), self.lit(q))
        assert abs((without - expected) / expected).max() > 0.01

    def test_so_is_their_covariance(self, q):
        before, _, after = self.after(q)
        _, was = whole(before, self.lit(q))
        _, now = whole(after, self.lit(q))
        expected = was @ before.covariance @ was.T
        np.testing.assert_allclose(now @ after.covariance @ now.T, expected, rtol=1e-7)
        assert abs(now @ before.covariance @ now.T / expected - 1.0).max() > 0.01
        np.testing.assert_array_equal(after.covariance, after.covariance.T)

    def test_all_else_stays(self, q):
        before, _, after = self.after(q)
        corrected = added_to(before, large_error())
        assert after.q_body_from_eci == corrected.q_body_from_eci
        assert after.omega_body_radps == corrected.omega_body_radps
        own = {*range(PARTS.mag_bias.start, PARTS.mag_bias.stop)}
        own |= {PARTS.cells.start + cell for cell in self.lit(q)}
        rest = [place for place in range(PARTS.size) if place not in own]
        moved = correction(corrected, after, CONFIG)
        np.testing.assert_allclose(moved[rest], 0.0, atol=1e-15)
        assert abs(moved[sorted(own)]).min() > 0.0
        among = np.ix_(rest, rest)
        np.testing.assert_allclose(after.covariance[among], before.covariance[among], rtol=1e-12)

    def test_a_deviation_that_is_traced_shows_as_before(self, q):
        before = told(q)
        effect = np.random.default_rng(5).normal(size=(PARTS.size, 3))
        trace = Trace((Cause(1, 2.0, 3.0), Cause(2, 1.0, 1.0)), effect, np.eye(3), 4)
        known = linear_about(before, B_ECI_T, SEEN, CONFIG, CELLS)
        corrected = added_to(replace(before, trace=trace), large_error())
        after = changed(corrected, relinearise, known, CONFIG, CELLS)
        (_, was), (_, now) = whole(before, self.lit(q)), whole(after, self.lit(q))
        np.testing.assert_allclose(now @ after.trace.effect, was @ effect, rtol=1e-9)

    def test_frozen_parameters_stay(self, q):
        before = told(q)
        known = linear_about(before, B_ECI_T, SEEN, CONFIG, CELLS)
        corrected = added_to(before, large_error())
        after = changed(corrected, relinearise, known, CONFIG, CELLS, True)
        assert pack(after) == pack(corrected)
        assert pack(changed(corrected, relinearise, known, CONFIG, CELLS)) != pack(corrected)

    def test_what_is_certain_stays(self, q):
        cell = self.lit(q)[0]
        place = PARTS.cells.start + cell
        covariance = told(q).covariance.copy()
        covariance[place] = covariance[:, place] = 0.0
        before = replace(told(q), covariance=covariance)
        known = linear_about(before, B_ECI_T, SEEN, CONFIG, CELLS)
        corrected = added_to(before, large_error())
        after = changed(corrected, relinearise, known, CONFIG, CELLS)
        assert after.parameters.cell_excess[cell] == corrected.parameters.cell_excess[cell]
        assert not after.covariance[place].any()

    def test_without_a_correction_nothing_changes(self, q):
        before = told(q)
        after = changed(
            before, relinearise, linear_about(before, B_ECI_T, SEEN, CONFIG, CELLS), CONFIG, CELLS
        )
        np.testing.assert_allclose(after.covariance, before.covariance, rtol=1e-12)
        np.testing.assert_allclose(after.parameters.cell_excess, EXCESS, rtol=1e-12)


def test_a_cell_shows_what_is_predicted_and_nearby_what_the_linear_equations_say():
    estimate = told()
    known = linear_about(estimate, B_ECI_T, SEEN, CONFIG, CELLS)
    for number, cell in enumerate(known.by_sun):
        value, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        there, sensitivity = cell_shown(known, number, estimate, CONFIG)
        assert there == pytest.approx(value + EXCESS[cell], rel=1e-12)
        np.testing.assert_array_equal(sensitivity, row)
        nearby, same = cell_shown(known, number, added_to(estimate, large_error()), CONFIG)
        assert nearby == pytest.approx(there + float(row[0] @ large_error()), rel=1e-9)
        np.testing.assert_array_equal(same, row)


def test_the_correction_is_what_was_added():
    np.testing.assert_allclose(correction(told(), added_to(told(), large_error()), CONFIG), large_error())


def test_half_a_turn_by_damaged_numbers_raises_nothing():
    before, after = told((1.0, 0.0, 0.0, 0.0)), told((0.0, 1.0, 0.0, 0.0))
    assert np.isnan(correction(before, after, CONFIG)).any()


def test_in_the_shadow_the_field_alone_is_linear():
    known = linear_about(told(), B_ECI_T, None, CONFIG, CELLS)
    assert (known.by_sun, known.by_earth, len(known.values)) == ((), (), 3)


@pytest.mark.long
class TestInformation:
    """A satellite at rest in a steady field: cells alone show the rotation about it, and all are wrong."""

    CONFIG = cell_filter(replace(CELLS, gain_sigma=0.12), **TURNED)
    SEEDS = 25

    def world(self, random):
        """The start of the filter, 6 deg wrong about the field, and the truth, by the priors."""
        config, places = self.CONFIG, self.CONFIG.layout
        known = (places.sun_turn, places.delay)  # else they would set the floor
        field = np.array(unit(rotate(Q_BODY_FROM_ECI, B_ECI_T)))
        covariance = config.initial_covariance.copy()
        covariance[0:6, 0:6] = 1e-14 * np.eye(6)
        covariance[0:3, 0:3] = radians(6.0) ** 2 * np.outer(field, field) + radians(0.2) ** 2 * np.eye(3)
        for place in known:
            covariance[place, place] *= 1e-8
        right = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, config)
        error = np.sqrt(covariance.diagonal()) * random.normal(size=places.size)
        true = replace(
            right, parameters=changed(right.parameters, correct_parameters, tuple(error.tolist()), places)
        )
        turn = from_small_rotation(tuple(radians(6.0) * random.normal() * field))
        q = normalise(multiply(Q_BODY_FROM_ECI, turn))
        return replace(right, q_body_from_eci=q, covariance=covariance), true, field

    def flown(self, seed, ticks, keep):
        """Error about the field over its standard deviation, and the standard deviation, deg."""
        random, config = np.random.default_rng(seed), self.CONFIG
        estimate, true, field = self.world(random)
        steady = field_prediction(*known_of(true), B_ECI_T, config)[0]
        level = [
            prediction(true, cell, SEEN, config, CELLS)[0] + excess
            for cell, excess in enumerate(true.parameters.cell_excess)
        ]
        for _ in range(ticks):
            known = linear_about(estimate, B_ECI_T, SEEN, config, CELLS)
            sample = tuple(np.add(steady, 2e-7 * random.normal(size=3)))
            currents = [one + CELLS.sigma * random.normal() for one in level]
            mekf.update_field(estimate, sample, B_ECI_T, config)
            update_cells(estimate, currents, known, config, CELLS)
            if keep:
                relinearise(estimate, known, config, CELLS)
        sigma = float(field @ estimate.covariance[0:3, 0:3] @ field) ** 0.5
        return float(correction(true, estimate, config)[:3] @ field) / sigma, np.degrees(sigma)

    def found(self, ticks, keep):
        """Mean of the squared error over its variance, and the mean standard deviation, deg."""
        errors, sigmas = np.array([self.flown(seed, ticks, keep) for seed in range(self.SEEDS)]).T
        return float((errors**2).mean()), float(sigmas.mean())

    def test_the_filter_knows_how_wrong_it_is_and_learns_nothing_from_more_of_the_same(self):
        nees, sigma_deg = self.found(60, keep=True)
        assert 0.5 < nees < 1.8  # 2.5 of its standard deviations, sqrt(2 / 25)
        assert self.found(30, keep=True)[1] == pytest.approx(sigma_deg, rel=0.01)

    def test_it_would_not_know_with_its_equations_turned_anew_in_each_tick(self):
        nees, sigma_deg = self.found(60, keep=False)
        assert nees > 3.0
        assert sigma_deg < 0.75 * self.found(60, keep=True)[1]
