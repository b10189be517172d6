"""The regulator against the worst disturbance: a game of the dipole with a torque, solved backwards in time.

As in ``riccati``, x+ = F x + G (d + w) - G [b x] m, with a torque w that is free in each step at the price

    gamma^2 |w / (w0^2 J_mean)|^2,

so that the sum of the cost over the steps is at most gamma^2 times that of w: gamma, in rad, bounds the root
mean square of the error relative to that of a torque in units of w0^2 J_mean, whatever its course. With the
stacked input v = (m, w), N = G (-[b x], E) and R = diag(effort E, -gamma^2 E / (w0^2 J_mean)^2) the step is

    v = -(N^T P N + R)^-1 N^T (P (F x + G d) + S d),

as for the regulator; it is a saddle where gamma^2 E / (w0^2 J_mean)^2 - G^T P G is positive definite. Without
bound on gamma it is the regulator, whose gain is also that of least H2 norm.

Source: Lovera 2000 and Zanchettin, Lovera 2011, as in Ovchinnikov, Roldugin 2019, section 3.2; the discrete
game: Basar, Bernhard 1995, chapter 3.
"""

import numpy as np

from fsw.core.laws.plan.riccati import SETTLED, Array, NotHeldError, Problem, orbit_cost, pushes_of


def game_backward(problem: Problem, b_orbit_t: Array, last: Array, price: float) -> tuple[Array, Array]:
    """Solve from the last step to the first, as ``riccati.backward``.

    Args:
        problem: the problem.
        b_orbit_t: field in the middle of each step, orbital axes, T, shape (n, 3).
        last: (P S) at the end of the last step, shape (6, 9).
        price: gamma^2 / (w0^2 J_mean)^2, of |w|^2, per (N m)^2.

    Returns:
        The gains of dipole and worst torque in each step, (n, 6, 9), and (P S) at the beginning of each.

    Raises:
        NotHeldError: the torque wins: gamma is too small.
    """
    gains, costs = np.empty((len(b_orbit_t), 6, 9)), np.empty((len(b_orbit_t), 6, 9))
    weights = np.diag(np.repeat([problem.effort, -price], 3))
    f, g = problem.free[:, :6], problem.free[:, 6:]
    pushes, ahead = pushes_of(problem, b_orbit_t), last
    for k in range(len(b_orbit_t) - 1, -1, -1):
        if np.linalg.eigvalsh(g.T @ ahead[:, :6] @ g)[-1] >= price:
            raise NotHeldError("the disturbance wins the game: gamma is too small")
        push = np.hstack([pushes[k], g])
        reached = ahead[:, :6] @ problem.free
        reached[:, 6:] += ahead[:, 6:]
        pushed = ahead[:, :6] @ push
        gain = -np.linalg.solve(push.T @ pushed + weights, push.T @ reached)
        ahead = f.T @ (reached + pushed @ gain)
        ahead[:, :6] += np.diag(problem.cost)
        gains[k], costs[k] = gain, ahead
    return gains, costs


def game_periodic(problem: Problem, b_orbit_t: Array, price: float) -> tuple[Array, Array]:
    """Solve for an orbit whose field repeats, as ``riccati.periodic``.

    Raises:
        NotHeldError: there is no saddle, or its motion is not stable.
    """
    f, g, pushes = problem.free[:, :6], problem.free[:, 6:], pushes_of(problem, b_orbit_t)
    reach = pushes @ pushes.swapaxes(-1, -2) / problem.effort - g @ g.T / price
    try:
        with np.errstate(all="ignore"):
            last = np.hstack([orbit_cost(problem, reach), np.zeros((6, 3))])
            if not np.isfinite(last).all():
                raise NotHeldError("there is no periodic saddle: gamma is too small")
            gains, costs = game_backward(problem, b_orbit_t, last, price)
            closed = np.eye(6)
            for push, gain in zip(pushes, gains, strict=True):
                closed = (f + np.hstack([push, g]) @ gain[:, :6]) @ closed
            last[:, 6:] = np.linalg.solve(np.eye(6) - closed.T, costs[0, :, 6:])
            gains, costs = game_backward(problem, b_orbit_t, last, price)
            change = np.abs(costs[0] - last).max(axis=0)
            settled = bool(np.all(change <= SETTLED * np.abs(last).max(axis=0)))
            stable = np.abs(np.linalg.eigvals(closed)).max() < 1.0
            positive = bool(np.linalg.eigvalsh(costs[0, :, :6])[0] > 0.0)
    except np.linalg.LinAlgError:
        settled = stable = positive = False
    if not (settled and stable and positive):
        raise NotHeldError("there is no periodic saddle: gamma is too small, or nothing holds this body")
    return gains, costs
