"""Claims that need no flight: theory and plant against each other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import pi, radians, sqrt
from typing import Any

import numpy as np

from fsw.core.laws.pd import attitude_error, pd_dipole
from hil_stub.coils.coil_driver import CoilLimits
from sim.campaign.claim import Claim, ClaimOutcome, Study, Threshold
from sim.design.theory.bodies import BODIES, UNSTABLE_BODIES, Body
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.design.theory.search import continuous, search
from sim.plant.config import BodyConfig, CoilConfig, FieldConfig, InitialConfig, OrbitConfig, PlantConfig
from sim.plant.dynamics.jacobi import jacobi_integral
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque, TorqueFunction
from sim.plant.environment.field import DirectDipole
from sim.plant.environment.orbit import EARTH_RADIUS_M, MU_M3PS2, CircularOrbit
from sim.plant.environment.surroundings import Surroundings
from sim.plant.plant import Plant
from sim.plant.rotation import (
    Mat3,
    Quaternion,
    Vec3,
    canonical,
    conjugate,
    cross,
    from_matrix,
    from_vector,
    matrix,
    multiply,
    normalise,
    transform,
)
from sim.value_types import Array, vec3

# --- The plant under a continuous PD dipole, as the theory has it

STEPS = 720
"""Integration steps an orbit."""
RAAN_RAD = 0.7
"""Arbitrary: nothing depends on it."""


@dataclass(frozen=True, slots=True)
class ControlledPlant:
    """The plant's rigid body under a continuous PD dipole, on a circular orbit in the direct dipole's field.

    Physics are the plant's, the law is that of the flight software; sampling and pulses are left out, as in
    the theory. States are those of ``theory.linear``: x = (Omega / w0, theta), here with theta = 2 qv of the
    attitude relative to the orbital frame, over the argument of latitude u, which stands for time.
    """

    body: Body
    k_w: float
    k_a: float

    @classmethod
    def of(cls, body: Body, gains: Gains) -> "ControlledPlant":
        """The body with gains that are numbers."""
        return cls(body, float(np.asarray(gains.k_w)), float(np.asarray(gains.k_a)))

    def rates(self, u: float, x: Array) -> Array:
        """dx/du by the plant's right-hand side, (6,)."""
        w0 = self.body.rate_radps
        around, normal, q_orbit = self._around(np.array([u]))[0]
        motion = self._motion(x, q_orbit)
        q_rate, omega_rate = RigidBody(self.body.inertia_kgm2).rates(motion, self._torque(normal), around)
        frame_rate: Quaternion = (0.0, 0.0, 0.0, -0.5 * w0)
        from_orbit = multiply(conjugate(q_orbit), motion.q_body_from_eci)
        turning = np.array(multiply(frame_rate, from_orbit)) + np.array(multiply(conjugate(q_orbit), q_rate))
        e3 = transform(matrix(motion.q_body_from_eci), normal)
        relative = w0 * x[:3]
        relative_rate = np.array(omega_rate) + w0 * np.cross(relative, e3)
        return np.concatenate([relative_rate / w0**2, 2.0 * turning[1:] / w0])

    def linearised(self, u: float, step: float = 1e-3) -> Array:
        """d(dx/du)/dx at x = 0, (6, 6): central differences of fourth order."""
        columns = []
        for axis in step * np.eye(6):
            near = self.rates(u, axis) - self.rates(u, -axis)
            far = self.rates(u, 2.0 * axis) - self.rates(u, -2.0 * axis)
            columns.append((8.0 * near - far) / (12.0 * step))
        return np.stack(columns, axis=1)

    def monodromy(self, step: float = 1e-4) -> Array:
        """Central differences of the flow over one orbit from u = 0, (6, 6)."""
        stages = self._around(np.linspace(0.0, 2.0 * pi, 2 * STEPS + 1))
        columns = [
            (self._flow(axis, stages) - self._flow(-axis, stages)) / (2.0 * step) for axis in step * np.eye(6)
        ]
        return np.stack(columns, axis=1)

    def _flow(self, x: Array, stages: "list[_Stage]") -> Array:
        """The state after one orbit, from x."""
        w0 = self.body.rate_radps
        _, normal, q_start = stages[0]
        rigid, torque, motion = (
            RigidBody(self.body.inertia_kgm2),
            self._torque(normal),
            self._motion(x, q_start),
        )
        around = [stage[0] for stage in stages]
        step_s = 2.0 * pi / w0 / STEPS
        for step in range(STEPS):
            motion = rigid.step(motion, torque, step_s, *around[2 * step : 2 * step + 3])
        q = canonical(multiply(conjugate(stages[-1][2]), motion.q_body_from_eci))
        e3 = transform(matrix(motion.q_body_from_eci), normal)
        relative = np.array(motion.omega_body_radps) - w0 * np.array(e3)
        return np.concatenate([relative / w0, 2.0 * np.array(q[1:])])

    def _motion(self, x: Array, q_orbit_from_eci: Quaternion) -> Motion:
        wx, wy, wz, a, b, c = x.tolist()
        w0 = self.body.rate_radps
        q: Quaternion = (sqrt(1.0 - 0.25 * (a * a + b * b + c * c)), 0.5 * a, 0.5 * b, 0.5 * c)
        nx, ny, nz = transform(matrix(q), (0.0, 0.0, w0))
        return Motion(multiply(q_orbit_from_eci, q), (w0 * wx + nx, w0 * wy + ny, w0 * wz + nz))

    def _torque(self, normal: Vec3) -> TorqueFunction:
        return TorqueFunction(_Torque(self, normal))

    def _around(self, u: Array) -> "list[_Stage]":
        """Surroundings, the orbit's normal and q_orbit_from_eci at each u."""
        body, w0 = self.body, self.body.rate_radps
        config = OrbitConfig(None, 1e3 * body.altitude_km, radians(body.inclination_deg), RAAN_RAD, 0.0)
        times = u / w0
        r_m, v_mps = CircularOrbit(config).at(times)
        b_t = DirectDipole().at(times, r_m)
        e1 = r_m / np.linalg.norm(r_m, axis=1)[:, None]
        e3 = np.cross(r_m[0], v_mps[0])
        e3 /= np.linalg.norm(e3)
        normal = vec3(e3)
        return [
            (
                Surroundings(radius, 3.0 * w0**2, vec3(b)),
                normal,
                from_matrix((radius, cross(normal, radius), normal)),
            )
            for radius, b in zip(map(vec3, e1), b_t, strict=True)
        ]


