"""Whatever stands in the state or comes from sensors: a sound estimate or none, and no exception."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest
from estimator_samples import (
    CONFIG,
    REFERENCE,
    SIZE,
    seen_from,
    step,
)
from gate_samples import measured
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.core.estimation import mekf
from fsw.core.estimation.dynamics.error_dynamics import Driven
from fsw.core.estimation.estimator import (
    Used,
)
from fsw.core.estimation.orbital_attitude import orbital_attitude
from fsw.core.estimation.parameters import NAMES
from fsw.wire.messages import MagField, SunVector


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # overflow is what is tried
class TestSoundness:
    @pytest.mark.parametrize("bad", [nan, inf, -inf, 1e200])
    @pytest.mark.parametrize("readings", [measured(), seen_from()], ids=["silent", "speaking"])
    @pytest.mark.parametrize("field", ["q_body_from_eci", "omega_body_radps", *NAMES])
    def test_a_broken_estimate_is_replaced_and_nothing_is_raised(self, settled, field, readings, bad):
        estimate = settled.estimate
        if field in NAMES:
            values = (*getattr(estimate.parameters, field)[:-1], bad)
            estimate = replace(estimate, parameters=replace(estimate.parameters, **{field: values}))
        else:
            estimate = replace(estimate, **{field: (*getattr(estimate, field)[:-1], bad)})
        broken = replace(settled, estimate=estimate)
        state, _ = step(broken, readings)
        assert state.estimate is None or mekf.healthy(state.estimate)
        if not np.isfinite(bad):
            assert state.restarts == 1
            assert (state.estimate is not None) is (readings.field is not None)

    @pytest.mark.parametrize(
        ("at", "bad"),
        [(at, bad) for at in ((0, 0), (0, 1), (4, 4), (3, 8), (11, 11)) for bad in (nan, inf, -1.0)]
        + [((0, 0), 1e300), ((4, 4), 1e300), ((11, 11), 1e300)],
    )
    def test_so_is_a_broken_covariance(self, settled, at, bad):
        covariance = settled.estimate.covariance.copy()
        covariance[at] = covariance[at[::-1]] = bad
        broken = replace(settled, estimate=replace(settled.estimate, covariance=covariance))
        for readings in (seen_from(), measured()):
            state, _ = step(broken, readings)
            assert state.estimate is None or mekf.healthy(state.estimate)

    def test_a_variance_that_the_update_makes_negative_is_lost(self, settled):
        """What ties attitude and bias together has grown in one place alone: the two no longer agree."""
        for value in (1e-2, -1e-2, 1.0, -1.0):
            covariance = settled.estimate.covariance.copy()
            covariance[2, 6] = value
            broken = replace(settled, estimate=replace(settled.estimate, covariance=covariance))
            state, _ = step(broken, seen_from())
            assert state.estimate is None or mekf.healthy(state.estimate)
            limits = CONFIG.valid_sigma_rad, CONFIG.usable_sigma_rad, CONFIG.fastest_valid_radps
            orbital_attitude(state.estimate, REFERENCE, *limits)

    def test_a_covariance_that_overflows_in_the_prediction_is_caught_before_the_update(self, settled):
        spinning = replace(
            settled.estimate, omega_body_radps=(1e60, -2e60, 3e60), covariance=1e100 * np.eye(SIZE)
        )
        state, used = step(replace(settled, estimate=spinning), seen_from())
        assert state.restarts == 1
        assert used == Used(True, True, False)

    @pytest.mark.long
    @given(
        st.tuples(*[st.floats(-65536.0, 65534.0)] * 3),
        st.tuples(*[st.floats(-1.1, 1.1)] * 3),
        st.integers(1, 100),
        st.floats(-8.0, 8.0),
    )
    @settings(max_examples=150, deadline=None)
    def test_no_reading_breaks_it(self, settled, b_nt, sun, elapsed, m):
        readings = seen_from(field=MagField(1, *b_nt), sun=SunVector(1, *sun))
        state, _ = step(settled, readings, driven=[Driven((m, -m, m), (-m, m, m))] * elapsed)
        assert state.estimate is None or mekf.healthy(state.estimate)
