"""A satellite to fly the laws on: rigid body, wheel, circular orbit, direct dipole, ideal coils.

Written apart from the plant: direction cosines instead of a quaternion, and the momentum as the state.
"""

from dataclasses import dataclass, field, replace
from math import cos, radians, sin, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import from_dcm
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.laws.interface import ControlConfig, FieldSample, LawInput, Setpoint, Wheel
from fsw.core.laws.table import LAWS
from fsw.core.orbit.ephemeris import Reference, ephemeris_model
from fsw.core.orbit.field import FieldKind
from fsw.core.orbit.propagation import circular_orbit
from fsw.table.schedules import SCHEDULERS

MU = 3.986004418e14
MU_E = 7.812e15
EPOCH_UNIX_S = 1742461200


@dataclass(frozen=True)
class Orbit:
    """Circular, ascending node on axis 1 of eci, direct dipole."""

    altitude_km: float = 800.0
    inclination_deg: float = 98.6
    dipole: float = 1.0

    @property
    def radius_m(self):
        return 6378.137e3 + 1e3 * self.altitude_km

    @property
    def rate_radps(self):
        return sqrt(MU / self.radius_m**3)

    @property
    def period_s(self):
        return 2.0 * np.pi / self.rate_radps

    def c_orbit_from_eci(self, t_s):
        """Rows: radius, along-track, normal; of one time or of many."""
        u, i = self.rate_radps * np.asarray(t_s), radians(self.inclination_deg)
        cu, su, ci, si = np.cos(u), np.sin(u), cos(i) + 0.0 * u, sin(i) + 0.0 * u
        axes = np.array([[cu, su * ci, su * si], [-su, cu * ci, cu * si], [0.0 * u, -si, ci]])
        return axes if axes.ndim == 2 else axes.transpose(2, 0, 1)

    def b_eci_t(self, t_s):
        """mu_e / r^3 (k - 3 (k . r) r), k the dipole along -z of eci."""
        radial = self.c_orbit_from_eci(t_s)[..., 0, :]
        k = np.array([0.0, 0.0, 1.0])
        return self.dipole * MU_E / self.radius_m**3 * (k - 3.0 * radial[..., 2:] * radial)


def cross(a, b):
    (a1, a2, a3), (b1, b2, b3) = a, b
    return [a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1]


@dataclass
class Body:
    """Inertia, a wheel of constant momentum or one that can be driven, and the coils' limit."""

    inertia: np.ndarray = field(default_factory=lambda: np.diag([1.02, 1.85, 1.95]))
    wheel: tuple = (0.0, 0.0, 0.0)
    most_am2: float = 1e9
    gravity: bool = True
    torque: tuple = (0.0, 0.0, 0.0)  # constant, body axes
    dipole: tuple = (0.0, 0.0, 0.0)  # its own, body axes
    vane_nm: float = 0.0  # turns axis 2 ahead, as feathers behind do in the air
    driven: Wheel | None = None
    driven_nms: float = 0.0  # its momentum at the start


@dataclass
class Flown:
    """Histories, a row a step; what ends in ``body`` is in body axes."""

    t_s: np.ndarray
    omega_body: np.ndarray  # absolute
    relative_body: np.ndarray  # against the orbital frame
    c_body_from_orbit: np.ndarray
    c_body_from_eci: np.ndarray
    momentum_eci: np.ndarray  # wheel included
    energy_j: np.ndarray  # of the body's own rotation
    m_body: np.ndarray
    wheel_nms: np.ndarray  # of the driven wheel

    @property
    def angle_deg(self):
        """From the nominal attitude."""
        trace = np.trace(self.c_body_from_orbit, axis1=1, axis2=2)
        return np.degrees(np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0)))

    def angle_to_deg(self, direction_eci):
        """Of the momentum from a direction."""
        return angles_deg(self.momentum_eci, direction_eci)

    def axis_to_deg(self, axis, direction_eci):
        """Of a body axis from a direction."""
        return angles_deg(self.c_body_from_eci[:, axis, :], direction_eci)


