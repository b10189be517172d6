"""The parameters of a satellite: their places in the error state, and what they do to rotor and dipole."""

import numpy as np
import pytest
from changed import changed

from fsw.core.algebra.vector import inverse
from fsw.core.estimation.parameters import (
    NAMES,
    NOTHING,
    SIZES,
    Parameters,
    Rotor,
    correct_parameters,
    difference,
    estimated_dipole,
    estimated_rotor,
    layout,
)


class TestLayout:
    def test_without_any_there_are_attitude_and_rate(self):
        places = layout(set())
        assert (places.size, places.carried) == (6, ())
        assert places.mag_bias is places.torque is places.dipole is places.coils is places.inertia is None
        assert places.mag_turn is places.mag_scale is places.sun_turn is places.delay is places.cells is None

    def test_all_of_them_stand_in_their_order_without_a_gap(self):
        places = layout(set(NAMES))
        assert places.size == 6 + sum(SIZES.values()) == 54
        assert (places.mag_bias, places.torque, places.dipole) == (slice(6, 9), slice(9, 12), slice(12, 15))
        assert (places.coils, places.inertia) == (slice(15, 24), slice(24, 30))
        assert (places.mag_turn, places.mag_scale, places.sun_turn) == (
            slice(30, 33),
            slice(33, 36),
            slice(36, 39),
        )
        assert (places.delay, places.cells) == (slice(39, 41), slice(41, 47))
        assert (places.cell_gain, places.earth_light) == (slice(47, 53), slice(53, 54))

    @pytest.mark.parametrize("name", NAMES)
    def test_one_alone_comes_first_and_one_left_out_leaves_no_gap(self, name):
        alone = layout({name})
        assert alone.carried == ((name, slice(6, 6 + SIZES[name])),)
        without = layout(set(NAMES) - {name})
        assert without.size == 54 - SIZES[name]
        assert name not in [known for known, _ in without.carried]
        ends = [place.stop for _, place in without.carried]
        assert [place.start for _, place in without.carried] == [6, *ends[:-1]]

    @pytest.mark.parametrize("name", NAMES)
    def test_each_has_a_place_of_its_own_name(self, name):
        own = {
            "mag_bias_t": "mag_bias",
            "torque_body_nm": "torque",
            "dipole_body_am2": "dipole",
            "coil_error": "coils",
            "inertia_error_kgm2": "inertia",
            "mag_turn_rad": "mag_turn",
            "mag_scale": "mag_scale",
            "sun_turn_rad": "sun_turn",
            "delay_s": "delay",
            "cell_excess": "cells",
            "cell_gain": "cell_gain",
            "earth_light": "earth_light",
        }
        places = layout({name})
        assert {field for field in own.values() if getattr(places, field) is not None} == {own[name]}


class TestCorrection:
    def test_adds_what_the_error_state_holds_to_what_is_carried_alone(self):
        places = layout({"mag_scale", "torque_body_nm"})
        error = (*[9.0] * 6, 1e-8, -2e-8, 3e-8, 0.001, 0.002, -0.003)
        before = Parameters(
            torque_body_nm=(5e-8, 6e-8, 7e-8), mag_scale=(0.01, 0.02, 0.03), dipole_body_am2=(0.1, 0.2, 0.3)
        )
        after = changed(before, correct_parameters, error, places)
        assert after.torque_body_nm == pytest.approx((6e-8, 4e-8, 1e-7))
        assert after.mag_scale == pytest.approx((0.011, 0.022, 0.027))
        rest = set(NAMES) - {"mag_scale", "torque_body_nm"}
        assert all(getattr(after, name) == getattr(before, name) for name in rest)

    def test_leaves_the_parameters_where_none_is_carried(self, full):
        after = changed(full.parameters, correct_parameters, (1.0,) * 6, layout(set()))
        assert after == full.parameters

    @pytest.mark.parametrize("names", [NAMES, NAMES[::2], NAMES[1::3], NAMES[-4:]])
    def test_the_difference_that_it_makes_is_the_error_state_s(self, names, full):
        places = layout(set(names))
        error = (*[0.0] * 6, *[0.5**n for n in range(places.size - 6)])
        before = Parameters(cell_excess=(0.0,) * 6, cell_gain=(0.0,) * 6, earth_light=(0.0,))
        after = changed(before, correct_parameters, error, places)
        assert difference(before, after, places) == list(error[6:])
        assert {name for name in NAMES if getattr(after, name) != getattr(before, name)} == set(names)
        assert sum(after.floats()) == sum(error)


class TestRotor:
    NOMINAL = Rotor(
        ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45)), ((0.0,) * 3,) * 3, (0.01, -0.02, 0.03)
    )

    def test_has_the_inertia_of_the_table_and_its_error_and_the_table_s_wheel(self):
        error = (0.05, -0.08, 0.06, 0.011, -0.009, 0.013)
        rotor = estimated_rotor(self.NOMINAL, Parameters(inertia_error_kgm2=error))
        expected = np.add(
            self.NOMINAL.inertia_kgm2, [[0.05, 0.011, -0.009], [0.011, -0.08, 0.013], [-0.009, 0.013, 0.06]]
        )
        np.testing.assert_allclose(rotor.inertia_kgm2, expected, rtol=1e-14)
        np.testing.assert_allclose(rotor.inertia_inverse, np.linalg.inv(expected), rtol=1e-12)
        assert rotor.wheel_body_nms == self.NOMINAL.wheel_body_nms

    def test_without_an_error_is_the_table_s(self):
        rotor = estimated_rotor(self.NOMINAL, NOTHING)
        assert rotor.inertia_kgm2 == self.NOMINAL.inertia_kgm2
        assert rotor.inertia_inverse == inverse(self.NOMINAL.inertia_kgm2)


class TestDipole:
    DRIVEN_AM2 = (0.3, -8.0, 2.0)

    def test_is_what_the_coils_make_of_the_drive_and_the_residual_one(self, full):
        """(1 + G) m_driven + d."""
        coils = np.eye(3) + np.reshape(full.parameters.coil_error, (3, 3))
        expected = coils @ self.DRIVEN_AM2 + full.parameters.dipole_body_am2
        np.testing.assert_allclose(estimated_dipole(self.DRIVEN_AM2, full.parameters), expected, rtol=1e-14)

    def test_of_a_satellite_as_in_its_table_is_the_driven_one(self):
        assert estimated_dipole(self.DRIVEN_AM2, NOTHING) == self.DRIVEN_AM2

    def test_while_nothing_is_driven_is_the_residual_one(self, full):
        assert estimated_dipole((0.0, 0.0, 0.0), full.parameters) == full.parameters.dipole_body_am2


def test_the_checksum_of_the_state_has_every_number():
    numbers = iter(range(1, 49))
    parameters = Parameters(*[tuple(next(numbers) for _ in range(SIZES[name])) for name in NAMES])
    assert parameters.floats() == tuple(range(1, 49))
