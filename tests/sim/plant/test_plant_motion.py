"""The motion of the plant: as configured, by its torques, conserved where nothing disturbs it."""

from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pytest
from plant_flights import fire, fly

from sim.plant.config import BodyConfig, DisturbanceConfig, FieldConfig, InitialConfig, OrbitConfig
from sim.plant.dynamics import torques
from sim.plant.errors import PlantError
from sim.plant.rotation import matrix
from sim.plant.wheel_config import WheelConfig

DAY = 86400
CIRCLE = OrbitConfig(None, 800e3, 1.72, 0.6, 0.35)


def test_it_starts_as_configured(make_plant, make_config):
    initial = make_config().initial
    truth = make_plant().truth()
    assert truth.q_body_from_orbit == pytest.approx(initial.q_body_from_orbit, abs=1e-14)
    assert truth.omega_body_orbit_radps == pytest.approx(initial.omega_body_orbit_radps, abs=1e-16)


def test_attitude_is_given_with_its_scalar_part_not_negative(make_plant):
    q = tuple(-part for part in make_plant().truth().q_body_from_orbit)
    history = fly(make_plant(initial=InitialConfig(q, (0.03, 0.05, -0.04))), 300)
    scalars = np.array([truth.q_body_from_orbit[0] for _, truth in history])
    assert scalars.min() >= 0.0
    assert scalars.min() < 0.05  # it went all the way round


def test_field_and_sun_turn_with_the_body(make_plant):
    """Seen from the orbital frame they hardly move in a tick, whatever the body does."""
    tumbling = InitialConfig((0.5, -0.5, 0.5, 0.5), (0.02, -0.03, 0.04))
    rows = [truth for _, truth in fly(make_plant(initial=tumbling), 100)]
    for name, most in (("b_body_t", 2e-7), ("sun_body", 2e-3)):
        in_orbit = np.array([np.array(matrix(row.q_body_from_orbit)).T @ getattr(row, name) for row in rows])
        assert np.linalg.norm(np.diff(in_orbit, axis=0), axis=1).max() < most


def test_attitude_follows_the_rate(make_plant):
    rows = [truth for _, truth in fly(make_plant(orbit=CIRCLE), 200)]
    for before, after in pairwise(rows):
        q, p = np.array(before.q_body_from_orbit), np.array(after.q_body_from_orbit)
        w = 0.5 * (np.array(before.omega_body_orbit_radps) + after.omega_body_orbit_radps)
        vector = q[0] * p[1:] - p[0] * q[1:] - np.cross(q[1:], p[1:])
        assert 2.0 * vector == pytest.approx(w, abs=2e-8)


def test_torques_by_source_are_those_that_turn_the_body(make_plant, make_config):
    """J dw/dt = T - w x J w, with the inertial rate w and its change over a tick."""
    inertia = np.array(make_config().body.inertia_kgm2)
    plant, rows, omega = make_plant(tick_hz=10, backoff_ms=0), [], []
    for tick in range(40):
        plant.begin_tick()
        rows.append(plant.truth())
        omega.append(plant.motion.omega_body_radps)
        if tick == 5:
            fire(plant, coil=0, level=3)
        plant.end_tick()
    for k in range(10, 30):
        w = np.array(omega[k])
        change = (np.array(omega[k + 1]) - omega[k - 1]) / 0.2
        torque = np.sum(rows[k].torque_body_nm, axis=0)
        assert inertia @ change + np.cross(w, inertia @ w) == pytest.approx(torque, rel=1e-5, abs=1e-10)


def test_each_source_speaks_for_itself(make_plant, make_config):
    row = fly(make_plant(), 8, {5: fire})[7][1]
    by_source = dict(zip(torques.SOURCES, row.torque_body_nm, strict=True))
    disturbance = make_config().disturbance
    assert by_source["bias"] == disturbance.torque_body_nm
    residual = np.cross(disturbance.residual_dipole_body_am2, row.b_body_t)
    assert by_source["residual_dipole"] == pytest.approx(residual)
    assert by_source["coils"] == pytest.approx(np.cross(row.m_body_am2, row.b_body_t))
    assert np.linalg.norm(by_source["coils"]) > 1e-5
    e1 = np.array(matrix(row.q_body_from_orbit))[:, 0]
    gradient = 3 * 3.986004418e14 / np.linalg.norm(row.r_eci_m) ** 3
    inertia = np.array(make_config().body.inertia_kgm2)
    assert by_source["gravity_gradient"] == pytest.approx(gradient * np.cross(e1, inertia @ e1))


