"""Sun cells in the filter: prediction and its derivative, one cell at a time, an excess that fades."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from cell_samples import (
    CELLS,
    EXCESS_SIGMA,
    LIGHT_SIGMA,
    NOISE_SIGMA,
    Q_BODY_FROM_ECI,
    REFERENCE,
    cell_filter,
)

from fsw.core.algebra.quaternion import from_small_rotation, multiply, normalise, rotate
from fsw.core.algebra.vector import norm
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.update import (
    CORRELATION_RAD,
    GATE_NIS,
    LEAST_COSINE,
    NO_CELLS,
    ORBIT_RADPS,
    faded,
    most_behind,
    prediction,
    sunlit,
    taken,
    update_cells,
)

CONFIG = cell_filter()
SEEN = light(REFERENCE.r_eci_m, REFERENCE.sun_eci, CELLS.albedo)
OMEGA = (0.004, -0.006, 0.003)
EXCESS = (0.03, -0.05, 0.04, -0.02, 0.06, -0.03)
GAIN = (0.04, 0.06, -0.05, 0.03, -0.02, 0.05)
LIGHT = 0.07


def begun(q=Q_BODY_FROM_ECI):
    """An estimate with parameters of their own."""
    estimate = mekf.start(q, OMEGA, CONFIG)
    known = estimate.parameters._replace(
        sun_turn_rad=(0.004, -0.006, 0.005), cell_excess=EXCESS, cell_gain=GAIN, earth_light=(LIGHT,)
    )
    return estimate._replace(parameters=known)


def shown(q_body_from_eci=Q_BODY_FROM_ECI, gain=(0.0,) * 6, light=0.0):
    """What cells show, without excess, turn and age: written out again."""
    s, e = rotate(q_body_from_eci, SEEN.s_eci), rotate(q_body_from_eci, SEEN.e_eci)
    earth = SEEN.earth * (1.0 + light / CELLS.albedo)
    return [
        (1.0 + more) * max(0.0, float(np.dot(normal, s)))
        + earth * (0.5 + 0.5 * float(np.dot(normal, e))) ** 2
        for normal, more in zip(CELLS.normals_body, gain, strict=True)
    ]


LIT = sunlit(Q_BODY_FROM_ECI, SEEN, CELLS)


def moved(estimate, index, step):
    """The estimate with another value of one number of its error state."""
    parts, parameters = CONFIG.layout, estimate.parameters
    if index < 3:
        turn = tuple(step if axis == index else 0.0 for axis in range(3))
        q = normalise(multiply(estimate.q_body_from_eci, from_small_rotation(turn)))
        return estimate._replace(q_body_from_eci=q)
    if index < 6:
        rate = tuple(
            w + (step if axis == index - 3 else 0.0) for axis, w in enumerate(estimate.omega_body_radps)
        )
        return estimate._replace(omega_body_radps=rate)
    for name, place in (
        ("sun_turn_rad", parts.sun_turn),
        ("delay_s", parts.delay),
        ("cell_excess", parts.cells),
        ("cell_gain", parts.cell_gain),
        ("earth_light", parts.earth_light),
    ):
        if place.start <= index < place.stop:
            values = list(getattr(parameters, name))
            values[index - place.start] += step
            return estimate._replace(parameters=parameters._replace(**{name: tuple(values)}))
    return estimate


class TestPrediction:
    def test_there_are_three_cells_in_the_sun_here(self):
        assert len(LIT) == 3

    @pytest.mark.parametrize("cell", LIT)
    def test_is_the_cosine_and_the_earth_s_light(self, cell):
        level = begun()._replace(
            parameters=begun().parameters._replace(sun_turn_rad=(0.0,) * 3, delay_s=(0.0, 0.0))
        )
        value, _ = prediction(level, cell, SEEN, CONFIG, CELLS)
        assert value == pytest.approx(shown(gain=GAIN, light=LIGHT)[cell], rel=1e-12)
        without, _ = prediction(level, cell, SEEN._replace(earth=0.0), CONFIG, CELLS)
        assert value - without > 0.002

    @pytest.mark.parametrize("cell", LIT)
    def test_the_sensitivity_is_its_derivative(self, cell):
        estimate = begun()
        _, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        for index in range(CONFIG.layout.size):
            step = 1e-6
            up, down = (moved(estimate, index, sign * step) for sign in (1.0, -1.0))
            values = [
                prediction(one, cell, SEEN, CONFIG, CELLS)[0] + one.parameters.cell_excess[cell]
                for one in (up, down)
            ]
            assert row[0, index] == pytest.approx((values[0] - values[1]) / (2.0 * step), abs=0.01), (
                index
            )  # second order in the turn

    def test_a_cell_in_the_shade_of_the_satellite_is_not_in_the_sun(self):
        q = Q_BODY_FROM_ECI
        turned = [multiply(q, normalise((1.0, *v))) for v in np.random.default_rng(4).normal(size=(300, 3))]
        for attitude in turned:
            s = rotate(attitude, SEEN.s_eci)
            expected = {
                cell
                for cell, normal in enumerate(CELLS.normals_body)
                if np.dot(normal, s) > LEAST_COSINE and not (cell == 2 and s[1] > 0.9)
            }
            assert set(sunlit(attitude, SEEN, CELLS)) == expected


class TestUpdate:
    def test_the_first_cell_is_taken_as_by_the_textbook(self):
        estimate, cell = begun(), LIT[0]
        value, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        innovation = 0.04
        after = taken(estimate, cell, value + EXCESS[cell] + innovation, SEEN, CONFIG, CELLS)
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
        after, used = update_cells(level, shown(), SEEN, CONFIG)
        assert (used.taken, used.refused) == (tuple(LIT), ())
        assert norm(np.subtract(after.q_body_from_eci, level.q_body_from_eci)) < 1e-9
        assert after.covariance.diagonal()[0:3].max() < level.covariance.diagonal()[0:3].max()

    def test_each_is_gated_by_itself(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        currents = shown()
        currents[LIT[1]] += 1.0
        after, used = update_cells(level, currents, SEEN, CONFIG)
        assert (used.taken, used.refused) == ((LIT[0], LIT[2]), (LIT[1],))
        without = [None if cell == LIT[1] else one for cell, one in enumerate(currents)]
        same, _ = update_cells(level, without, SEEN, CONFIG)
        np.testing.assert_array_equal(after.covariance, same.covariance)

    @pytest.mark.parametrize(("off", "fits"), [(0.999, True), (1.001, False)])
    def test_the_gate_is_that_of_one_number(self, off, fits):
        estimate, cell = begun(), LIT[0]
        value, row = prediction(estimate, cell, SEEN, CONFIG, CELLS)
        sigma = ((row @ estimate.covariance @ row.T)[0, 0] + NOISE_SIGMA**2) ** 0.5
        current = value + EXCESS[cell] + off * GATE_NIS**0.5 * sigma
        assert (taken(estimate, cell, current, SEEN, CONFIG, CELLS) is not None) is fits

    def test_one_that_shows_nothing_is_refused_and_changes_nothing(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        currents = [0.0] * 6
        after, used = update_cells(level, currents, SEEN, CONFIG)
        assert after is level
        assert (used.taken, used.refused) == ((), tuple(LIT))

    def test_none_is_taken_in_the_shadow_or_without_cells(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        assert update_cells(level, shown(), None, CONFIG) == (level, NO_CELLS)

    def test_what_is_no_number_never_gets_through(self):
        estimate = begun()
        for bad in (float("nan"), float("inf")):
            with np.errstate(invalid="ignore"):  # infinity times zero
                assert taken(estimate, LIT[0], bad, SEEN, CONFIG, CELLS) is None


class TestExcess:
    def test_keeps_its_spread_and_forgets_what_it_was(self):
        estimate = begun()
        place = CONFIG.layout.cells
        turn = norm(OMEGA) + ORBIT_RADPS
        keep = 1.0 / (1.0 + turn / CORRELATION_RAD)
        after = faded(estimate, CONFIG)
        assert after.parameters.cell_excess == pytest.approx([keep * one for one in EXCESS])
        np.testing.assert_allclose(after.covariance.diagonal()[place], EXCESS_SIGMA**2, rtol=1e-12)
        of_light = 1.0 / (1.0 + ORBIT_RADPS / CORRELATION_RAD)  # however fast the satellite turns
        assert after.parameters.earth_light == pytest.approx((of_light * LIGHT,))
        for _ in range(2000):
            after = faded(after, CONFIG)
        assert np.abs(after.parameters.cell_excess).max() < 1e-6

    def test_of_a_cell_that_has_been_seen_returns_to_its_spread(self):
        level = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        seen, _ = update_cells(level, shown(), SEEN, CONFIG)
        place = CONFIG.layout.cells.start + LIT[0]
        assert seen.covariance[place, place] < 0.95 * EXCESS_SIGMA**2
        crossed = abs(seen.covariance[place, 0:3]).max()
        later = seen
        for _ in range(3000):
            later = faded(later, CONFIG)
        assert later.covariance[place, place] == pytest.approx(EXCESS_SIGMA**2, rel=1e-2)
        assert abs(later.covariance[place, 0:3]).max() < 0.1 * crossed

    def test_a_lasting_excess_is_no_white_noise(self):
        """A thousand samples of cells that are all 0.1 too bright must not make the filter sure of them."""
        estimate = mekf.start(Q_BODY_FROM_ECI, (0.0,) * 3, CONFIG)
        wrong = [one + 0.1 for one in shown()]
        for _ in range(1000):
            estimate, _ = update_cells(faded(estimate, CONFIG), wrong, SEEN, CONFIG)
        sigma_deg = np.degrees(np.sqrt(estimate.covariance.diagonal()[0:3]))
        assert sigma_deg.min() > 1.0

    def test_without_cells_nothing_is_touched(self):
        estimate = begun()
        assert faded(estimate, replace(CONFIG, cells=None)) is estimate


@pytest.mark.parametrize(("light_shown", "brighter"), [(LIGHT, 1.0 + LIGHT / CELLS.albedo), (-LIGHT, 1.0)])
def test_a_cell_with_the_sun_behind_it_shows_the_earth_and_its_excess_at_most(light_shown, brighter):
    """The Earth as bright as the cells have shown it, yet not darker than by the table."""
    estimate = begun()
    estimate = estimate._replace(parameters=estimate.parameters._replace(earth_light=(light_shown,)))
    for normal in CELLS.normals_body:
        view = 0.5 + 0.5 * np.dot(normal, rotate(Q_BODY_FROM_ECI, SEEN.e_eci))
        most = most_behind(estimate, normal, SEEN, CELLS)
        earth = brighter * SEEN.earth * view**2
        assert most == pytest.approx(0.05 + earth + 4.0 * hypot(EXCESS_SIGMA, LIGHT_SIGMA))
