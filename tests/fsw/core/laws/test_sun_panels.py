"""Sun pointing from panel currents: the sense of each term, and how near it comes."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from fsw.core.laws.sun_panels import PanelGains, panel_currents, panel_torque, sun_panels

SUN = (0.2, -0.7, 0.5)
component = st.floats(-1.0, 1.0, allow_subnormal=False)
directions = (
    st.tuples(component, component, component)
    .filter(lambda v: np.linalg.norm(v) > 0.1)
    .map(lambda v: tuple(float(c) for c in np.array(v) / np.linalg.norm(v)))
)


def test_of_two_opposite_panels_one_is_in_the_shade():
    assert panel_currents((0.6, -0.64, 0.48)) == (0.6, 0.0, 0.0, 0.64, 0.48, 0.0)


def test_the_equation_by_hand():
    """k1 delta e3 + k2 e1 x s_max: delta = 0 - 0.64, most on -2, e1 x (-e2) = -e3."""
    currents = panel_currents((0.6, -0.64, 0.48))
    assert panel_torque(currents, 0, 2.0, 5.0) == pytest.approx((0.0, 0.0, -1.28 - 5.0))
    assert panel_torque(currents, 2, 2.0, 5.0) == pytest.approx((5.0, 1.2, 0.0))


@pytest.mark.long
@given(directions, st.integers(0, 2))
def test_each_term_turns_the_axis_to_the_sun_if_the_panels_do_not_face_away(sun, axis):
    """A body that turns with the torque: d(e . s)/dt has the sign of torque . (e x s)."""
    assume(sun[axis] > 0.0)
    e = np.eye(3)[axis]
    for gains in ((1.0, 0.0), (0.0, 1.0)):
        torque = np.array(panel_torque(panel_currents(sun), axis, *gains))
        assert torque @ np.cross(e, sun) >= 0.0


@pytest.mark.long
def test_the_sun_comes_to_the_axis_within_the_corner_of_its_panel(bench, turned):
    """Within 45 deg, where its own panel has the most: nothing turns it about the last axis there."""
    run = bench.fly(
        sun_panels,
        bench.setpoint(k_w=6e6, k_a=2000.0),
        gains={"sun_panels": PanelGains(1.0)},
        body=bench.Body(gravity=False),
        c_body_from_orbit=turned((1, 2, -1), 80.0),
        omega_body=(0.01, -0.01, 0.01),
        seconds=2.5 * bench.Orbit().period_s,
        step_s=5.0,
        sun_eci=SUN,
    )
    off = run.axis_to_deg(0, SUN)
    assert off[0] > 60.0
    assert off[-200:].max() < 45.0
    assert abs(run.c_body_from_eci[-1, 1] @ SUN) < 0.1  # along u, which the difference takes away


def test_a_share_without_sense_is_refused():
    with pytest.raises(ValueError, match="must be positive"):
        PanelGains(1.0, 0.0)
