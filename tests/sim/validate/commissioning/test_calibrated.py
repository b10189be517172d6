"""The claims on calibration: every satellite counts, in what was found and in how it points by it."""

from dataclasses import replace
from math import nan

import numpy as np
import pytest

from sim.campaign.claim import ClaimVerdict
from sim.plant.hardware.sensors import MagnetometerPhysics
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load
from sim.validate.commissioning.calibrated import Flown, conclude, true_calibration
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
