"""What speaks against a sample by itself: each check at its limit, in its order, by its memory."""

from dataclasses import replace
from math import cos, nan, radians, sin

import pytest
from cell_samples import CELLS
from gate_samples import measured
from with_values import with_values

from fsw.core.algebra.vector import add, norm, scale, unit
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.memory import Memory
from fsw.core.fdir.sensors.plausibility import SHADOW_M, PlausibilityConfig, examine
from fsw.core.fdir.sensors.standstill import Displacement, Steps
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.ephemeris import reference_at
from fsw.core.orbit.sun import apparent_sun
from fsw.wire.messages import CoilStatus, MagField, SunCells, SunVector

LIMITS = PlausibilityConfig(
    field_t=2e-6, field_part=0.01, in_range_t=1e-3, angle_rad=0.05, sun_norm=0.03, late_ticks=0
)
IDLE = CoilStatus(0, 0, 0, 0, 0, 0)
NT = 1e-9


@pytest.fixture(scope="module")
def reference(make_world):
    """Of a sunlit tick."""
    world = make_world()
    world.fly(20)
    found = reference_at(world.state.ephemeris, world.state.tick, world.config.ephemeris)
    assert found.lit
    return found


@pytest.fixture
def readings(reference):
    """Sound readings, with some of the values changed."""

    def make(b_eci_t=None, sun_eci=None, **changed):
        b, s = b_eci_t or reference.b_eci_t, sun_eci or reference.sun_eci
        sound = {
            "field": MagField(1, *scale(1.0 / NT, b), counter=0),
            "sun": SunVector(1, *s, counter=0),
            "coil": IDLE,
        }
        return measured(**(sound | changed))

    return make


def causes(findings):
    return findings.field_cause, findings.sun_cause


def test_sound_samples_have_nothing_against_them_and_agree(reference, readings):
    findings = examine(Memory(), readings(), reference, LIMITS)
    assert causes(findings) == (0, 0)
    assert (findings.pair, findings.apart) == (True, False)


@pytest.mark.requirement("REQ-SENSOR-02")
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_strength_of_the_field_may_be_off_by_offset_and_part_of_its_own(reference, readings, sign):
    size = norm(reference.b_eci_t)
    limit = 2e-6 + 0.01 * size
    inside = scale(1.0 + 0.99 * sign * limit / size, reference.b_eci_t)
    outside = scale(1.0 + 1.01 * sign * limit / size, reference.b_eci_t)
    assert causes(examine(Memory(), readings(inside), reference, LIMITS)) == (0, 0)
    assert causes(examine(Memory(), readings(outside), reference, LIMITS)) == (SensorFault.STRENGTH, 0)


@pytest.mark.parametrize("part", [0.968, 1.032, nan])
def test_the_sun_vector_has_the_length_of_one(reference, readings, part):
    long = readings(sun_eci=scale(part, reference.sun_eci))
    assert causes(examine(Memory(), long, reference, LIMITS)) == (0, SensorFault.STRENGTH)
    good = readings(sun_eci=scale(1.028, reference.sun_eci))
    assert causes(examine(Memory(), good, reference, LIMITS)) == (0, 0)


@pytest.mark.requirement("REQ-SENSOR-01")
def test_a_field_marked_as_not_valid_counts_while_no_coil_drives(reference, readings):
    saturated = readings(field=MagField(0, 1.0, 2.0, 3.0, counter=0))
    assert causes(examine(Memory(), saturated, reference, LIMITS)) == (SensorFault.SATURATED, 0)
    driven = readings(field=MagField(0, 1.0, 2.0, 3.0, counter=0), coil=IDLE.replace(level=2))
    assert causes(examine(Memory(), driven, reference, LIMITS)) == (0, 0)


@pytest.mark.requirement("REQ-SENSOR-01")
def test_an_axis_at_the_end_of_its_range_is_no_fault_in_a_field_that_may_be_beyond_it(reference, readings):
    strength = norm(reference.b_eci_t)
    narrow, wide = (with_values(LIMITS, in_range_t=part * strength) for part in (0.99, 1.01))
    sample = MagField(0, 1.0, 2.0, 3.0, counter=0)
    invalid, at_the_end = readings(field=sample), readings(field=sample, saturated=((0.0, 1.0, 0.0),))
    assert causes(examine(Memory(), at_the_end, reference, narrow)) == (0, 0)
    assert causes(examine(Memory(), at_the_end, reference, wide)) == (SensorFault.SATURATED, 0)
    assert causes(examine(Memory(), invalid, reference, narrow)) == (SensorFault.SATURATED, 0), "a self-test"


