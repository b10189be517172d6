"""attitude_*.csv: the plant's rigid body and its torques against histories of other simulators."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np

from fsw.core.algebra import quaternion as onboard
from sim.campaign.claim import Threshold
from sim.errors import HarnessError
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, Mat3, Vec3, matrix, normalise
from sim.report.figures.attitude_arrays import angle_rad, relative
from sim.validate.reference.comparison import ReferenceComparison, largest
from sim.validate.reference.reference_table import ReferenceTable, names_of
from sim.value_types import Array

# --- Keplerian motion in closed form, for histories that were computed with it

_ROUNDS = 50


def two_body(r0_m: Array, v0_mps: Array, mu_m3ps2: float, t_s: Array) -> Array:
    """Positions [m], (n, 3), at times from the start, by Lagrange's f and g.

    n t = x - (1 - r0/a) sin x + (r0.v0 / sqrt(mu a)) (1 - cos x) gives the change x of the eccentric anomaly
    (Battin 1999, section 4.3), solved by Newton's method.

    Raises:
        ValueError: the orbit is not closed.
    """
    radius = float(np.linalg.norm(r0_m))
    a = 1.0 / (2.0 / radius - float(v0_mps @ v0_mps) / mu_m3ps2)
    if not 0.0 < a < np.inf:
        raise ValueError("the orbit is not closed")
    rate = np.sqrt(mu_m3ps2 / a**3)
    cosine, sine = 1.0 - radius / a, float(r0_m @ v0_mps) / np.sqrt(mu_m3ps2 * a)
    mean = rate * t_s
    x = mean.copy()
    for _ in range(_ROUNDS):
        error = x - cosine * np.sin(x) + sine * (1.0 - np.cos(x)) - mean
        change = error / (1.0 - cosine * np.cos(x) + sine * np.sin(x))
        x -= change
        if np.abs(change).max(initial=0.0) < 1e-14 * max(1.0, float(np.abs(mean).max(initial=0.0))):
            break
    f = 1.0 - a / radius * (1.0 - np.cos(x))
    g = t_s - (x - np.sin(x)) / rate
    r_m: Array = f[:, None] * r0_m + g[:, None] * v0_mps
    return r_m


# --- The check

ATTITUDE_RAD = 1e-7
RATE_RADPS = 1e-9
POSITION_M = 1e-2
MATRIX = 1e-13
MATRIX_WIDE = "a header may give the quaternion to 14 digits"

TURN_A_STEP_RAD = 0.006
"""Largest turn in a Runge-Kutta step: errors of 1e-9 rad after 1000 rad."""
MOST_STEPS = 10_000
"""Integration steps from a row to the next."""
LONGEST_STEP_S, SHORTEST_STEP_S = 1.0, 0.005


@dataclass(frozen=True, slots=True)
class AttitudeCase:
    """The header of a history: body, orbit and field."""

    inertia_kgm2: Mat3
    r0_m: Array
    v0_mps: Array
    start: Motion
    c0: Array
    mu_m3ps2: float
    gravity: bool
    dipole_body_am2: Vec3
    dipole_tm3: float
    dipole_axis: Array


def check(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Fly the header's case through the plant's integrator and compare every row.

    Raises:
        HarnessError: header or rows are malformed.
    """
    case, times = read_case(table), table.column("t_s")
    if times[0] < 0.0 or (np.diff(times) <= 0.0).any():
        row = 0 if times[0] < 0.0 else int(np.flatnonzero(np.diff(times) <= 0.0)[0]) + 1
        raise HarnessError(f"{table.path}, line {table.lines[row]}, column t_s: times must rise from 0")
    q = table.columns("q0", "q1", "q2", "q3")
    omega = table.columns(*names_of("omega_", "xyz", "_rad_s"))
    r_m = 1e3 * table.columns(*names_of("r_eci_", "xyz", "_km"))
    longest_step_s = step_s(omega)
    gaps_s = np.diff(times, prepend=0.0)
    if gaps_s.max() > MOST_STEPS * longest_step_s:
        row = int(np.argmax(gaps_s))
        raise HarnessError(
            f"{table.path}, line {table.lines[row]}, column t_s: the {gaps_s[row]:g} s before it take more "
            f"than {MOST_STEPS} integration steps at such rates"
        )
    ours_q, ours_omega = fly(case, times, longest_step_s)
    norm = np.linalg.norm(q, axis=1)
    yield ReferenceComparison(
        "attitude",
        "Attitude through the plant's integrator",
        "rad",
        np.maximum(angle_rad(relative(ours_q, q / norm[:, None])), np.abs(norm - 1.0)),
        ATTITUDE_RAD,
    )
    yield ReferenceComparison("rate", "Inertial rate", "rad/s", largest(ours_omega - omega), RATE_RADPS)
    ours_r_m = two_body(case.r0_m, case.v0_mps, case.mu_m3ps2, times)
    yield ReferenceComparison(
        "position", "Position on the header's orbit", "m", largest(ours_r_m - r_m), POSITION_M
    )
    start = case.start.q_body_from_eci
    for who, c in (("Plant", matrix(start)), ("Onboard", onboard.dcm(start))):
        apart = np.zeros(len(table))
        apart[0] = np.abs(np.array(c) - case.c0).max()
        yield ReferenceComparison(
            f"matrix_{who.lower()}",
            f"{who} matrix of the first attitude",
            "1",
            apart,
            MATRIX,
            Threshold.OWN,
            MATRIX_WIDE,
        )


