"""The axes of the laws: a turn of body axes onto body axes, its matrix and quaternion the same."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import conjugate, from_dcm, multiply, rotate
from fsw.core.algebra.vector import ZERO, cross, dot
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.plan.law_axes import NAMED, law_axes

V_BODY = (0.3, -1.7, 2.9)
J_BODY = ((1.1, 0.03, -0.07), (0.03, 2.3, 0.05), (-0.07, 0.05, 1.9))
PAIRS = [(up, ahead) for up in NAMED for ahead in NAMED if up[-1] != ahead[-1]]
TURNED = [pair for pair in PAIRS if pair != ("x", "y")]


def test_there_are_24_of_which_the_body_axes_themselves_are_none():
    assert len(PAIRS) == 24
    assert law_axes("x", "y") is None
    found = [law_axes(*pair) for pair in TURNED]
    assert len({(axes.place, axes.sign) for axes in found}) == 23


@pytest.mark.parametrize(("up", "ahead"), TURNED)
class TestATurn:
    def test_components_are_those_along_up_ahead_and_the_normal(self, up, ahead):
        first, second = NAMED[up], NAMED[ahead]
        expected = tuple(dot(axis, V_BODY) for axis in (first, second, cross(first, second)))
        assert law_axes(up, ahead).of_body(V_BODY) == expected

    def test_there_and_back_changes_no_bit(self, up, ahead):
        axes = law_axes(up, ahead)
        assert axes.to_body(axes.of_body(V_BODY)) == V_BODY
        assert axes.of_body(axes.to_body(V_BODY)) == V_BODY

    def test_the_quaternion_turns_as_the_axes_do(self, up, ahead):
        axes = law_axes(up, ahead)
        assert rotate(axes.q_law_from_body, V_BODY) == pytest.approx(axes.of_body(V_BODY), rel=1e-14)

    def test_a_tensor_turns_with_its_vectors(self, up, ahead):
        axes = law_axes(up, ahead)
        turned = np.array(axes.matrix(J_BODY)) @ axes.of_body(V_BODY)
        assert turned == pytest.approx(axes.of_body(tuple(np.array(J_BODY) @ V_BODY)), rel=1e-14)

    def test_the_coil_along_an_axis_keeps_its_misalignment(self, up, ahead):
        """Whatever is asked of the coils in one set of axes gives the dipole that it gives in the other."""
        axes = law_axes(up, ahead)
        coils_body = ((0.98, 0.05, -0.02), (-0.04, 1.03, 0.01), (0.03, -0.06, 0.95))
        asked_body = (0.4, -0.9, 1.3)
        given = tuple(np.array(asked_body) @ np.array(coils_body))
        again = np.array(axes.of_body(asked_body)) @ np.array(axes.matrix(coils_body))
        assert again == pytest.approx(axes.of_body(given), rel=1e-14)

    def test_the_nominal_attitude_is_that_in_which_the_named_axes_are_those_of_the_orbit(self, up, ahead):
        axes = law_axes(up, ahead)
        q_body_from_orbit = conjugate(axes.q_law_from_body)
        assert rotate(q_body_from_orbit, (1.0, 0.0, 0.0)) == pytest.approx(NAMED[up], abs=1e-15)
        assert rotate(q_body_from_orbit, (0.0, 1.0, 0.0)) == pytest.approx(NAMED[ahead], abs=1e-15)
        found = axes.attitude(Attitude(q_body_from_orbit, ZERO, 0.1, 0.2, True, False))
        assert found.q_body_from_orbit == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-15)

    def test_another_attitude_is_as_far_from_nominal_and_as_certain(self, up, ahead):
        axes, turn = law_axes(up, ahead), from_dcm(((0.6, 0.8, 0.0), (-0.8, 0.6, 0.0), (0.0, 0.0, 1.0)))
        of_body = Attitude(multiply(conjugate(axes.q_law_from_body), turn), V_BODY, 0.1, 0.2, False, True)
        found = axes.attitude(of_body)
        assert found.q_body_from_orbit[0] == pytest.approx(turn[0], rel=1e-14)
        assert found.q_body_from_orbit[1:] == pytest.approx(axes.of_body(turn[1:]), abs=1e-14)
        assert found.omega_body_orbit_radps == axes.of_body(V_BODY)
        assert (found.sigma3_attitude_rad, found.sigma3_rate_radps) == (0.1, 0.2)
        assert (found.valid, found.usable) == (False, True)


@pytest.mark.parametrize(("up", "ahead"), [("x", "x"), ("z", "-z")])
def test_no_axis_flies_ahead_that_looks_up_or_down(up, ahead):
    with pytest.raises(ValueError, match=f"'{ahead}' cannot fly ahead where '{up}' looks up"):
        law_axes(up, ahead)
