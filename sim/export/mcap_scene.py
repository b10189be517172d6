"""Attitude and vectors of a flight for a 3-D panel: true and estimated body, and arrows."""

from math import sqrt
from typing import Any

from foxglove.channels import FrameTransformsChannel, SceneUpdateChannel
from foxglove.messages import Color, CubePrimitive, SceneEntity, SceneUpdate, Vector3

from fsw.wire.messages import NavAttitude
from sim.drawing.foxglove_scene import BODY, ESTIMATE, ORBIT, arrow, attitude, stamp_of

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
        self._transforms.log(attitude(BODY, (w, x, y, z), time_ns), log_time=time_ns)
        lit = row["lit"][0] > 0.0
        vectors = {
            "field": row["b_body_t"],
            "sun": row["sun_body"] if lit else [0.0, 0.0, 0.0],
            "dipole": row["m_body_am2"],
        }
        body = [arrow(direction, _COLOURS[name]) for name, direction in vectors.items() if any(direction)]
        stamp = stamp_of(time_ns)
        cube = CubePrimitive(size=Vector3(x=1.0, y=0.6, z=0.6), color=_GREY)
        entities = [
            SceneEntity(id="satellite", frame_id=BODY, timestamp=stamp, cubes=[cube], arrows=body),
            SceneEntity(
                id="nadir",
                frame_id=ORBIT,
                timestamp=stamp,
                arrows=[arrow([-1.0, 0.0, 0.0], _COLOURS["nadir"])],
            ),
        ]
        self._scene.log(SceneUpdate(entities=entities), log_time=time_ns)

    def log_estimate(self, nav: NavAttitude, time_ns: int) -> None:
        """The estimated attitude, where it is valid."""
        if nav.valid:
            w = sqrt(max(0.0, 1.0 - nav.q_x**2 - nav.q_y**2 - nav.q_z**2))
            estimate = attitude(ESTIMATE, (w, nav.q_x, nav.q_y, nav.q_z), time_ns)
            self._transforms.log(estimate, log_time=time_ns)
