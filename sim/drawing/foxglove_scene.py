"""Attitude and arrows for the 3-D panel of Foxglove: frames ``orbit``, ``body``, ``body_estimate``.

``orbit`` has axis x along the radius outward, y along the track, z along the orbit normal. A rotation of a
FrameTransform takes components in the child frame to the parent frame: q_body_from_orbit as it is
(Hamilton product, v_orbit = q v_body q*).
"""

from collections.abc import Sequence
from math import hypot

from foxglove.messages import (
    ArrowPrimitive,
    Color,
    FrameTransform,
    FrameTransforms,
    Pose,
    Quaternion,
    Timestamp,
    Vector3,
)

ORBIT, BODY, ESTIMATE = "orbit", "body", "body_estimate"
LENGTH_M = 2.0
"""Of an arrow: a direction is drawn, not a size."""


def attitude(child: str, q: tuple[float, float, float, float], time_ns: int) -> FrameTransforms:
    """The attitude of a body frame, q_body_from_orbit."""
    transform = FrameTransform(
        timestamp=stamp_of(time_ns),
        parent_frame_id=ORBIT,
        child_frame_id=child,
        translation=Vector3(),
        rotation=Quaternion(w=q[0], x=q[1], y=q[2], z=q[3]),
    )
    return FrameTransforms(transforms=[transform])


def stamp_of(time_ns: int) -> Timestamp:
    """A time as Foxglove writes it."""
    return Timestamp(sec=time_ns // 10**9, nsec=time_ns % 10**9)


def arrow(direction: Sequence[float], colour: Color) -> ArrowPrimitive:
    """An arrow from the origin, ``LENGTH_M`` long."""
    return ArrowPrimitive(
        pose=Pose(position=Vector3(), orientation=from_x_axis(direction)),
        shaft_length=0.8 * LENGTH_M,
        shaft_diameter=0.05,
        head_length=0.2 * LENGTH_M,
        head_diameter=0.12,
        color=colour,
    )


def from_x_axis(direction: Sequence[float]) -> Quaternion:
    """The shortest turn from the x axis, along which an arrow is drawn, to a direction."""
    x, y, z = direction
    size = hypot(x, y, z)
    w = size + x
    if w < 1e-9 * size:  # the other way: half a turn about z
        return Quaternion(w=0.0, x=0.0, y=0.0, z=1.0)
    norm = hypot(w, z, y)
    return Quaternion(w=w / norm, x=0.0, y=-z / norm, z=y / norm)
