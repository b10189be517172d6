"""A law of the table flown on the plant's rigid body: circular orbit, all known, any dipole.

Physics are the plant's, the law is that of the flight software; filter, sampling noise and pulses are left
out, so that a claim on a law is not a claim on them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isnan, radians
from typing import Any

import numpy as np

from fsw.core.algebra.quaternion import from_dcm, rotate
from fsw.core.algebra.vector import inverse
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.interface import ControlConfig, Demand, FieldSample, LawInput, Memory, Setpoint, Wheel
from fsw.core.laws.plan.riccati import Schedule
from fsw.core.laws.table import LAWS
from fsw.core.orbit.ephemeris import Reference
from sim.plant.config import OrbitConfig
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque, Torque, TorqueFunction
from sim.plant.dynamics.wheel import SpinningWheel
from sim.plant.environment.field import DirectDipole, RotatingIgrf
from sim.plant.environment.orbit import Array, CircularOrbit
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import (
    ZERO,
    Mat3,
    Quaternion,
    Vec3,
    add,
    conjugate,
    from_matrix,
    matrix,
    multiply,
    transform,
)
from sim.plant.wheel_config import WheelConfig

# --- What a flight has been


@dataclass(frozen=True, slots=True)
class LawHistory:
    """Histories, a row a step, each before its dipole acts.

    Attributes:
        t_s: time.
        orbit_rate_radps: of the circular orbit.
        omega_body_radps: inertial rate, body axes.
        relative_body_radps: rate relative to the orbital frame, body axes.
        q_body_from_orbit: attitude.
        c_body_from_orbit: the same as matrices.
        c_body_from_eci: attitude.
        momentum_eci_nms: of body and wheel.
        m_body_am2: dipole of the coils over the step.
        wheel_nms: momentum of a driven wheel relative to the body, along its axis; 0 without one.
    """

    t_s: Array
    orbit_rate_radps: float
    omega_body_radps: Array
    relative_body_radps: Array
    q_body_from_orbit: Array
    c_body_from_orbit: Array
    c_body_from_eci: Array
    momentum_eci_nms: Array
    m_body_am2: Array
    wheel_nms: Array

    @property
    def orbits(self) -> Array:
        """Time in orbits."""
        return self.t_s * self.orbit_rate_radps / (2.0 * np.pi)

    @property
    def angle_deg(self) -> Array:
        """Angle from the nominal attitude."""
        scalar = np.clip(np.abs(self.q_body_from_orbit[:, 0]), 0.0, 1.0)
        angle: Array = np.degrees(2.0 * np.arccos(scalar))
        return angle

    @property
    def last_orbit_deg(self) -> float:
        """The largest angle from the nominal attitude in the last orbit."""
        return float(self.angle_deg[self.orbits > self.orbits[-1] - 1.0].max())

    def axis_deg(self, axis: int, direction_eci: Vec3) -> Array:
        """Angle of a body axis, from 0, from a direction."""
        return angle_deg(self.c_body_from_eci[:, axis, :], direction_eci)

    def orbit_axis_deg(self, axis: int, direction: int) -> Array:
        """Angle of a body axis, from 0, from an axis of the orbital frame."""
        cosines = np.clip(self.c_body_from_orbit[:, axis, direction], -1.0, 1.0)
        angle: Array = np.degrees(np.arccos(cosines))
        return angle


def angle_deg(vectors: Array, direction: Vec3) -> Array:
    """Angle of each row from a direction in the same axes."""
    cosines = vectors @ np.array(direction) / np.linalg.norm(direction) / np.linalg.norm(vectors, axis=1)
    angle: Array = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return angle


# --- The flight

DEGREE, EPOCH_UNIX_S = 13, 1_742_461_200
"""Of the true field."""

Extra = Callable[[Mat3, Vec3], Vec3]
"""A further torque, body axes [N m], from C(body from eci) and the velocity in eci [m/s]."""


class NoNumberError(Exception):
    """A law has asked for a dipole or a wheel torque that is no number."""


@dataclass(frozen=True, slots=True)
class ConstantTorque:
    """A constant torque, body axes, N m."""

    torque_body_nm: Vec3

    def __call__(self, c_body_from_eci: Mat3, velocity_eci_mps: Vec3) -> Vec3:
        """The torque, wherever the body is and however it is turned."""
        return self.torque_body_nm


@dataclass(frozen=True, slots=True)
class LawFlight:
    """What is flown.

    Attributes:
        law: name in the table of laws.
        inertia_kgm2: body axes.
        k_w, k_a, k_i, spin_radps: of the setpoint.
        gains: the law's own; None for its defaults.
        near: whether the form of POINT is flown, else that of ACQUIRE.
        hand_over_orbits: after so many orbits the form of POINT takes over.
        rotation_rad: turn from the orbital frame to the body at the start, rotation vector.
        omega_body_radps: absolute rate at the start; that of the orbital frame is added where ``relative``.
        orbits: length.
        step_s: of the law and of the integration.
        most_am2: dipole of each coil.
        sun_eci: direction of the Sun; None: no Sun sensor.
        gravity: whether the gravity gradient acts.
        extra: a further torque.
        attitude_known: whether the law knows attitude and rate.
        schedules: by law, of the periodic laws.
        igrf: whether the field is the true one, else the direct dipole's.
        wheel: a wheel that the law may drive; its friction is not compensated.
    """

    law: str
    inertia_kgm2: Mat3
    k_w: float = 0.0
    k_a: float = 0.0
    spin_radps: float = 0.0
    gains: object = None
    near: bool = False
    hand_over_orbits: float = float("inf")
    rotation_rad: Vec3 = ZERO
    omega_body_radps: Vec3 = ZERO
    relative: bool = False
    orbits: float = 1.0
    step_s: float = 5.0
    most_am2: float = 1e3
    sun_eci: Vec3 | None = None
    gravity: bool = True
    wheel_body_nms: Vec3 = ZERO
    altitude_km: float = 800.0
    inclination_deg: float = 98.6
    extra: Extra | None = None
    attitude_known: bool = True
    k_i: float = 0.0
    schedules: dict[str, Schedule] = field(default_factory=dict)
    igrf: bool = False
    wheel: WheelConfig | None = None


def fly(case: LawFlight) -> LawHistory:
    """Fly it; the dipole holds over a step.

    Raises:
        NoNumberError: the law asks for what no coil or wheel can give, so that no figure is that of the law.
    """
    row, settings, setpoint = LAWS[case.law], _settings(case), _setpoint(case)
    own = case.inertia_kgm2 if case.wheel is None else case.wheel.rest_of(case.inertia_kgm2)
    rigid, orbit = RigidBody(own, case.wheel_body_nms), _orbit(case)
    rate = float(np.linalg.norm(np.cross(orbit.r_m[0], orbit.v_mps[0])) / np.linalg.norm(orbit.r_m[0]) ** 2)
    hand_over_s = case.hand_over_orbits * 2.0 * np.pi / rate
    motion, before, rows = _start(case, orbit, rate), FieldSample(), []
    wheel = None if case.wheel is None else SpinningWheel(case.wheel, motion.omega_body_radps)
    memory: Memory = ()
    for tick in range((len(orbit.r_m) - 1) // 2):
        near, place = case.near or tick * case.step_s >= hand_over_s, 2 * tick
        inputs, relative, from_orbit = _inputs(case, orbit, place, rate, motion, before, tick)
        h = None if wheel is None else wheel.relative_nms(motion.omega_body_radps)
        inputs = inputs.replace(wheel_nms=h)
        demand = (row.point if near else row.acquire)(inputs, memory, setpoint, settings)
        _check_numbers(case, tick, demand)
        before, memory = inputs.sample, demand.memory
        m = _clipped(demand.m_body_am2, case.most_am2)
        q, omega = motion.q_body_from_eci, motion.omega_body_radps
        rows.append((tick * case.step_s, q, omega, relative, from_orbit, m, h or 0.0))
        driven, reaction = None, ZERO
        if wheel is not None:
            driven = wheel.advance(demand.wheel_torque_nm or 0.0, omega, case.step_s)
            reaction = driven.reaction_nm
        torque = _torque(case, m, _vec3(orbit.v_mps[place]), reaction)
        motion = rigid.step(motion, torque, case.step_s, *orbit.around(place), driven=driven)
    return _flown(case, rate, rows)


@dataclass(frozen=True, slots=True)
class _Orbit:
    """The circular orbit at each half step, eci."""

    r_m: Array
    v_mps: Array
    b_t: Array
    gradient_ps2: float

    def around(self, place: int) -> list[Surroundings]:
        """At the start, the middle and the end of a step."""
        return [
            Surroundings(_vec3(r / np.linalg.norm(r)), self.gradient_ps2, _vec3(b))
            for r, b in zip(self.r_m[place : place + 3], self.b_t[place : place + 3], strict=True)
        ]

    def axes(self, place: int) -> Mat3:
        """Rows: radius, ahead, normal."""
        e1 = self.r_m[place] / np.linalg.norm(self.r_m[place])
        e3 = np.cross(self.r_m[place], self.v_mps[place])
        e3 = e3 / np.linalg.norm(e3)
        return _vec3(e1), _vec3(np.cross(e3, e1)), _vec3(e3)


def _orbit(case: LawFlight) -> _Orbit:
    height_m, inclination_rad = 1e3 * case.altitude_km, radians(case.inclination_deg)
    circular = CircularOrbit(OrbitConfig(None, height_m, inclination_rad, 0.0, 0.0))
    (r, v) = (part[0] for part in circular.at(np.array([0.0])))
    rate = float(np.linalg.norm(np.cross(r, v)) / (r @ r))
    steps = int(case.orbits * 2.0 * np.pi / rate / case.step_s)
    times = 0.5 * case.step_s * np.arange(2 * steps + 1, dtype=np.float64)
    r_m, v_mps = circular.at(times)
    b_t = (RotatingIgrf(DEGREE, EPOCH_UNIX_S) if case.igrf else DirectDipole()).at(times, r_m)
    return _Orbit(r_m, v_mps, b_t, 3.0 * rate**2 if case.gravity else 0.0)


def _start(case: LawFlight, orbit: _Orbit, rate: float) -> Motion:
    half = 0.5 * float(np.linalg.norm(case.rotation_rad))
    sine = 0.5 * np.sinc(half / np.pi)
    x, y, z = (sine * part for part in case.rotation_rad)
    turn: Quaternion = (float(np.cos(half)), float(x), float(y), float(z))
    nx, ny, nz = transform(matrix(turn), (0.0, 0.0, rate if case.relative else 0.0))
    wx, wy, wz = case.omega_body_radps
    return Motion(multiply(from_matrix(orbit.axes(0)), turn), (wx + nx, wy + ny, wz + nz))


def _inputs(
    case: LawFlight, orbit: _Orbit, place: int, rate: float, motion: Motion, before: FieldSample, tick: int
) -> tuple[LawInput, Vec3, Quaternion]:
    axes, c = orbit.axes(place), matrix(motion.q_body_from_eci)
    q_orbit = from_dcm(axes)
    from_orbit = multiply(conjugate(q_orbit), motion.q_body_from_eci)
    nx, ny, nz = transform(c, axes[2])
    wx, wy, wz = motion.omega_body_radps
    relative = (wx - rate * nx, wy - rate * ny, wz - rate * nz)
    b_eci = _vec3(orbit.b_t[place])
    b_body = transform(c, b_eci)
    sun = None if case.sun_eci is None else rotate(motion.q_body_from_eci, case.sun_eci)
    r_m = _vec3(orbit.r_m[place])
    reference = Reference(
        r_eci_m=r_m,
        radius_m=float(np.linalg.norm(r_m)),
        b_eci_t=b_eci,
        sun_eci=case.sun_eci or (1.0, 0.0, 0.0),
        lit=sun is not None,
        q_orbit_from_eci=q_orbit,
        orbit_rate_radps=rate,
    )
    attitude, sample = (
        Attitude(from_orbit, relative, 0.0, 0.0, case.attitude_known),
        FieldSample(b_body, tick),
    )
    return LawInput(attitude, b_body, sample, before, sun, reference, tick=tick), relative, from_orbit


def _torque(case: LawFlight, m: Vec3, velocity: Vec3, reaction: Vec3) -> Torque:
    alone, extra = BodyTorque(case.inertia_kgm2, m, reaction), case.extra
    if extra is None:
        return alone

    def torque(q: Quaternion, omega: Vec3, around: Surroundings) -> Vec3:
        return add(alone.at(q, omega, around), extra(matrix(q), velocity))

    return TorqueFunction(torque)


def _setpoint(case: LawFlight) -> Setpoint:
    return Setpoint(case.law, case.k_w, case.k_a, case.k_i, case.spin_radps)


def _settings(case: LawFlight) -> ControlConfig:
    own = LAWS[case.law].gains
    gains = {} if own is None else {case.law: case.gains or own()}
    return ControlConfig(
        setpoint=_setpoint(case),
        gains=gains,
        inertia_kgm2=case.inertia_kgm2,
        inertia_inverse=inverse(case.inertia_kgm2),
        wheel_body_nms=case.wheel_body_nms,
        pulsed=False,
        tick_s=case.step_s,
        horizon_s=case.step_s,
        mean_dipole_am2=case.most_am2,
        schedules=case.schedules,
        wheel=None if case.wheel is None else _onboard(case.wheel, case.step_s),
    )


def _onboard(w: WheelConfig, step_s: float) -> Wheel:
    limits = (w.inertia_kgm2, w.max_torque_nm, w.max_momentum_nms)
    return Wheel(w.axis_body, *limits, w.viscous_nms, w.coulomb_nm, step_s, stale_ticks=1)


def _flown(case: LawFlight, rate: float, rows: list[Any]) -> LawHistory:
    t_s, q, omega, relative, from_orbit, m, h = map(np.array, zip(*rows, strict=True))
    c_eci = np.array([matrix(tuple(row)) for row in q.tolist()])
    c_orbit = np.array([matrix(tuple(row)) for row in from_orbit.tolist()])
    axis = ZERO if case.wheel is None else case.wheel.axis_body
    momentum = omega @ np.array(case.inertia_kgm2).T + np.array(case.wheel_body_nms) + np.outer(h, axis)
    h_eci = np.einsum("tji,tj->ti", c_eci, momentum)
    return LawHistory(t_s, rate, omega, relative, from_orbit, c_orbit, c_eci, h_eci, m, h)


def _check_numbers(case: LawFlight, tick: int, demand: Demand) -> None:
    if any(map(isnan, (*demand.m_body_am2, demand.wheel_torque_nm or 0.0))):
        raise NoNumberError(
            f"{tick * case.step_s:g} s after the start {case.law} asks for what is no number: a dipole of "
            f"{demand.m_body_am2} A m^2, a wheel torque of {demand.wheel_torque_nm} N m"
        )


def _clipped(m: Vec3, most: float) -> Vec3:
    x, y, z = (max(-most, min(most, part)) for part in m)
    return (x, y, z)


def _vec3(v: Array) -> Vec3:
    x, y, z = v.tolist() if isinstance(v, np.ndarray) else v
    return (x, y, z)
