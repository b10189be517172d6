"""Periodic H2 control from the magnetometer alone: a periodic Kalman filter and the periodic regulator.

The measured field b shows a small rotation theta, with B the field of the model in orbital axes, by

    y = b - B = [B x] theta + v,    x = (Omega, theta),    x+ = F x + G (d_rest + w) - G [b x] m,

v and w white, d_rest the torque on the nominal attitude. The covariance of the estimate after the field of
step k is periodic, Sigma(u), and the estimate follows y by

    dx/dt = F-motion + Sigma(u) H^T (y - H x) / (v^2 step),     H = (0, [B x]).

The dipole is that of ``lqr`` for the estimated state. Of all linear laws that see b alone, filter and
regulator together leave the least mean square of theta and dipole: least H2 norm from (w, v). The estimate
begins at rest in the nominal attitude, and the angles must be small: 30 deg about an axis across B move b by
13 % along B too, which the linear model does not have.

Source: Wisniewski, Stoustrup 2001, as in Ovchinnikov, Roldugin 2019, section 3.2. The review has no equation:
they are the periodic separation theorem for the step of ``riccati``.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from fsw.core.algebra.quaternion import from_small_rotation, rotate
from fsw.core.algebra.vector import Mat3, Vec3, add, cross, norm, sub
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    LqrGains,
    dipole,
    latitude_argument,
    node,
    orbit_problem,
    schedule,
    within,
)
from fsw.core.laws.plan.riccati import Array, Problem, Schedule, free_step, skews

ORBITS = 60
"""Largest number until the covariance has settled."""
SETTLED = 1e-6
"""Relative change in an orbit at which it counts as settled."""
FIRST_RAD = 1.0
"""Uncertainty of the attitude with which the covariance begins; that of the rate is w0 times this, rad/s."""


@dataclass(frozen=True, slots=True)
class FieldOnlyGains(LqrGains):
    """Weights as for ``lqr``, and what the filter assumes of field and torque.

    Attributes:
        noise: root mean square error of the field averaged over a step (1/48 orbit), relative to B0.
        torque: root mean square of the unknown torque of a step, relative to w0^2 J_mean.
    """

    effort: float = 1.0
    noise: float = 0.01
    torque: float = 0.05

    def __post_init__(self) -> None:
        """Check what the equations need.

        Raises:
            ValueError: a weight or an intensity out of range.
        """
        LqrGains.__post_init__(self)
        if not (1e-6 <= self.noise <= 10.0 and 1e-6 <= self.torque <= 100.0):
            raise ValueError(
                f"noise must be 1e-6 to 10 and torque 1e-6 to 100, not {self.noise:g} and {self.torque:g}"
            )


def field_only_schedule(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    inclination_rad: float,
    field_t: float,
    gains: FieldOnlyGains,
) -> Schedule:
    """The regulator of ``lqr`` and, as observer, Sigma / (v^2 step) of each step."""
    orbit = (inertia_kgm2, wheel_body_nms, orbit_rate_radps, inclination_rad, field_t)
    problem, b_orbit_t = orbit_problem(*orbit, gains)
    torque_nm = gains.torque * orbit_rate_radps**2 * float(np.trace(np.array(inertia_kgm2))) / 3.0
    noise_t = gains.noise * field_t
    first = FIRST_RAD * np.repeat([orbit_rate_radps, 1.0], 3)
    sigma = covariances(problem, b_orbit_t, torque_nm, noise_t, np.diag(first * first))
    plain = schedule(*orbit, gains)
    return Schedule(problem, plain.gains, plain.costs, sigma / (noise_t * noise_t * problem.step_s))


def covariances(problem: Problem, b_orbit_t: Array, torque_nm: float, noise_t: float, first: Array) -> Array:
    """Sigma after the field of each step, (n, 6, 6), propagated orbit by orbit until it repeats.

    Args:
        problem: the problem.
        b_orbit_t: field in each step, orbital axes, T, shape (n, 3).
        torque_nm: root mean square of the torque of a step.
        noise_t: root mean square of the field's error in a step.
        first: Sigma before the first step.
    """
    f, g = problem.free[:, :6], problem.free[:, 6:]
    driven = torque_nm * torque_nm * g @ g.T
    h = np.zeros((len(b_orbit_t), 3, 6))
    h[:, :, 3:] = skews(b_orbit_t)
    found, sigma = np.empty((len(b_orbit_t), 6, 6)), first
    for _ in range(ORBITS):
        before = found[-1].copy()
        for k, seen in enumerate(h):
            across = sigma @ seen.T
            gained = across @ np.linalg.solve(seen @ across + noise_t * noise_t * np.eye(3), across.T)
            found[k] = 0.5 * (sigma - gained + (sigma - gained).T)
            sigma = f @ found[k] @ f.T + driven
        if np.abs(found[-1] - before).max() <= SETTLED * np.abs(found[-1]).max():
            break
    return found


def lqg_field(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The regulator on the state estimated from the field; memory: tick, state and dipole given, 10 numbers.

    After a gap of more than a step of the table the estimate begins anew.
    """
    table, reference = config.schedules.get("lqg_field"), inputs.reference
    if reference is None or table is None or norm(reference.b_eci_t) == 0.0:
        return Demand()
    b_orbit = rotate(reference.q_orbit_from_eci, reference.b_eci_t)
    step = node(latitude_argument(reference))
    seconds = (inputs.tick - memory[0]) * config.tick_s if len(memory) == 10 else 0.0
    if not 0.0 < seconds <= table.problem.step_s:
        x, seconds = np.zeros(6), config.tick_s
    else:
        m1, m2, m3 = memory[7:]
        x = _moved(np.array(memory[1:7]), (m1, m2, m3), b_orbit, seconds, table, config)
    if inputs.sample.tick == inputs.tick:
        x = _corrected(x, inputs.sample.b_body_t, b_orbit, seconds, table.observer[step])
    w1, w2, w3, t1, t2, t3 = x.tolist()
    q = from_small_rotation((t1, t2, t3))
    attitude = Attitude(q, rotate(q, (w1, w2, w3)), 0.0, 0.0, True)
    m = within(
        dipole(table.gains[step].ravel().tolist(), attitude, table.problem.resting_nm),
        config.mean_dipole_am2,
    )
    back = rotate((q[0], -q[1], -q[2], -q[3]), m)
    return Demand(m, memory=(float(inputs.tick), *x.tolist(), *back))


def _moved(
    x: Array, m_orbit_am2: Vec3, b_orbit: Vec3, seconds: float, table: Schedule, config: ControlConfig
) -> Array:
    """The state after ``seconds`` under the dipole given and the torque on the nominal attitude."""
    w0 = 2.0 * pi / STEPS / table.problem.step_s
    free = free_step(config.inertia_kgm2, config.wheel_body_nms, w0, seconds)
    torque_nm = add(cross(m_orbit_am2, b_orbit), table.problem.resting_nm)
    moved: Array = free @ np.concatenate([x, torque_nm])
    return moved


def _corrected(x: Array, b_body_t: Vec3, b_orbit: Vec3, seconds: float, observer: Array) -> Array:
    """The state corrected by a field sample that stands for ``seconds``."""
    h = np.zeros((3, 6))
    h[:, 3:] = skews(np.array(b_orbit))
    innovation = np.array(sub(b_body_t, b_orbit)) - h @ x
    corrected: Array = x + seconds * observer @ (h.T @ innovation)
    return corrected


LAWS = {
    "lqg_field": LawEntry(47, Aim.THREE_AXIS, lqg_field, lqg_field, FieldOnlyGains),
}
