"""The pulsed actuator by Floquet theory: short pulses and long pauses in place of a continuous dipole.

Between pulses the body moves freely, x' = A0 x, and the law's torque T(u) = -F(u) x is only accumulated as an
owed impulse, r' = T - r / tau. A pulse of length T_p at u_k pays by the torque p / T_p. Due is what will be
owed half a period later, d = r + T(u_k) period / 2, and p = P_k d is nearest to it, |J^-1 (d - p)| least,
among the torques that the coils can give at u_k,

    all coils at once: p normal to b;     one coil in turn: p along e_j x b, j = 1, 2, 3, 1, ...

and r - p stays owed. This is the onboard scheduler without the steps of its levels; that picks the coil by
need, not in turn. Everything is linear in (x, r), so one period (pulse and pause) is a matrix, and the
periods of an orbit multiply to the monodromy matrix. Pulses and orbit do not keep step (at 800 km 58.8
periods of 103 s make an orbit): the analysis takes the nearest whole number of periods an orbit, a multiple
of three for coils in turn, and reports it.

On the average over a period the pulses give the law's own torque if the dipole is raised by period / T_p,
as paying an impulse does: the averaged analysis is then the continuous one. Unraised, it is the
continuous one with the gains lowered by the duty.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import exp, pi

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import degree_of_stability, product
from sim.design.theory.linear import Gains, dipole_field, feedback_scales, free_motion, projection
from sim.value_types import Array

PARALLEL = 1e-6
"""A coil whose torque is below this fraction of the largest is parallel to the field, and pays nothing."""


@dataclass(frozen=True, slots=True)
class Pulsing:
    """How the actuator pulses.

    Attributes:
        pulse_s: length of a pulse.
        backoff_s: from its end to the next one.
        leak_s: time constant with which an owed impulse is forgotten.
        in_turn: one coil a pulse, in turn; else all three at once.
    """

    pulse_s: float = 3.0
    backoff_s: float = 100.0
    leak_s: float = 300.0
    in_turn: bool = False

    @property
    def duty(self) -> float:
        """The part of time that a pulse takes."""
        return self.pulse_s / (self.pulse_s + self.backoff_s)

    def periods_per_orbit(self, body: Body) -> int:
        """Whole number of periods (for coils in turn: of three periods) nearest to an orbit."""
        group = 3 if self.in_turn else 1
        orbit_s = 2.0 * pi / body.rate_radps
        return group * max(1, round(orbit_s / (group * (self.pulse_s + self.backoff_s))))


class PulsedLoop:
    """The pulsed loop of one body; what does not depend on the gains is computed once.

    Args:
        body: the satellite and its orbit.
        pulsing: how its coils pulse; its times are stretched alike until they fit the orbit.
        size: states of the motion, 6, or 9 with the integral of theta.
    """

    def __init__(self, body: Body, pulsing: Pulsing, size: int = 6) -> None:
        self.body, self.periods = body, pulsing.periods_per_orbit(body)
        inertia = np.asarray(body.inertia_kgm2)
        free = free_motion(body, size)
        period = 2.0 * pi / self.periods
        pulse, leak = period * pulsing.duty, pulsing.leak_s * body.rate_radps
        starts = period * np.arange(self.periods, dtype=np.float64)
        self._paid = _payable(dipole_field(starts + 0.5 * pulse, body), inertia, pulsing.in_turn)
        self._kept = exp(-period / leak)
        push = np.zeros((size, 3))
        push[:3] = np.linalg.inv(inertia) / pulse
        self._free, self._pushed = _response(free, push, period, pulse)
        places, weights = _quadrature((0.0, pulse, period))
        reached = [_response(free, push, place, pulse) for place in places]
        owed = -weights * np.exp((places - period) / leak)
        normal = projection(starts[:, None] + places, body)
        of_x, of_p = (np.array(parts) for parts in zip(*reached, strict=True))
        self._pending_x = _demanded(normal, owed, of_x)
        self._pending_p = _demanded(normal, owed, of_p)
        half = np.array([-0.5 * period])
        self._ahead = _demanded(projection(starts[:, None], body), half, np.eye(size)[None])

    def degree(self, gains: Gains) -> Array:
        """Degrees of stability, of the shape of the gains."""
        return degree_of_stability(self.monodromy(gains))

    def monodromy(self, gains: Gains) -> Array:
        """The transition matrix of (x, r) over an orbit, (..., n + 3, n + 3) for gains of shape (...)."""
        n, scales = len(self._free), feedback_scales(self.body, gains)
        unpaid = np.zeros((*scales.shape[:-1], self.periods, n + 3, n + 3))
        unpaid[..., :n, :n] = self._free
        unpaid[..., n:, :n] = np.tensordot(scales, self._pending_x, axes=1)
        unpaid[..., n:, n:] = self._kept * np.eye(3)
        due = np.zeros((*unpaid.shape[:-2], 3, n + 3))
        due[..., :n] = np.tensordot(scales, self._ahead, axes=1)
        due[..., n:] = np.eye(3)
        by_pulse = np.zeros((*unpaid.shape[:-2], n + 3, 3))
        by_pulse[..., :n, :] = self._pushed
        by_pulse[..., n:, :] = np.tensordot(scales, self._pending_p, axes=1) - self._kept * np.eye(3)
        return product(unpaid + by_pulse @ self._paid @ due)


def _payable(field: Array, inertia: Array, in_turn: bool) -> Array:
    """P_k, shape (k, 3, 3): maps an owed impulse to the part that the coils can pay."""
    inverse = np.linalg.inv(inertia)
    if not in_turn:
        normal = field @ inertia
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        whole: Array = inertia @ (np.eye(3) - normal[:, :, None] * normal[:, None, :]) @ inverse
        return whole
    axes = np.eye(3)[np.arange(len(field)) % 3]
    along = np.cross(axes, field) @ inverse
    size = np.linalg.norm(along, axis=-1, keepdims=True)
    along = np.where(size > PARALLEL * size.max(), along / np.maximum(size, PARALLEL * size.max()), 0.0)
    chosen: Array = inertia @ (along[:, :, None] * along[:, None, :]) @ inverse
    return chosen


def _demanded(normal: Array, weights: Array, states: Array) -> Array:
    """Sum over places j of w_j G_kj X_j, X_j the rows of the block's states: shape (blocks, k, 3, columns).

    Args:
        normal: G at the places of each period, (k, j, 3, 3).
        weights: (j,).
        states: the state at each place, (j, 3 blocks, columns).
    """
    blocks = states.reshape(len(states), -1, 3, states.shape[-1])
    demanded: Array = np.einsum("kjab,j,jcbd->ckad", normal, weights, blocks, optimize=True)
    return demanded


def _quadrature(edges: tuple[float, ...], order: int = 6) -> tuple[Array, Array]:
    """Gauss nodes and weights between neighbouring edges."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    pairs = list(pairwise(edges))
    places = [0.5 * (b - a) * (nodes + 1.0) + a for a, b in pairs]
    return np.concatenate(places), np.concatenate([0.5 * (b - a) * weights for a, b in pairs])


def _response(free: Array, push: Array, after: float, pulse: float) -> tuple[Array, Array]:
    """The response of the state at ``after`` to the state at 0, and to a push from 0 to ``pulse``."""
    from scipy.linalg import expm  # noqa: PLC0415  (slow to load)

    n = len(free)
    both = np.zeros((n + 3, n + 3))
    both[:n, :n], both[:n, n:] = free, push
    moved = expm(both * min(after, pulse))
    coasted = expm(free * max(0.0, after - pulse))
    return coasted @ moved[:n, :n], coasted @ moved[:n, n:]
