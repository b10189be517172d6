"""The Jacobi integral: its equation, and that the plant conserves it and changes it as torques say."""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.plant.config import BodyConfig, DisturbanceConfig, FieldConfig, InitialConfig, OrbitConfig
from sim.plant.dynamics.jacobi import jacobi_integral
from sim.plant.environment.orbit import EARTH_RADIUS_M, MU_M3PS2
from sim.plant.rotation import from_vector

ALTITUDE_M = 800e3
RATE = sqrt(MU_M3PS2 / (EARTH_RADIUS_M + ALTITUDE_M) ** 3)
CIRCLE = OrbitConfig(None, ALTITUDE_M, 1.72, 0.6, 0.35)
INERTIA = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
WHEEL = (0.003, -0.002, 0.004)
J = np.array(INERTIA)
ORBITS_3 = int(6.0 * pi / RATE)


@pytest.fixture
def fly(make_plant):
    """Truth every so many ticks of an uncontrolled flight on the circle."""

    def fly(ticks, every, **parts):
        parts = {"orbit": CIRCLE, "disturbance": DisturbanceConfig(), "body": BodyConfig(INERTIA)} | parts
        plant, rows = make_plant(**parts), []
        for tick in range(ticks):
            if tick % every == 0:
                rows.append(plant.truth())
            plant.begin_tick()
            plant.end_tick()
        return plant, rows

    return fly


def integrals(rows, inertia=J, wheel=None):
    q = np.array([row.q_body_from_orbit for row in rows])
    omega = np.array([row.omega_body_orbit_radps for row in rows])
    return jacobi_integral(inertia, q, omega, RATE, wheel)


def test_its_equation_by_other_algebra():
    rng = np.random.default_rng(3)
    turns = Rotation.random(40, rng)
    omega = 1e-3 * rng.standard_normal((40, 3))
    found = jacobi_integral(J, turns.as_quat(scalar_first=True), omega, RATE, np.array(WHEEL))
    for turn, w, h in zip(turns, omega, found, strict=True):
        body_from_orbit = turn.as_matrix().T
        e1, _, e3 = body_from_orbit.T
        inertial = w + RATE * e3
        # the energy in the rotating frame: kinetic - w0 . angular momentum + gravity's potential
        momentum = J @ inertial + WHEEL
        energy = 0.5 * inertial @ J @ inertial - RATE * e3 @ momentum + 1.5 * RATE**2 * e1 @ J @ e1
        assert h == pytest.approx(energy, rel=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("wheel", [(0.0, 0.0, 0.0), WHEEL])
@pytest.mark.parametrize(
    "start",
    [
        InitialConfig(from_vector((0.4, -0.3, 0.5)), (1e-3, -7e-4, 5e-4)),
        InitialConfig(from_vector((2.1, 1.3, -0.6)), (-3e-3, 2e-3, 4e-3)),
    ],
)
def test_three_orbits_conserve_it(fly, start, wheel):
    _, rows = fly(ORBITS_3, 30, initial=start, body=BodyConfig(INERTIA, wheel))
    found = integrals(rows, wheel=wheel)
    assert np.abs(found / found[0] - 1.0).max() < 1e-11


def test_a_wheel_that_is_left_out_is_missed(fly):
    _, rows = fly(600, 30, body=BodyConfig(INERTIA, WHEEL))
    found = integrals(rows)
    assert np.ptp(found) > 1e-3 * abs(found[0])


def test_a_torque_changes_it_by_its_power(fly):
    """Every torque at once, trapezoidal work of torque and rate, at 1 Hz."""
    disturbance = DisturbanceConfig((3e-7, -2e-7, 1e-7), (0.01, 0.02, -0.03), eddy_nms_per_t2=2e4)
    _, rows = fly(1500, 1, disturbance=disturbance, body=BodyConfig(INERTIA, WHEEL))
    sources = [np.array(row.torque_body_nm)[1:].sum(axis=0) for row in rows]  # all but gravity
    power = np.array([t @ row.omega_body_orbit_radps for t, row in zip(sources, rows, strict=True)])
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]))])
    found = integrals(rows, wheel=WHEEL)
    assert np.abs(found - found[0] - work).max() < 1e-5 * np.ptp(found)
    assert np.ptp(found) > 0.01 * abs(found[0])


def test_eddy_currents_brake_a_fast_body_as_their_power_says(fly):
    """1/2 w.Jw of the inertial rate falls at every step; with nothing else, by k |w x b|^2 a second."""
    spinning = InitialConfig(omega_body_orbit_radps=(0.05, -0.08, 0.06))
    plant, rows = fly(
        400,
        1,
        initial=spinning,
        disturbance=DisturbanceConfig(eddy_nms_per_t2=1e6),
        field=FieldConfig("direct_dipole"),
        max_substep_s=0.25,
    )
    assert plant.torque_sources[-1] == "eddy"
    omega, energy, lost = [], [], []
    for row in rows:
        e3 = Rotation.from_quat(row.q_body_from_orbit, scalar_first=True).as_matrix().T[:, 2]
        w = np.array(row.omega_body_orbit_radps) + RATE * e3
        omega.append(w)
        energy.append(0.5 * w @ J @ w)
        lost.append(1e6 * np.sum(np.cross(w, row.b_body_t) ** 2))
    assert (np.diff(energy) < 0.0).all()
    work = np.concatenate([[0.0], np.cumsum(0.5 * (np.array(lost)[1:] + lost[:-1]))])
    assert np.array(energy) - energy[0] == pytest.approx(-work, rel=2e-3, abs=2e-3 * work[-1])
    assert work[-1] > 0.05 * energy[0]
