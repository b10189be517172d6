"""Periodic linear-quadratic regulator of the dipole on the direct dipole's field.

The linearised motion of ``linear`` under a dipole m, x' = A x + B(u) v with v = m B0 / w0^2 and
B = J^-1 (-[B x]) in the rows of w, and the cost, the integral over u of

    rate |w|^2 + attitude |theta|^2 + integral |xi|^2 + effort |v / J|^2      (J the mean moment)

The periodic solution of the Riccati equation is reached from the end of many orbits backwards. A step is
exact: with Phi the transition matrix of the Hamiltonian system, P_k = (Phi22 - P Phi12)^-1 (P Phi11 - Phi21).

A known constant disturbance torque is added as uncontrollable states. Their own block of P grows without
bound and does not affect the gains; the blocks of the motion and of the coupling converge.

Source: Bittanti, Colaneri 2009, Periodic Systems; the step: Schiff, Shnider 1999.
"""

from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from math import pi

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import degree_of_stability, monodromy, transitions
from sim.design.theory.linear import Gains, System, dipole_field, free_motion, skew
from sim.value_types import Array

NODES = 128
"""Nodes an orbit."""
EFFORTS = np.geomspace(1e-2, 1e2, 17)
"""Efforts among which ``best_effort`` looks."""
ORBITS = 400
BEYOND = 1e100
"""A solution beyond it has diverged."""
CONVERGED = 1e-10
"""Relative change of the gain over an orbit."""


class Augmented(Enum):
    """The states of the law beside rate and attitude."""

    NOTHING = "nothing"
    INTEGRAL = "integral of theta"
    TORQUE = "constant disturbance torque"


@dataclass(frozen=True, slots=True)
class Weights:
    """Weights of the cost, as in the head of this module."""

    rate: float = 1.0
    attitude: float = 1.0
    integral: float = 0.1
    effort: float = 1.0


@dataclass(frozen=True, slots=True)
class PeriodicLaw:
    """A periodic law, m = K(u) x.

    Attributes:
        u_rad: arguments of latitude of the nodes, 2 pi k / N, shape (N,).
        gain: K at the nodes, (N, 3, 6 or 9): from (Omega [rad/s], theta [rad]) and then, where augmented, the
            integral of theta [rad s] or the disturbance torque [N m], body axes, to the dipole [A m^2], body
            axes. The sign is in K; theta is half of S.
        augmented: what the last three columns are of.
    """

    u_rad: Array
    gain: Array
    augmented: Augmented


class NotConvergedError(Exception):
    """The Riccati equation has no periodic solution that stabilises, or not within ``ORBITS``."""


def design(
    body: Body, weights: Weights | None = None, augmented: Augmented = Augmented.NOTHING, nodes: int = NODES
) -> PeriodicLaw:
    """The periodic regulator.

    Raises:
        NotConvergedError: the gains did not converge, for instance as the dipole cannot turn all axes.
    """
    chosen = weights or Weights()
    a, cost = _motion(body, augmented), _cost(chosen, augmented)
    n = len(a)
    effort = chosen.effort / (float(np.trace(np.asarray(body.inertia_kgm2))) / 3.0) ** 2

    def hamiltonian(u: Array) -> Array:
        b = _actuation(u, body, n)
        whole = np.zeros((*u.shape, 2 * n, 2 * n))
        whole[..., :n, :n] = a
        whole[..., :n, n:] = -b @ b.swapaxes(-1, -2) / effort
        whole[..., n:, :n] = -cost
        whole[..., n:, n:] = -a.T
        return whole

    riccati = _periodic_riccati(transitions(hamiltonian, nodes), n)
    u = 2.0 * pi / nodes * np.arange(nodes, dtype=np.float64)
    w0, scale = body.rate_radps, body.rate_radps**2 / body.field_t
    third = {Augmented.INTEGRAL: w0, Augmented.TORQUE: 1.0 / w0**2}.get(augmented, 1.0)
    of_si = np.repeat([1.0 / w0, 1.0, third], 3)[:n]
    gain: Array = -scale / effort * _actuation(u, body, n).swapaxes(-1, -2) @ riccati * of_si
    return PeriodicLaw(u, gain, augmented)


def best_effort(body: Body, augmented: Augmented = Augmented.NOTHING) -> tuple[Weights, float]:
    """The weights, among ``EFFORTS``, whose loop has the least degree of stability, and that degree.

    Raises:
        NotConvergedError: there is no law with any of them.
    """
    laws = []
    for effort in EFFORTS:
        weights = Weights(effort=float(effort))
        with suppress(NotConvergedError):
            law = design(body, weights, augmented)
            laws.append((float(degree_of_stability(monodromy(closed_loop(body, law)))), weights))
    if not laws:
        raise NotConvergedError("there is no periodic regulator with any of the efforts tried")
    degree, weights = min(laws, key=lambda one: one[0])
    return weights, degree


