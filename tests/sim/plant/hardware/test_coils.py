from dataclasses import replace
from math import exp

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from sim.plant.config import CoilConfig
from sim.plant.hardware.coils import Coils

TAU = 0.4  # slow, so that every part of the curve counts
LEVELS = (0.5, 2.0, 8.0)
CONFIG = CoilConfig(LEVELS, 11.0, TAU, (0.97, -1.02, 1.05))


def one(coil, level):
    """Currents that drive one coil at a level."""
    amperes = np.sign(level) * (0.0, *LEVELS)[abs(level)] / 11.0
    return tuple(amperes if each == coil else 0.0 for each in range(3))


def test_current_rises_and_decays_exponentially():
    coils = Coils(CONFIG)
    coils.advance(one(1, 3), 1.0, 1.0)
    full = 8.0 / 11.0
    assert coils.readback_a == pytest.approx(full * (1.0 - exp(-1.0 / TAU)))
    coils.advance(one(1, 0), 0.0, 1.0)
    assert coils.readback_a == pytest.approx(full * (1.0 - exp(-1.0 / TAU)) * exp(-1.0 / TAU))


def test_dipole_is_along_the_coil_with_its_sign_and_its_error():
    for coil, scale in enumerate(CONFIG.dipole_scale):
        for level in (-3, -2, -1, 1, 2, 3):
            coils = Coils(CONFIG)
            coils.advance(one(coil, level), 100.0, 100.0)
            nominal = np.sign(level) * CONFIG.levels_am2[abs(level) - 1]
            expected = [nominal * scale * (axis == coil) for axis in range(3)]
            assert coils.dipole_body_am2 == pytest.approx(expected)
            assert coils.readback_a == pytest.approx(nominal / 11.0)


def test_mean_dipole_is_the_integral_of_the_curve_with_the_drive_ending_inside_the_step():
    coils = Coils(CONFIG)
    coils.advance(one(2, 1), 0.3, 1.0)  # starts from a rest of current
    start = coils.readback_a
    on_s, step_s, target = 0.7, 1.0, -2.0 / 11.0

    def current(t):
        rise = target + (start - target) * exp(-min(t, on_s) / TAU)
        return rise * exp(-max(t - on_s, 0.0) / TAU)

    mean = coils.advance(one(2, -2), on_s, step_s)
    integral = quad(current, 0.0, step_s, points=[on_s])[0]
    assert mean == pytest.approx((0.0, 0.0, 11.0 * 1.05 * integral / step_s), rel=1e-9)
    assert coils.readback_a == pytest.approx(current(step_s))


def test_steps_can_be_split_without_moving_the_impulse():
    whole, split = Coils(CONFIG), Coils(CONFIG)
    mean = np.array(whole.advance(one(0, 2), 0.6, 1.0))
    parts = [split.advance(one(0, 2), on_s, 0.25) for on_s in (0.25, 0.25, 0.1, 0.0)]
    assert np.mean(parts, axis=0) == pytest.approx(mean)
    assert split.readback_a == pytest.approx(whole.readback_a)


def test_a_coil_decays_while_the_next_is_driven():
    coils = Coils(CONFIG)
    coils.advance(one(0, 3), 1.0, 1.0)
    before = coils.dipole_body_am2[0]
    mean = coils.advance(one(1, 1), 1.0, 1.0)
    assert coils.dipole_body_am2[0] == pytest.approx(before * exp(-1.0 / TAU))
    assert mean[0] > 0.0
    assert mean[1] < 0.0  # wired the wrong way round


def test_impulse_of_a_whole_pulse_is_that_of_the_drive():
    """What the rise lacks the decay gives back."""
    coils = Coils(CONFIG)
    impulse = sum(coils.advance(one(0, 2), float(step < 3), 1.0)[0] for step in range(100))
    assert impulse == pytest.approx(3.0 * 2.0 * 0.97)


