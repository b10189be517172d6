"""Arrows of Foxglove's 3-D panel, which are drawn along x: their orientation turns x to their vector."""

import numpy as np
import pytest
from foxglove.messages import Quaternion

from sim.drawing.foxglove_scene import from_x_axis


@pytest.mark.parametrize(
    "direction", [(1, 0, 0), (-2, 0, 0), (0, 3, 0), (0, 0, -1), (1, -2, 0.5), (-1, 1e-9, 0)]
)
def test_an_arrow_points_along_its_vector(direction):
    """An arrow is drawn along x: its orientation turns x there."""
    text = repr(from_x_axis(list(map(float, direction))))
    assert isinstance(from_x_axis([1.0, 0.0, 0.0]), Quaternion)
    x, y, z, w = (float(part.split("=")[1].strip(" )")) for part in text.partition("(")[2].split(","))
    turned = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    assert turned == pytest.approx(np.array(direction) / np.linalg.norm(direction), abs=1e-6)
