"""Asymptotic periodic regulator: one cost matrix for the whole orbit, and the field as it is now.

As effort becomes costly, the periodic solution of the Riccati equation tends to a constant one, that of the
averaged reach of the coils,

    P = Q + F^T P (E + R P)^-1 F,     R = mean over an orbit of N N^T / effort,   N(b) = -G [b x].

The law puts the present field into N: nothing is tabulated over the orbit, and nothing but that field depends
on where the satellite is,

    m = -(N^T P N + effort E)^-1 N^T (P (F x + G d) + S d),   S = Fc^T (S + P G),   Fc = (E + R P)^-1 F.

x = (Omega, theta) and the torque d in orbital axes, as in ``riccati``. The source has the integral of the
error as states; here the torque that the filter estimates takes its place. The field is
the modelled one, as for every law with a usable attitude.

Source: Psiaki 2001, as in Ovchinnikov, Roldugin 2019, section 3.2, where the functional is damaged; the
discrete form is derived here from the step of ``riccati``.
"""

from dataclasses import dataclass

import numpy as np

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Mat3, Vec3, transform, transpose
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.lqr import (
    STEPS,
    LqrGains,
    balanced_pd,
    dipole,
    expected_torque,
    orbit_problem,
    within,
)
from fsw.core.laws.plan.riccati import Array, Problem, Schedule, orbit_cost, pushes_of


@dataclass(frozen=True, slots=True)
class AveragedGains(LqrGains):
    """Weights of rate and dipole against that of attitude, as for ``lqr``; the dipole's should be large."""

    effort: float = 1.0


def averaged_schedule(
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    orbit_rate_radps: float,
    inclination_rad: float,
    field_t: float,
    gains: AveragedGains,
) -> Schedule:
    """The constant (P S) in each step, and the gains on the direct dipole's field.

    Where nothing holds the body, as with a steady field along a free axis, P looks half an orbit ahead.
    """
    problem, b_orbit_t = orbit_problem(
        inertia_kgm2, wheel_body_nms, orbit_rate_radps, inclination_rad, field_t, gains
    )
    pushes = pushes_of(problem, b_orbit_t)
    reach = np.mean(pushes @ pushes.swapaxes(-1, -2), axis=0) / problem.effort
    f, g = problem.free[:, :6], problem.free[:, 6:]
    try:
        with np.errstate(all="ignore"):
            cost = orbit_cost(problem, np.broadcast_to(reach, (STEPS, 6, 6)))
    except np.linalg.LinAlgError:
        cost = np.full((6, 6), np.inf)  # grown beyond what can be inverted
    closed = _closed(f, reach, cost)
    if not np.isfinite(cost).all() or np.abs(np.linalg.eigvals(closed)).max() >= 1.0:
        cost = np.zeros((6, 6))
        for _ in range(STEPS // 2):
            cost = f.T @ cost @ _closed(f, reach, cost) + np.diag(problem.cost)
        closed = _closed(f, reach, cost)
    coupling = np.linalg.lstsq(np.eye(6) - closed.T, closed.T @ cost @ g, rcond=None)[0]
    both = np.hstack([0.5 * (cost + cost.T), coupling])
    tabulated = np.array([gain_at(problem, both, b) for b in b_orbit_t])
    return Schedule(problem, tabulated, np.broadcast_to(both, (STEPS, 6, 9)).copy())


def _closed(f: Array, reach: Array, cost: Array) -> Array:
    """Fc = (E + R P)^-1 F; 2 E, which is unstable, if P is not finite or the inverse does not exist."""
    if not np.isfinite(cost).all():
        return 2.0 * np.eye(6)
    bent = np.eye(6) + reach @ cost
    if not np.isfinite(bent).all() or np.linalg.matrix_rank(bent) < len(bent):
        return 2.0 * np.eye(6)
    return np.asarray(np.linalg.solve(bent, f), dtype=np.float64)


def gain_at(problem: Problem, both: Array, b_orbit_t: Array) -> Array:
    """The gain M(b) from (Omega, theta, d) to the dipole, orbital axes, shape (3, 9).

    Args:
        problem: step and effort.
        both: (P S), shape (6, 9).
        b_orbit_t: the field, orbital axes, T.
    """
    push = pushes_of(problem, b_orbit_t[None])[0]
    ahead = both[:, :6] @ problem.free
    ahead[:, 6:] += both[:, 6:]
    curvature = push.T @ both[:, :6] @ push + problem.effort * np.eye(3)
    return np.asarray(-np.linalg.solve(curvature, push.T @ ahead), dtype=np.float64)


def lqr_averaged(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The dipole M(b) (Omega, theta, d), b the field in orbital axes, d as for ``lqr``."""
    table = config.schedules.get("lqr_averaged")
    if not inputs.attitude.usable or inputs.reference is None or table is None:
        return Demand()
    back = transpose(dcm(inputs.attitude.q_body_from_orbit))
    gain = gain_at(table.problem, table.costs[0], np.array(transform(back, inputs.b_body_t)))
    wanted = dipole(gain.ravel().tolist(), inputs.attitude, expected_torque(inputs, table))
    return Demand(within(wanted, config.mean_dipole_am2))


LAWS = {
    "lqr_averaged": LawEntry(44, Aim.THREE_AXIS, balanced_pd, lqr_averaged, AveragedGains),
}
