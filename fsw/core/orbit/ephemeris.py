"""The slow rate group: orbit, field and Sun at nodes, and a cubic between the nodes.

There is a node every ``node_ticks`` ticks; it depends on its number alone, so that the window of four nodes
around a tick does not depend on earlier ticks.
"""

from dataclasses import dataclass, replace
from math import cos, sin
from typing import Final, final

from fsw.core.algebra.quaternion import Quaternion, conjugate, from_dcm, rotate
from fsw.core.algebra.vector import ZERO, Vec3, cross, dot, is_finite, norm, scale, sub
from fsw.core.orbit.elements import Elements
from fsw.core.orbit.field import FieldKind, OnboardField, field_eci_t, prepare_field
from fsw.core.orbit.igrf_coefficients import MAX_DEGREE
from fsw.core.orbit.propagation import Orbit, element_orbit, state_eci
from fsw.core.orbit.sun import lit, sun_eci
from fsw.wire.value import Value

NODE_S_RANGE = (10, 30)

Weights = tuple[float, float, float, float]


@final
class EphemerisNode(Value):
    """One node: position (m), velocity (m/s), field (T), unit vector to the Sun; all eci."""

    FIELDS = ("r_eci_m", "v_eci_mps", "b_eci_t", "sun_eci")
    __slots__ = FIELDS

    def __init__(self, r_eci_m: Vec3, v_eci_mps: Vec3, b_eci_t: Vec3, sun_eci: Vec3) -> None:
        self.r_eci_m = r_eci_m
        self.v_eci_mps = v_eci_mps
        self.b_eci_t = b_eci_t
        self.sun_eci = sun_eci


Nodes = tuple[EphemerisNode, EphemerisNode, EphemerisNode, EphemerisNode]


@final
class EphemerisWindow(Value):
    """Four successive nodes; the ticks it serves lie between the second and the third."""

    FIELDS = ("first_node", "nodes")
    __slots__ = FIELDS

    def __init__(self, first_node: int, nodes: Nodes) -> None:
        self.first_node = first_node
        self.nodes = nodes


@dataclass(frozen=True, slots=True)
class EphemerisModel:
    """The orbit and the field of a flight, and the clock of its nodes."""

    orbit: Orbit
    field: OnboardField
    epoch_unix_s: int
    tick_hz: int
    node_ticks: int


@final
class Reference(Value):
    """Orbit, field and Sun that the satellite expects in one tick.

    Orbit axes: 1 along the radius, 2 ahead, 3 along the orbit normal. ``orbit_rate_radps`` is about axis 3;
    ``b_rate_eci_tps`` is how the field changes along the orbit, T/s, within a few percent.
    """

    FIELDS = (
        *("r_eci_m", "radius_m", "b_eci_t", "sun_eci", "lit", "q_orbit_from_eci", "orbit_rate_radps"),
        "b_rate_eci_tps",
    )
    __slots__ = FIELDS

    def __init__(
        self,
        r_eci_m: Vec3,
        radius_m: float,
        b_eci_t: Vec3,
        sun_eci: Vec3,
        lit: bool,
        q_orbit_from_eci: Quaternion,
        orbit_rate_radps: float,
        b_rate_eci_tps: Vec3 = ZERO,
    ) -> None:
        self.r_eci_m = r_eci_m
        self.radius_m = radius_m
        self.b_eci_t = b_eci_t
        self.sun_eci = sun_eci
        self.lit = lit
        self.q_orbit_from_eci = q_orbit_from_eci
        self.orbit_rate_radps = orbit_rate_radps
        self.b_rate_eci_tps = b_rate_eci_tps


def ephemeris_model(
    orbit: Orbit,
    epoch_unix_s: int,
    tick_hz: int,
    field: FieldKind = FieldKind.IGRF14,
    degree: int = MAX_DEGREE,
    node_s: int = 20,
) -> EphemerisModel:
    """The model of a flight whose tick 0 is at the epoch.

    Raises:
        ValueError: a number is out of range, the field does not hold at the epoch, or the orbit has no
            position there.
    """
    if tick_hz < 1:
        raise ValueError(f"the tick rate must be at least 1 Hz, not {tick_hz}")
    if not NODE_S_RANGE[0] <= node_s <= NODE_S_RANGE[1]:
        raise ValueError(f"nodes stand {NODE_S_RANGE[0]} to {NODE_S_RANGE[1]} s apart, not {node_s}")
    if state_eci(orbit, epoch_unix_s) is None:
        raise ValueError(
            f"SGP4 finds no orbit at Unix time {epoch_unix_s} s: the elements are too old or decayed"
        )
    prepared = prepare_field(field, epoch_unix_s, degree)
    return EphemerisModel(orbit, prepared, epoch_unix_s, tick_hz, node_ticks=node_s * tick_hz)


def with_orbit(model: EphemerisModel, elements: Elements | None) -> EphemerisModel:
    """The model with the orbit of elements from the ground; None: with its own.

    Raises:
        ValueError: the elements are not a low orbit.
    """
    return model if elements is None else replace(model, orbit=element_orbit(elements))


