"""What is allowed and most likely wrong."""

import pytest

from sim.flight.record_flight import ticks_of
from sim.scenario.schema import load, parse_settings, shipped
from sim.sizing.scenario_warnings import scenario_warnings


def found(name, *settings):
    return scenario_warnings(load(name, parse_settings(settings)))


@pytest.mark.parametrize("scenario", shipped(), ids=lambda scenario: scenario.name)
def test_no_scenario_that_ships_is_doubted(scenario):
    assert scenario_warnings(scenario) == []


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("body.inertia_kgm2=[6.7,33,33.5]", ["body.inertia_kgm2 is too large", "g m^2"]),
        ("body.inertia_kgm2=[6.7e-6,33e-6,33.5e-6]", ["body.inertia_kgm2 is too small", "kg m^2"]),
        (
            "coils.levels_am2=[3,12,48] coils.dipole_per_ampere_am2=50",
            ["too small for coils.levels_am2", "mA m^2"],
        ),
        (
            "disturbance.torque_nm=[1e-7,0,0]",
            ["balancing the disturbance of 1e-07 N m takes 4", "A m^2 would do"],
        ),
        ("orbit.inclination_deg=0", ["orbit.inclination_deg = 0", "over the equator"]),
        ("orbit.inclination_deg=1.7", ["orbit.inclination_deg = 1.7", "is it in deg, not in rad?"]),
        (
            "body.inertia_kgm2=[6700,33000,33500] coils.levels_am2=[3,12,48] coils.dipole_per_ampere_am2=50",
            ["body.inertia_kgm2 asks for coils of", "A m^2", "is it in kg m^2?"],
        ),
        ("coils.backoff_s=100.5", ["coils.backoff_s = 100.5", "ticks of 1 s", "longer"]),
        ("coils.pulse_s=2.5", ["coils.pulse_s = 2.5", "ticks of 1 s", "shorter"]),
        (
            "sensors.magnetometer.noise_nt=0.2",
            ["sensors.magnetometer.noise_nt = 0.2", "better", "is it in nT?"],
        ),
        ("sensors.magnetometer.noise_nt=9e3", ["noisier"]),
        ("sensors.sun.noise_deg=30", ["sensors.sun.noise_deg = 30", "noisier", "is it in deg?"]),
        ("sensors.magnetometer.saturation_nt=30000", ["saturation_nt = 30000", "field over the poles"]),
        (
            "sensors.sun.fov_half_deg=1.05 sensors.sun.boresights=[[1,0,0]]",
            ["sensors.sun.fov_half_deg = 1.05 is a narrow view", "in deg, not in rad?"],
        ),
        (
            "body.plates=[{area_m2=0.01,normal=[1,0,0]},{area_m2=10000,normal=[0,1,0]}]",
            ["body.plates: plate 1 has area_m2 = 10000", "is it in m^2?"],
        ),
        (
            "body.plates=[{area_m2=0.01,normal=[1,0,0],centre_m=[50,0,10]}]",
            ["body.plates: plate 0 has centre_m = 50.9", "is it in m?"],
        ),
        ("initial.rate_degps=[60,0,0]", ["initial.rate_degps is 60 deg/s"]),
        ("control.leak_s=30", ["control.leak_s = 30", "103 s"]),
        ("disturbance.residual_dipole_am2=[0.0001,0,0]", ["residual_dipole_am2 is off by 0.0001", "= 0"]),
        ("disturbance.residual_dipole_am2=[0.002,0,0]", ["residual_dipole_am2 is off by 0.002", "= 0"]),
        ("sensors.magnetometer.bias_nt=[0,5000,0]", ["bias_nt is off by 5e+03", "= 500"]),
        (
            "coils.dipole_scale=[1,1.2,1]",
            ["coils.dipole_scale is off by 20 %, and flight.uncertainty.coil_gain_percent = "],
        ),
        ("orbit.along_track_km=8", ["orbit.along_track_km is off by 8", "along_track_km = 0"]),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_mistake_is_named_with_key_and_figure(setting, words):
    told = found("cubesat3u", *setting.split())
    assert any(all(word in doubt for word in words) for doubt in told), told


def test_currents_that_no_coil_takes():
    """Of a continuous driver; those of pulses must fit into their report."""
    continuous = ("coils.driver=continuous", "coils.max_dipole_am2=0.1")
    told = found("cubesat3u", *continuous, "coils.dipole_per_ampere_am2=0.0005")
    assert any("coils.dipole_per_ampere_am2 = 0.0005 makes" in doubt and "mA" in doubt for doubt in told), (
        told
    )


def test_a_magnetometer_beyond_its_range_by_its_offset():
    offset, known = (
        "sensors.magnetometer.bias_nt=[0,30000,0]",
        "flight.calibration.magnetometer.offset_nt=[0,30000,0]",
    )
    (doubt,) = found("microsat", offset, known)
    assert "saturation_nt = 65000 is less than 72" in doubt
    _, other = found("microsat", offset, known, "sensors.magnetometer.saturation_nt=64000")
    assert "range_nt = 65000 is not the sensor's, sensors.magnetometer.saturation_nt = 64000" in other
    (mistaken,) = found("microsat", "flight.calibration.magnetometer.range_nt=50000")
    assert "range_nt = 50000 is not the sensor's" in mistaken
    near = "sensors.magnetometer.bias_nt=[0,3000,0]", "flight.calibration.magnetometer.offset_nt=[0,3000,0]"
    assert found("microsat", *near) == []


