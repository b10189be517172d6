"""Sections that only the plant uses: what they refuse, in one sentence with the key."""

import pytest

from fsw.input.schema import TableError
from sim.scenario.schema import flight_table, load, parse_settings

PLATE = "body.plates=[{area_m2=0.3, normal=[0, -1, 0]}]"
CONTINUOUS = ("coils.driver=continuous", "coils.max_dipole_am2=12")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (["disturbance.drag={}"], ["disturbance.drag needs body.plates"]),
        (["disturbance.solar_pressure={}"], ["disturbance.solar_pressure needs body.plates"]),
        (
            [PLATE, "disturbance.drag.density_scale=-1"],
            ["disturbance.drag.density_scale", "a number at least 0"],
        ),
        ([PLATE, "disturbance.drag.scale=1"], ["disturbance.drag.scale is not a known key"]),
        ([PLATE, "disturbance.solar_pressure.flux_wpm2=-1"], ["flux_wpm2", "a number at least 0"]),
        (["disturbance.eddy_nms_per_t2=-1"], ["eddy_nms_per_t2", "at least 0"]),
        (["disturbance.torque_noise_nm_rts=-1e-9"], ["torque_noise_nm_rts", "at least 0"]),
        (["orbit.along_track_km=20001"], ["orbit.along_track_km", "at most 20000"]),
        (["orbit.along_track_km=far"], ["orbit.along_track_km = 'far' is not allowed"]),
        (["flight.orbit.along_track_km=5"], ["[flight]: orbit.along_track_km is not a known key"]),
        (["coils.misalignment_deg=[1, 2, 3]"], ["coils.misalignment_deg.0"]),
        (["coils.misalignment_deg=[[1, 2, 3], [1, 2, 3]]"], ["coils.misalignment_deg.2 is missing"]),
        (["coils.misalignment_deg=[[1, 2, 3], [1, 2, 3], [1, 2, nan]]"], ["coils.misalignment_deg.2.2"]),
        (
            ["sensors.magnetometer.non_orthogonality_deg=[0, 0, -10.1]"],
            ["sensors.magnetometer.non_orthogonality_deg.2", "-10.1 is not allowed", "a number at least -10"],
        ),
        (["disturbance.remanence_part=1.5"], ["disturbance.remanence_part", "at most 1"]),
        (["disturbance.residual_dipole_eclipse_am2=[0, 1]"], ["residual_dipole_eclipse_am2.2 is missing"]),
        (["sensors.sun.albedo=1.3"], ["sensors.sun.albedo = 1.3 is not allowed"]),
        (["disturbance.torque_daily_part=1.1"], ["disturbance.torque_daily_part", "at most 1"]),
        (["disturbance.torque_daily_part=-0.1"], ["disturbance.torque_daily_part", "at least 0"]),
        (["body.plates=[{area_m2=0, normal=[0, 0, 1]}]"], ["body.plates.0.area_m2"]),
        (["body.plates=[{area_m2=1, normal=[0, 0, 0]}]"], ["body.plates.0: normal must not be zero"]),
        (["body.plates=[{normal=[0, 0, 1]}]"], ["body.plates.0.area_m2 is missing"]),
        (
            ["body.plates=[{area_m2=1, normal=[0, 0, 1], specular=0.6, diffuse=0.5}]"],
            ["body.plates.0", "specular and diffuse together"],
        ),
        (["body.plates=[{area_m2=1, normal=[0, 0, 1], specular=1.1}]"], ["body.plates.0.specular"]),
        (["sensors.magnetometer.latency_s=-0.1"], ["sensors.magnetometer.latency_s", "at least 0"]),
        (
            ["sensors.cells={normals=[[1, 0, 0]], quantum_percent=-1}"],
            ["cells.quantum_percent", "a number at least 0"],
        ),
        (["flight.estimator.sun_quantum=-1"], ["[flight]: estimator.sun_quantum = -1", "at least 0"]),
        (["sensors.sun.quantum=1.5"], ["sensors.sun.quantum = 1.5", "at most 1"]),
        (["sensors.magnetometer.quantum_nt=2e5"], ["sensors.magnetometer.quantum_nt", "100000"]),
        (
            ["sensors.cells={normals=[[1, 0, 0]], quantum_percent=101}"],
            ["cells.quantum_percent", "a number at most 100"],
        ),
        (["sensors.sun.latency_s=61"], ["sensors.sun.latency_s", "at most 60"]),
        (["sensors.sun.fov_half_deg=60"], ["sensors.sun", "both fov_half_deg and boresights"]),
        (["sensors.sun.boresights=[[1, 0, 0]]"], ["sensors.sun", "both fov_half_deg and boresights"]),
        (
            ["sensors.sun.fov_half_deg=60", "sensors.sun.boresights=[[0, 0, 0]]"],
            ["sensors.sun", "boresights must not be zero"],
        ),
        (["coils.driver=continuous"], ["max_dipole_am2"]),
        (
            [*CONTINUOUS, "time.tick_hz=10"],
            ["coils.on_fraction = 0.8 leaves the coils 20 ms", "takes 50 ms", "time.tick_hz"],
        ),
        ([*CONTINUOUS, "coils.on_fraction=1.0"], ["coils.on_fraction = 1 leaves the coils 0 ms"]),
    ],
)
def test_errors_are_reported_in_one_sentence(settings, words):
    with pytest.raises(TableError) as caught:
        load("microsat", parse_settings(tuple(settings)))
    sentence = str(caught.value)
    assert "\n" not in sentence
    for word in words:
        assert word in sentence


@pytest.mark.parametrize(
    "settings",
    [
        [*CONTINUOUS, "time.tick_hz=10", "coils.on_fraction=0.5"],
        [*CONTINUOUS, "time.tick_hz=10", "knowledge=perfect"],
        ["time.tick_hz=10", "coils.on_fraction=1.0"],
        [PLATE],
        ["sensors.sun.fov_half_deg=180", "sensors.sun.boresights=[[0, 0, 2]]"],
    ],
)
def test_what_is_allowed(settings):
    assert load("microsat", parse_settings(tuple(settings)))


def test_the_controller_does_not_know_of_it():
    known = load("microsat")
    settings = (
        PLATE,
        "disturbance.drag={}",
        "disturbance.torque_noise_nm_rts=1e-9",
        "sensors.magnetometer.latency_s=0.4",
    )
    assert flight_table(load("microsat", parse_settings(settings))) == flight_table(known)
