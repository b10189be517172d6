"""What the script of the report is given."""

import numpy as np
import pytest

from sim.report.charts.page_data import LEAST_SIDE, sides


def test_the_body_is_a_cuboid_of_its_inertia():
    a, b, c = 2.0, 1.0, 3.0
    inertia = np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    assert sides(inertia) == pytest.approx([2 / 3, 1 / 3, 1.0], abs=1e-3)


def test_no_side_is_too_short_to_be_seen():
    assert sides(np.diag([0.01, 1.0, 1.0])).tolist() == [1.0, LEAST_SIDE, LEAST_SIDE]


def test_the_data_are_those_of_the_flight(page):
    data = page.data
    assert data["time"]["end_s"] == 7000.0
    assert data["time"]["eclipses"] == [[1000.0, 3000.0]]
    lanes = data["charts"]["modes"]["panels"][0]["lanes"]
    assert {lane["label"]: lane["spans_s"] for lane in lanes} == {
        "SAFE": [], "DETUMBLE": [], "ACQUIRE": [[0.0, 3500.0]], "POINT": [[3500.0, 7000.0]],
    }  # fmt: skip
    assert {"zoom", "gaps_and_levels", "track"}.isdisjoint(data["charts"])
