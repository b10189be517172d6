"""The slow rate group: orbit, field and Sun at nodes, and between the nodes a cubic.

A node stands every ``node_ticks`` ticks and depends on its number alone, so that the window of four nodes
around a tick is the same however it was reached.
"""

from dataclasses import dataclass

from fsw.core.field import Field, FieldKind, field_eci_t, prepare_field
from fsw.core.igrf_coefficients import MAX_DEGREE
from fsw.core.orbit import Orbit, state_eci
from fsw.core.quaternion import Quaternion, from_dcm
from fsw.core.sun import lit, sun_eci
from fsw.core.vector import Vec3, cross, dot, norm, scale

NODE_S_RANGE = (10, 30)


@dataclass(frozen=True, slots=True)
class Node:
    """What is known at one node: position (m), velocity (m/s), field (T), unit vector to the Sun; all eci."""

    r_eci_m: Vec3
    v_eci_mps: Vec3
    b_eci_t: Vec3
    sun_eci: Vec3


@dataclass(frozen=True, slots=True)
class EphemerisWindow:
    """Four successive nodes; the ticks it serves lie between the second and the third."""

    first_node: int
    nodes: tuple[Node, Node, Node, Node]


@dataclass(frozen=True, slots=True)
class EphemerisModel:
    """The orbit and the field of a flight, and the clock of its nodes."""

    orbit: Orbit
    field: Field
    epoch_unix_s: int
    tick_hz: int
    node_ticks: int


@dataclass(frozen=True, slots=True)
class Reference:
    """What the satellite expects around it in one tick.

    Orbit axes: 1 along the radius, 2 ahead, 3 along the orbit normal. ``orbit_rate_radps`` is about axis 3.
    """

    r_eci_m: Vec3
    radius_m: float
    b_eci_t: Vec3
    sun_eci: Vec3
    lit: bool
    q_orbit_from_eci: Quaternion
    orbit_rate_radps: float


def ephemeris_model(  # noqa: PLR0917
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


def advance(window: EphemerisWindow | None, tick: int, model: EphemerisModel) -> EphemerisWindow | None:
    """The window that serves the tick: at most one new node in steady flight, four at boot and after a jump.

    None where the orbit has no position: there is no reference then, and the next call begins afresh.
    """
    first = tick // model.node_ticks - 1
    if window is not None:
        if window.first_node == first:
            return window
        if window.first_node == first - 1:
            new = node(first + 3, model)
            return None if new is None else EphemerisWindow(first, (*window.nodes[1:], new))
    n0, n1, n2, n3 = (node(first + i, model) for i in range(4))
    if n0 is None or n1 is None or n2 is None or n3 is None:
        return None
    return EphemerisWindow(first, (n0, n1, n2, n3))


def node(number: int, model: EphemerisModel) -> Node | None:
    """The node at tick ``number * node_ticks``, or None where the orbit has no position."""
    unix_s = model.epoch_unix_s + number * model.node_ticks / model.tick_hz
    state = state_eci(model.orbit, unix_s)
    if state is None:
        return None
    r_eci_m, v_eci_mps = state
    return Node(r_eci_m, v_eci_mps, field_eci_t(model.field, r_eci_m, unix_s), sun_eci(unix_s))


def reference_at(window: EphemerisWindow, tick: int, model: EphemerisModel) -> Reference:
    """The reference at a tick that the window serves.

    Position by the Hermite cubic on the two nodes around the tick, velocity as its derivative, field by the
    Lagrange cubic on all four, Sun by a straight line; the radius to 1e-9, the field to 0.1 nT.
    """
    before, left, right, after = window.nodes
    step_s = model.node_ticks / model.tick_hz
    s = (tick - (window.first_node + 1) * model.node_ticks) / model.node_ticks

    r0, r1, v0, v1 = left.r_eci_m, right.r_eci_m, left.v_eci_mps, right.v_eci_mps
    t = 1.0 - s
    h00, h10, h11 = t * t * (1.0 + 2.0 * s), s * t * t * step_s, -s * s * t * step_s
    h01 = 1.0 - h00
    r = (
        h00 * r0[0] + h01 * r1[0] + h10 * v0[0] + h11 * v1[0],
        h00 * r0[1] + h01 * r1[1] + h10 * v0[1] + h11 * v1[1],
        h00 * r0[2] + h01 * r1[2] + h10 * v0[2] + h11 * v1[2],
    )
    d01, d10, d11 = 6.0 * s * t / step_s, t * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)
    v = (
        d01 * (r1[0] - r0[0]) + d10 * v0[0] + d11 * v1[0],
        d01 * (r1[1] - r0[1]) + d10 * v0[1] + d11 * v1[1],
        d01 * (r1[2] - r0[2]) + d10 * v0[2] + d11 * v1[2],
    )
    b0, b1, b2, b3 = before.b_eci_t, left.b_eci_t, right.b_eci_t, after.b_eci_t
    p, q = s * t, (1.0 + s) * (2.0 - s)
    l0, l1, l2, l3 = -p * (2.0 - s) / 6.0, t * q / 2.0, s * q / 2.0, -p * (1.0 + s) / 6.0
    b = (
        l0 * b0[0] + l1 * b1[0] + l2 * b2[0] + l3 * b3[0],
        l0 * b0[1] + l1 * b1[1] + l2 * b2[1] + l3 * b3[1],
        l0 * b0[2] + l1 * b1[2] + l2 * b2[2] + l3 * b3[2],
    )
    s0, s1 = left.sun_eci, right.sun_eci
    sun = (t * s0[0] + s * s1[0], t * s0[1] + s * s1[1], t * s0[2] + s * s1[2])

    r2 = dot(r, r)
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
        orbit_rate_radps=momentum / r2,
    )


def pack_values(window: EphemerisWindow) -> tuple[float, ...]:
    """The window as 49 numbers, its first node's number leading."""
    a, b, c, d = window.nodes
    return (
        window.first_node,
        *a.r_eci_m,
        *a.v_eci_mps,
        *a.b_eci_t,
        *a.sun_eci,
        *b.r_eci_m,
        *b.v_eci_mps,
        *b.b_eci_t,
        *b.sun_eci,
        *c.r_eci_m,
        *c.v_eci_mps,
        *c.b_eci_t,
        *c.sun_eci,
        *d.r_eci_m,
        *d.v_eci_mps,
        *d.b_eci_t,
        *d.sun_eci,
    )
