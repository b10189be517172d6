"""Periodic linear-quadratic regulator: the dipole of least cost over all time, in the direct dipole's field.

The gain M(u) is tabulated over the argument of latitude u of an orbit, from the controller's own inertia and
orbit, once, when the onboard table is loaded. The law uses the constant torque that the filter estimates: a
dipole cannot cancel it, but there is a periodic motion with the least error, and the law leads to it. M gives
the total dipole: effort is charged for it, residual dipole included, so that the coils' is that less the
residual, whatever the field to come. Were only the coils' effort charged, a residual dipole would be left to
act where that is cheap, and pointing would be worse.

Source: Ovchinnikov, Roldugin 2019, section 3.2; the equations stand in ``riccati``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, pi, sin
from typing import Protocol

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, dcm
from fsw.core.algebra.vector import Mat3, Vec3, add, cross, scale, sub, transform, transpose
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import driven_momentum
from fsw.core.laws.pd import pd_far
from fsw.core.laws.plan.riccati import (
    E3,
    Array,
    NotHeldError,
    Problem,
    Schedule,
    backward,
    periodic,
    regulator_problem,
)
from fsw.core.laws.projection import torque_dipole
from fsw.core.orbit.ephemeris import Reference

STEPS = 48
"""Steps per orbit: about two minutes each, little more than the pulses are apart."""


@dataclass(frozen=True, slots=True)
class LqrGains:
    """Weights of rate and dipole against that of attitude, as in ``riccati.regulator_problem``."""

    rate: float = 0.0
    effort: float = 0.1

    def __post_init__(self) -> None:
        """Check what the equations need.

        Raises:
            ValueError: a weight out of range.
        """
        check_weights(self.rate, self.effort)


def check_weights(rate: float, effort: float) -> None:
    """Check that the weights are in range.

    Raises:
        ValueError: a weight out of range.
    """
    if not (0.0 <= rate <= 1e6 and 1e-6 <= effort <= 1e6):
        raise ValueError(f"rate must be 0 to 1e6 and effort 1e-6 to 1e6, not {rate:g} and {effort:g}")


class CostWeights(Protocol):
    """What the cost of a law is made of."""

    @property
    def rate(self) -> float:
        """Weight of a rate of w0, against that of a radian."""

    @property
    def effort(self) -> float:
        """Weight of the dipole that accelerates the mean moment by w0^2, against that of a radian."""


def middles() -> Array:
    """The arguments of latitude in the middle of the steps, rad."""
    u: Array = 2.0 * pi / STEPS * (np.arange(STEPS, dtype=np.float64) + 0.5)
    return u


def orbit_problem(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    inclination_rad: float,
    field_t: float,
    weights: CostWeights,
) -> tuple[Problem, Array]:
    """The problem of a step, and the direct dipole's field in the middle of each, orbital axes, T, (n, 3).

    Arguments: as for ``schedule``.
    """
    u = middles()
    across, along = sin(inclination_rad), np.full(STEPS, cos(inclination_rad))
    b_orbit_t = field_t * np.stack([-2.0 * across * np.sin(u), across * np.cos(u), along], axis=-1)
    step_s = 2.0 * pi / STEPS / orbit_rate_radps
    problem = regulator_problem(
        inertia_kgm2, wheel_body_nms, orbit_rate_radps, field_t, step_s, weights.rate, weights.effort
    )
    return problem, b_orbit_t


def schedule(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    inclination_rad: float,
    field_t: float,
    weights: CostWeights,
) -> Schedule:
    """The periodic solution on the direct dipole's field of a circular orbit.

    Where none holds the body, as on an equatorial orbit with its steady field, the schedule looks one to two
    orbits ahead: it holds what can be held.

    Args:
        inertia_kgm2: J, body axes.
        wheel_body_nms: momentum of a wheel, body axes.
        orbit_rate_radps: w0.
        inclination_rad: of the orbit.
        field_t: B0 = mu_e / r^3, the field above the equator.
        weights: of the cost.
    """
    problem, b_orbit_t = orbit_problem(
        inertia_kgm2, wheel_body_nms, orbit_rate_radps, inclination_rad, field_t, weights
    )
    try:
        gains, costs = periodic(problem, b_orbit_t)
    except NotHeldError:
        gains, costs = backward(problem, np.concatenate([b_orbit_t, b_orbit_t]), np.zeros((6, 9)))
    return Schedule(problem, gains[:STEPS], costs[:STEPS])


def latitude_argument(reference: Reference) -> float:
    """The argument of latitude u, rad, -pi to pi: axes 1 and 2 rise by sin u sin i and cos u sin i."""
    (_, _, rise), (_, _, climb), _ = dcm(reference.q_orbit_from_eci)
    return atan2(rise, climb)


def node(u_rad: float) -> int:
    """The step of the table in which an argument of latitude lies."""
    return int(u_rad % (2.0 * pi) * STEPS / (2.0 * pi)) % STEPS


def dipole(gain: Sequence[float], attitude: Attitude, torque_body_nm: Vec3) -> Vec3:
    """The dipole M (Omega, theta, d), body axes, A m^2.

    Args:
        gain: M, three rows of nine one after the other, orbital axes.
        attitude: theta is 2 qv of its quaternion.
        torque_body_nm: d, body axes.
    """
    state = orbital_state(attitude, torque_body_nm)
    return transform(
        dcm(attitude.q_body_from_orbit),
        (_product(gain[0:9], state), _product(gain[9:18], state), _product(gain[18:27], state)),
    )


def orbital_state(attitude: Attitude, torque_body_nm: Vec3) -> tuple[float, ...]:
    """(Omega, theta, d), orbital axes: nine numbers."""
    back = transpose(dcm(attitude.q_body_from_orbit))
    omega = transform(back, attitude.omega_body_orbit_radps)
    return (*omega, *rotation(attitude.q_body_from_orbit), *transform(back, torque_body_nm))


def _product(row: Sequence[float], state: tuple[float, ...]) -> float:
    total = 0.0
    for factor, value in zip(row, state, strict=True):
        total += factor * value
    return total


def rotation(q_body_from_orbit: Quaternion) -> Vec3:
    """The turn theta = 2 qv for a scalar part >= 0, rad: the same components in orbital and in body axes."""
    q0, q1, q2, q3 = q_body_from_orbit
    factor = 2.0 if q0 >= 0.0 else -2.0
    return (factor * q1, factor * q2, factor * q3)


def within(m_body_am2: Vec3, most_am2: float) -> Vec3:
    """The dipole, scaled down so that no component exceeds ``most_am2``."""
    largest = max(abs(component) for component in m_body_am2)
    return scale(most_am2 / largest, m_body_am2) if largest > most_am2 else m_body_am2


def lqr(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The dipole M(u) (Omega, theta, d), d the estimated torque and what rests on the nominal attitude."""
    return by_schedule(inputs, config.schedules.get("lqr"), config)


