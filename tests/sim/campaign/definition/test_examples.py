"""The campaign files in ``examples`` can be flown, and disperse what they say."""

from pathlib import Path

import numpy as np
import pytest

from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.population import POPULATIONS
from sim.scenario.schema import flight_table

FILES = sorted((Path(__file__).resolve().parents[4] / "examples" / "campaigns").glob("*.toml"))


@pytest.mark.long
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_its_runs_are_allowed_and_the_onboard_table_is_the_same_for_all(path):
    campaign = load_campaign(str(path), {}, {})
    scenarios = [campaign.scenario(campaign.draw(run)) for run in range(20)]
    assert len({scenario.body.inertia_kgm2 for scenario in scenarios}) == 20
    assert len({flight_table(scenario).crc for scenario in scenarios}) == 1


def test_the_microsat_has_twelve_dispersions():
    assert len(load_campaign(str(FILES[0]), {}, {}).disperse) == 12


@pytest.mark.long
def test_the_population_keeps_its_tolerances():
    campaign = load_campaign(str(FILES[1]), {}, {})
    bounds = POPULATIONS["50kg"].tolerances
    for run in range(30):
        scenario = campaign.scenario(campaign.draw(run))
        inertia = np.array(scenario.body.inertia)
        sensors, coils = scenario.sensors, scenario.coils
        assert inertia == pytest.approx(inertia.T)
        moments = np.diagonal(inertia) / [1.02, 1.85, 1.95]
        assert moments == pytest.approx(1.0, abs=0.01 * bounds.inertia_percent)
        dipole_am2 = np.linalg.norm(scenario.disturbance.residual_dipole_am2)
        assert bounds.residual_dipole_am2[0] <= dipole_am2 <= bounds.residual_dipole_am2[1]
        peak_nm = np.abs(scenario.disturbance.torque_nm) * (1.0 + scenario.disturbance.torque_daily_part)
        assert peak_nm.max() <= bounds.torque_nm
        assert np.array(coils.dipole_scale) == pytest.approx(1.0, abs=0.01 * bounds.coil_gain_percent)
        assert np.linalg.norm(coils.misalignment_deg, axis=1).max() <= bounds.coil_misalignment_deg
        assert np.abs(sensors.magnetometer.bias_nt).max() <= bounds.magnetometer_bias_nt
        assert np.linalg.norm(sensors.sun.misalignment_deg) <= bounds.sun_misalignment_deg
        assert sensors.magnetometer.latency_s == sensors.sun.latency_s == bounds.latency_s
        assert scenario.disturbance.remanence_part <= 0.01 * bounds.remanence_percent
        assert scenario.field.storm_nt <= bounds.storm_nt
        assert sensors.sun.albedo <= 0.01 * bounds.albedo_percent
    stated = flight_table(scenario).uncertainty.model_dump()
    declared = {key: value for key, value in bounds.declared().items() if value is not None}
    assert {key: stated[key] for key in declared} == declared
    ordinary = {"shadow_dipole_am2": 0.007, "shadow_impulse_nms": pytest.approx(1.6e-4, rel=0.01)}
    assert {
        key: value for key, value in stated.items() if key not in declared and value is not None
    } == ordinary
