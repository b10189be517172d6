"""The outlines of land: closed, on the map, and where land is."""

import numpy as np
import pytest
from matplotlib.path import Path

from sim.drawing.coastline import coastlines


@pytest.fixture(scope="module")
def outlines():
    return coastlines()


@pytest.mark.parametrize(
    ("longitude", "latitude", "is_land"),
    [
        (10.0, 50.0, True),  # Germany
        (134.0, -25.0, True),  # Australia
        (-175.0, 67.0, True),  # Chukotka, beyond the date line
        (0.0, -88.0, False),  # south of the last outline: the ice has no coast at the pole
        (0.0, -80.0, True),  # Antarctica
        (-30.0, 40.0, False),  # the Atlantic
        (-150.0, 0.0, False),  # the Pacific
    ],
)
def test_land_is_where_it_is(outlines, longitude, latitude, is_land):
    inside = sum(Path(outline).contains_point((longitude, latitude)) for outline in outlines)
    assert inside % 2 == is_land


def test_no_outline_crosses_the_map(outlines):
    leaps = [np.abs(np.diff(outline[:, 0])).max() for outline in outlines if outline[:, 1].min() > -80.0]
    assert max(leaps) < 20.0