def angles_deg(vectors, direction):
    cosines = vectors @ np.asarray(direction) / np.linalg.norm(direction) / np.linalg.norm(vectors, axis=1)
    return np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))


def setpoint(law="", k_w=6.27e6, k_a=0.0, k_i=0.0, spin_radps=0.0):
    return Setpoint(law, k_w, k_a, k_i, spin_radps)


def config(body, step_s, gains=None):
    inertia = tuple(map(tuple, body.inertia.tolist()))
    inverse = tuple(map(tuple, np.linalg.inv(body.inertia).tolist()))
    return ControlConfig(
        setpoint=setpoint(),
        gains=gains or {},
        inertia_kgm2=inertia,
        inertia_inverse=inverse,
        wheel_body_nms=body.wheel,
        pulsed=False,
        tick_s=step_s,
        horizon_s=3.0,
        mean_dipole_am2=min(body.most_am2, 1e3),
        wheel=body.driven,
    )


def inputs_at(orbit, tick, step_s, *motion, **more):
    """What a law sees of the true motion at a tick; arguments as of ``inputs_in``."""
    t_s = tick * step_s
    return inputs_in(orbit, tick, orbit.c_orbit_from_eci(t_s), orbit.b_eci_t(t_s), *motion, **more)


def inputs_in(
    orbit, tick, c_orbit, b_eci, c_body_from_eci, omega, before, sun_eci=None, known=True, sampled=True
):
    c_body_from_orbit = c_body_from_eci @ c_orbit.T
    b_body = tuple((c_body_from_eci @ b_eci).tolist())
    relative = omega - orbit.rate_radps * c_body_from_orbit[:, 2]
    q = from_dcm(tuple(map(tuple, c_body_from_orbit.tolist())))
    attitude = Attitude(q, tuple(relative.tolist()), 0.0, 0.0, True) if known else UNKNOWN
    sun = None if sun_eci is None else tuple((c_body_from_eci @ sun_eci).tolist())
    reference = Reference(
        r_eci_m=tuple((orbit.radius_m * c_orbit[0]).tolist()),
        radius_m=orbit.radius_m,
        b_eci_t=tuple(b_eci.tolist()),
        sun_eci=(1.0, 0.0, 0.0) if sun_eci is None else tuple(sun_eci),
        lit=sun is not None,
        q_orbit_from_eci=from_dcm(tuple(map(tuple, c_orbit.tolist()))),
        orbit_rate_radps=orbit.rate_radps,
    )
    before = FieldSample() if before is None else before
    sample = FieldSample(b_body, tick) if sampled else before
    return LawInput(attitude, b_body, sample, before, sun, reference, tick=tick)


