"""Faces and full scales of cells that are known, through albedo and what is no current."""

import numpy as np
import pytest

from sim.commissioning.calibrate.cells import LEAST_ROWS, fit_cell

FACE = np.array([-0.95, -0.3, 0.1]) / np.linalg.norm((-0.95, -0.3, 0.1))


def sunlit(count=500, noise=8.0, seed=4):
    random = np.random.default_rng(seed)
    sun = random.standard_normal((count, 3))
    sun /= np.linalg.norm(sun, axis=1)[:, None]
    current = 420.0 * np.maximum(0.0, sun @ FACE) + noise * random.standard_normal(count)
    return current, sun, np.ones(count, dtype=bool)


def off_deg(fit):
    return np.degrees(np.arccos(min(1.0, fit.face_body @ FACE)))


def test_face_and_full_scale_are_found_within_their_deviations():
    fits = [fit_cell("a", *sunlit(seed=seed)) for seed in range(20)]
    assert np.mean([off_deg(fit) < 3.0 * fit.face_sigma_deg for fit in fits]) > 0.9
    assert np.mean([abs(fit.full_scale - 420.0) < 3.0 * fit.full_scale_sigma for fit in fits]) > 0.9
    assert all(fit.determined for fit in fits)


def test_light_of_the_earth_on_the_dark_side_and_wild_rows_do_not_count():
    current, sun, lit = sunlit()
    current[sun @ FACE < 0.0] += 100.0
    current[7] = 17658.0
    fit = fit_cell("a", current, sun, lit)
    assert off_deg(fit) < 1.5
    assert fit.full_scale == pytest.approx(420.0, rel=0.02)


def test_rows_in_shadow_and_empty_fields_do_not_count():
    current, sun, lit = sunlit()
    lit[:200], current[:200], current[300] = False, 0.0, np.nan
    assert off_deg(fit_cell("a", current, sun, lit)) < 1.5


def test_too_few_rows_give_none_and_few_are_not_told():
    current, sun, lit = sunlit(8)
    assert fit_cell("a", current, sun, lit) is None
    lit[:] = False
    assert fit_cell("a", current, sun, lit) is None
    along = np.tile(FACE, (LEAST_ROWS, 1)) + 0.001 * sunlit(LEAST_ROWS)[1]
    one_way = fit_cell(
        "a", 420.0 * (along @ FACE) + sunlit(LEAST_ROWS)[0] * 0.02, along, np.ones(len(along), bool)
    )
    assert not one_way.determined
