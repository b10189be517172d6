"""Torque at worst on a periodic loop: norms, PD gains that bear it best, control from the measured field.

Sources: Zanchettin, Lovera 2011; Kulkarni, Campbell 2004, as in Ovchinnikov, Roldugin 2019, section 3.2.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from fsw.core.laws.plan.game import game_periodic
from fsw.core.laws.plan.riccati import Array, NotHeldError, Problem, periodic, pushes_of, skews

# --- Norms of a periodic loop

FREQUENCIES = 33
"""Between zero and half an orbit's, at which the frequency response is taken."""


class Norms(NamedTuple):
    """In rad for a torque of w0^2 J_mean."""

    h2: float
    h_infinity: float


class UnstableLoopError(Exception):
    """The loop has no norms."""


def norms(
    problem: Problem, b_orbit_t: Array, gains: Array, unit_nm: float, frequencies: int = FREQUENCIES
) -> Norms:
    """The norms of a loop.

    The steps of ``fsw/core/laws/plan/riccati.py`` with a torque w in each,

        x+ = (F - G [b x] M) x + G w,    z = (Q^1/2 x, effort^1/2 M x),

    w in units of w0^2 J_mean. Over an orbit of n steps they are one step of a constant system from the n
    torques to the n errors (lifting); its H-infinity norm is the largest singular value of its frequency
    response, and the H2 norm the root of the mean square of z under white torque of unit variance.

    Source: Bittanti, Colaneri 2009, Periodic Systems, sections 6.2 (lifting) and 9.1 (norms).

    Args:
        problem: steps and weights.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).
        gains: M of each step, from (Omega, theta) to the dipole, orbital axes, shape (n, 3, 6).
        unit_nm: the torque that counts as one, w0^2 J_mean.
        frequencies: how many are taken.

    Raises:
        UnstableLoopError: a motion of the loop does not decay.
    """
    f, g = problem.free[:, :6], unit_nm * problem.free[:, 6:]
    closed = f + pushes_of(problem, b_orbit_t) @ gains
    seen = np.concatenate(
        [
            np.broadcast_to(np.diag(np.sqrt(problem.cost)), (len(gains), 6, 6)),
            np.sqrt(problem.effort) * gains,
        ],
        axis=1,
    )
    whole, driven, observed, direct = _lifted(closed, g, seen)
    if np.abs(np.linalg.eigvals(whole)).max() >= 1.0:
        raise UnstableLoopError("the loop is not stable")
    return Norms(_h2(closed, g, seen, whole), _h_infinity(whole, driven, observed, direct, frequencies))


def _lifted(closed: Array, g: Array, seen: Array) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of an orbit as one step."""
    steps = len(closed)
    state, reach = np.eye(6), np.zeros((6, 3 * steps))
    observed, direct = np.zeros((steps, 9, 6)), np.zeros((steps, 9, 3 * steps))
    for k in range(steps):
        observed[k], direct[k] = seen[k] @ state, seen[k] @ reach
        state, reach = closed[k] @ state, closed[k] @ reach
        reach[:, 3 * k : 3 * k + 3] = g
    return state, reach, observed.reshape(-1, 6), direct.reshape(9 * steps, -1)


def _h2(closed: Array, g: Array, seen: Array, whole: Array) -> float:
    """The root of the mean over the steps of the trace of z's covariance."""
    driven = np.zeros((6, 6))
    for step in closed:
        driven = step @ driven @ step.T + g @ g.T
    scale = np.sqrt(np.diag(driven))
    scaled, motion = driven / np.outer(scale, scale), whole * scale / scale[:, None]
    flat = np.linalg.solve(np.eye(36) - np.kron(motion, motion), scaled.ravel())
    covariance, total = flat.reshape(6, 6) * np.outer(scale, scale), 0.0
    for step, sees in zip(closed, seen, strict=True):
        total += float(np.trace(sees @ covariance @ sees.T))
        covariance = step @ covariance @ step.T + g @ g.T
    return float(np.sqrt(total / len(closed)))


def _h_infinity(whole: Array, driven: Array, observed: Array, direct: Array, frequencies: int) -> float:
    """The largest singular value over the frequencies."""
    largest = 0.0
    for angle in np.linspace(0.0, np.pi, frequencies):
        response = direct + observed @ np.linalg.solve(np.exp(1j * angle) * np.eye(6) - whole, driven)
        largest = max(largest, float(np.linalg.eigvalsh(response.conj().T @ response)[-1]))
    return float(np.sqrt(largest))


# --- Gains of the PD law with the least H-infinity norm

ROUGH = 9
"""Frequencies during the search."""
EVALUATIONS = 80
UNSTABLE = 1e6
"""Stands for the norm of a loop that has none."""


class PdDesign(NamedTuple):
    """Gains, N m s / T^2 and N m / T^2, and the norms of their loop."""

    k_w: float
    k_a: float
    norms: Norms


