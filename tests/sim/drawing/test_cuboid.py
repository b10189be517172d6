"""The body as it is drawn has the inertia of the satellite."""

import numpy as np
import pytest

from sim.drawing.cuboid import LEAST_SIDE, sides


def test_the_body_is_a_cuboid_of_its_inertia():
    a, b, c = 2.0, 1.0, 3.0
    inertia = np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    assert sides(inertia) == pytest.approx([2 / 3, 1 / 3, 1.0], abs=1e-3)


def test_no_side_is_too_short_to_be_seen():
    assert sides(np.diag([0.01, 1.0, 1.0])).tolist() == [1.0, LEAST_SIDE, LEAST_SIDE]