@pytest.mark.requirement("REQ-SENSOR-05")
def test_a_missing_sample_speaks_against_its_sensor(reference, readings):
    assert causes(examine(Memory(), readings(field=None), reference, LIMITS)) == (SensorFault.SILENT, 0)
    assert causes(examine(Memory(), readings(sun=None), reference, LIMITS)) == (0, SensorFault.SILENT)
    dark = readings(sun=SunVector(0, 0.0, 0.0, 0.0, counter=0))
    assert causes(examine(Memory(), dark, reference, LIMITS)) == (0, 0), "no Sun is a sample too"


@pytest.mark.requirement("REQ-SENSOR-09")
def test_a_sun_in_certain_shadow_is_none(reference, readings):
    across = turned(reference, radians(90.0))
    for side_m, cause in ((SHADOW_M - 1e3, SensorFault.UNLIT), (SHADOW_M + 1e3, 0)):
        behind = add(scale(-7.0e6, reference.sun_eci), scale(side_m, across))
        dark = reference.replace(r_eci_m=behind, lit=False)
        assert causes(examine(Memory(), readings(), dark, LIMITS))[1] == cause


def behind_the_earth(reference):
    return reference.replace(r_eci_m=scale(-7.0e6, reference.sun_eci), lit=False)


class TestCells:
    """What speaks against several cells in one tick speaks against the board that reads them."""

    LIMITS = with_values(LIMITS, cells=CELLS, sun_norm=0.5)
    BEYOND = 1.0 + CELLS.albedo + 4.0 * CELLS.model_sigma

    def found(self, reference, readings, currents, isolated=()):
        sent = [part * full for part, full in zip(currents, CELLS.full_sun, strict=True)]
        read = readings(sun=None, cells=SunCells(1, *sent, counter=0))
        return examine(Memory(), read, reference, self.LIMITS, None, isolated)

    @pytest.mark.parametrize(
        ("currents", "isolated", "cause"),
        [
            ((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (), 0),
            ((0.3, 0.0, 0.3, 0.0, 0.0, 0.0), (), 0),
            ((0.3, 0.3, 0.3, 0.0, 0.0, 0.0), (), SensorFault.UNLIT),
            ((0.3, 0.3, 0.3, 0.0, 0.0, 0.0), (1,), 0),
            ((0.3, 0.3, 0.3, 0.3, 0.0, 0.0), (1,), SensorFault.UNLIT),
        ],
    )
    def test_more_than_two_lamps_in_the_shadow(self, reference, readings, currents, isolated, cause):
        findings = self.found(behind_the_earth(reference), readings, currents, isolated)
        assert findings.sun_cause == cause
        assert findings.shadow
        assert findings.currents == ((None,) * 6 if cause else pytest.approx(currents))

    def test_in_the_light_many_cells_may_be_lit(self, reference, readings):
        findings = self.found(reference, readings, (0.3, 0.0, 0.6, 0.1, 0.7, 0.1))
        assert findings.sun_cause == 0
        assert not findings.shadow

    @pytest.mark.parametrize("dark", [False, True])
    @pytest.mark.parametrize(
        ("wrong", "isolated", "cause"), [((1, 4), (), SensorFault.STRENGTH), ((1, 4), (4,), 0), ((1,), (), 0)]
    )
    def test_more_than_one_brighter_than_anything_makes_it(
        self, reference, readings, dark, wrong, isolated, cause
    ):
        """A single one is judged by itself, and its message shows nothing about the others."""
        currents = tuple(1.01 * self.BEYOND if cell in wrong else 0.0 for cell in range(6))
        at = behind_the_earth(reference) if dark else reference
        findings = self.found(at, readings, currents, isolated)
        assert findings.sun_cause == cause
        only = tuple(one if cell == 1 and not cause else None for cell, one in enumerate(currents))
        assert findings.currents == pytest.approx(only)

    def test_the_brightest_that_the_table_allows_is_no_fault(self, reference, readings):
        currents = (0.99 * self.BEYOND, 0.0, 0.99 * self.BEYOND, 0.0, 0.0, 0.2)
        findings = self.found(reference, readings, currents)
        assert (findings.sun_cause, findings.currents) == (0, pytest.approx(currents))


@pytest.mark.requirement("REQ-SENSOR-03")
class TestFrozen:
    def fly(self, reference, readings, ticks, still_field, still_sun, late_ticks=0):
        """The findings after ticks in which the others move."""
        memory, findings = Memory(), None
        for tick in range(ticks):
            b = reference.b_eci_t if still_field else scale(1.0 + 1e-4 * tick, reference.b_eci_t)
            s = reference.sun_eci if still_sun else scale(1.0 + 1e-4 * tick, reference.sun_eci)
            limits = with_values(LIMITS, late_ticks=late_ticks)
            findings = examine(memory, readings(b, s), reference, limits)
        return findings

    def test_a_sample_that_is_repeated_while_the_other_moves(self, reference, readings):
        assert causes(self.fly(reference, readings, 1, True, False)) == (0, 0)
        assert causes(self.fly(reference, readings, 2, True, False)) == (SensorFault.FROZEN, 0)
        assert causes(self.fly(reference, readings, 2, False, True)) == (0, SensorFault.FROZEN)

    def test_both_together_are_another_matter(self, reference, readings):
        assert causes(self.fly(reference, readings, 9, True, True)) == (0, 0)

    def test_a_sensor_may_repeat_its_sample_for_as_long_as_it_may_be_late(self, reference, readings):
        assert causes(self.fly(reference, readings, 4, True, False, late_ticks=3)) == (0, 0)
        assert causes(self.fly(reference, readings, 5, True, False, late_ticks=3)) == (SensorFault.FROZEN, 0)

    def test_a_quantised_sample_may_repeat_itself_unless_the_estimate_shows_that_it_moves(
        self, reference, readings, make_world
    ):
        world = make_world()
        world.fly_until_valid()
        known = world.state.estimator.estimate
        limits = with_values(LIMITS, steps=Steps(field_t=2e-7, sun=0.0, tick_s=1.0), late_ticks=1)
        found = {}
        for name, estimate in (("unknown", None), ("known", known)):
            memory, causes_found = Memory(), []
            for tick in range(60):
                moving = scale(1.0 + 1e-4 * tick, reference.sun_eci)
                findings = examine(memory, readings(sun_eci=moving), reference, limits, estimate)
                causes_found.append(findings.field_cause)
            found[name] = causes_found
        assert found["unknown"] == [0] * 60
        first = found["known"].index(SensorFault.FROZEN)
        assert 3 < first < 20
        assert set(found["known"][first:]) == {SensorFault.FROZEN}
        assert memory.motion.of_field.sigma > 0.0
        assert memory.motion.of_sun == Displacement()

    def test_a_continuous_sample_needs_no_estimate(self, reference, readings):
        limits = with_values(LIMITS, steps=Steps(field_t=0.0, sun=4e-3, tick_s=1.0))
        memory = Memory()
        examine(memory, readings(), reference, limits)
        moving = readings(sun_eci=scale(1.0001, reference.sun_eci))
        assert causes(examine(memory, moving, reference, limits)) == (SensorFault.FROZEN, 0)

    def test_without_steps_there_is_no_motion_to_remember(self, reference, readings):
        memory = Memory()
        examine(memory, readings(), reference, LIMITS)
        assert memory.motion is None

    def test_darkness_is_not_frozen(self, reference, readings):
        memory = Memory()
        for _ in range(5):
            dark = readings(sun=SunVector(0, 0.0, 0.0, 0.0, counter=0))
            examine(memory, dark, reference, LIMITS)
        assert memory.sun_still == 0


def turned(reference, angle_rad):
    """The Sun's direction turned towards the field."""
    b = scale(1.0 / norm(reference.b_eci_t), reference.b_eci_t)
    s = reference.sun_eci
    along = sum(x * y for x, y in zip(b, s, strict=True))
    across = tuple(x - along * y for x, y in zip(b, s, strict=True))
    across = scale(1.0 / norm(across), across)
    return tuple(cos(angle_rad) * x + sin(angle_rad) * y for x, y in zip(s, across, strict=True))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_angle_of_field_and_sun_by_what_its_errors_turn_the_field_of_this_tick(reference, readings, sign):
    limit = 0.05 + 2e-6 / norm(reference.b_eci_t)
    for part, apart in ((0.98, False), (1.02, True)):
        sun = turned(reference, sign * part * limit)
        assert examine(Memory(), readings(sun_eci=sun), reference, LIMITS).apart is apart


def test_a_sample_with_something_against_it_is_not_compared(reference, readings):
    weak = readings(scale(0.5, reference.b_eci_t), turned(reference, radians(60.0)))
    findings = examine(Memory(), weak, reference, LIMITS)
    assert findings.field_cause == SensorFault.STRENGTH
    assert (findings.pair, findings.apart) == (False, False)


def test_the_earths_light_may_turn_the_sun_as_far_as_the_table_allows(reference, readings):
    """The angle to the field is then wrong by the deflection, without a fault of either."""
    limits = replace(LIMITS, most_albedo=0.4)
    below_noon = reference.replace(
        r_eci_m=(RADIUS_M + 800e3, 0.0, 0.0), sun_eci=unit((1.0, 1.0, 0.0)), b_eci_t=(3e-5, 0.0, 0.0)
    )

    def apart(albedo, limits=limits):
        seen, _ = apparent_sun(below_noon.r_eci_m, below_noon.sun_eci, albedo)
        return examine(Memory(), readings(below_noon.b_eci_t, seen), below_noon, limits).apart

    assert [apart(albedo) for albedo in (0.0, 0.2, 0.4, 1.0)] == [False, False, False, True]
    assert [apart(albedo, LIMITS) for albedo in (0.0, 0.4)] == [False, True]
