"""The whole plant against a second integration: all that turns the body at once, in numpy and scipy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fsw.wire.messages import CoilDipole
from sim.plant.config import (
    BodyConfig,
    CoilConfig,
    ContinuousConfig,
    DisturbanceConfig,
    FieldConfig,
    OrbitConfig,
    PlateConfig,
)
from sim.plant.environment.atmosphere import altitude_m, density_kgpm3
from sim.plant.environment.field import make_field
from sim.plant.environment.orbit import make_orbit
from sim.plant.environment.sun import AU_M, illumination, sun_eci_m

J = np.array([[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]])
WHEEL = (0.02, -0.01, 0.03)
ORBIT = OrbitConfig(None, 420e3, 1.72, 0.6, 0.35)
PLATES = (
    PlateConfig(0.30, (0.6, 0.0, 0.8), (0.2, 0.1, -0.02), 2.2, 0.3, 0.2),
    PlateConfig(0.12, (0.0, 1.0, 0.0), (0.1, 0.31, -0.05), 2.5, 0.1, 0.7),
    PlateConfig(0.45, (0.0, -0.8, -0.6), (0.06, -0.02, 0.4), 1.9, 0.5, 0.1),
    PlateConfig(0.25, (-1.0, 0.0, 0.0), (-0.2, 0.05, 0.1), 2.1, 0.2, 0.2),
)
DISTURBANCE = DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03), 1.5, 1361.0, 300.0, 0.0, 0.4)
ASKED = (0.0625, -0.125, 0.03125)
TURNS = ((0.02, -0.03, 0.05), (0.04, 0.01, -0.02), (-0.03, 0.05, 0.01))
COILS = CoilConfig((0.5, 2.0, 8.0), 11.0, 0.0, (0.97, 1.02, 1.05), ContinuousConfig(12.0, 1.0), TURNS)
AXES = np.array([Rotation.from_rotvec(turn).apply(axis) for turn, axis in zip(TURNS, np.eye(3), strict=True)])
DRIVEN_AM2 = (np.array(ASKED) * 12.0 * COILS.dipole_scale) @ AXES
SECONDS = 600


class Model:
    """The same equations, written anew: torques in vectors, the Sun's and the air's part plate by plate."""

    def __init__(self, config):
        self.epoch = config.epoch_unix_s
        self.orbit, self.field = make_orbit(ORBIT, self.epoch), make_field(config.field, self.epoch)

    def torque(self, t, body_from_eci, w):
        times = np.array([t])
        (r,), (v,) = self.orbit.at(times)
        b = body_from_eci @ self.field.at(times, r[None])[0]
        e = body_from_eci @ r / np.linalg.norm(r)
        torque = 3.0 * 3.986004418e14 / np.linalg.norm(r) ** 3 * np.cross(e, J @ e)
        torque += np.cross(DRIVEN_AM2 + DISTURBANCE.residual_dipole_body_am2, b)
        torque += (1.0 + 0.4 * np.cos(2.0 * np.pi * t / 86400.0)) * np.array(DISTURBANCE.torque_body_nm)
        torque += 300.0 * np.cross(np.cross(w, b), b)
        return torque + self.plates(times, r, v, body_from_eci)

    def plates(self, times, r, v, body_from_eci):
        sun = sun_eci_m(self.epoch, times)[0]
        to_sun = sun - r
        far = np.linalg.norm(to_sun)
        lit = illumination(r[None], sun[None])[0]
        pressure = 1361.0 / 299792458.0 * (AU_M / far) ** 2 * lit
        s = body_from_eci @ to_sun / far
        flow = body_from_eci @ (v - np.cross([0.0, 0.0, 7.2921159e-5], r))
        speed, density = np.linalg.norm(flow), 1.5 * density_kgpm3(altitude_m(r[None]))[0]
        torque = np.zeros(3)
        for plate in PLATES:
            n = np.array(plate.normal_body)
            force = -0.5 * density * plate.drag_coefficient * plate.area_m2 * max(n @ flow, 0.0) * flow
            c = max(n @ s, 0.0)
            push = 2.0 * (plate.diffuse / 3.0 + plate.specular * c) * n + (1.0 - plate.specular) * s
            torque += np.cross(plate.centre_body_m, force - pressure * plate.area_m2 * c * push)
        assert speed > 7000.0
        return torque

    def rates(self, t, y):
        q, w = y[:4], y[4:]
        body_from_eci = Rotation.from_quat(q, scalar_first=True).as_matrix().T
        turn = np.array([-q[1:] @ w, *(q[0] * w + np.cross(q[1:], w))])
        torque = self.torque(t, body_from_eci, w) - np.cross(w, J @ w + WHEEL)
        return [*(0.5 * turn), *np.linalg.solve(J, torque)]


@pytest.mark.long
def test_ten_minutes_of_everything_at_once(make_plant, make_config, rotation_angle):
    parts = {
        "orbit": ORBIT,
        "field": FieldConfig("tilted_dipole"),
        "body": BodyConfig(tuple(map(tuple, J.tolist())), WHEEL, PLATES),
        "disturbance": DISTURBANCE,
        "coils": COILS,
        "max_substep_s": 0.25,
    }
    plant, model = make_plant(**parts), Model(make_config(**parts))
    q, w = plant.motion.q_body_from_eci, plant.motion.omega_body_radps
    solved = solve_ivp(model.rates, (0.0, SECONDS), [*q, *w], "DOP853", rtol=1e-10, atol=1e-13, max_step=20.0)
    driven = []
    for _ in range(SECONDS):
        plant.begin_tick()
        plant.receive(CoilDipole(*ASKED).encode())
        plant.end_tick()
        driven.append(plant.truth().m_body_am2)
    assert driven[-1] == pytest.approx(DRIVEN_AM2)
    found, expected = plant.motion, solved.y[:, -1]
    assert rotation_angle(found.q_body_from_eci, expected[:4]) < 1e-7
    assert np.abs(np.subtract(found.omega_body_radps, expected[4:])).max() < 1e-9
    assert rotation_angle(found.q_body_from_eci, q) > 0.5