def pd_tabulated(b_orbit_t: Array, k_w: float, k_a: float) -> Array:
    """The PD law as gains of each step, from (Omega, theta) to the dipole, orbital axes, (n, 3, 6)."""
    across = skews(b_orbit_t)
    return np.concatenate([-k_w * across, -2.0 * k_a * across], axis=2)


def best_pd(problem: Problem, b_orbit_t: Array, unit_nm: float, start: tuple[float, float]) -> PdDesign:
    """The pair of gains with the least H-infinity norm near a pair that is stable.

        m = -b x (k_w Omega + 2 k_a theta)

    is the structured law among those of ``norms``: for each pair of gains the loop has a norm, and the pair
    with the least one bears every torque with the least error. The norm is flat about its least value, and
    the search is by the simplex of Nelder and Mead over the logarithms of the gains.

    Source: Zanchettin, Lovera 2011, as in Ovchinnikov, Roldugin 2019, section 3.2: there by a randomised
    search.

    Raises:
        UnstableLoopError: no pair that was tried is stable.
    """

    def norm(logarithms: Array) -> float:
        k_w, k_a = np.exp(logarithms)
        try:
            return norms(problem, b_orbit_t, pd_tabulated(b_orbit_t, k_w, k_a), unit_nm, ROUGH).h_infinity
        except UnstableLoopError:
            return UNSTABLE

    found = minimize(
        norm,
        np.log(start),
        method="Nelder-Mead",
        options={"maxfev": EVALUATIONS, "xatol": 1e-2, "fatol": 1e-4},
    )
    k_w, k_a = np.exp(found.x).tolist()
    return PdDesign(k_w, k_a, norms(problem, b_orbit_t, pd_tabulated(b_orbit_t, k_w, k_a), unit_nm))


# --- Control from the measured field: models of measurement and disturbance in one game

ORBITS = 60
"""After which the estimate's matrix has settled."""
SETTLED = 1e-6
HALVINGS = 7
"""Of the interval in which the least gamma lies."""


@dataclass(frozen=True, slots=True)
class Measured:
    """What is controlled, and by what.

    Attributes:
        problem: steps and weights.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).
        torque_nm: w of one, N m.
        error_t: v of one, T.
    """

    problem: Problem
    b_orbit_t: Array
    torque_nm: float
    error_t: float

    def sees(self) -> Array:
        """H of each step, (n, 3, 6)."""
        return np.concatenate([np.zeros((len(self.b_orbit_t), 3, 3)), skews(self.b_orbit_t)], axis=2)


class Controller(NamedTuple):
    """xi+ = motion xi + feedback y, m = gains xi, of each step: (n, 6, 6), (n, 6, 3), (n, 3, 6)."""

    motion: Array
    feedback: Array
    gains: Array


def central_controller(case: Measured, gamma: float) -> Controller:
    """The controller for a bound.

    The steps of ``fsw/core/laws/plan/riccati.py`` with a torque w and an error v of the field in each,

        x+ = F x - G [b x] m + G w,    y = [b x] theta + v,    z = (Q^1/2 x, effort^1/2 m),

    w in units of a torque, v in units of an error. The dipole of a step knows y up to the step before. With P
    and M of the game that knows the state (``game``), the estimate xi and its Sigma are

        Sigma+ = F S F^T + G G^T torque^2,    S = (Sigma^-1 + H^T H / error^2 - Q / gamma^2)^-1,
        xi+ = F xi - G [b x] m + F S (Q xi / gamma^2 + H^T (y - H xi) / error^2),
        m = M (E - Sigma P / gamma^2)^-1 xi,    H = (0, [b x]),

    as long as U = Sigma^-1 - Q / gamma^2 and gamma^2 E - (F U^-1 F^T + G G^T torque^2) P+ are positive: the
    worst is finite though the field of a step tells nothing. Then the sum of |z|^2 stays under gamma^2 times
    that of |w|^2 + |v|^2. A large gamma leaves the Kalman filter with the regulator (LQG).

    Source: Kulkarni, Campbell 2004, as in Ovchinnikov, Roldugin 2019, section 3.2, where the method is named;
    the equations: Basar, Bernhard 1995, chapter 6 (delayed measurement).

    Args:
        case: what is controlled.
        gamma: the bound; infinite: LQG.

    Raises:
        NotHeldError: gamma is too small, or nothing holds the body.
    """
    problem, f = case.problem, case.problem.free[:, :6]
    pays = (gamma / case.torque_nm) ** 2
    told_all = problem, case.b_orbit_t
    gains, costs = periodic(*told_all) if gamma == np.inf else game_periodic(*told_all, pays)
    pushes, sees, share = pushes_of(problem, case.b_orbit_t), case.sees(), np.diag(problem.cost) / gamma**2
    sigmas, shrunk, unseen = _estimates(case, share)
    motion, observed, answers = (
        np.empty_like(sigmas),
        np.empty((len(pushes), 6, 3)),
        np.empty((len(pushes), 3, 6)),
    )
    for k, push in enumerate(pushes):
        after = unseen[k] @ costs[(k + 1) % len(pushes), :, :6] / gamma**2
        if np.abs(np.linalg.eigvals(after)).max() >= 1.0:
            raise NotHeldError("estimate and control do not go together: gamma is too small")
        answers[k] = gains[k, :3, :6] @ np.linalg.inv(np.eye(6) - sigmas[k] @ costs[k, :, :6] / gamma**2)
        observed[k] = f @ shrunk[k] @ sees[k].T / case.error_t**2
        motion[k] = f + push @ answers[k] + f @ shrunk[k] @ share - observed[k] @ sees[k]
    return Controller(motion, observed, answers)


