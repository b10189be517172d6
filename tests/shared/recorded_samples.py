"""A recorded pass that is made up: a torque-free spin along a real orbit, seen by sensors with known errors.

The motion is integrated as a rotation matrix, and the field by the plant's model: nothing here is shared with
what is tested.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from sgp4.api import Satrec

from sim.commissioning.recorded.along import along
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.plant.environment.field import RotatingIgrf
from sim.plant.environment.sun import sun_eci_m
from sim.scenario.element_file import nearest_elements

DATA = Path(__file__).parent / "suchai3"
TLE = DATA / "tle.txt"
START_UNIX_S = 1702307970
"""In the Sun, near the elements of 2023-12-11."""

OFFSET_NT = np.array([41000.0, -23500.0, 8700.0])
MATRIX = np.array([[1.06, 0.021, -0.013], [0.021, 0.97, 0.017], [-0.013, 0.017, 1.03]])
RATIOS = np.array([0.93, 1.0, 0.31])
AXES = Rotation.from_rotvec(np.radians((2.0, 0.0, -4.0))).as_matrix()
"""Columns: the principal axes."""
FACES = {"left": (np.array([-0.95, -0.3, 0.1]), 420.0), "down": (np.array([0.1, -0.2, -0.97]), 510.0)}


@dataclass(frozen=True)
class MadeUp:
    """The truth: times, attitudes body from eci, rates; and the rows of the file."""

    t_s: np.ndarray
    dcm: np.ndarray
    omega_radps: np.ndarray
    b_eci_nt: np.ndarray
    sun_eci: np.ndarray
    text: str

    def along(self, folder):
        """Written, read and placed on the orbit."""
        path = folder / "made_up.csv"
        path.write_text(self.text)
        recorded = read_pass(path)
        return along(recorded, nearest_elements(TLE, recorded.middle_unix_s))


def made_up(seconds=240, rate_degps=31.0, noise_nt=150.0, seed=3, drift_nt=0.0):
    """The pass; ``drift_nt``: how far the bias along sensor axis x has moved at its end."""
    random = np.random.default_rng(seed)
    t_s = np.arange(float(seconds))
    dcm, omega = _motion(t_s, rate_degps, random)
    b_eci_nt, sun_eci = _surroundings(t_s)
    body_nt = np.einsum("nij,nj->ni", dcm, b_eci_nt) + noise_nt * random.standard_normal((seconds, 3))
    mag_nt = body_nt @ np.linalg.inv(MATRIX).T + OFFSET_NT
    mag_nt[:, 0] += drift_nt * t_s / t_s[-1]
    gyro = np.degrees(omega) + 0.05 * random.standard_normal((seconds, 3)) + (-1.2, 0.4, 0.8)
    sun_body = np.einsum("nij,nj->ni", dcm, sun_eci)
    cells = {name: scale * np.maximum(0.0, sun_body @ face / np.linalg.norm(face)) + 30.0
             for name, (face, scale) in FACES.items()}  # fmt: skip
    head = ["utc_unix_s", *(f"mag_{a}_nt" for a in "xyz"), *(f"gyro_{a}_degps" for a in "xyz")]
    rows = np.column_stack((START_UNIX_S + t_s, mag_nt, gyro, *cells.values()))
    lines = [",".join([*head, *(f"sun_cell_{name}_raw" for name in cells)])]
    lines += [",".join(f"{value:.6f}" for value in row) for row in rows]
    return MadeUp(t_s, dcm, omega, b_eci_nt, sun_eci, "\n".join(lines) + "\n")


def _motion(t_s, rate_degps, random):
    inertia = AXES @ np.diag(RATIOS) @ AXES.T
    inverse = np.linalg.inv(inertia)

    def rates(_, state):
        w = state[9:]
        cross = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate(((-cross @ state[:9].reshape(3, 3)).ravel(), -inverse @ cross @ inertia @ w))

    wobble = np.radians(0.4) * random.standard_normal(3)
    omega = np.radians(rate_degps) * AXES[:, 1] + wobble - (wobble @ AXES[:, 1]) * AXES[:, 1]
    begun = np.concatenate((Rotation.random(rng=random).as_matrix().ravel(), omega))
    found = solve_ivp(rates, (0.0, t_s[-1]), begun, "DOP853", t_s, rtol=1e-9, atol=1e-10).y
    return found[:9].T.reshape(-1, 3, 3), found[9:].T


def _surroundings(t_s):
    first, second = TLE.read_text().splitlines()[1:3]
    satellite = Satrec.twoline2rv(first, second)
    days = 2440587.5 + (START_UNIX_S + t_s) / 86400.0
    _, r_km, _ = satellite.sgp4_array(np.floor(days), days - np.floor(days))
    b_eci_nt = 1e9 * RotatingIgrf(13, START_UNIX_S).at(t_s, 1e3 * r_km)
    sun = sun_eci_m(START_UNIX_S, t_s)
    return b_eci_nt, sun / np.linalg.norm(sun, axis=1)[:, None]
