"""From field and cells to an estimate: which refusals count, when parameters start anew, lost ticks."""

from dataclasses import replace
from math import inf, radians

import numpy as np
import pytest
from cell_samples import CELLS, Q_BODY_FROM_ECI, REFERENCE, cell_filter, cells_taken
from changed import changed
from estimator_samples import IDLE, field_message
from gate_samples import measured

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.algebra.vector import ZERO, scale, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.prediction import earthlit, sunlit
from fsw.core.estimation.dynamics.error_dynamics import Driven
from fsw.core.estimation.estimator import EstimatorConfig, EstimatorState, Turning, predict, update
from fsw.core.estimation.start.batch import SampleBatch
from fsw.core.estimation.start.batch_sample import BatchSample
from fsw.core.estimation.start.first import StartLimits
from fsw.wire.messages import SunCells

MEKF = cell_filter()
CONFIG = EstimatorConfig(MEKF, False, StartLimits(3e-6, inf, 0.0), 6, radians(5.0), radians(5.0), inf)
SEEN = light(REFERENCE.r_eci_m, REFERENCE.sun_eci, CELLS.albedo)
SLOW = scale(radians(0.05), unit((0.6, -0.48, 0.64)))
LIT = sunlit(Q_BODY_FROM_ECI, SEEN, CELLS)
"""Three cells."""


def currents(q=Q_BODY_FROM_ECI):
    """What ideal cells show, parts of full sunlight."""
    s, e = rotate(q, SEEN.s_eci), rotate(q, SEEN.e_eci)
    return [
        max(0.0, float(np.dot(n, s))) + SEEN.earth * (0.5 + 0.5 * float(np.dot(n, e))) ** 2
        for n in CELLS.normals_body
    ]


def readings(*off):
    """Ideal samples of field and cells, but for these cells, which show too much."""
    shown = [one + 1.5 * (cell in off) for cell, one in enumerate(currents())]
    sent = [one * full for one, full in zip(shown, CELLS.full_sun, strict=True)]
    field = field_message(rotate(Q_BODY_FROM_ECI, REFERENCE.b_eci_t))
    return measured(field=field, cells=SunCells(1, *sent), coil=IDLE)


def running(turning=Turning.NO):
    """An estimate that is sure of attitude and rate."""
    estimate = mekf.start(Q_BODY_FROM_ECI, SLOW, MEKF)
    covariance = estimate.covariance.copy()
    covariance[0:6, 0:6] *= 1e-4
    return EstimatorState(replace(estimate, covariance=covariance), 2, turning=turning)


@pytest.mark.parametrize(
    ("off", "in_a_row"),
    [((), 0), (LIT[:1], 0), (LIT[:2], 0), (LIT, 3)],
    ids=["none", "one", "two, but one is taken", "all"],
)
def test_cells_count_as_refused_where_more_than_one_is_and_none_is_taken(off, in_a_row):
    state = running()
    used = update(state, readings(*off), REFERENCE, CONFIG)
    assert used.cells.refused == tuple(off)
    assert (state.rejected_in_a_row, state.rejected_total) == (in_a_row, int(in_a_row > 0))


class TestAnew:
    """After a fast turn the parameters start anew, the attitude twice as uncertain as it was."""

    def test_with_cells(self):
        before = running(Turning.FAST)
        same = changed(running(), update, readings(), REFERENCE, CONFIG).estimate
        state = changed(before, update, readings(), REFERENCE, CONFIG)
        assert state.turning is Turning.NO
        np.testing.assert_allclose(state.estimate.covariance[0:6, 0:6], 4.0 * same.covariance[0:6, 0:6])
        np.testing.assert_array_equal(state.estimate.covariance[6:, 6:], MEKF.initial_covariance[6:, 6:])
        np.testing.assert_array_equal(state.estimate.covariance[0:6, 6:], 0.0)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_not_while_the_rate_about_one_axis_is_hardly_known(self, axis):
        before = running(Turning.FAST)
        covariance = before.estimate.covariance.copy()
        covariance[3 + axis, 3 + axis] = radians(0.5) ** 2
        before = replace(before, estimate=replace(before.estimate, covariance=covariance))
        state = changed(before, update, readings(), REFERENCE, CONFIG)
        assert state.turning is Turning.FAST


def test_of_lost_ticks_each_has_its_dipole_in_the_batch():
    sample = BatchSample(0.0, ZERO, ZERO, (0.0,) * 6, ZERO, ZERO, REFERENCE.r_eci_m, 1.0, 0.0)
    driven = [Driven((0.3, 0.0, -0.1), ZERO), Driven(ZERO, ZERO), Driven((0.0, 0.5, 0.2), ZERO)]
    state = EstimatorState(batch=SampleBatch((sample,)))
    predict(state, REFERENCE, driven, CONFIG)
    assert state.batch.since_s == 3.0
    assert state.batch.driven_am2s == pytest.approx((0.3, 0.5, 0.1))


def test_a_cell_with_the_sun_behind_it_tells_how_bright_the_earth_is():
    q, place = (-0.508, -0.673, -0.313, 0.437), MEKF.layout.earth_light.start
    behind = earthlit(q, SEEN, CELLS)
    assert behind
    whole = currents(q)
    without = [None if cell in behind else one for cell, one in enumerate(whole)]
    estimate = mekf.start(normalise(q), SLOW, MEKF)
    known, unknown = (cells_taken(estimate, shown, SEEN, MEKF)[0] for shown in (whole, without))
    assert known.covariance[place, place] < 0.99 * unknown.covariance[place, place]
