"""How far a satellite is off its onboard table, by the keys that say so."""

import pytest

from fsw.table.estimator import table_bounds
from sim.scenario.schema import flight_table, load, parse_settings
from sim.sizing.deviations import deviations


def found(*settings, name="microsat"):
    scenario = load(name, parse_settings(settings))
    return deviations(scenario, table_bounds(flight_table(scenario)))


EACH = {
    "flight.body.inertia_kgm2=[1.02,1.85,2.6]": ("inertia_percent", 25.0),
    "flight.body.inertia_kgm2=[[1.02,0,0],[0,1.85,-0.16],[0,-0.16,1.95]]": ("products_percent", 9.96),
    "disturbance.torque_nm=[3e-6,-7e-6,0]": ("torque_nm", 7e-6),
    "disturbance.residual_dipole_am2=[0,0,-0.3]": ("residual_dipole_am2", 0.3),
    "disturbance.residual_dipole_eclipse_am2=[0,0.2,0]": ("shadow_dipole_am2", 0.2),
    "disturbance.remanence_part=0.004": ("remanence_percent", 0.4),
    "orbit.along_track_km=-8": ("along_track_km", 8.0),
    "coils.dipole_scale=[1,0.85,1]": ("coil_gain_percent", 15.0),
    "coils.misalignment_deg=[[0,3,0],[0,0,0],[0,0,0]]": ("coil_misalignment_deg", 3.0),
    "sensors.magnetometer.bias_nt=[0,-5000,10]": ("magnetometer_bias_nt", 5e3),
    "sensors.magnetometer.orbit_bias_nt=[700,0,0]": ("magnetometer_orbit_nt", 700.0),
    "sensors.magnetometer.shadow_bias_nt=[0,0,900]": ("magnetometer_shadow_nt", 900.0),
    "sensors.magnetometer.scale=[1,1,0.98]": ("magnetometer_scale_percent", 2.0),
    "sensors.magnetometer.misalignment_deg=[0,1.5,0]": ("magnetometer_misalignment_deg", 1.5),
    "sensors.magnetometer.latency_s=0.7": ("latency_s", 0.7),
    "sensors.sun.misalignment_deg=[0,0,-2]": ("sun_misalignment_deg", 2.0),
    "sensors.sun.albedo=true": ("albedo_percent", 30.0),
    "sensors.sun.latency_s=0.9": ("latency_s", 0.9),
}


@pytest.mark.parametrize("setting", EACH)
def test_a_key_that_is_changed_is_off_and_no_other(setting):
    of_table, worst = EACH[setting]
    usual = [one.worst for one in found()]
    changed = [one for one, was in zip(found(setting), usual, strict=True) if one.worst != pytest.approx(was)]
    (one,) = [one for one in changed if one.worst > one.slight]
    assert (one.key, one.of_table) == (setting.split("=")[0].removeprefix("flight."), of_table)
    assert one.worst == pytest.approx(worst, rel=0.01)
    assert one.worst > one.bound
    assert f"flight.uncertainty.{of_table} = " in one.words


def test_a_bound_that_is_declared_stands_beside_its_deviation():
    declared = ("flight.uncertainty.sun_misalignment_deg=2.5", "sensors.sun.misalignment_deg=[0,0,-2]")
    (one,) = [one for one in found(*declared) if one.key == "sensors.sun.misalignment_deg"]
    assert (one.bound, one.worst) == (pytest.approx(2.5), pytest.approx(2.0))


def test_of_sun_cells():
    of_cells = [one for one in found(name="cubesat-cells") if one.key.startswith("sensors.cells.")]
    assert [one.of_table for one in of_cells] == ["cell_gain_percent", "cell_light_percent", "latency_s"]
    assert not [one for one in found(name="cubesat-cells") if one.key.startswith("sensors.sun.")]