_Stage = tuple[Surroundings, Vec3, Quaternion]


@dataclass(frozen=True, slots=True)
class _Torque:
    """Gravity gradient and the PD law's dipole in the field, as ``RigidBody`` takes it."""

    plant: ControlledPlant
    normal: Vec3

    def __call__(self, q: Quaternion, omega: Vec3, around: Surroundings) -> Vec3:
        w0, c = self.plant.body.rate_radps, matrix(normalise(q))
        e1, e3, b = transform(c, around.e_eci), transform(c, self.normal), transform(c, around.b_eci_t)
        e2 = cross(e3, e1)
        error = attitude_error(((e1[0], e2[0], e3[0]), (e1[1], e2[1], e3[1]), (e1[2], e2[2], e3[2])))
        relative = (omega[0] - w0 * e3[0], omega[1] - w0 * e3[1], omega[2] - w0 * e3[2])
        m = pd_dipole(b, relative, error, self.plant.k_w, self.plant.k_a)
        return BodyTorque(self.plant.body.inertia_kgm2, m).at(q, omega, around)


# --- The claims

THEORY = "Ovchinnikov, Roldugin, Ivanov, Penkov 2015, eq. 3 and 4"

KNOWN_BEST: dict[str, tuple[float, Gains]] = {
    "1U": (-0.522, Gains(6.2385e4, 9.1252)),
    "3U": (-0.886, Gains(5.85e4, 54.9)),
    "50 kg": (-0.519, Gains(6.2694e6, 1614.9)),
    "100 kg": (-0.487, Gains(2.4618e7, 3679.5)),
    "few tons": (-0.497, Gains(1.0171e10, 2.8213e6)),
    "boom": (-0.167, Gains(3.2433e8, 4.7969e4)),
}
"""Best degrees of stability of an earlier search, to three digits, and gains near them.

The paper prints none for bodies whose inertia it tells.
"""
ROUNDED = 5e-4

ROUGH_STEPS = 64
"""Steps of the Magnus integration, for the map and the descents from it."""

FULL: Mat3 = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
"""An inertia tensor with nothing zero in it, kg m^2."""
POINTS = 8
"""Arguments of latitude at which linearisations are compared."""


def studies() -> list[Study]:
    """The Jacobi integral; linearisation, exponents and best gains of the PD law."""
    return [jacobi(), linearisation(), exponents(), best_gains(), unstable_bodies()]


def jacobi() -> Study:
    """The integral that the uncontrolled motion conserves."""
    claim = Claim(
        "jacobi",
        "Relative drift of the Jacobi integral, uncontrolled, three circular orbits of 800 km",
        "Beletsky 1966; Hughes 1986, chapter 9",
        "1",
        high=1e-12,
    )
    return Study("jacobi", (jacobi_drift,), lambda drifts: [claim.judge(drifts[0])])


def linearisation() -> Study:
    """The design tools' matrix against differences of the plant's right-hand side."""
    bodies = (*BODIES, replace(BODIES[2], name="50 kg, full inertia tensor", inertia_kgm2=FULL))
    claim = Claim(
        "linearisation",
        "Linearised motion against finite differences of the plant's right-hand side",
        THEORY,
        "1",
        high=2e-10,
    )
    return _worst_of(claim, bodies, linearisation_error)