@pytest.mark.long
def test_the_jacobi_integral_is_conserved(make_plant, make_config):
    """1/2 W J W + 3/2 w0^2 e1 J e1 - 1/2 w0^2 e3 J e3, uncontrolled on a circle, over three orbits."""
    inertia = np.array(make_config().body.inertia_kgm2)
    plant = make_plant(orbit=CIRCLE, disturbance=DisturbanceConfig())
    a = 6378137.0 + 800e3
    rate = sqrt(3.986004418e14 / a**3)
    parts = []
    for tick in range(int(3 * 2.0 * pi / rate)):
        if tick % 60 == 0:
            row = plant.truth()
            c = np.array(matrix(row.q_body_from_orbit))
            w, e1, e3 = np.array(row.omega_body_orbit_radps), c[:, 0], c[:, 2]
            potential = rate**2 * (1.5 * e1 @ inertia @ e1 - 0.5 * e3 @ inertia @ e3)
            parts.append((0.5 * w @ inertia @ w, potential))
        plant.begin_tick()
        plant.end_tick()
    total = np.sum(parts, axis=1)
    assert np.abs(total / total[0] - 1.0).max() < 1e-11
    assert np.ptp(parts, axis=0).min() > 0.1 * total[0]  # they trade all the while


def test_shorter_substeps_hardly_move_the_motion(make_plant, rotation_angle):
    commands = {
        5: lambda plant: fire(plant, coil=0, level=3),
        40: lambda plant: fire(plant, coil=2, level=-3, seq=2),
    }
    whole = fly(make_plant(), 300, commands)[-1][1]
    fine = fly(make_plant(max_substep_s=0.05), 300, commands)[-1][1]
    assert rotation_angle(whole.q_body_from_orbit, fine.q_body_from_orbit) < 1e-5
    assert whole.r_eci_m == pytest.approx(fine.r_eci_m, abs=1e-4)


def test_a_fast_tumble_keeps_energy_and_momentum(make_plant, make_config):
    """200 deg/s about no principal axis for 100 s, at one tick a second."""
    inertia = np.array(make_config().body.inertia_kgm2)
    fast = InitialConfig(omega_body_orbit_radps=(2.1, 2.2, 1.7))
    plant = make_plant(orbit=CIRCLE, disturbance=DisturbanceConfig(), initial=fast)
    energy, momentum = [], []
    for _ in range(100):
        w, c = np.array(plant.motion.omega_body_radps), np.array(matrix(plant.motion.q_body_from_eci))
        energy.append(w @ inertia @ w)
        momentum.append(c.T @ inertia @ w)
        plant.begin_tick()
        plant.end_tick()
    assert energy[-1] == pytest.approx(energy[0], rel=1e-4)
    assert momentum[-1] == pytest.approx(momentum[0], abs=1e-4 * np.linalg.norm(momentum[0]))


@pytest.mark.parametrize("driven", [False, True])
def test_the_nutation_by_a_wheel_goes_on(make_plant, driven):
    """A sphere with momentum h along axis 3: the rate across it turns at h / J and keeps its size."""
    j_kgm2, h_nms, rotor_kgm2, ticks = 0.03, 0.01, 1e-5, 600
    along_kgm2 = j_kgm2 + rotor_kgm2 if driven else j_kgm2
    body = BodyConfig(
        ((j_kgm2, 0.0, 0.0), (0.0, j_kgm2, 0.0), (0.0, 0.0, along_kgm2)), (0.0, 0.0, 0.0 if driven else h_nms)
    )
    wheel = WheelConfig((0.0, 0.0, 1.0), rotor_kgm2, 1e-3, 0.02, momentum_nms=h_nms) if driven else None
    plant = make_plant(
        orbit=CIRCLE,
        disturbance=DisturbanceConfig(),
        body=body,
        wheel=wheel,
        initial=InitialConfig(omega_body_orbit_radps=(0.005, 0.0, 0.0)),
    )
    x0, y0, _ = plant.motion.omega_body_radps
    for _ in range(ticks):
        plant.begin_tick()
        plant.end_tick()
    x, y, _ = plant.motion.omega_body_radps
    turned, angle = complex(x, y) / complex(x0, y0), h_nms / j_kgm2 * ticks
    assert abs(turned) == pytest.approx(1.0, abs=1e-3)
    assert turned == pytest.approx(np.exp(1j * angle), abs=2e-3)


def test_nothing_is_known_of_the_field_after_the_table_ends(make_config, make_plant):
    with pytest.raises(ValueError, match="1900 to 2030"):
        make_plant(orbit=CIRCLE, epoch_unix_s=61 * 366 * DAY)
    make_plant(orbit=CIRCLE, epoch_unix_s=61 * 366 * DAY, field=FieldConfig("direct_dipole"))


def test_a_motion_that_the_integration_loses_ends_the_plant(make_plant):
    plant = make_plant(initial=InitialConfig(omega_body_orbit_radps=(1e12, 1e11, 0.0)))
    plant.begin_tick()
    with pytest.raises(PlantError, match="the motion diverges in tick 0"):
        plant.end_tick()