def test_a_tle_of_another_year():
    (doubt,) = found("microsat", "time.epoch_utc=2025-04-01T00:00:00Z")
    assert "orbit.tle is of 2015-03-27 and the flight begins on 2025-04-01, 10.0 years later" in doubt
    (doubt,) = found("microsat", "time.epoch_utc=2013-03-27T03:00:00Z", "field.model=tilted_dipole")
    assert "2.0 years earlier" in doubt
    assert found("microsat", "time.epoch_utc=2015-05-01T00:00:00Z") == []


def test_an_inclination_that_was_left_out():
    values = load("cubesat3u").model_dump(exclude_unset=True)
    del values["orbit"]["inclination_deg"]
    from sim.scenario.schema import scenario_of

    (doubt,) = scenario_warnings(scenario_of(values, "mine"))
    assert "where the key is left out it is 0" in doubt


@pytest.mark.parametrize(
    "settings",
    [
        ("knowledge=perfect", "sensors.sun.noise_deg=30"),
        ("sensors.magnetometer.noise_nt=0", "sensors.sun.noise_deg=0"),
        ("coils.driver=continuous", "coils.max_dipole_am2=0.1", "coils.backoff_s=100.5"),
    ],
)
def test_what_does_not_matter_is_not_doubted(settings):
    assert found("cubesat3u", *settings) == []


@pytest.mark.parametrize(("bound_nm", "doubted"), [(6e-9, True), (2.4e-8, True), (5e-8, False)])
def test_drag_and_light_need_a_bound_by_which_the_filter_follows_them(bound_nm, doubted):
    """They reach 1.04e-8 N m on the 6U in its nominal attitude."""
    told = found("cubesat6u", f"flight.uncertainty.torque_nm={bound_nm}")
    assert bool(told) is doubted, told
    assert all("reach 1e-08 N m on body.plates" in doubt and "5.2e-08" in doubt for doubt in told)


def test_drag_that_is_of_no_consequence_needs_no_bound():
    """A hundredth of the density, and no light, on a satellite that declares no torque at all."""
    thin = ("disturbance.drag.density_scale=0.01", "disturbance.solar_pressure.flux_wpm2=1")
    exact = ("flight.uncertainty.torque_nm=0", "disturbance.torque_nm=[0,0,0]")
    assert found("cubesat6u", *thin, *exact) == []
    assert found("cubesat6u", *exact) != []


def telecommand(**content):
    return {"telecommand": [{"at_s": 50.0, "message": "TC_CLEAR"}, {"at_s": 600.0, **content}]}


@pytest.mark.parametrize(
    ("content", "answer"),
    [
        ({"message": "TC_LAW", "law": "two_coils"}, "'unknown': the satellite has no such law"),
        ({"message": "TC_LAW", "law": "own"}, "'unknown': the satellite has no such law"),
        ({"message": "TC_GAIN", "gain": "k_w", "value": -3.0}, "'out_of_range': the value"),
        (
            {"message": "TC_PARAMETER", "component": "cell_1", "value": 0.1},
            "'not_allowed': its filter does not estimate",
        ),
        ({"message": "TC_PARAMETER", "component": "mag_bias_x", "value": 0.1}, "'out_of_range': the value"),
    ],
    ids=lambda value: value["message"] if isinstance(value, dict) else "",
)
def test_a_telecommand_that_will_be_refused(content, answer):
    (doubt,) = scenario_warnings(load("microsat", telecommand(**content)))
    assert doubt.startswith(f"telecommand[1], {content['message']} at 600 s, will be answered {answer}")


@pytest.mark.parametrize(
    "content",
    [
        {"message": "TC_LAW", "law": "pd"},
        {"message": "TC_GAIN", "gain": "k_a", "value": 30.0},
        {"message": "TC_MODE", "mode": "POINT"},
        {"message": "TC_PARAMETER", "component": "mag_bias_x", "value": 1e-7},
    ],
    ids=lambda content: content["message"],
)
def test_one_that_may_be_carried_out_is_not_doubted(content):
    assert scenario_warnings(load("microsat", telecommand(**content))) == []


def with_telecommands(*times_s):
    sent = [{"at_s": at_s, "message": "TC_CLEAR"} for at_s in times_s]
    return load("microsat", {"telecommand": sent})


def test_a_scenario_that_is_shorter_than_its_telecommands_is_doubted():
    ticks = ticks_of(with_telecommands(), None)
    assert scenario_warnings(with_telecommands(ticks - 1.0)) == []
    (doubt,) = scenario_warnings(with_telecommands(float(ticks)))
    assert "will not be sent" in doubt


def test_what_counts_is_how_long_the_run_is():
    asked = with_telecommands(600.0)
    assert scenario_warnings(asked, 601) == []
    (doubt,) = scenario_warnings(asked, 600)
    assert "at 600 s, will not be sent: the last tick is at 599 s" in doubt
    late = with_telecommands(float(ticks_of(asked, None)))
    assert scenario_warnings(late, 2 * ticks_of(asked, None)) == []


def test_a_flight_shorter_than_the_orbit_for_which_the_field_holds_is_not_refused():
    late = load("cubesat6u", {"time": {"epoch_utc": "2029-12-31T23:00:00Z", "orbits": 0.1}})
    assert not [doubt for doubt in scenario_warnings(late) if "balancing" in doubt]