def test_current_dies_away_and_stays_away():
    coils = Coils(CONFIG)
    coils.advance(one(0, 3), 1.0, 1.0)
    for _ in range(60):
        coils.advance(one(0, 0), 0.0, 1.0)
    assert coils.readback_a == 0.0
    assert coils.advance(one(0, 0), 0.0, 1.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("drive", [(0, 0, 1.0), (1, 3, 0.0)])
def test_nothing_flows_without_level_or_time(drive):
    coils = Coils(CONFIG)
    assert coils.advance(one(*drive[:2]), drive[2], 1.0) == (0.0, 0.0, 0.0)
    assert coils.dipole_body_am2 == (0.0, 0.0, 0.0)


def test_without_lag_the_current_is_the_drive():
    coils = Coils(CoilConfig((0.5, 2.0, 8.0), 11.0, 0.0))
    assert coils.advance(one(0, 2), 0.25, 1.0) == pytest.approx((0.5, 0.0, 0.0))
    assert coils.readback_a == 0.0
    coils.advance(one(0, 2), 1.0, 1.0)
    assert coils.readback_a == pytest.approx(2.0 / 11.0)


def test_three_coils_at_once_are_three_coils_one_at_a_time():
    """Each has its own current; the supply reads their sum."""
    driven_a, on_s = (0.05, -0.4, 0.3), 0.7
    together, apart = Coils(CONFIG), [Coils(CONFIG) for _ in range(3)]
    for step in range(4):
        mean = together.advance(driven_a, on_s if step < 2 else 0.0, 1.0)
        means = [
            coils.advance(
                tuple(a * (axis == coil) for axis, a in enumerate(driven_a)), on_s * (step < 2), 1.0
            )
            for coil, coils in enumerate(apart)
        ]
        assert mean == pytest.approx(np.sum(means, axis=0), rel=1e-14)
        assert all(mean)
        assert together.readback_a == pytest.approx(sum(coils.readback_a for coils in apart), rel=1e-14)
        assert together.dipole_body_am2 == tuple(coils.dipole_body_am2[i] for i, coils in enumerate(apart))


TURNS = ((0.02, -0.03, 0.05), (0.04, 0.01, -0.02), (-0.03, 0.05, 0.01))


def test_an_axis_that_is_turned_gives_its_dipole_along_the_turned_axis():
    """The same currents along the axes that scipy turns."""
    driven_a, straight, turned = (
        (0.05, -0.4, 0.3),
        Coils(CONFIG),
        Coils(replace(CONFIG, misalignment_rad=TURNS)),
    )
    axes = [Rotation.from_rotvec(turn).apply(axis) for turn, axis in zip(TURNS, np.eye(3), strict=True)]
    for on_s in (0.7, 0.0):
        by_coil, mean = (np.array(coils.advance(driven_a, on_s, 1.0)) for coils in (straight, turned))
        assert mean == pytest.approx(by_coil @ axes, rel=1e-12)
        assert turned.dipole_body_am2 == pytest.approx(straight.dipole_body_am2 @ np.array(axes), rel=1e-12)
        assert turned.readback_a == straight.readback_a
        assert np.abs(mean - by_coil).min() > 1e-3


def test_axes_that_are_not_turned_give_the_same_bits():
    plain, zero = Coils(CONFIG), Coils(replace(CONFIG, misalignment_rad=((0.0, 0.0, 0.0),) * 3))
    assert plain.advance(one(1, 3), 0.7, 1.0) == zero.advance(one(1, 3), 0.7, 1.0)
    assert plain.dipole_body_am2 == zero.dipole_body_am2


KEEPS = replace(CONFIG, time_constant_s=0.0, remanence_part=0.02)


class TestRemanence:
    def test_a_part_of_the_last_pulse_stays_until_the_next(self):
        """By hand, coil 2: 2 % of its dipole of 8 at 1.05, then 2 % of -0.5."""
        coils = Coils(KEEPS)
        for level, kept in (
            (0, 0.0),
            (3, 0.0),
            (0, 0.168),
            (0, 0.168),
            (-1, 0.0),
            (0, -0.0105),
            (0, -0.0105),
        ):
            coils.advance(one(2, level), float(level != 0), 1.0)
            assert coils.remanence_body_am2 == pytest.approx((0.0, 0.0, kept), abs=1e-15)
            assert coils.mean_remanence_body_am2 == pytest.approx((0.0, 0.0, kept), abs=1e-15)

    def test_each_coil_keeps_its_own(self):
        coils = Coils(KEEPS)
        for coil, level in ((0, 3), (1, -2), (2, 1), (0, -1)):
            coils.advance(one(coil, level), 1.0, 1.0)
        coils.advance(one(0, 0), 0.0, 1.0)
        expected = 0.02 * np.array([-0.5 * 0.97, -2.0 * -1.02, 0.5 * 1.05])
        assert coils.remanence_body_am2 == pytest.approx(expected)

    def test_a_pulse_that_ends_inside_a_step_leaves_its_part_for_the_rest(self):
        coils = Coils(KEEPS)
        coils.advance(one(0, 3), 0.7, 1.0)
        full = 0.02 * 8.0 * 0.97
        assert coils.remanence_body_am2 == pytest.approx((full, 0.0, 0.0))
        assert coils.mean_remanence_body_am2 == pytest.approx((0.3 * full, 0.0, 0.0))
        assert coils.dipole_body_am2 == coils.remanence_body_am2  # no lag, so no current is left

    def test_it_is_along_the_coil_and_none_of_the_read_back(self):
        turned, straight = Coils(replace(KEEPS, misalignment_rad=TURNS)), Coils(KEEPS)
        for coils in (turned, straight):
            coils.advance((0.05, -0.4, 0.3), 0.5, 1.0)
        axes = [Rotation.from_rotvec(turn).apply(axis) for turn, axis in zip(TURNS, np.eye(3), strict=True)]
        assert turned.remanence_body_am2 == pytest.approx(straight.remanence_body_am2 @ np.array(axes))
        assert turned.readback_a == 0.0

    def test_without_it_nothing_is_kept(self):
        coils = Coils(CONFIG)
        coils.advance(one(0, 3), 0.7, 1.0)
        assert coils.remanence_body_am2 == coils.mean_remanence_body_am2 == (0.0, 0.0, 0.0)

    @pytest.mark.parametrize("part", [-0.01, 1.01, float("nan")])
    def test_a_part_that_is_none_is_refused(self, part):
        with pytest.raises(ValueError, match="remanence_part must lie between 0 and 1"):
            replace(CONFIG, remanence_part=part)


def test_an_output_drives_the_coil_that_it_is_wired_to_with_its_own_gain_and_turn():
    """Output 2 lies against axis 3: its gain and its turn go with the output."""
    turns = ((0.0, 0.0, 0.0), (0.0, 0.05, 0.0), (0.0, 0.0, 0.0))
    coils = Coils(replace(CONFIG, wiring=(2, -3, 1), misalignment_rad=turns))
    coils.advance(one(1, 3), 100.0, 100.0)
    turned = Rotation.from_rotvec(turns[1]).apply([0.0, 0.0, -1.0])
    assert coils.dipole_body_am2 == pytest.approx(8.0 * -1.02 * turned)


def test_a_core_keeps_nothing_while_its_coil_is_held_on_and_a_part_afterwards():
    coils = Coils(CoilConfig(LEVELS, 11.0, 0.0, remanence_part=0.1))
    driven, held = (0.1, -0.2, 0.0), (0.0, -0.2, 0.0)
    assert coils.advance(driven, 0.25, 1.0, held) == pytest.approx((0.275, -2.2, 0.0))
    assert coils.mean_remanence_body_am2 == pytest.approx((0.1 * 1.1 * 0.75, 0.0, 0.0))
    assert coils.remanence_body_am2 == pytest.approx((0.11, 0.0, 0.0))
    coils.advance(driven, 0.0, 1.0, held)
    assert coils.mean_remanence_body_am2 == pytest.approx((0.11, 0.0, 0.0))
    coils.advance((0.0, 0.0, 0.0), 0.0, 1.0)
    assert coils.remanence_body_am2 == pytest.approx((0.11, -0.22, 0.0))
