"""What a batch makes of the table, and what a motion shows: as the filter has it, and written out again."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from batch_samples import CONFIG, STARTS, flight
from cell_samples import CELLS, REFERENCE

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import cross, norm, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.prediction import prediction
from fsw.core.estimation.start.batch_model import (
    RATES_DEGPS,
    TURNS,
    Motions,
    constant_slopes,
    expected,
    leg,
    model_of,
    starts,
)
from fsw.core.orbit.earth import MU_M3PS2

MODEL = model_of(CONFIG, CELLS)
Q, OMEGA = STARTS[0]
SAMPLES = flight(Q, OMEGA, 3, driven_am2=(0.02, -0.03, 0.01))[0]
BIAS, EXCESS = (2e-7, -3e-7, 4e-7), (0.03, -0.05, 0.04, -0.02, 0.06, -0.03)
GAIN, LIGHT = (0.04, 0.06, -0.05, 0.03, -0.02, 0.05), 0.07
NUMBERS = np.array([(*OMEGA, *[0.0] * 12, *BIAS, *EXCESS, *GAIN, LIGHT)])


def shown(numbers=NUMBERS, q=Q):
    return expected(Motions(np.array([q]), numbers), SAMPLES[0], MODEL)


def test_between_two_samples_acts_what_is_in_their_middle_and_was_driven_up_to_the_later():
    before, after = SAMPLES[0], replace(SAMPLES[1], since_s=23.0)
    before = replace(before, r_eci_m=(6.6e6, 0.4e6, -2.0e6), m_body_am2=(1.0, 2.0, 3.0))
    found = leg(before, after)
    middle = 0.5 * (np.array(before.r_eci_m) + np.array(after.r_eci_m))
    assert found.length_s == 23.0
    np.testing.assert_allclose(found.e1_eci, middle / np.linalg.norm(middle))
    np.testing.assert_allclose(found.b_eci_t, 0.5 * (np.array(before.b_eci_t) + np.array(after.b_eci_t)))
    assert found.gravity_per_s2 == pytest.approx(3.0 * MU_M3PS2 / np.linalg.norm(middle) ** 3)
    assert tuple(found.m_body_am2) == after.m_body_am2 == (0.02, -0.03, 0.01)


def test_a_part_of_bias_and_of_all_that_a_cell_is_wrong_by_is_noise_of_each_sample():
    bias_t = hypot(3e-7, 5e-7)
    varying = 0.3 * hypot(0.06, 0.05, 0.08)
    assert MODEL.field_sigma_t == pytest.approx(hypot(2e-7, 0.3 * bias_t))
    assert MODEL.excess_varying == pytest.approx(varying)
    assert MODEL.current_sigma == pytest.approx(hypot(0.012, varying))
    sigmas = [0.01] * 3 + [3e-8] * 3 + [0.03, 0.05, 0.04, 0.01, 0.01, 0.01]
    shown_by = [bias_t] * 3 + [0.06] * 6 + [0.05] * 6 + [0.08]
    np.testing.assert_allclose(MODEL.prior, [np.inf] * 6 + sigmas + shown_by)


@pytest.mark.parametrize("q", [q for q, _ in STARTS])
def test_a_motion_shows_what_the_filter_predicts(q):
    found = shown(q=q).values[0]
    estimate = mekf.start(q, OMEGA, CONFIG)
    known = replace(estimate.parameters, delay_s=(0.0, 0.0), cell_gain=GAIN, earth_light=(LIGHT,))
    estimate = replace(estimate, parameters=known)
    seen = light(SAMPLES[0].r_eci_m, SAMPLES[0].s_eci, CELLS.albedo)
    cells = [prediction(estimate, cell, seen, CONFIG, CELLS)[0] + EXCESS[cell] for cell in range(6)]
    np.testing.assert_allclose(found[3:], cells, rtol=1e-9)
    np.testing.assert_allclose(found[:3], np.add(rotate(q, SAMPLES[0].b_eci_t), BIAS), rtol=1e-9)


def test_the_slopes_by_what_shows_at_once_are_its_differences():
    slopes = constant_slopes(shown(), 1)[0]
    for column in range(16):
        step = np.zeros_like(NUMBERS)
        step[0, 15 + column] = 1e-3
        difference = (shown(NUMBERS + step).values - shown(NUMBERS - step).values)[0] / 2e-3
        np.testing.assert_allclose(slopes[:, column], difference, atol=1e-9)


class TestStarts:
    """Rotations about the field, each with rates that carry it to where it is seen next."""

    FIRST = replace(SAMPLES[0], coarse=None)
    SECOND = SAMPLES[1]

    def checked(self, first, second, count):
        """That they begin with the first field, and end with the second one; their attitudes."""
        motions: Motions = starts((first, second), MODEL)
        assert len(motions.q) == count
        field, later = unit(first.field_t), unit(second.field_t)
        for q, omega in zip(motions.q, motions.numbers[:, 0:3], strict=True):
            np.testing.assert_allclose(unit(rotate(tuple(q), first.b_eci_t)), field, atol=1e-12)
            along = np.dot(omega, field) * np.array(field)  # about the field: it moves nothing of it
            across = second.since_s * (omega - along)
            still = unit(rotate(tuple(q), second.b_eci_t))
            np.testing.assert_allclose(
                unit(tuple(np.subtract(still, cross(tuple(across), still)))), later, atol=1e-3
            )
        return motions.q

    def test_without_three_lit_cells_all_rotations(self):
        attitudes = self.checked(self.FIRST, self.SECOND, TURNS * len(RATES_DEGPS))
        suns = np.array([rotate(tuple(q), REFERENCE.sun_eci) for q in attitudes[:: len(RATES_DEGPS)]])
        apart = suns @ suns.T - np.eye(TURNS)
        assert apart.max() < 0.999

    def test_with_the_sun_along_the_field_too(self):
        first = replace(self.FIRST, s_eci=unit(self.FIRST.b_eci_t))
        attitudes = self.checked(first, self.SECOND, TURNS * len(RATES_DEGPS))
        assert np.abs(np.linalg.norm(attitudes, axis=1) - 1.0).max() < 1e-12
        ups = np.array([rotate(tuple(q), unit(first.r_eci_m)) for q in attitudes[:: len(RATES_DEGPS)]])
        assert (ups @ ups.T - np.eye(TURNS)).max() < 0.999

    def test_with_three_the_one_that_they_show(self):
        first = replace(SAMPLES[0], coarse=rotate(Q, SAMPLES[0].s_eci))
        attitude = self.checked(first, self.SECOND, len(RATES_DEGPS))[0]
        assert norm(cross(rotate(tuple(attitude), first.s_eci), first.coarse)) < 0.02
