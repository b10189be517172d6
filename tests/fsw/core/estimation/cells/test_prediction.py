"""What Sun cells should show, its derivative, and the most that one facing away from the Sun can show."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from cell_samples import (
    CELLS,
    EXCESS_SIGMA,
    GAIN,
    LIGHT,
    LIGHT_SIGMA,
    Q_BODY_FROM_ECI,
    SEEN,
    begun,
    cell_filter,
    shown,
)

from fsw.core.algebra.quaternion import from_small_rotation, multiply, normalise, rotate
from fsw.core.estimation.cells.cell_set import Light
from fsw.core.estimation.cells.prediction import LEAST_COSINE, most_behind, prediction, sunlit

CONFIG = cell_filter()
LIT = sunlit(Q_BODY_FROM_ECI, SEEN, CELLS)


def moved(estimate, index, step):
    """The estimate with another value of one number of its error state."""
    parts, parameters = CONFIG.layout, estimate.parameters
    if index < 3:
        turn = tuple(step if axis == index else 0.0 for axis in range(3))
        q = normalise(multiply(estimate.q_body_from_eci, from_small_rotation(turn)))
        return replace(estimate, q_body_from_eci=q)
    if index < 6:
        rate = tuple(
            w + (step if axis == index - 3 else 0.0) for axis, w in enumerate(estimate.omega_body_radps)
        )
        return replace(estimate, omega_body_radps=rate)
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
            return replace(estimate, parameters=replace(parameters, **{name: tuple(values)}))
    return estimate


class TestPrediction:
    def test_there_are_three_cells_in_the_sun_here(self):
        assert len(LIT) == 3

    @pytest.mark.parametrize("cell", LIT)
    def test_is_the_cosine_and_the_earth_s_light(self, cell):
        level = replace(
            begun(), parameters=replace(begun().parameters, sun_turn_rad=(0.0,) * 3, delay_s=(0.0, 0.0))
        )
        value, _ = prediction(level, cell, SEEN, CONFIG, CELLS)
        assert value == pytest.approx(shown(gain=GAIN, light=LIGHT)[cell], rel=1e-12)
        without, _ = prediction(level, cell, Light(SEEN.s_eci, SEEN.e_eci, 0.0), CONFIG, CELLS)
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


def test_without_light_of_the_earth_it_shows_its_excess_at_most():
    dark = replace(CELLS, albedo=0.0)
    for normal in CELLS.normals_body:
        most = most_behind(begun(), normal, Light(SEEN.s_eci, SEEN.e_eci, 0.0), dark)
        assert most == pytest.approx(0.05 + 4.0 * hypot(EXCESS_SIGMA, LIGHT_SIGMA))


@pytest.mark.parametrize(("light_shown", "brighter"), [(LIGHT, 1.0 + LIGHT / CELLS.albedo), (-LIGHT, 1.0)])
def test_a_cell_with_the_sun_behind_it_shows_the_earth_and_its_excess_at_most(light_shown, brighter):
    """The Earth as bright as the cells have shown it, yet not darker than by the table."""
    estimate = begun()
    estimate = replace(estimate, parameters=replace(estimate.parameters, earth_light=(light_shown,)))
    for normal in CELLS.normals_body:
        view = 0.5 + 0.5 * np.dot(normal, rotate(Q_BODY_FROM_ECI, SEEN.e_eci))
        most = most_behind(estimate, normal, SEEN, CELLS)
        earth = brighter * SEEN.earth * view**2
        assert most == pytest.approx(0.05 + earth + 4.0 * hypot(EXCESS_SIGMA, LIGHT_SIGMA))
