"""Directions around the satellite against the plant's own and against each other."""

from math import radians

import pytest

from fsw.core.algebra.quaternion import conjugate, from_small_rotation, normalise, rotate
from fsw.core.algebra.vector import norm, unit
from sim.scenario.law_named import with_law_withheld
from sim.scenario.schema import load
from sim.watch.directions import arrows, off_deg, onboard_around

Q = normalise((0.8, 0.3, -0.4, 0.2))


def test_field_and_sun_are_those_of_the_orbit():
    """Near the equator the field is northward: along or against the orbit normal of an equatorial orbit."""
    scenario = load("microsat")
    at = onboard_around(scenario)
    first, later = at(0), at(600)
    assert 2e-5 < norm(first.b_orbit_t) < 6e-5
    assert first.b_orbit_t != later.b_orbit_t
    suns = [there.sun_orbit for there in map(at, range(600, 6600, 100))]
    lit = [sun for sun in suns if sun is not None]
    assert 0.5 < len(lit) / len(suns) < 0.95, "an orbit has its shadow"
    assert all(norm(sun) == pytest.approx(1.0, abs=1e-3) for sun in lit)


def test_a_measured_direction_is_off_by_the_turn_between_it_and_the_prediction():
    b_orbit = (1e-5, -2e-5, 3e-5)
    measured = rotate(Q, b_orbit)
    assert off_deg(Q, measured, b_orbit) == pytest.approx(0.0, abs=1e-5)
    across = unit((2.0, 1.0, 0.0))
    turn = from_small_rotation(tuple(radians(3.0) * c for c in across))
    assert off_deg(Q, rotate(Q, rotate(turn, b_orbit)), b_orbit) == pytest.approx(3.0, abs=0.01)
    assert off_deg(Q, tuple(-b for b in measured), b_orbit) == pytest.approx(180.0, abs=1e-4)


@pytest.mark.parametrize(
    ("q", "measured", "modelled"),
    [
        (None, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        (Q, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        (Q, (1.0, 0.0, 0.0), None),
    ],
)
def test_what_is_not_known_is_not_compared(q, measured, modelled):
    assert off_deg(q, measured, modelled) is None


def test_arrows_are_in_orbit_axes_and_what_was_measured_is_turned_there():
    sun_orbit = unit((0.2, -0.9, 0.5))
    found = arrows(Q, None, rotate(Q, sun_orbit))
    assert found["Sun"] == pytest.approx(sun_orbit)
    assert rotate(Q, found["body 2"]) == pytest.approx((0.0, 1.0, 0.0))
    assert found["body 3"] == pytest.approx(rotate(conjugate(Q), (0.0, 0.0, 1.0)))
    assert "field" not in found


def test_without_an_attitude_they_are_in_body_axes_and_nothing_is_said_of_the_orbit():
    found = arrows(None, (0.0, 3e-5, 0.0), None)
    assert found == {
        "body 1": (1.0, 0.0, 0.0),
        "body 2": (0.0, 1.0, 0.0),
        "body 3": (0.0, 0.0, 1.0),
        "field": (0.0, 1.0, 0.0),
    }


def test_a_law_of_ones_own_is_not_executed_for_it(tmp_path):
    law, trace = tmp_path / "law.py", tmp_path / "executed"
    law.write_text(f"open({str(trace)!r}, 'w').close()\nlaw = None\n")
    scenario = load("microsat", {"control": {"law": f"{law}:law"}})
    assert onboard_around(scenario)(0) is not None
    assert onboard_around(with_law_withheld(scenario))(0) is not None, "as of a run that was recorded"
    assert not trace.exists()
