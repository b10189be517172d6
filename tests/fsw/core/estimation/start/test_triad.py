"""TRIAD against reference attitudes made with 40 digits, and what it takes to start a filter."""

import csv
from math import degrees, radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import add, cross, norm, scale, unit
from fsw.core.estimation.start.triad import consistent, triad
from sim.validate.reference.reference_table import DATA

REFERENCE = DATA / "triad_mekf.csv"
TOLERANCE_RAD = 1e-9
"""As the reference states."""


def reference_cases():
    lines = [line for line in REFERENCE.read_text().splitlines() if not line.startswith("#")]
    return [pytest.param(row, id=f"{row['case']}-{row['kind']}") for row in csv.DictReader(lines)]


def vector(row, name):
    return tuple(float(row[f"{name}_{axis}"]) for axis in "xyz")


def quaternion(row, name):
    return tuple(float(row[f"{name}_{index}"]) for index in range(4))


def angle_between_rad(p, q):
    turn = multiply(conjugate(normalise(p)), normalise(q))
    return 2.0 * np.arctan2(norm(turn[1:]), abs(turn[0]))


@pytest.mark.parametrize("row", reference_cases())
class TestReference:
    def test_attitude(self, row):
        ours = triad(vector(row, "b1"), vector(row, "b2"), vector(row, "r1"), vector(row, "r2"))
        assert angle_between_rad(ours, quaternion(row, "q_triad")) < TOLERANCE_RAD

    def test_lengths_do_not_matter(self, row):
        ours = triad(
            scale(3.1e-5, vector(row, "b1")),
            scale(7.0, vector(row, "b2")),
            scale(0.02, vector(row, "r1")),
            scale(4.2e-5, vector(row, "r2")),
        )
        assert angle_between_rad(ours, quaternion(row, "q_triad")) < TOLERANCE_RAD

    def test_maps_the_primary_exactly(self, row):
        b1, r1 = vector(row, "b1"), vector(row, "r1")
        ours = triad(b1, vector(row, "b2"), r1, vector(row, "r2"))
        assert norm(cross(unit(b1), rotate(ours, unit(r1)))) < 1e-14

    def test_maps_the_plane_of_the_pair(self, row):
        b1, b2, r1, r2 = (vector(row, name) for name in ("b1", "b2", "r1", "r2"))
        normal_body, normal_ref = unit(cross(b1, b2)), unit(cross(r1, r2))
        assert norm(cross(normal_body, rotate(triad(b1, b2, r1, r2), normal_ref))) < TOLERANCE_RAD


def test_the_reference_has_cases_of_every_kind():
    kinds = {parameters.values[0]["kind"] for parameters in reference_cases()}
    assert {"identity", "half_turn", "near_half_turn", "orthogonal", "noise_free", "general"} <= kinds


LIMITS = {
    "max_field_error_t": 3e-6,
    "max_angle_error_rad": radians(5.0),
    "min_separation_rad": radians(15.0),
}
B_ECI_T = (2.1e-5, -1.3e-5, 3.2e-5)
S_ECI = unit((-0.4, 0.8, 0.3))
TURN = normalise((0.5, -0.3, 0.6, 0.2))


def turned_towards(vector, goal, angle_rad):
    """``vector`` turned by an angle in the plane of both."""
    return tuple(Rotation.from_rotvec(np.array(unit(cross(vector, goal))) * angle_rad).apply(vector).tolist())


class TestConsistency:
    """A pair starts the filter only if strength and angle are those of the model."""

    def seen(self, b_eci_t=B_ECI_T, s_eci=S_ECI):
        return rotate(TURN, b_eci_t), rotate(TURN, s_eci)

    def test_a_perfect_pair_passes_in_any_attitude(self):
        assert consistent(*self.seen(), B_ECI_T, S_ECI, **LIMITS)

    @pytest.mark.parametrize(
        ("error_t", "passes"), [(2.9e-6, True), (-2.9e-6, True), (3.1e-6, False), (-3.1e-6, False)]
    )
    def test_strength_of_the_field(self, error_t, passes):
        b, s = self.seen()
        longer = add(b, scale(error_t, unit(b)))
        assert consistent(longer, s, B_ECI_T, S_ECI, **LIMITS) is passes

    @pytest.mark.parametrize(
        ("error_deg", "passes"), [(4.9, True), (-4.9, True), (5.1, False), (-5.1, False)]
    )
    def test_angle_between_field_and_sun(self, error_deg, passes):
        b, s = self.seen()
        moved = turned_towards(s, b, radians(error_deg))
        assert consistent(b, moved, B_ECI_T, S_ECI, **LIMITS) is passes

    @pytest.mark.parametrize("opposite", [1.0, -1.0])
    @pytest.mark.parametrize(("separation_deg", "passes"), [(10.0, False), (14.5, False), (17.0, True)])
    def test_nearly_parallel_pairs_tell_no_attitude(self, separation_deg, passes, opposite):
        s_eci = turned_towards(scale(opposite, unit(B_ECI_T)), S_ECI, radians(separation_deg))
        b, s = self.seen(s_eci=s_eci)
        assert consistent(b, s, B_ECI_T, s_eci, **LIMITS) is passes

    def test_a_mirrored_field_does_not_pass(self):
        b, s = self.seen()
        angle = degrees(np.arccos(np.dot(unit(B_ECI_T), S_ECI)))
        assert abs(180.0 - 2.0 * angle) > 5.0
        assert not consistent(scale(-1.0, b), s, B_ECI_T, S_ECI, **LIMITS)

    @pytest.mark.parametrize("bad", [(0.0, 0.0, 0.0), (float("nan"), 1e-5, 2e-5), (float("inf"), 0.0, 0.0)])
    def test_no_field_and_no_number_do_not_pass(self, bad):
        assert not consistent(bad, self.seen()[1], B_ECI_T, S_ECI, **LIMITS)

    @pytest.mark.parametrize("bad", [(float("nan"), 0.5, 0.5), (float("inf"), 0.0, 0.0)])
    def test_no_sun_that_is_no_number(self, bad):
        assert not consistent(self.seen()[0], bad, B_ECI_T, S_ECI, **LIMITS)
