"""The orbit ahead: the field along it, and how fast the orbital frame turns.

Evaluating the field model is what a look ahead costs. Where many times are wanted it is evaluated at few, and
a polynomial through these gives the others; its error is nearly the least where the few are Chebyshev nodes,

    t_k = T (1 - cos((k + 1/2) pi / n)) / 2.

Source: Berrut, Trefethen 2004, section 5 (interpolation at Chebyshev points of the first kind).
"""

from collections.abc import Sequence
from math import ceil, cos, pi
from typing import NamedTuple

import numpy as np

from fsw.core.laws.plan.cost_to_go import rounded, times
from fsw.core.laws.plan.riccati import Array
from fsw.core.orbit.ephemeris import EphemerisModel
from fsw.core.orbit.field import field_eci_t
from fsw.core.orbit.propagation import state_eci

NODES, NODES_PER_ORBIT = 4, 12
"""From 300 km up IGRF-14 is then matched within 0.3 uT over a third of an orbit, 2 uT over a whole one."""


def check_horizon(orbits: float, least: float, most: float) -> None:
    """Check that a plan reaches as far as it must and can be made quickly.

    Raises:
        ValueError: it does not.
    """
    if not least <= orbits <= most:
        raise ValueError(f"horizon_orbits must be {least:g} to {most:g}, not {orbits:g}")


class OrbitAhead(NamedTuple):
    """The field at each time, orbital axes then, T, (n, 3), and the rate of the orbital frame, (n,)."""

    b_orbit_t: Array
    rate_radps: Array


class Sight(NamedTuple):
    """When the orbit is evaluated, and the weights (wanted, nodes) that interpolate to the times wanted."""

    nodes_s: tuple[float, ...]
    weights: Array


def orbit_ahead(model: EphemerisModel, times_unix_s: Sequence[float]) -> OrbitAhead | None:
    """The orbit at these times; None where it has no position."""
    states = [state for state in (state_eci(model.orbit, t) for t in times_unix_s) if state is not None]
    if len(states) < len(times_unix_s):
        return None
    r, v = (np.array(part) for part in zip(*states, strict=True))
    b = np.array([field_eci_t(model.field, r_m, t) for (r_m, _), t in zip(states, times_unix_s, strict=True)])
    normal = np.cross(r, v)
    radius, momentum = (np.sqrt(np.add.reduce(vector * vector, axis=-1))[:, None] for vector in (r, normal))
    e1, e3 = r / radius, normal / momentum
    axes = np.stack([e1, np.cross(e3, e1), e3], axis=1)
    rates_radps: Array = (momentum / (radius * radius))[:, 0]
    return OrbitAhead(np.add.reduce(axes * b[:, None, :], axis=-1), rates_radps)


def sight(wanted_s: Sequence[float], orbit_s: float) -> Sight:
    """How the orbit is seen at times from 0 to the last, s; the nodes are rounded as by ``rounded``."""
    span_s = wanted_s[-1]
    count = NODES + ceil(NODES_PER_ORBIT * span_s / orbit_s)
    angles = [(k + 0.5) * pi / count for k in range(count)]
    nodes_s = rounded(np.array([0.5 * span_s * (1.0 - cos(angle)) for angle in angles]))
    weights = np.ones((len(wanted_s), count))
    for k, node_s in enumerate(nodes_s.tolist()):
        for other_s in np.delete(nodes_s, k).tolist():
            weights[:, k] *= (np.array(wanted_s) - other_s) / (node_s - other_s)
    return Sight(tuple(nodes_s.tolist()), weights)


def interpolated_orbit(model: EphemerisModel, from_unix_s: float, by: Sight) -> OrbitAhead | None:
    """The orbit at the times wanted, counted from ``from_unix_s``; None where it has no position."""
    at_nodes = orbit_ahead(model, [from_unix_s + node_s for node_s in by.nodes_s])
    if at_nodes is None:
        return None
    found = times(by.weights, np.hstack([at_nodes.b_orbit_t, at_nodes.rate_radps[:, None]]))
    return OrbitAhead(found[:, :3], found[:, 3])