def fly(
    law,
    law_setpoint,
    *,
    gains=None,
    orbit=Orbit(),
    body=None,
    c_body_from_orbit=None,
    omega_body=(0.0, 0.0, 0.0),
    seconds=6000.0,
    step_s=4.0,
    sun_eci=None,
    known=True,
    switch=None,
    look=lambda inputs: inputs,
    settings=None,
):
    """Fly a law from an attitude and an absolute rate; the dipole holds over a step.

    ``switch`` is (time, law): the law flown from that time on; ``look`` changes what the law sees, and
    ``settings`` stand for those of the body.
    """
    body = body or Body()
    settings = settings or config(body, step_s, gains)
    inverse, wheel = np.linalg.inv(body.inertia), np.array(body.wheel)
    pull = 3.0 * orbit.rate_radps**2 if body.gravity else 0.0
    sun = None if sun_eci is None else np.array(sun_eci) / np.linalg.norm(sun_eci)
    c0 = np.eye(3) if c_body_from_orbit is None else c_body_from_orbit
    ticks = int(seconds / step_s)
    half_steps_s = 0.5 * step_s * np.arange(2 * ticks + 1)
    c_orbit, b_eci = orbit.c_orbit_from_eci(half_steps_s), orbit.b_eci_t(half_steps_s)
    around = np.stack([b_eci, c_orbit[:, 0], c_orbit[:, 1]], axis=2)  # columns: field, radius, ahead
    # columns: the axes of eci in the body, and the momentum with the wheel's
    axis = np.array(body.driven.axis_body) if body.driven else np.zeros(3)
    h = body.driven_nms
    state = np.column_stack([c0 @ c_orbit[0], body.inertia @ np.array(omega_body) + wheel + h * axis])
    before, memory, rows = FieldSample(), (), []

    def change(state, around, m, h):
        b, vertical, (a1, _, a3) = (state[:, :3] @ around).T.tolist()
        w1, w2, w3 = (inverse @ (state[:, 3] - wheel - h * axis)).tolist()
        out = np.array([[0.0, w3, -w2], [-w3, 0.0, w1], [w2, -w1, 0.0]]) @ state
        gravity = cross(vertical, (body.inertia @ vertical).tolist())
        whole = [coils + own for coils, own in zip(m, body.dipole, strict=True)]
        vane = (body.vane_nm * a3, 0.0, -body.vane_nm * a1)
        parts = zip(cross(whole, b), gravity, body.torque, vane, strict=True)
        out[:, 3] += [magnetic + pull * g + constant + air for magnetic, g, constant, air in parts]
        return out

    for tick in range(ticks):
        if switch is not None and tick * step_s >= switch[0]:
            law = switch[1]
        c_body_from_eci, omega = state[:, :3], inverse @ (state[:, 3] - wheel - h * axis)
        now = c_orbit[2 * tick], b_eci[2 * tick]
        inputs = inputs_in(orbit, tick, *now, c_body_from_eci, omega, before, sun, known)
        inputs = inputs.replace(wheel_nms=h if body.driven else None)
        demand = law(look(inputs), memory, law_setpoint, settings)
        before, memory = inputs.sample, demand.memory
        m = [max(-body.most_am2, min(body.most_am2, part)) for part in demand.m_body_am2]
        rows.append((tick * step_s, omega, c_body_from_eci @ now[0].T, state, m, h))
        start, middle, end = around[2 * tick : 2 * tick + 3]
        motor = (demand.wheel_torque_nm or 0.0) if body.driven else 0.0
        halfway, after = h + 0.5 * step_s * motor, h + step_s * motor
        k1 = change(state, start, m, h)
        k2 = change(state + 0.5 * step_s * k1, middle, m, halfway)
        k3 = change(state + 0.5 * step_s * k2, middle, m, halfway)
        k4 = change(state + step_s * k3, end, m, after)
        h = after
        state = state + step_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        c = state[:, :3]
        state[:, :3] = 1.5 * c - 0.5 * c @ c.T @ c  # orthogonal again
    return flown(rows, orbit, body)


def fly_from_rest(law, law_setpoint, *, c_body_from_orbit, orbits, orbit=Orbit(), **more):
    """From an attitude at rest in the orbital frame; further arguments as of ``fly``."""
    omega_body = orbit.rate_radps * c_body_from_orbit[:, 2]
    start = {"c_body_from_orbit": c_body_from_orbit, "omega_body": omega_body}
    return fly(law, law_setpoint, orbit=orbit, seconds=orbits * orbit.period_s, **start, **more)


def flown(rows, orbit, body):
    t_s, omega, c_body_from_orbit, state, m, h = map(np.array, zip(*rows, strict=True))
    return Flown(
        t_s,
        omega,
        omega - orbit.rate_radps * c_body_from_orbit[:, :, 2],
        c_body_from_orbit,
        state[:, :, :3],
        np.einsum("tji,tj->ti", state[:, :, :3], state[:, :, 3]),
        0.5 * np.einsum("ti,ij,tj->t", omega, body.inertia, omega),
        m,
        h,
    )


