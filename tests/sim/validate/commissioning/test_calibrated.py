"""The claims on calibration: every satellite counts, in what was found and in how it points by it."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace

import numpy as np
import pytest

from fsw.input.schema import merge
from sim.campaign.claim import ClaimVerdict
from sim.campaign.consistency import consistency_figures
from sim.campaign.flight import Order, fly_order
from sim.errors import HarnessError
from sim.plant.hardware.sensors import MagnetometerPhysics
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load
from sim.validate.commissioning import calibrated
from sim.validate.commissioning.calibrated import (
    POINTED,
    VALUES,
    Flown,
    TrueCalibration,
    conclude,
    errors,
    true_calibration,
)
from sim.validate.commissioning.wirings import SCENARIO, satellite

GOOD = [Flown(number, (0.5, -2.9, 1.1, -0.3), 0.61, 0.58) for number in range(1, 31)]


def verdicts(flights):
    inside, pointing = conclude(flights)
    return inside.verdict, pointing.verdict


def test_satellites_that_are_found_right_and_point_by_it_pass():
    assert verdicts(GOOD) == (ClaimVerdict.PASS, ClaimVerdict.PASS)


@pytest.mark.parametrize("found_deg", [0.70, 20.0, nan])
def test_one_satellite_that_points_worse_by_more_than_a_tenth_fails(found_deg):
    flights = [*GOOD[:-1], GOOD[-1]._replace(found_deg=found_deg)]
    assert verdicts(flights) == (ClaimVerdict.PASS, ClaimVerdict.FAIL)
    assert "satellite 30; median 1.052" in conclude(flights)[1].where or np.isnan(found_deg)


def test_more_than_one_value_of_twenty_beyond_3_sigma_fails():
    off = [one._replace(off=(0.5, -3.1, 1.1, -0.3)) for one in GOOD]
    assert verdicts([*off[:7], *GOOD[7:]])[0] is ClaimVerdict.FAIL
    assert verdicts([*off[:5], *GOOD[5:]])[0] is ClaimVerdict.PASS


def test_a_value_whose_error_is_no_number_fails():
    assert verdicts([*GOOD[:-1], GOOD[-1]._replace(off=(0.5, nan, 1.1, -0.3))])[0] is ClaimVerdict.FAIL


class TestUntold:
    """A satellite whose log does not tell its calibration fails the claims, and the reason is told."""

    WHY = "the log cannot tell the magnetometer: 2 wirings explain it alike"

    def found(self, delay_ticks, delay_sigma):
        response = SimpleNamespace(delay_ticks=delay_ticks, delay_sigma=delay_sigma)
        field = SimpleNamespace(covariance=np.eye(12), matrix=np.eye(3), offset_nt=np.zeros(3))
        coils = {"field_nt_per_am2": np.zeros((3, 3)), "field_sigma": np.ones((3, 3))}
        return SimpleNamespace(field=field, response=response, **coils)

    TRUE = TrueCalibration(np.eye(3), np.zeros(3), np.zeros((3, 3)), 1.0)

    def test_every_value_has_an_error(self):
        off = errors(self.found(3.0, 0.5), self.TRUE, 1.0)
        assert len(off) == VALUES
        assert off[-1] == pytest.approx(4.0)

    @pytest.mark.parametrize(("delay_ticks", "delay_sigma"), [(None, 0.5), (3.0, None)])
    def test_a_delay_that_is_not_found_is_told(self, delay_ticks, delay_sigma):
        with pytest.raises(HarnessError, match="does not tell the delay"):
            errors(self.found(delay_ticks, delay_sigma), self.TRUE, 1.0)

    def test_a_log_that_tells_too_little_is_a_result(self, monkeypatch):
        def untold(samples, table):
            raise HarnessError(self.WHY)

        monkeypatch.setattr(calibrated, "_fly", lambda folder, *flight: folder)
        monkeypatch.setattr(calibrated, "read_samples", lambda log, tick_hz: None)
        monkeypatch.setattr(calibrated, "calibrated", untold)
        found = calibrated.flown(8)
        assert (found.number, found.reason) == (8, self.WHY)
        assert np.isnan([*found.off, found.found_deg, found.perfect_deg]).all()

    def test_it_fails_both_claims(self):
        lost = Flown(30, (nan,) * VALUES, nan, nan, self.WHY)
        assert verdicts([*GOOD[:-1], lost]) == (ClaimVerdict.FAIL, ClaimVerdict.FAIL)
        assert {one.where for one in conclude([*GOOD[:-1], lost])} == {f"satellite 30: {self.WHY}"}


def test_the_true_calibration_undoes_what_the_sensor_does():
    scenario = load(SCENARIO, satellite(17))
    true, config = true_calibration(scenario), plant_config(scenario, 1).magnetometer
    assert np.abs(true.offset_nt).max() > 3000.0
    assert np.abs(true.matrix - np.eye(3)).max() > 0.01
    field_t, dipole_am2 = np.array([21e-6, -13e-6, 34e-6]), np.array([0.3, -0.2, 0.1])
    sensor = MagnetometerPhysics(
        replace(config, noise_t=0.0, quantum_t=0.0, saturation_t=1.0, latency_s=0.0), 1
    )
    channels_nt = 1e9 * np.array(sensor.measure(tuple(field_t), tuple(dipole_am2))[0])
    coils_nt = true.field_nt_per_am2 @ dipole_am2
    assert true.matrix @ (channels_nt - true.offset_nt) - coils_nt == pytest.approx(1e9 * field_t, abs=1.0)
    assert true.delay_s == scenario.sensors.magnetometer.latency_s


@pytest.mark.long
@pytest.mark.parametrize(("range_nt", "known"), [(65000.0, True), (65534.0, False)])
@pytest.mark.slow
def test_a_magnetometer_at_the_end_of_its_range_serves_by_its_other_axes(range_nt, known):
    """Offset and field of satellite 8 exceed its range for a fifth of the orbit, part of it in shadow."""
    scenario = load(SCENARIO, satellite(8))
    true = true_calibration(scenario)
    magnetometer = {
        "offset_nt": true.offset_nt.tolist(),
        "matrix": true.matrix.tolist(),
        "range_nt": range_nt,
    }
    coils = {"field_nt_per_am2": true.field_nt_per_am2.tolist(), "field_delay_s": true.delay_s}
    uncertainty = {
        "latency_s": 1.0,
        "magnetometer_bias_nt": 100.0,
        "magnetometer_scale_percent": 0.15,
        "magnetometer_misalignment_deg": 0.07,
    }
    flight = {"calibration": {"magnetometer": magnetometer, "coils": coils}, "uncertainty": uncertainty}
    overrides = merge(merge(satellite(8), POINTED), {"flight": flight})
    flown = fly_order(Order(SCENARIO, overrides, 8, 2.0, consistency_figures))
    assert (flown.summary["isolated"] == []) is known
    if known:
        assert min(flown.figures[f"inside_{axis}"] for axis in (1, 2, 3)) > 0.95
        assert flown.summary["pointing_deg"]["rms_last_orbit"] < 1.0
