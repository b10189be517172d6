"""The plant's configuration from a scenario: all values, in SI."""

from math import pi, radians

import pytest
from scipy.spatial.transform import Rotation

from fsw.table.config import flight_config
from hil_stub.coils.interlock import CoilLimits
from sim.audit.limits import limits_in
from sim.plant.config import ContinuousConfig, DisturbanceConfig, PlateConfig
from sim.scenario.assemble import coil_limits, plant_config
from sim.scenario.schema import flight_table, load, parse_settings, shipped

SETTINGS = parse_settings(
    (
        "time.tick_hz=4",
        "time.epoch_utc=2025-03-20T09:00:00Z",
        "orbit.altitude_km=700",
        "orbit.inclination_deg=98.2",
        "orbit.raan_deg=10",
        "orbit.u0_deg=20",
        "orbit.along_track_km=-5.5",
        "field.model=igrf14",
        "field.degree=12",
        "body.inertia_kgm2=[[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]",
        "initial.axis=[2, -3, 6]",
        "initial.angle_deg=50",
        "initial.rate_degps=[0.1, -0.2, 0.3]",
        "coils.levels_am2=[0.4, 1.6, 6.4]",
        "coils.pulse_s=2.5",
        "coils.backoff_s=90",
        "coils.backoff=per_coil",
        "coils.dipole_per_ampere_am2=21",
        "coils.time_constant_s=0.02",
        "coils.dipole_scale=[0.9, 1.1, 1.2]",
        "coils.misalignment_deg=[[0.1, 0.2, 0.3], [-0.4, 0.5, 0.6], [0.7, -0.8, 0.9]]",
        "sensors.magnetometer.noise_nt=150",
        "sensors.magnetometer.bias_nt=[100, -200, 300]",
        "sensors.magnetometer.scale=[1.01, 0.99, 1.02]",
        "sensors.magnetometer.misalignment_deg=[0.1, 0.2, -0.3]",
        "sensors.magnetometer.non_orthogonality_deg=[0.4, -0.5, 0.6]",
        "sensors.magnetometer.quantum_nt=4",
        "sensors.magnetometer.saturation_nt=60000",
        "sensors.magnetometer.latency_s=0.3",
        "sensors.magnetometer.coil_field_nt_per_am2=[[1, 2, 3], [4, 5, 6], [7, 8, 9]]",
        "sensors.sun.noise_deg=0.4",
        "sensors.sun.misalignment_deg=[0.3, -0.1, 0.2]",
        "sensors.sun.quantum=0.001",
        "sensors.sun.latency_s=0.7",
        "sensors.sun.albedo=true",
        "sensors.sun.fov_half_deg=60",
        "sensors.sun.boresights=[[3, 0, -4], [0, 0.5, 0]]",
        "disturbance.torque_nm=[1e-8, -2e-8, 3e-8]",
        "disturbance.torque_daily_part=0.3",
        "disturbance.residual_dipole_am2=[0.01, -0.02, 0.03]",
        "disturbance.residual_dipole_eclipse_am2=[0.04, -0.05, 0.06]",
        "disturbance.remanence_part=0.02",
        "disturbance.eddy_nms_per_t2=30",
        "disturbance.torque_noise_nm_rts=2e-9",
        "disturbance.drag.density_scale=1.5",
        "disturbance.solar_pressure={}",
        "body.wheel_nms=[0.01, 0.02, -0.03]",
        "body.plates=[{area_m2=0.3, normal=[0, -2, 0], centre_m=[0.01, -0.2, 0.03]}, "
        "{area_m2=0.4, normal=[3, 0, 4], drag_coefficient=2.5, specular=0.3, diffuse=0.6}]",
        "plant.max_substep_s=0.5",
    )
)


@pytest.fixture(scope="module")
def plant():
    return plant_config(load("microsat", SETTINGS), seed=17)


def test_time_and_seed(plant):
    assert (plant.tick_hz, plant.epoch_unix_s, plant.seed, plant.max_substep_s) == (4, 1742461200, 17, 0.5)


