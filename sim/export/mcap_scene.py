"""Attitude and vectors for a 3-D panel: frames ``orbit``, ``body``, ``body_estimate``, and arrows.

``orbit`` has axis x along the radius outward, y along the track, z along the orbit normal. A rotation of a
FrameTransform takes components in the child frame to the parent frame: q_body_from_orbit as it is
(Hamilton product, v_orbit = q v_body q*).
"""

from math import hypot, sqrt
from typing import Any

from foxglove.channels import FrameTransformsChannel, SceneUpdateChannel
from foxglove.messages import (
    ArrowPrimitive,
    Color,
    CubePrimitive,
    FrameTransform,
    FrameTransforms,
    Pose,
    Quaternion,
    SceneEntity,
    SceneUpdate,
    Timestamp,
    Vector3,
)

from fsw.wire.messages import NavAttitude

ORBIT, BODY, ESTIMATE = "orbit", "body", "body_estimate"
LENGTH_M = 2.0
"""Of an arrow: directions are drawn, and sizes are in the topic ``/truth``."""

_COLOURS = {
    "field": Color(r=0.2, g=0.5, b=1.0, a=1.0),
    "sun": Color(r=1.0, g=0.8, b=0.1, a=1.0),
    "dipole": Color(r=0.9, g=0.2, b=0.2, a=1.0),
    "nadir": Color(r=0.3, g=0.7, b=0.4, a=1.0),
}
_GREY = Color(r=0.6, g=0.6, b=0.65, a=0.9)


class Scene:
    """The topics ``/tf`` and ``/scene`` of a context of foxglove."""

    def __init__(self, context: Any) -> None:  # noqa: ANN401  untyped there
        self._transforms = FrameTransformsChannel("/tf", context=context)
        self._scene = SceneUpdateChannel("/scene", context=context)

    def log_truth(self, row: dict[str, list[float]], time_ns: int) -> None:
        """The true attitude, and what the plant has around it: field, Sun, dipole."""
        w, x, y, z = row["q_body_from_orbit"]
        self._log_attitude(BODY, (w, x, y, z), time_ns)
        lit = row["lit"][0] > 0.0
        vectors = {
            "field": row["b_body_t"],
            "sun": row["sun_body"] if lit else [0.0, 0.0, 0.0],
            "dipole": row["m_body_am2"],
        }
        body = [_arrow(direction, _COLOURS[name]) for name, direction in vectors.items() if any(direction)]
        stamp = _stamp(time_ns)
        cube = CubePrimitive(size=Vector3(x=1.0, y=0.6, z=0.6), color=_GREY)
        entities = [
            SceneEntity(id="satellite", frame_id=BODY, timestamp=stamp, cubes=[cube], arrows=body),
            SceneEntity(
                id="nadir",
                frame_id=ORBIT,
                timestamp=stamp,
                arrows=[_arrow([-1.0, 0.0, 0.0], _COLOURS["nadir"])],
            ),
        ]
        self._scene.log(SceneUpdate(entities=entities), log_time=time_ns)

    def log_estimate(self, attitude: NavAttitude, time_ns: int) -> None:
        """The estimated attitude, where it is valid."""
        if attitude.valid:
            x, y, z = attitude.q_x, attitude.q_y, attitude.q_z
            w = sqrt(max(0.0, 1.0 - x * x - y * y - z * z))
            self._log_attitude(ESTIMATE, (w, x, y, z), time_ns)

    def _log_attitude(self, child: str, q: tuple[float, float, float, float], time_ns: int) -> None:
        transform = FrameTransform(
            timestamp=_stamp(time_ns),
            parent_frame_id=ORBIT,
            child_frame_id=child,
            translation=Vector3(),
            rotation=Quaternion(w=q[0], x=q[1], y=q[2], z=q[3]),
        )
        self._transforms.log(FrameTransforms(transforms=[transform]), log_time=time_ns)


def _stamp(time_ns: int) -> Timestamp:
    return Timestamp(sec=time_ns // 10**9, nsec=time_ns % 10**9)


def _arrow(direction: list[float], colour: Color) -> ArrowPrimitive:
    """An arrow from the origin, ``LENGTH_M`` long."""
    return ArrowPrimitive(
        pose=Pose(position=Vector3(), orientation=_from_x_axis(direction)),
        shaft_length=0.8 * LENGTH_M,
        shaft_diameter=0.05,
        head_length=0.2 * LENGTH_M,
        head_diameter=0.12,
        color=colour,
    )


def _from_x_axis(direction: list[float]) -> Quaternion:
    """The shortest turn from the x axis, along which an arrow is drawn, to a direction."""
    x, y, z = direction
    size = hypot(x, y, z)
    w = size + x
    if w < 1e-9 * size:  # the other way: half a turn about z
        return Quaternion(w=0.0, x=0.0, y=0.0, z=1.0)
    norm = hypot(w, z, y)
    return Quaternion(w=w / norm, x=0.0, y=-z / norm, z=y / norm)
