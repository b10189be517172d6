"""The plant's rigid body under a continuous PD dipole on a circular orbit in the direct dipole's field.

Physics are the plant's, the law is that of the flight software; sampling and pulses are left out, as in the
theory. States are those of ``theory.linear``: x = (Omega / w0, theta), here with
theta = 2 qv of the attitude relative to the orbital frame, over the argument of latitude u.
"""

from dataclasses import dataclass
from math import pi, radians, sqrt

import numpy as np

from fsw.core.laws.pd import attitude_error, pd_dipole
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains
from sim.plant.config import OrbitConfig
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque, TorqueFunction
from sim.plant.environment.field import DirectDipole
from sim.plant.environment.orbit import CircularOrbit
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import (
    Quaternion,
    Vec3,
    canonical,
    conjugate,
    cross,
    from_matrix,
    matrix,
    multiply,
    normalise,
    transform,
)
from sim.value_types import Array

STEPS = 720
"""Integration steps an orbit."""
RAAN_RAD = 0.7
"""Arbitrary: nothing depends on it."""


@dataclass(frozen=True, slots=True)
class ControlledPlant:
    """A body with its gains; functions of time are functions of the argument of latitude u."""

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
        normal = _vec3(e3)
        return [
            (
                Surroundings(radius, 3.0 * w0**2, _vec3(b)),
                normal,
                from_matrix((radius, cross(normal, radius), normal)),
            )
            for radius, b in zip(map(_vec3, e1), b_t, strict=True)
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


def _vec3(v: Array) -> Vec3:
    x, y, z = v.tolist()
    return (x, y, z)