def test_orbit_and_field(plant):
    orbit = plant.orbit
    assert orbit.tle is None
    assert orbit.altitude_m == 700e3
    assert (orbit.inclination_rad, orbit.raan_rad) == pytest.approx((radians(98.2), radians(10.0)))
    assert orbit.u0_rad == pytest.approx(radians(20.0))
    assert orbit.along_track_m == -5500.0
    assert (plant.field.model, plant.field.degree) == ("igrf14", 12)


def test_elements_are_passed_on():
    scenario = load("microsat", parse_settings(("orbit.along_track_km=3",)))
    orbit = plant_config(scenario, 1).orbit
    assert orbit.tle == scenario.orbit.tle
    assert orbit.along_track_m == 3000.0


def test_body_and_start(plant):
    assert plant.body.inertia_kgm2 == ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
    turn = Rotation.from_rotvec([radians(50.0) * c / 7.0 for c in (2.0, -3.0, 6.0)])
    assert plant.initial.q_body_from_orbit == pytest.approx(turn.as_quat(scalar_first=True), abs=1e-15)
    assert plant.initial.omega_body_orbit_radps == pytest.approx(tuple(map(radians, (0.1, -0.2, 0.3))))


def test_surface_and_wheel(plant):
    body = plant.body
    assert body.wheel_body_nms == (0.01, 0.02, -0.03)
    front, oblique = body.plates
    assert front == PlateConfig(0.3, (0.0, -1.0, 0.0), (0.01, -0.2, 0.03), 2.2, 0.0, 0.0)
    assert oblique.normal_body == pytest.approx((0.6, 0.0, 0.8))
    assert (oblique.area_m2, oblique.centre_body_m) == (0.4, (0.0, 0.0, 0.0))
    assert (oblique.drag_coefficient, oblique.specular, oblique.diffuse) == (2.5, 0.3, 0.6)


def test_coils_and_their_limits(plant):
    coils, limits = plant.coils, plant.limits
    assert coils.levels_am2 == (0.4, 1.6, 6.4)
    assert (coils.dipole_per_ampere_am2, coils.time_constant_s) == (21.0, 0.02)
    assert coils.dipole_scale == (0.9, 1.1, 1.2)
    assert coils.remanence_part == 0.02
    turns = ((0.1, 0.2, 0.3), (-0.4, 0.5, 0.6), (0.7, -0.8, 0.9))
    assert coils.misalignment_rad == tuple(tuple(map(radians, turn)) for turn in turns)
    assert (limits.tick_hz, limits.pulse_ms, limits.backoff_ms, limits.shared) == (4, 2500, 90000, False)


def test_magnetometer(plant):
    sensor = plant.magnetometer
    assert sensor.noise_t == pytest.approx(150e-9)
    assert sensor.bias_t == pytest.approx((100e-9, -200e-9, 300e-9))
    assert sensor.scale == (1.01, 0.99, 1.02)
    assert sensor.misalignment_rad == pytest.approx(tuple(map(radians, (0.1, 0.2, -0.3))))
    assert sensor.non_orthogonality_rad == pytest.approx(tuple(map(radians, (0.4, -0.5, 0.6))))
    assert sensor.latency_s == 0.3
    assert (sensor.quantum_t, sensor.saturation_t) == pytest.approx((4e-9, 60000e-9))
    for row, expected in zip(sensor.coil_coupling_t_per_am2, ((1, 2, 3), (4, 5, 6), (7, 8, 9)), strict=True):
        assert row == pytest.approx(tuple(1e-9 * c for c in expected))


def test_sun_sensor(plant):
    sensor = plant.sun_sensor
    assert sensor.noise_rad == pytest.approx(radians(0.4))
    assert sensor.misalignment_rad == pytest.approx(tuple(map(radians, (0.3, -0.1, 0.2))))
    assert sensor.quantum == 0.001
    assert sensor.albedo == 0.3
    assert (sensor.latency_s, sensor.fov_half_rad) == (0.7, pytest.approx(radians(60.0)))
    assert sensor.boresights_body == (pytest.approx((0.6, 0.0, -0.8)), (0.0, 1.0, 0.0))


