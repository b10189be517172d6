"""A bias that moves is shown with its size and sense; one that stands still is not."""

import numpy as np
import pytest
from recorded_samples import made_up

from sim.commissioning.calibrate.magnetometer import fit_magnetometer
from sim.commissioning.calibrate.recorded import bias_drift

pytestmark = pytest.mark.long


def drift(folder, drift_nt, extra=None):
    truth = made_up(1000, seed=4, drift_nt=drift_nt)
    around = truth.along(folder)
    if extra is not None:
        around = extra(around)
    fit = fit_magnetometer(around.recorded.mag_nt, around.strength_nt)
    return bias_drift(around, fit)


def test_a_bias_that_moves_is_seen_to(tmp_path):
    found = drift(tmp_path, 3000.0)
    assert len(found.middle_s) == 5
    moved = found.bias_nt[-1, 0] - found.bias_nt[0, 0]
    assert moved == pytest.approx(3000.0 * 0.8, abs=5.0 * found.sigma_nt[:, 0].max() + 200.0)
    assert found.largest_nt > 800.0
    assert found.eclipse_nt is None
    assert found.per_degc_nt is None


def test_one_that_stands_still_is_not(tmp_path):
    found = drift(tmp_path, 0.0)
    assert np.mean(np.abs(found.bias_nt) < 3.0 * found.sigma_nt) > 0.9
    assert found.largest_nt < 300.0


def test_with_temperature_the_slope_is_found(tmp_path):
    def warmed(around):
        warm = np.linspace(10.0, -5.0, len(around.tick))
        return _with(around, recorded=_with(around.recorded, temperature_degc=warm))

    found = drift(tmp_path, 3000.0, warmed)
    value, sigma = found.per_degc_nt
    assert value[0] == pytest.approx(-200.0, abs=60.0 + 3.0 * sigma[0])
    assert abs(value[1]) < 60.0 + 3.0 * sigma[1]


def test_in_shadow_less_in_the_sun(tmp_path):
    def shaded(around):
        late = around.tick >= 500
        mag = around.recorded.mag_nt.copy()
        mag[late, 2] += 900.0
        return _with(around, lit=~late, recorded=_with(around.recorded, mag_nt=mag))

    value, sigma = drift(tmp_path, 0.0, shaded).eclipse_nt
    assert value[2] == pytest.approx(900.0, abs=5.0 * sigma[2] + 150.0)
    assert abs(value[0]) < 5.0 * sigma[0] + 150.0


def _with(value, **changes):
    from dataclasses import replace

    return replace(value, **changes)
