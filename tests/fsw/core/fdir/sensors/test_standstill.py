"""For how long a quantised reading may stand still: until what it measures has certainly moved further."""

from functools import cache
from math import hypot, sqrt

import numpy as np
import pytest
from cell_samples import REFERENCE
from filter_steps import plain_filter
from with_values import with_values

from fsw.core.algebra.quaternion import from_small_rotation, multiply, normalise, rotate
from fsw.core.algebra.vector import add, scale, sub
from fsw.core.estimation import mekf
from fsw.core.fdir.evidence import SIGMAS
from fsw.core.fdir.sensors.standstill import Displacement, ReadingMotion, Steps, is_frozen, update_motion

STEPS = Steps(field_t=2e-7, sun=4e-3, tick_s=0.5)
OMEGA = (0.002, -0.003, 0.001)
Q_BODY_FROM_ECI = normalise((0.6, -0.4, 0.5, 0.3))
BOTH = (True, True)


class Models:
    """Field and Sun at the start; the field changes along the orbit."""

    b_eci_t, sun_eci, b_rate_eci_tps = (1.7e-5, -2.3e-5, 3.1e-5), (0.6, -0.48, 0.64), (3e-8, 5e-8, -2e-8)


@cache
def tuning(sigma_radps):
    return plain_filter(
        (1.02, 1.85, 1.95), STEPS.tick_s, attitude_sigma_rad=0.02, rate_sigma_radps=sigma_radps
    )


def estimated(q=Q_BODY_FROM_ECI, sigma_radps=1e-9):
    return mekf.start(q, OMEGA, tuning(sigma_radps))


def reference_at(time_s):
    """The models so many seconds on."""
    b_eci_t = add(Models.b_eci_t, scale(time_s, Models.b_rate_eci_tps))
    return REFERENCE.replace(b_eci_t=b_eci_t, sun_eci=Models.sun_eci, b_rate_eci_tps=Models.b_rate_eci_tps)


def attitude(time_s):
    """Of a satellite that turns with OMEGA, from the eci axes."""
    return multiply(Q_BODY_FROM_ECI, from_small_rotation(scale(time_s, OMEGA)))


def after(ticks, motion=None, still=BOTH, steps=STEPS, **estimate):
    """The motion after these ticks, by default from rest."""
    motion = ReadingMotion() if motion is None else motion
    for tick in range(ticks):
        time_s = (tick + 0.5) * steps.tick_s
        update_motion(motion, *still, estimated(attitude(time_s), **estimate), reference_at(time_s), steps)
    return motion


def frozen(motion, still, steps):
    """Of field and Sun."""
    field_still, sun_still = still
    of_field, of_sun = motion.of_field, motion.of_sun
    return is_frozen(of_field, field_still, steps.field_t), is_frozen(of_sun, sun_still, steps.sun)


def test_the_motion_is_the_difference_of_what_is_measured_at_both_ends():
    """Of the rotation and of the field's own change."""
    ticks = 40
    motion = after(ticks)
    time_s = ticks * STEPS.tick_s
    q = attitude(time_s)
    of_field = sub(rotate(q, reference_at(time_s).b_eci_t), rotate(Q_BODY_FROM_ECI, Models.b_eci_t))
    of_sun = sub(rotate(q, Models.sun_eci), rotate(Q_BODY_FROM_ECI, Models.sun_eci))
    np.testing.assert_allclose(motion.of_field.by_body, of_field, atol=0.02 * np.linalg.norm(of_field))
    np.testing.assert_allclose(motion.of_sun.by_body, of_sun, atol=0.02 * np.linalg.norm(of_sun))


def test_its_error_is_the_rate_s_for_all_the_time():
    motion = after(8, sigma_radps=3e-4)
    sigma_rad = sqrt(3.0) * 3e-4 * 8 * STEPS.tick_s
    strengths = [np.linalg.norm(reference_at((tick + 0.5) * STEPS.tick_s).b_eci_t) for tick in range(8)]
    assert motion.of_field.sigma == pytest.approx(sigma_rad * np.mean(strengths))
    assert motion.of_sun.sigma == pytest.approx(sigma_rad)


def test_a_reading_that_changes_begins_anew():
    motion = after(5)
    update_motion(motion, False, True, estimated(), reference_at(0.0), STEPS)
    assert motion.of_field == Displacement()
    assert motion.of_sun != Displacement()
    motion = after(5)
    update_motion(motion, True, False, estimated(), reference_at(0.0), STEPS)
    assert motion.of_field != Displacement()
    assert motion.of_sun == Displacement()


def test_what_is_not_known_counts_as_rest():
    motion = after(5)
    update_motion(motion, *BOTH, None, reference_at(0.0), STEPS)
    assert motion == after(5)


@pytest.mark.parametrize("step", [0.1, 3e-7])
def test_a_step_hides_its_length_on_each_axis_and_the_rate_s_error_some_more(step):
    limit = sqrt(3.0) * step + SIGMAS * 0.2 * step
    assert not Displacement((0.99 * limit, 0.0, 0.0), 0.2 * step).exceeds(step)
    assert Displacement((0.0, -1.01 * limit, 0.0), 0.2 * step).exceeds(step)


def test_what_rounds_to_the_same_never_looks_frozen():
    random = np.random.default_rng(5)
    for _ in range(1000):
        cell = random.integers(-9, 9, 3)
        a, b = (STEPS.sun * (cell + random.uniform(-0.5, 0.5, 3)) for _ in range(2))
        assert not Displacement(tuple(b - a)).exceeds(STEPS.sun)


def test_only_what_stands_still_and_should_not_is_frozen():
    far, near = (Displacement((part, 0.0, 0.0)) for part in (1.0, 1e-12))
    assert frozen(ReadingMotion(far, far), BOTH, STEPS) == (True, True)
    assert frozen(ReadingMotion(far, near), BOTH, STEPS) == (True, False)
    assert frozen(ReadingMotion(near, far), BOTH, STEPS) == (False, True)
    assert frozen(ReadingMotion(far, far), (False, False), STEPS) == (False, False)


def test_a_continuous_reading_never_stands_still():
    of_field, of_sun = with_values(STEPS, sun=0.0), with_values(STEPS, field_t=0.0)
    assert frozen(ReadingMotion(), BOTH, of_field) == (False, True)
    assert frozen(ReadingMotion(), BOTH, of_sun) == (True, False)
    assert after(3, steps=of_field).of_sun == Displacement()
    assert after(3, steps=of_sun).of_field == Displacement()


def test_a_rate_that_is_hardly_known_shows_nothing():
    known, unknown = after(400, sigma_radps=1e-6), after(400, sigma_radps=hypot(*OMEGA))
    assert frozen(known, BOTH, STEPS) == (True, True)
    assert frozen(unknown, BOTH, STEPS) == (False, False)