def closed_loop(body: Body, law: PeriodicLaw) -> System:
    """The matrix A(u) of the motion under a periodic law, the gain between its nodes by Fourier's series.

    Six states, or nine with the integral of theta; a known disturbance does not change stability.
    """
    size = 9 if law.augmented is Augmented.INTEGRAL else 6
    free = free_motion(body, size)
    w0, scale = body.rate_radps, body.field_t / body.rate_radps**2
    to_si = np.repeat([w0, 1.0, 1.0 / w0], 3)[:size]
    nodes = len(law.u_rad)
    series = np.fft.rfft(scale * law.gain[..., :size] * to_si, axis=0) / nodes
    orders = np.arange(len(series))
    series[1 : (nodes + 1) // 2] *= 2.0

    def matrix(u: Array) -> Array:
        gain = np.tensordot(np.exp(1j * u[:, None] * orders), series, axes=1).real
        whole: Array = free + _actuation(u, body, size) @ gain
        return whole

    return matrix


def _motion(body: Body, augmented: Augmented) -> Array:
    """The constant matrix of the motion and of the known disturbance."""
    if augmented is not Augmented.TORQUE:
        return free_motion(body, 9 if augmented is Augmented.INTEGRAL else 6)
    matrix = np.zeros((9, 9))
    matrix[:6, :6] = free_motion(body)
    matrix[:3, 6:] = np.linalg.inv(np.asarray(body.inertia_kgm2))
    return matrix


def _cost(weights: Weights, augmented: Augmented) -> Array:
    third = {Augmented.NOTHING: [], Augmented.INTEGRAL: [weights.integral], Augmented.TORQUE: [0.0]}
    return np.diag(np.repeat([weights.rate, weights.attitude, *third[augmented]], 3))


def _actuation(u: Array, body: Body, size: int) -> Array:
    """B(u), shape (k, n, 3)."""
    whole = np.zeros((*u.shape, size, 3))
    whole[..., :3, :] = -np.linalg.inv(np.asarray(body.inertia_kgm2)) @ skew(dipole_field(u, body))
    return whole


def _periodic_riccati(steps: Array, n: int) -> Array:
    """The periodic solution at the nodes, (N, n, n), from the Hamiltonian system's transition matrices."""
    solution = np.zeros((len(steps), n, n))
    p, motion = np.zeros((n, n)), slice(0, 6)
    for _ in range(ORBITS):
        before = solution[0, motion].copy()
        for k in range(len(steps) - 1, -1, -1):
            phi = steps[k]
            p = np.linalg.solve(phi[n:, n:] - p @ phi[:n, n:], p @ phi[:n, :n] - phi[n:, :n])
            p = 0.5 * (p + p.T)
            solution[k] = p
        change, size = np.abs(solution[0, motion] - before).max(), np.abs(solution[0, motion]).max()
        if not size < BEYOND:
            break
        if change <= CONVERGED * size:
            return solution
    raise NotConvergedError("the periodic Riccati equation did not converge")


# --- Gains of the PD law that come nearest to the regulator


def lqr_gains(body: Body, effort: float = 1.0) -> Gains:
    """The PD gains nearest to the regulator of this effort.

    The periodic regulator asks for m = K_w(u) Omega + K_a(u) theta. The PD law m = -b x (k_w Omega + 2 k_a
    theta) that comes nearest to it over the orbit, by the sum of squares of the elements, has

        k_w = -sum <K_w, [b x]> / sum |[b x]|^2,     k_a = -1/2 sum <K_a, [b x]> / sum |[b x]|^2,

    b the field on the nominal attitude. The effort decides how strong the gains are.

    Source: Ovchinnikov, Roldugin 2019, section 3.1, after Chasset, Noteborn, Bodin, Larsson, Jakobsson 2013:
    the PD law aboard TANGO, its gains by the regulator. The review does not say how they were drawn from it;
    the nearest over the orbit is this project's choice.

    Raises:
        NotConvergedError: there is no such regulator.
    """
    law = design(body, Weights(effort=effort))
    cross = body.field_t * skew(dipole_field(law.u_rad, body))
    size = float(np.sum(cross**2))
    k_w, twice_k_a = (-float(np.sum(law.gain[..., part : part + 3] * cross)) / size for part in (0, 3))
    return Gains(k_w, 0.5 * twice_k_a)