def scheduled(body, step_s, law, gains=None, orbit=Orbit(), also=()):
    """The settings of a law that flies by a schedule of its body and orbit; ``also`` are further laws."""
    own = {name: LAWS[name].gains(**(gains or {} if name == law else {})) for name in (law, *also)}
    ready = config(body, step_s, own)
    circle = (orbit.rate_radps, radians(orbit.inclination_deg), orbit.dipole * MU_E / orbit.radius_m**3)
    made = {name: SCHEDULERS[name](ready.inertia_kgm2, body.wheel, *circle, own[name]) for name in own}
    return replace(ready, mean_dipole_am2=min(body.most_am2, 1e3), schedules=made)


def model_of(orbit, kind=FieldKind.DIRECT_DIPOLE):
    """Orbit and field as a controller knows them, in ticks of a second."""
    circle = circular_orbit(orbit.altitude_km, orbit.inclination_deg, 0.0, 0.0, EPOCH_UNIX_S)
    return ephemeris_model(circle, EPOCH_UNIX_S, 1, kind, degree=4)


class Bench:
    """What the tests of the laws use."""

    Orbit, Body = Orbit, Body
    fly, fly_from_rest, inputs_at = staticmethod(fly), staticmethod(fly_from_rest), staticmethod(inputs_at)
    setpoint, config = staticmethod(setpoint), staticmethod(config)
    scheduled, model_of = staticmethod(scheduled), staticmethod(model_of)
    angles_deg = staticmethod(angles_deg)


@pytest.fixture(scope="session")
def bench():
    return Bench


@pytest.fixture(scope="session")
def turned():
    """The direction cosines of a frame turned by an angle about an axis: the transpose of scipy's."""

    def turned_by(axis, angle_deg):
        unit = np.array(axis) / np.linalg.norm(axis)
        return Rotation.from_rotvec(radians(angle_deg) * unit).as_matrix().T

    return turned_by


# --- a pitch wheel's axis, from a lean away from the orbit normal

PITCH_WHEEL_NMS = 0.05
WHEEL_INERTIA = np.diag([1.9, 1.95, 2.0])


class Lean:
    """A flight and what came of the wheel's axis."""

    def __init__(self, run, normal_eci, orbit_ticks):
        self.run = run
        self.lean_deg = run.axis_to_deg(2, normal_eci)
        self.orbit_ticks = orbit_ticks

    def most_deg(self, orbit):
        """The largest lean of an orbit, from 0."""
        return self.lean_deg[orbit * self.orbit_ticks : (orbit + 1) * self.orbit_ticks].max()

    def mean_angles_deg(self):
        """Yaw, roll and pitch on the mean of the last orbit."""
        c = self.run.c_body_from_orbit[-self.orbit_ticks :]
        s = np.stack([c[:, 1, 2] - c[:, 2, 1], c[:, 2, 0] - c[:, 0, 2], c[:, 0, 1] - c[:, 1, 0]], axis=1)
        return np.degrees(0.5 * s.mean(axis=0))


@pytest.fixture(scope="session")
def lean(bench, turned):
    """Fly a law with its gains from a turn about an axis, at a rate beside that of the orbit."""

    def fly(
        law,
        *,
        gains=None,
        angle_deg=10.0,
        axis=(1, 1, 0.3),
        relative=(0.0, 0.0, 0.0),
        inclination_deg=98.6,
        orbits=2.0,
        step_s=8.0,
        k_w=1e7,
        k_a=4000.0,
        k_i=0.0,
        **body,
    ):
        orbit, c0 = bench.Orbit(inclination_deg=inclination_deg), turned(axis, angle_deg)
        run = bench.fly(
            law,
            bench.setpoint(k_w=k_w, k_a=k_a, k_i=k_i),
            gains={law.__name__: gains},
            orbit=orbit,
            body=bench.Body(inertia=WHEEL_INERTIA, wheel=(0.0, 0.0, PITCH_WHEEL_NMS), **body),
            c_body_from_orbit=c0,
            omega_body=np.array(relative) + orbit.rate_radps * c0[:, 2],
            seconds=orbits * orbit.period_s,
            step_s=step_s,
        )
        return Lean(run, orbit.c_orbit_from_eci(0.0)[2], int(orbit.period_s / step_s))

    return fly