def advance(window: EphemerisWindow | None, tick: int, model: EphemerisModel) -> EphemerisWindow | None:
    """The window that serves the tick: at most one new node in steady flight, four at boot and after a jump.

    None where the orbit has no position: the next call then computes all four nodes.
    """
    first = tick // model.node_ticks - 1
    if window is not None:
        if window.first_node == first:
            return window
        if window.first_node == first - 1:
            new = node(first + 3, model)
            _, a, b, c = window.nodes
            return None if new is None else EphemerisWindow(first, (a, b, c, new))
    n0, n1 = node(first, model), node(first + 1, model)
    n2, n3 = node(first + 2, model), node(first + 3, model)
    if n0 is None or n1 is None or n2 is None or n3 is None:
        return None
    return EphemerisWindow(first, (n0, n1, n2, n3))


def node(number: int, model: EphemerisModel) -> EphemerisNode | None:
    """The node at tick ``number * node_ticks``, or None where the orbit has no position."""
    unix_s = model.epoch_unix_s + number * model.node_ticks / model.tick_hz
    state = state_eci(model.orbit, unix_s)
    if state is None:
        return None
    r_eci_m, v_eci_mps = state
    return EphemerisNode(r_eci_m, v_eci_mps, field_eci_t(model.field, r_eci_m, unix_s), sun_eci(unix_s))


def reference_at(window: EphemerisWindow, tick: int, model: EphemerisModel) -> Reference:
    """The reference at a tick that the window serves: every vector by the cubic through its four nodes.

    Measured over a day, nodes 20 s apart: field within 0.02 nT at 800 km and 0.06 nT at 300 km, position
    within 0.1 m. Nodes 30 s apart: 0.1 nT at 800 km but 0.3 nT at 300 km, and 0.3 m.
    """
    n0, n1, n2, n3 = window.nodes
    past_left = tick - (window.first_node + 1) * model.node_ticks
    weights = _lagrange(past_left / model.node_ticks)
    r = _blend(weights, n0.r_eci_m, n1.r_eci_m, n2.r_eci_m, n3.r_eci_m)
    v = _blend(weights, n0.v_eci_mps, n1.v_eci_mps, n2.v_eci_mps, n3.v_eci_mps)
    b = _blend(weights, n0.b_eci_t, n1.b_eci_t, n2.b_eci_t, n3.b_eci_t)
    sun = _blend(weights, n0.sun_eci, n1.sun_eci, n2.sun_eci, n3.sun_eci)
    radius_m = norm(r)
    normal = cross(r, v)
    momentum = norm(normal)
    e1, e3 = scale(1.0 / radius_m, r), scale(1.0 / momentum, normal)
    return Reference(
        r_eci_m=r,
        radius_m=radius_m,
        b_eci_t=b,
        sun_eci=sun,
        lit=lit(r, sun),
        q_orbit_from_eci=from_dcm((e1, cross(e3, e1), e3)),
        orbit_rate_radps=momentum / dot(r, r),
        b_rate_eci_tps=scale(model.tick_hz / model.node_ticks, sub(n2.b_eci_t, n1.b_eci_t)),
    )


def plausible(reference: Reference) -> bool:
    """Whether the values are possible; a window with a damaged node is computed anew."""
    q0, q1, q2, q3 = reference.q_orbit_from_eci
    return (
        LEAST_RADIUS_M < reference.radius_m < MOST_RADIUS_M
        and norm(reference.b_eci_t) < MOST_FIELD_T
        and 0.9 < norm(reference.sun_eci) < 1.1
        and is_finite(q0 + q1 + q2 + q3 + reference.orbit_rate_radps)
    )


LEAST_RADIUS_M: Final = 6.3e6
MOST_RADIUS_M: Final = 1e9
MOST_FIELD_T: Final = 1e-4
"""The Earth's field is nowhere stronger than 0.07 mT."""


def _lagrange(s: float) -> Weights:
    """Weights of the nodes at -1, 0, 1, 2 in the cubic through all four, at s in [0, 1]."""
    past, left, right, ahead = 1.0 + s, s, 1.0 - s, 2.0 - s
    return (
        left * right * ahead / -6.0,
        past * right * ahead / 2.0,
        past * left * ahead / 2.0,
        past * left * right / -6.0,
    )


def _blend(weights: Weights, a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> Vec3:
    """The weighted sum of four vectors."""
    w0, w1, w2, w3 = weights
    return (
        w0 * a[0] + w1 * b[0] + w2 * c[0] + w3 * d[0],
        w0 * a[1] + w1 * b[1] + w2 * c[1] + w3 * d[1],
        w0 * a[2] + w1 * b[2] + w2 * c[2] + w3 * d[2],
    )


def earlier(reference: Reference, elapsed_s: float) -> tuple[Vec3, Vec3]:
    """Radius direction, unit, and field, T, so long before a tick, eci.

    The radius turns at the orbit rate and the field changes at its own: over a minute within 0.1 deg and
    500 nT in a low orbit.

    Args:
        reference: of the tick.
        elapsed_s: time before it, at most a minute.
    """
    up = scale(1.0 / reference.radius_m, reference.r_eci_m)
    if not elapsed_s:
        return up, reference.b_eci_t
    turned = reference.orbit_rate_radps * elapsed_s
    ahead = rotate(conjugate(reference.q_orbit_from_eci), (0.0, 1.0, 0.0))
    e1_eci = sub(scale(cos(turned), up), scale(sin(turned), ahead))
    return e1_eci, sub(reference.b_eci_t, scale(elapsed_s, reference.b_rate_eci_tps))