def by_schedule(inputs: LawInput, table: Schedule | None, config: ControlConfig) -> Demand:
    """The dipole by the gain tabulated for this argument of latitude; nothing without what it needs."""
    if not inputs.attitude.usable or inputs.reference is None or table is None:
        return Demand()
    gain = table.gains[node(latitude_argument(inputs.reference))].ravel().tolist()
    return Demand(
        within(dipole(gain, inputs.attitude, expected_torque(inputs, table)), config.mean_dipole_am2)
    )


def expected_torque(inputs: LawInput, table: Schedule) -> Vec3:
    """The constant torque that the plan allows for, body axes, N m."""
    return add(inputs.torque_body_nm, table.problem.resting_nm)


def exact_torque(inputs: LawInput, reference: Reference, table: Schedule, config: ControlConfig) -> Vec3:
    """The same with that of a driven wheel on the nominal attitude, -w0 e3 x h, body axes, N m.

    For a law that has this wheel in its motion; in the tables there is only the one at constant speed.
    """
    turned_nm = scale(-reference.orbit_rate_radps, cross(E3, driven_momentum(inputs, config)))
    return add(expected_torque(inputs, table), turned_nm)


def balanced_pd(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """Far from the goal: the PD law's far form, less the estimated torque; no memory for the law near it.

    Within the limits of ``acquisition_error`` the attitude's term cannot balance a torque that takes a third
    of what the coils give.
    """
    wanted_am2 = pd_far(inputs, (), setpoint, config).m_body_am2
    if not inputs.attitude.usable:
        return Demand()
    return Demand(sub(wanted_am2, torque_dipole(inputs.torque_body_nm, inputs.b_body_t)))


LAWS = {
    "lqr": LawEntry(40, Aim.THREE_AXIS, balanced_pd, lqr, LqrGains),
}
