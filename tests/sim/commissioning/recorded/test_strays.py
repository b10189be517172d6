"""Rows that the others do not bear out are found, whichever they are, and no others."""

import numpy as np
import pytest
from corrupt_rows import KINDS, seeded, spoilt
from hypothesis import given, settings
from hypothesis import strategies as st
from recorded_samples import DATA, MATRIX, OFFSET_NT, TLE, made_up

from sim.commissioning.recorded.along import along, screened
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.recorded.strays import (
    stray_currents,
    stray_sizes,
    stray_strengths,
    stray_values,
)
from sim.scenario.element_file import nearest_elements

PASSES = {
    "real": (DATA / "s3_20240426T041442Z.csv").read_text().splitlines(),
    "real, in the Sun": (DATA / "s3_20240314T153551Z.csv").read_text().splitlines(),
    "made up": made_up(120).text.splitlines(),
}
GROSS = ("nan", "ERR", "1e30", "zeros", "fill row", "cut off")
"""What no row of a pass can be, whatever the column."""


def is_gross(kind, row, lines, lit):
    """Whether a row so spoilt must be found: at its ends a pass may have a gap, in shadow no cell counts."""
    at_an_end = row in (1, len(lines) - 1)
    return kind in GROSS or (kind in ("late", "early") and not at_an_end) or (kind == "-999999" and lit.any())


@pytest.fixture(scope="module")
def used(tmp_path_factory):
    """The rows that are used of lines of a file."""
    path = tmp_path_factory.mktemp("pass") / "pass.csv"

    def rows(lines):
        path.write_text("\n".join(lines) + "\n")
        recorded = read_pass(path)
        return screened(along(recorded, nearest_elements(TLE, recorded.middle_unix_s)))

    return rows


def same(one, other):
    """Whether all that is used of two passes is the same, bit by bit."""
    a, b = one.recorded, other.recorded
    values = [(a.utc_unix_s, b.utc_unix_s), (a.mag_nt, b.mag_nt), (a.gyro_degps, b.gyro_degps)]
    values += [(a.cells[name], b.cells[name]) for name in a.cells]
    values += [(one.tick, other.tick), (one.b_eci_nt, other.b_eci_nt)]
    return all(np.array_equal(x, y, equal_nan=True) for x, y in values)


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(sorted(PASSES)),
    st.one_of(st.just(0.0), st.just(1.0), st.floats(0.0, 1.0)),
    st.sampled_from(KINDS),
    st.integers(0, 2**32),
)
def test_whatever_row_is_spoilt_what_is_used_is_what_is_used_without_it(used, name, part, kind, seed):
    lines = PASSES[name]
    row = 1 + round(part * (len(lines) - 2))
    found = used(spoilt(lines, row, kind, seeded(seed)))
    left_out = {line for one in found.recorded.left_out for line in one.lines}
    if row + 1 in left_out:
        assert same(found, used([*lines[:row], *lines[row + 1 :]]))
    else:
        assert not is_gross(kind, row, lines, found.lit), spoilt(lines, row, kind, seeded(seed))[row]
        assert found.recorded.left_out == (), "the row is borne out, and no other pays for it"


@pytest.mark.parametrize("name", sorted(PASSES))
def test_of_a_sound_pass_every_row_is_used(used, name):
    assert used(PASSES[name]).recorded.left_out == ()


@pytest.mark.parametrize("places", [range(1, 7), range(60, 66), range(-6, 0), range(5, 120, 20)])
@pytest.mark.parametrize("kind", ["-999999", "zeros", "fill row"])
def test_a_few_per_cent_of_the_rows_are_left_out_alike(used, places, kind):
    lines = PASSES["made up"]
    rows = [place % len(lines) for place in places]
    spoiled = lines
    for row in rows:
        spoiled = spoilt(spoiled, row, kind, seeded(1))
    assert same(used(spoiled), used([line for place, line in enumerate(lines) if place not in rows]))


def sphere(count=300, seed=2):
    random = np.random.default_rng(seed)
    direction = random.standard_normal((count, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    strength = 35e3 + 5e3 * np.sin(np.linspace(0.0, 5.0, count))
    field = direction * strength[:, None] + 150.0 * random.standard_normal((count, 3))
    return field @ np.linalg.inv(MATRIX).T + OFFSET_NT, strength


@pytest.mark.long
@given(st.integers(0, 299), st.integers(0, 2), st.floats(6e3, 1e9) | st.floats(-1e9, -6e3))
@settings(max_examples=40, deadline=None)
def test_a_spike_along_the_field_is_found_in_any_direction(row, seed, size_nt):
    mag_nt, strength_nt = sphere(seed=seed)
    along_field = mag_nt[row] - OFFSET_NT
    mag_nt[row] += size_nt * along_field / np.linalg.norm(along_field)
    off_nt = np.linalg.norm(MATRIX @ (mag_nt[row] - OFFSET_NT)) - strength_nt[row]
    found = np.flatnonzero(stray_strengths(mag_nt, strength_nt))
    assert found.tolist() == ([row] if abs(off_nt) > 2500.0 else found.tolist())


def test_a_row_that_no_other_can_check_does_not_decide():
    """All samples in a plane but one: it alone would tell the offset across the plane."""
    mag_nt, strength_nt = sphere()
    angle = np.linspace(0.0, 40.0, 300)
    mag_nt = np.column_stack((strength_nt * np.cos(angle), strength_nt * np.sin(angle), np.zeros(300)))
    mag_nt += 50.0 * np.random.default_rng(1).standard_normal((300, 3))
    mag_nt[150] = (0.0, 0.0, strength_nt[150])
    assert np.flatnonzero(stray_strengths(mag_nt, strength_nt)).tolist() == [150]


def test_where_more_than_a_tenth_do_not_fit_nothing_tells_which_are_wrong():
    mag_nt, strength_nt = sphere()
    mag_nt[:40] *= 3.0
    assert not stray_strengths(mag_nt, strength_nt).any()


def test_values_and_sizes_far_from_the_others_are_found():
    values = np.array([1.0, 1.1, 0.9, 1.0, 1.05, 0.95, 1.02, 0.98, np.nan, 1.0, 0.0, 1.0])
    assert np.flatnonzero(stray_values(values)).tolist() == [10]
    assert not stray_values(np.full(12, np.nan)).any()
    assert np.flatnonzero(stray_values(np.array([*[225.0] * 11, 0.0]))).tolist() == [11]
    assert np.flatnonzero(stray_sizes(np.array([*[2.0, 3.0, 1.0] * 4, 90.0]))).tolist() == [12]
    assert not stray_sizes(np.zeros(12)).any()


def test_a_cell_is_judged_by_its_brightest_rows_in_the_sun():
    current = np.array([0.0, 480.0, 500.0, 0.0, 20.0, 470.0, 0.0, 490.0, 0.0, 510.0, 17658.0, 0.0, 1.0])
    lit = np.ones(13, dtype=bool)
    assert np.flatnonzero(stray_currents(current, lit)).tolist() == [10]
    assert not stray_currents(current, np.zeros(13, dtype=bool)).any()