def _estimates(case: Measured, share: Array) -> tuple[Array, Array, Array]:
    """Sigma before each step, S in it, Sigma after it without its field, orbit by orbit until they repeat."""
    f, g = case.problem.free[:, :6], case.torque_nm * case.problem.free[:, 6:]
    shape = (len(case.b_orbit_t), 6, 6)
    sigmas, shrunk, unseen = np.empty(shape), np.empty(shape), np.empty(shape)
    size = np.repeat([1.0 / case.problem.step_s, 1.0], 3)  # rates and angles of one size
    sizes = np.outer(size, size)
    sigma = 1e-4 * np.diag(size**2)
    for _ in range(ORBITS):
        before = sigma
        for k, h in enumerate(case.sees()):
            sigmas[k] = sigma
            without = np.linalg.inv(sigma / sizes) - share * sizes
            if np.linalg.eigvalsh(without)[0] <= 0.0:
                raise NotHeldError("the estimate is lost: gamma is too small")
            shrunk[k] = np.linalg.inv(without + h.T @ h / case.error_t**2 * sizes) * sizes
            unseen[k] = f @ (np.linalg.inv(without) * sizes) @ f.T + g @ g.T
            sigma = f @ shrunk[k] @ f.T + g @ g.T
            sigma = 0.5 * (sigma + sigma.T)
        if np.abs(sigma - before).max() <= SETTLED * np.abs(sigma).max():
            return sigmas, shrunk, unseen
    raise NotHeldError("the estimate does not repeat: gamma is too small")


def least_gamma(case: Measured, low: float, high: float) -> tuple[float, Controller]:
    """About the least gamma for which there is a controller, and that.

    Args:
        case: what is controlled.
        low: a gamma that is too small.
        high: one for which there is a controller.

    Raises:
        NotHeldError: there is none for ``high``.
    """
    found = high, central_controller(case, high)
    for _ in range(HALVINGS):
        middle = float(np.sqrt(low * found[0]))
        try:
            found = middle, central_controller(case, middle)
        except NotHeldError:
            low = middle
    return found


def measured_norm(case: Measured, controller: Controller, frequencies: int = FREQUENCIES) -> float:
    """The H-infinity norm from (w, v) to z of the closed loop, by lifting as in ``norms``.

    Raises:
        UnstableLoopError: a motion of the loop does not decay.
    """
    problem, pushes, sees = case.problem, pushes_of(case.problem, case.b_orbit_t), case.sees()
    steps, scale = len(pushes), np.tile(np.repeat([1.0 / problem.step_s, 1.0], 3), 2)
    state, reach = np.eye(12), np.zeros((12, 6 * steps))
    observed, direct = np.zeros((steps, 9, 12)), np.zeros((steps, 9, 6 * steps))
    for k in range(steps):
        step = np.block(
            [
                [problem.free[:, :6], pushes[k] @ controller.gains[k]],
                [controller.feedback[k] @ sees[k], controller.motion[k]],
            ]
        )
        seen = np.zeros((9, 12))
        seen[:6, :6] = np.diag(np.sqrt(problem.cost))
        seen[6:, 6:] = np.sqrt(problem.effort) * controller.gains[k]
        observed[k], direct[k] = seen * scale @ state, seen * scale @ reach
        step = step * scale / scale[:, None]
        state, reach = step @ state, step @ reach
        reach[:6, 6 * k : 6 * k + 3] = case.torque_nm * problem.free[:, 6:] / scale[:6, None]
        reach[6:, 6 * k + 3 : 6 * k + 6] = case.error_t * controller.feedback[k] / scale[6:, None]
    if np.abs(np.linalg.eigvals(state)).max() >= 1.0:
        raise UnstableLoopError("the loop is not stable")
    largest = 0.0
    for angle in np.linspace(0.0, np.pi, frequencies):
        motion = np.linalg.solve(np.exp(1j * angle) * np.eye(12) - state, reach)
        response = direct.reshape(9 * steps, -1) + observed.reshape(-1, 12) @ motion
        largest = max(largest, float(np.linalg.norm(response, 2)))
    return largest
