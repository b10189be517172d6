"""Sun cells in the filter: each is gated by itself, and its excess fades."""

from dataclasses import replace

import numpy as np
import pytest
from cell_samples import (
    CELLS,
    EXCESS,
    EXCESS_SIGMA,
    LIGHT,
    NOISE_SIGMA,
    OMEGA,
    Q_BODY_FROM_ECI,
    SEEN,
    begun,
    cell_filter,
    cells_taken,
    shown,
)
from changed import changed

from fsw.core.algebra.vector import norm
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.prediction import prediction, sunlit
from fsw.core.estimation.cells.relinearise import correction
from fsw.core.estimation.cells.update import GATE_NIS, NO_CELLS, take_cell
from fsw.core.estimation.changes import CORRELATION_RAD, ORBIT_RADPS, fade
from fsw.core.estimation.kalman import Cause, Trace
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.parameters import NOTHING, correct_parameters, layout
from fsw.core.packing import pack

CONFIG = cell_filter()
LIT = sunlit(Q_BODY_FROM_ECI, SEEN, CELLS)


class TestUpdate:
    def test_the_first_cell_is_taken_as_by_the_textbook(self):
        estimate, cell = begun(), LIT[0]
        value, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        innovation = 0.04
        after = estimate.copy()
        assert take_cell(after, cell, value + EXCESS[cell] + innovation, SEEN, CONFIG, CELLS)
        p = estimate.covariance
        s = (row @ p @ row.T)[0, 0] + NOISE_SIGMA**2
        gain = (p @ row.T)[:, 0] / s
        np.testing.assert_allclose(after.covariance, p - np.outer(gain, gain) * s, atol=1e-12)
        place = CONFIG.layout.cells.start
        change = np.subtract(after.parameters.cell_excess, EXCESS)
        np.testing.assert_allclose(change, gain[place : place + 6] * innovation, rtol=1e-9, atol=1e-15)
        assert (after.nis, after.numbers) == (pytest.approx(innovation**2 / s), 1)

    def test_ideal_cells_are_taken_and_leave_the_attitude(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        after, used = cells_taken(level, shown(), SEEN, CONFIG)
        assert (used.taken, used.refused) == (tuple(LIT), ())
        assert np.linalg.norm(np.subtract(after.q_body_from_eci, level.q_body_from_eci)) < 1e-9
        assert after.covariance.diagonal()[0:3].max() < level.covariance.diagonal()[0:3].max()

    def test_each_is_gated_by_itself(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        currents = shown()
        currents[LIT[1]] += 1.0
        after, used = cells_taken(level, currents, SEEN, CONFIG)
        assert (used.taken, used.refused) == ((LIT[0], LIT[2]), (LIT[1],))
        without = [None if cell == LIT[1] else one for cell, one in enumerate(currents)]
        same, _ = cells_taken(level, without, SEEN, CONFIG)
        np.testing.assert_array_equal(after.covariance, same.covariance)

    @pytest.mark.parametrize(("off", "fits"), [(0.999, True), (1.001, False)])
    def test_the_gate_is_that_of_one_number(self, off, fits):
        estimate, cell = begun(), LIT[0]
        value, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        sigma = ((row @ estimate.covariance @ row.T)[0, 0] + NOISE_SIGMA**2) ** 0.5
        current = value + EXCESS[cell] + off * GATE_NIS**0.5 * sigma
        assert take_cell(estimate, cell, current, SEEN, CONFIG, CELLS) is fits

    def test_one_that_shows_nothing_is_refused_and_changes_nothing(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        after, used = cells_taken(level, [0.0] * 6, SEEN, CONFIG)
        assert pack(after) == pack(level)
        assert (used.taken, used.refused) == ((), tuple(LIT))

    def test_none_is_taken_in_the_shadow(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        after, used = cells_taken(level, shown(), None, CONFIG)
        assert (pack(after), used) == (pack(level), NO_CELLS)

    def test_what_is_no_number_never_gets_through(self):
        estimate = begun()
        for bad in (float("nan"), float("inf")):
            with np.errstate(invalid="ignore"):  # infinity times zero
                assert not take_cell(estimate, LIT[0], bad, SEEN, CONFIG, CELLS)


class TestExcess:
    def test_keeps_its_spread_and_forgets_what_it_was(self):
        estimate = begun()
        place = CONFIG.layout.cells
        turn = norm(OMEGA) + ORBIT_RADPS
        keep = 1.0 / (1.0 + turn / CORRELATION_RAD)
        after = changed(estimate, fade, CONFIG)
        assert after.parameters.cell_excess == pytest.approx([keep * one for one in EXCESS])
        np.testing.assert_allclose(after.covariance.diagonal()[place], EXCESS_SIGMA**2, rtol=1e-12)
        of_light = 1.0 / (1.0 + ORBIT_RADPS / CORRELATION_RAD)  # however fast the satellite turns
        assert after.parameters.earth_light == pytest.approx((of_light * LIGHT,))
        for _ in range(2000):
            after = changed(after, fade, CONFIG)
        assert np.abs(after.parameters.cell_excess).max() < 1e-6

    def test_of_a_cell_that_has_been_seen_returns_to_its_spread(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        seen, _ = cells_taken(level, shown(), SEEN, CONFIG)
        place = CONFIG.layout.cells.start + LIT[0]
        assert seen.covariance[place, place] < 0.95 * EXCESS_SIGMA**2
        crossed = abs(seen.covariance[place, 0:3]).max()
        later = seen
        for _ in range(3000):
            later = changed(later, fade, CONFIG)
        assert later.covariance[place, place] == pytest.approx(EXCESS_SIGMA**2, rel=1e-2)
        assert abs(later.covariance[place, 0:3]).max() < 0.1 * crossed

    @pytest.mark.long
    def test_a_lasting_excess_is_no_white_noise(self):
        """A thousand samples of cells that are all 0.1 too bright must not make the filter sure of them."""
        estimate = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        wrong = [one + 0.1 for one in shown()]
        for _ in range(1000):
            estimate, _ = cells_taken(changed(estimate, fade, CONFIG), wrong, SEEN, CONFIG)
        sigma_deg = np.degrees(np.sqrt(estimate.covariance.diagonal()[0:3]))
        assert sigma_deg.min() > 1.0

    def test_what_a_deviation_leaves_decays_as_they_do(self):
        """An estimate that is wrong by an effect is, a tick later, wrong by what is then traced of it."""
        estimate, parts = begun(), CONFIG.layout
        effect = np.zeros((parts.size, 2))
        effect[parts.cells, 0], effect[parts.earth_light, 0] = (0.01, -0.02, 0.03, 0.01, -0.01, 0.02), 0.04
        effect[0:3, 0] = 1e-3
        traced = replace(estimate, trace=Trace((Cause(0, 0.0, 0.0),), effect, np.zeros((2, 2)), 0))
        known = changed(estimate.parameters, correct_parameters, tuple(effect[:, 0].tolist()), parts)
        before, wrong = (
            changed(traced, fade, CONFIG),
            changed(replace(estimate, parameters=known), fade, CONFIG),
        )
        left = correction(before, wrong, CONFIG)
        np.testing.assert_allclose(before.trace.effect[6:, 0], left[6:], rtol=1e-9, atol=1e-15)
        np.testing.assert_array_equal(before.trace.effect[0:6], effect[0:6])
        assert 0.0 < left[parts.earth_light.start] < 0.04
        assert traced.trace.effect is effect

    def test_without_cells_the_earths_light_alone_goes_to_its_mean(self):
        """It deflects a Sun sensor, and is no less one that varies with what the satellite passes over."""
        parts = layout({"mag_bias_t", "earth_light"})
        parameters = replace(NOTHING, earth_light=(0.3,))
        covariance = np.diag([1e-4] * 6 + [1e-14] * 3 + [1e-6])
        config = replace(
            CONFIG,
            cells=None,
            layout=parts,
            initial_parameters=replace(NOTHING, earth_light=(0.2,)),
            initial_covariance=np.diag([1e-2] * 6 + [1e-13] * 3 + [1e-2]),
        )
        estimate = Estimate(Q_BODY_FROM_ECI, (0.01, -0.02, 0.03), parameters, covariance)
        later = changed(estimate, fade, config)
        kept = 1.0 / (1.0 + config.tick_s * ORBIT_RADPS)
        assert later.parameters.earth_light == pytest.approx((0.2 + kept * 0.1,), rel=1e-12)
        expected = covariance.diagonal().copy()
        expected[9] = kept**2 * 1e-6 + (1.0 - kept**2) * 1e-2
        np.testing.assert_allclose(later.covariance.diagonal(), expected, rtol=1e-9)
        assert later.q_body_from_eci == estimate.q_body_from_eci