def read_case(table: ReferenceTable) -> AttitudeCase:
    """The case of a header.

    Raises:
        HarnessError: a line of the header is missing or malformed.
    """
    translation = table.comment("translation") or ""
    rows = np.reshape(table.header("J (kg m^2", 9), (3, 3))
    q = table.header("q0 (body<-inertial", 4)
    dipole, dipole_tm3, axis = ZERO, 0.0, np.zeros(3)
    if table.comment("dipole m_body") is not None:
        dipole = _vec3(table.header("dipole m_body", 3))
        field = table.comment("field: B_inertial") or ""
        dipole_tm3 = table.numbers_after(field.partition(" T m^3")[0], "mu_e = ", 1, "field: ... mu_e = ")[0]
        axis = np.array(table.numbers_after(field, "mhat (constant, inertial) = ", 3, "field: ... mhat = "))
    if not any(q):
        raise HarnessError(f"{table.path}: the header's quaternion q0 is zero")
    case = AttitudeCase(
        inertia_kgm2=(_vec3(rows[0]), _vec3(rows[1]), _vec3(rows[2])),
        r0_m=np.array(table.header("r0_m", 3)),
        v0_mps=np.array(table.header("v0_m_s", 3)),
        start=Motion(normalise((q[0], q[1], q[2], q[3])), _vec3(table.header("w0_rad_s", 3))),
        c0=np.reshape(table.header("C0", 9), (3, 3)),
        mu_m3ps2=table.numbers_after(translation, "mu = ", 1, "translation: ... mu = ")[0],
        gravity="gravity gradient ON" in translation,
        dipole_body_am2=dipole,
        dipole_tm3=dipole_tm3,
        dipole_axis=axis,
    )
    _check_physics(table, case)
    return case


def fly(case: AttitudeCase, times: Array, longest_step_s: float) -> tuple[Array, Array]:
    """Attitudes (n, 4) and inertial rates (n, 3) of the plant's rigid body at rising times from 0."""
    body, motion, here = RigidBody(case.inertia_kgm2), case.start, 0.0
    torque = BodyTorque(case.inertia_kgm2, case.dipole_body_am2)
    history = []
    for time in times.tolist():
        steps = ceil((time - here) / longest_step_s)
        around = surroundings(case, np.linspace(here, time, 2 * steps + 1))
        for step in range(steps):
            motion = body.step(motion, torque, (time - here) / steps, *around[2 * step : 2 * step + 3])
        history.append(motion)
        here = time
    return np.array([m.q_body_from_eci for m in history]), np.array([m.omega_body_radps for m in history])


def surroundings(case: AttitudeCase, t_s: Array) -> list[Surroundings]:
    """Radius, gradient and field, B = (mu_e / r^3) (3 (m . e) e - m), at each time."""
    r_m = two_body(case.r0_m, case.v0_mps, case.mu_m3ps2, t_s)
    r_norm = np.linalg.norm(r_m, axis=1)[:, None]
    e = r_m / r_norm
    gradient = case.gravity * 3.0 * case.mu_m3ps2 / r_norm[:, 0] ** 3
    b_t = case.dipole_tm3 / r_norm**3 * (3.0 * (e @ case.dipole_axis)[:, None] * e - case.dipole_axis)
    return [
        Surroundings((ex, ey, ez), g, (bx, by, bz))
        for (ex, ey, ez), g, (bx, by, bz) in zip(e.tolist(), gradient.tolist(), b_t.tolist(), strict=True)
    ]


def step_s(omega: Array) -> float:
    """The integration step for a history of rates."""
    fastest = float(np.linalg.norm(omega, axis=1).max())
    return float(np.clip(TURN_A_STEP_RAD / np.maximum(fastest, 1e-9), SHORTEST_STEP_S, LONGEST_STEP_S))


def _check_physics(table: ReferenceTable, case: AttitudeCase) -> None:
    if not np.linalg.eigvalsh(np.array(case.inertia_kgm2)).min() > 0.0:
        raise HarnessError(f"{table.path}: the header's J is not positive definite")
    if not case.mu_m3ps2 > 0.0:
        raise HarnessError(f"{table.path}: the header's mu is {case.mu_m3ps2:g}, and no planet's")
    try:
        two_body(case.r0_m, case.v0_mps, case.mu_m3ps2, np.zeros(1))
    except (ValueError, ZeroDivisionError):
        raise HarnessError(f"{table.path}: the header's r0_m and v0_m_s are no closed orbit") from None


def _vec3(values: list[float] | Array) -> Vec3:
    x, y, z = (float(value) for value in values)
    return (x, y, z)