def test_disturbances(plant):
    assert plant.disturbance.torque_body_nm == (1e-8, -2e-8, 3e-8)
    assert plant.disturbance.torque_daily_part == 0.3
    assert plant.disturbance.residual_dipole_eclipse_body_am2 == (0.04, -0.05, 0.06)
    assert plant.disturbance.residual_dipole_body_am2 == (0.01, -0.02, 0.03)
    assert (plant.disturbance.density_scale, plant.disturbance.solar_flux_wpm2) == (1.5, 1361.0)
    assert (plant.disturbance.eddy_nms_per_t2, plant.disturbance.torque_noise_nm_rts) == (30.0, 2e-9)


def test_what_a_scenario_does_not_speak_of_is_not_there():
    plain = plant_config(load("microsat"), 1)
    assert (plain.body.plates, plain.body.wheel_body_nms) == ((), (0.0, 0.0, 0.0))
    assert plain.disturbance == DisturbanceConfig((3e-8, 3e-8, 3e-8))
    assert plain.orbit.along_track_m == 0.0
    assert plain.coils.remanence_part == 0.0
    assert plain.coils.misalignment_rad == ((0.0, 0.0, 0.0),) * 3
    assert plain.magnetometer.non_orthogonality_rad == (0.0, 0.0, 0.0)
    assert (plain.magnetometer.latency_s, plain.sun_sensor.latency_s) == (0.0, 0.0)
    assert plain.sun_sensor.albedo == 0.0
    assert (plain.sun_sensor.fov_half_rad, plain.sun_sensor.boresights_body) == (pi, ())
    assert plain.coils.continuous is None


def test_the_continuous_driver():
    given = ("coils.driver=continuous", "coils.max_dipole_am2=12")
    coils = plant_config(load("microsat", parse_settings(given)), 1).coils
    assert coils.continuous == ContinuousConfig(12.0, 0.8)
    shorter = parse_settings((*given, "coils.on_fraction=0.5"))
    assert plant_config(load("microsat", shorter), 1).coils.continuous == ContinuousConfig(12.0, 0.5)
    pulsed = parse_settings(("coils.max_dipole_am2=12",))
    assert plant_config(load("microsat", pulsed), 1).coils.continuous is None


@pytest.mark.parametrize(("knowledge", "perfect"), [("filter", False), ("perfect", True)])
def test_perfect_knowledge_is_the_plant_s_to_give(knowledge, perfect):
    assert plant_config(load("microsat", {"knowledge": knowledge}), 1).perfect_knowledge is perfect


# --- One table of coils, from which scheduler, boards and auditor each take the same limits


@pytest.mark.parametrize("backoff", ["shared", "per_coil"])
def test_the_limits_of_the_board_are_those_of_the_table(backoff):
    scenario = load(
        "microsat",
        {"coils": {"pulse_s": 2.5, "backoff_s": 7.25, "backoff": backoff}, "time": {"tick_hz": 10}},
    )
    assert coil_limits(scenario.coils, scenario.time.tick_hz) == CoilLimits(
        tick_hz=10, pulse_ms=2500, backoff_ms=7250, shared=backoff == "shared"
    )


@pytest.mark.parametrize("scenario", shipped(), ids=lambda scenario: scenario.name)
def test_scheduler_board_and_auditor_agree(scenario):
    board = coil_limits(scenario.coils, scenario.time.tick_hz)
    pulses = flight_config(flight_table(scenario)).coils.pulses
    audited = limits_in(scenario.model_dump(mode="json"), scenario.name)
    assert pulses.shared == board.shared == audited.shared
    assert 1000 * pulses.duration_ms == 1000 * board.pulse_ms == audited.pulse_us
    assert 1000 * board.backoff_ms == audited.backoff_us
    assert pulses.backoff_ticks * 1000 >= board.backoff_ms * board.tick_hz