def exponents() -> Study:
    """Floquet exponents of the linear theory against those of the plant's motion."""
    claim = Claim(
        "exponents",
        "Degree of stability against that of the nonlinear plant over one orbit",
        THEORY,
        "1/rad",
        high=3e-5,
    )
    return _worst_of(claim, BODIES, exponent_error)


def best_gains() -> Study:
    """The search finds gains as good as the best known."""
    claims = [
        Claim(
            f"best_gains.{body.name.replace(' ', '_')}",
            f"Best degree of stability of {body.name}, as good as the best known to three digits",
            THEORY,
            "1/rad",
            high=KNOWN_BEST[body.name][0] + ROUNDED,
            threshold=Threshold.PROTOTYPE,
        )
        for body in BODIES
    ]

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        return [claim.judge(degree, text) for claim, (degree, text, _) in zip(claims, found, strict=True)]

    return Study("best_gains", tuple(partial(best_degree, body) for body in BODIES), conclude)


def unstable_bodies() -> Study:
    """The search distinguishes bodies that gains can stabilise from those that they cannot."""
    stabilisable = dict(zip((body.name for body in UNSTABLE_BODIES), (True, False, False), strict=True))
    claim = Claim(
        "unstable_bodies",
        "Bodies unstable under gravity gradient that are misjudged as to whether gains stabilise them",
        THEORY,
        "bodies",
        high=0.0,
        threshold=Threshold.PROTOTYPE,
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        wrong = [
            name
            for (name, can), (*_, stabilised) in zip(stabilisable.items(), found, strict=True)
            if can != stabilised
        ]
        return [claim.judge(float(len(wrong)), ", ".join(wrong))]

    return Study("unstable_bodies", tuple(partial(best_degree, body) for body in UNSTABLE_BODIES), conclude)


def jacobi_drift() -> float:
    """The largest |H - H_0| / |H_0| over three orbits of the whole plant, coils off."""
    altitude_m = 800e3
    rate = sqrt(MU_M3PS2 / (EARTH_RADIUS_M + altitude_m) ** 3)
    plant = Plant(
        PlantConfig(
            epoch_unix_s=1_742_461_200,
            tick_hz=1,
            seed=1,
            orbit=OrbitConfig(None, altitude_m, 1.72, 0.6, 0.35),
            field=FieldConfig("direct_dipole"),
            body=BodyConfig(FULL),
            initial=InitialConfig(from_vector((0.4, -0.3, 0.5)), (1e-3, -7e-4, 5e-4)),
            coils=CoilConfig((0.5, 2.0, 8.0)),
            limits=CoilLimits(tick_hz=1),
        )
    )
    rows = []
    for _ in range(round(3.0 * 2.0 * pi / rate)):
        rows.append(plant.truth())
        plant.begin_tick()
        plant.end_tick()
    q = np.array([row.q_body_from_orbit for row in rows])
    omega = np.array([row.omega_body_orbit_radps for row in rows])
    integral = jacobi_integral(np.array(FULL), q, omega, rate)
    return float(np.abs(integral - integral[0]).max() / abs(integral[0]))


def linearisation_error(body: Body) -> float:
    """The largest difference of any element at any point of the orbit."""
    gains = _gains(body)
    system, plant = closed_loop(body, gains), ControlledPlant.of(body, gains)
    points = 2.0 * pi * (np.arange(POINTS) + 0.3) / POINTS
    theirs = np.array([plant.linearised(u) for u in points.tolist()])
    return float(np.abs(system(points) - theirs).max())


def exponent_error(body: Body) -> float:
    """Between the degrees of stability of linear theory and of the plant."""
    gains = _gains(body)
    ours = degree_of_stability(monodromy(closed_loop(body, gains)))
    return abs(float(ours - degree_of_stability(ControlledPlant.of(body, gains).monodromy())))


def best_degree(body: Body) -> tuple[float, str, bool]:
    """The best degree of stability found, with its gains, and whether gains stabilise the body."""
    found = search(body, continuous(body), continuous(body, ROUGH_STEPS))
    best = found.best
    return best.degree, f"k_w {best.gains.k_w:.6g}, k_a {best.gains.k_a:.6g}", found.stabilised


def _gains(body: Body) -> Gains:
    return KNOWN_BEST[body.name.partition(",")[0]][1]


def _worst_of(claim: Claim, bodies: Sequence[Body], error: Callable[[Body], float]) -> Study:
    def conclude(errors: Sequence[float]) -> list[ClaimOutcome]:
        worst = int(np.argmax(errors))
        return [claim.judge(errors[worst], bodies[worst].name)]

    return Study(claim.id, tuple(partial(error, body) for body in bodies), conclude)
