"""Closed expressions for the decay with a pitch wheel, against Floquet theory."""

from dataclasses import replace

import numpy as np
import pytest

from sim.design.pitch_wheel_damping import convergence
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.floquet import monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop

BODY = Body("wheeled", diagonal((1.4, 1.6, 1.9)), 800.0, 70.0, (0.0, 0.0, 0.01))
WEAK = 2e4


def floquet(body, k_w, steps=512):
    values = np.log(np.abs(multipliers(monodromy(closed_loop(body, Gains(k_w, 0.0)), steps)))) / (2.0 * np.pi)
    return np.sort(values)[::2]


@pytest.mark.parametrize("wheel_nms", [0.003, 0.01, 0.03, -0.02])
@pytest.mark.parametrize("inclination_deg", [40.0, 98.6])
def test_they_are_the_exponents_of_weak_damping(wheel_nms, inclination_deg):
    body = replace(BODY, wheel_nms=(0.0, 0.0, wheel_nms), inclination_deg=inclination_deg)
    np.testing.assert_allclose(np.sort(convergence(body, WEAK)), floquet(body, WEAK), rtol=0.02)


def test_the_modes_are_told_apart_by_a_strong_wheel():
    """The precession slows as the wheel, the nutation and the pitch do not."""
    body, stronger = (replace(BODY, wheel_nms=(0.0, 0.0, h)) for h in (0.1, 0.2))
    one, two = convergence(body, WEAK), convergence(stronger, WEAK)
    assert one.precession == pytest.approx(2.0 * two.precession, rel=0.05)
    assert one.nutation == pytest.approx(two.nutation, rel=0.02)
    assert one.pitch == two.pitch
    assert one.nutation < one.precession < 0.0


def test_against_a_wheel_the_drag_drives_the_precession():
    """The free motion is stable there by the gyroscopic torque alone."""
    assert convergence(replace(BODY, wheel_nms=(0.0, 0.0, -0.02)), WEAK).precession > 0.0


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"inertia_kgm2": ((1.4, 0.1, 0.0), (0.1, 1.6, 0.0), (0.0, 0.0, 1.9))}, "principal"),
        ({"wheel_nms": (0.001, 0.0, 0.01)}, "along axis 3"),
        ({"wheel_nms": (0.0, 0.001, 0.01)}, "along axis 3"),
        ({"inertia_kgm2": diagonal((1.6, 1.4, 1.9))}, "not stable"),
        ({"wheel_nms": (0.0, 0.0, -0.0005)}, "not stable"),
    ],
)
def test_what_the_expressions_do_not_hold_for_is_refused(changed, named):
    with pytest.raises(ValueError, match=f"wheeled: .*{named}"):
        convergence(replace(BODY, **changed), WEAK)
