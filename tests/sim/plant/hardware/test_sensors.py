from dataclasses import replace
from math import radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.plant.hardware.sensors import Delay, MagnetometerPhysics, SunSensorPhysics
from sim.plant.sensor_config import MagnetometerConfig, SunSensorConfig

B = (1.1e-5, -2.3e-5, 3.1e-5)
S = (0.6, -0.48, 0.64)
OFF = (0.0, 0.0, 0.0)


def read_field(config, m=OFF, b=B, seed=1):
    return MagnetometerPhysics(config, seed).measure(b, m)


def read_sun(config, lit=1.0, seed=1):
    return SunSensorPhysics(config, seed).measure(S, lit)


def test_perfect_sensors_show_the_truth():
    assert read_field(MagnetometerConfig()) == (pytest.approx(B, rel=1e-15), True)
    assert read_sun(SunSensorConfig()) == (pytest.approx(S, rel=1e-15), True)


def test_bias_and_scale_are_added_and_multiplied_on_their_axes():
    config = MagnetometerConfig(bias_t=(3e-7, -2e-7, 1e-7), scale=(1.01, 0.98, 1.03))
    expected = np.array(B) * (1.01, 0.98, 1.03) + (3e-7, -2e-7, 1e-7)
    assert read_field(config)[0] == pytest.approx(expected)


def test_misalignment_turns_the_sensor():
    tilt = (0.02, -0.03, 0.05)
    sensor_from_body = Rotation.from_rotvec(tilt).inv()
    assert read_field(MagnetometerConfig(misalignment_rad=tilt))[0] == pytest.approx(
        sensor_from_body.apply(B)
    )
    assert read_sun(SunSensorConfig(misalignment_rad=tilt))[0] == pytest.approx(sensor_from_body.apply(S))


SKEW = (radians(2.0), radians(-3.0), radians(1.5))


def sensed_axes(**errors):
    """Directions of the three sensors, body axes: their answers to a field along each body axis."""
    fields = np.eye(3) * 3e-5
    columns = [read_field(MagnetometerConfig(**errors), b=tuple(field))[0] for field in fields]
    return np.array(columns).T / 3e-5


def test_sensor_axes_lack_their_angles_of_a_right_angle():
    x, y, z = sensed_axes(non_orthogonality_rad=SKEW)
    assert np.linalg.norm([x, y, z], axis=1) == pytest.approx(1.0, rel=1e-14)
    assert [np.arccos(x @ y), np.arccos(x @ z), np.arccos(y @ z)] == pytest.approx(
        np.pi / 2.0 - np.array(SKEW)
    )
    assert x == pytest.approx([1.0, 0.0, 0.0])
    assert y[2] == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.det([x, y, z]) > 0.99


def test_a_single_skew_turns_one_axis_towards_another():
    """By hand: the z sensor leans by 2 degrees towards y."""
    _, _, z = sensed_axes(non_orthogonality_rad=(0.0, 0.0, radians(2.0)))
    assert z == pytest.approx([0.0, np.sin(radians(2.0)), np.cos(radians(2.0))])


def test_the_skew_is_between_the_axes_of_the_turned_sensor():
    tilt = (0.02, -0.03, 0.05)
    straight, turned = (
        sensed_axes(non_orthogonality_rad=SKEW),
        sensed_axes(non_orthogonality_rad=SKEW, misalignment_rad=tilt),
    )
    assert turned == pytest.approx(Rotation.from_rotvec(tilt).apply(straight), abs=1e-14)


def test_without_skew_the_reading_has_the_same_bits():
    tilted = MagnetometerConfig(misalignment_rad=(0.02, -0.03, 0.05), noise_t=2e-7)
    assert read_field(replace(tilted, non_orthogonality_rad=OFF)) == read_field(tilted)


def test_errors_come_in_their_order_turned_then_scaled_then_biased():
    tilt, scale, bias = (0.02, -0.03, 0.05), (1.5, 0.5, 1.7), (1e-6, 2e-6, 3e-6)
    config = MagnetometerConfig(bias_t=bias, scale=scale, misalignment_rad=tilt)
    expected = np.array(scale) * Rotation.from_rotvec(tilt).inv().apply(B) + bias
    assert read_field(config)[0] == pytest.approx(expected)


def test_coils_add_their_own_field():
    """0.1 A m^2 at 0.1 m on its axis: mu0 m / (2 pi r^3) = 20 uT, as large as the Earth's field."""
    on_axis = 2e-7 / 0.1**3
    config = MagnetometerConfig(
        coil_coupling_t_per_am2=((on_axis, 2e-6, 3e-6), (4e-6, -0.5 * on_axis, 5e-6), (6e-6, 7e-6, 8e-6))
    )
    own = np.array(read_field(config, (0.1, 0.0, 0.0))[0]) - B
    assert own == pytest.approx([2e-5, 4e-7, 6e-7])
    own = np.array(read_field(config, (0.0, 0.1, 0.0))[0]) - B
    assert own == pytest.approx([2e-7, -1e-5, 7e-7])
    assert read_field(config)[0] == pytest.approx(B)


def test_magnetometer_noise_is_white_with_the_given_deviation():
    sensor = MagnetometerPhysics(MagnetometerConfig(noise_t=2e-7), 5)
    errors = np.array([sensor.measure(B, OFF)[0] for _ in range(5000)]) - B
    assert errors.std(axis=0) == pytest.approx([2e-7] * 3, rel=0.05)
    assert np.abs(errors.mean(axis=0)).max() < 4.0 * 2e-7 / np.sqrt(5000)
    assert np.abs(np.corrcoef(errors.T) - np.eye(3)).max() < 0.06


def test_sun_noise_is_an_angle_across_the_line_of_sight():
    sensor = SunSensorPhysics(SunSensorConfig(noise_rad=radians(0.5)), 5)
    readings = np.array([sensor.measure(S, 1.0)[0] for _ in range(5000)])
    assert np.linalg.norm(readings, axis=1) == pytest.approx(1.0, abs=1e-14)
    across = np.cross(S, readings)
    assert np.degrees(np.sqrt((across**2).sum(axis=1).mean() / 2.0)) == pytest.approx(0.5, rel=0.05)
    assert np.abs(across.mean(axis=0)).max() < 4.0 * radians(0.5) / np.sqrt(5000)


def test_readings_are_whole_quanta():
    field, _ = read_field(MagnetometerConfig(noise_t=2e-7, quantum_t=3e-8))
    assert np.array(field) / 3e-8 == pytest.approx(np.round(np.array(field) / 3e-8), abs=1e-9)
    sun, _ = read_sun(SunSensorConfig(noise_rad=0.01, quantum=1e-3))
    assert np.array(sun) / 1e-3 == pytest.approx(np.round(np.array(sun) / 1e-3), abs=1e-9)
    exact, _ = read_field(MagnetometerConfig(quantum_t=3e-8))
    assert np.abs(np.array(exact) - B).max() <= 1.5e-8 * (1 + 1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_one_saturated_axis_spoils_the_sample_and_is_held_at_the_end_of_the_range(axis, sign):
    b = [1e-5, -1e-5, 1e-5]
    b[axis] = sign * 5.1e-5
    reading, valid = read_field(MagnetometerConfig(saturation_t=5e-5), b=tuple(b))
    assert not valid
    assert reading[axis] == sign * 5e-5
    b[axis] = sign * 4.9e-5
    assert read_field(MagnetometerConfig(saturation_t=5e-5), b=tuple(b)) == (pytest.approx(b), True)


@pytest.mark.parametrize(("lit", "valid"), [(0.0, False), (0.499, False), (0.5, True), (1.0, True)])
def test_sun_is_seen_while_half_of_it_is(lit, valid):
    reading, seen = read_sun(SunSensorConfig(), lit)
    assert seen is valid
    assert reading == (pytest.approx(S) if valid else OFF)


def test_noise_of_a_sample_does_not_depend_on_what_was_sensed_before():
    """An eclipse or a saturated sample draws its numbers all the same."""
    sun_config, field_config = SunSensorConfig(noise_rad=0.01), MagnetometerConfig(noise_t=2e-7)
    dark, light = SunSensorPhysics(sun_config, 1), SunSensorPhysics(sun_config, 1)
    dark.measure(S, 0.0)
    light.measure(S, 1.0)
    assert dark.measure(S, 1.0) == light.measure(S, 1.0)
    strong, weak = MagnetometerPhysics(field_config, 1), MagnetometerPhysics(field_config, 1)
    strong.measure((1.0, 1.0, 1.0), OFF)
    weak.measure(OFF, OFF)
    assert strong.measure(B, OFF) == weak.measure(B, OFF)


def test_sensors_of_one_seed_have_their_own_noise():
    field, _ = read_field(MagnetometerConfig(noise_t=1.0, saturation_t=99.0), b=OFF)
    config = SunSensorConfig(noise_rad=1e-6)
    across = np.cross(S, read_sun(config)[0]) / 1e-6
    expected = np.cross(S, np.cross(field, S))
    assert np.abs(across - expected).max() > 0.1
    assert np.abs(across + expected).max() > 0.1


def test_configuration_can_be_replaced_in_part():
    config = replace(MagnetometerConfig(noise_t=2e-7), noise_t=0.0)
    assert read_field(config)[0] == pytest.approx(B)


class TestLatency:
    @pytest.mark.parametrize("tick_hz", [1, 4, 10])
    @pytest.mark.parametrize("latency_s", [0.05, 0.3, 0.5, 1.0, 2.5, 3.7])
    def test_a_steady_change_is_shown_late_by_just_that_time(self, latency_s, tick_hz):
        """A straight line is its own interpolation, at whole ticks and between them."""
        delay = Delay(latency_s, tick_hz)
        slope, start = np.array([2.0, -3.0, 0.5]), np.array([7.0, 1.0, -4.0])
        for tick in range(60):
            t = tick / tick_hz
            shown = delay.take(tuple(start + slope * t))
            assert shown == pytest.approx(start + slope * max(0.0, t - latency_s), abs=0.51 / tick_hz * 3.0)
            if t >= latency_s + 1.0 / tick_hz:
                assert shown == pytest.approx(start + slope * (t - latency_s), abs=1e-9)

    def test_before_the_first_sample_there_is_the_first(self):
        delay = Delay(3.0, 1)
        assert [delay.take((float(k), 1.0)) for k in range(6)] == [
            *[(0.0, 1.0)] * 4,
            (1.0, 1.0),
            (2.0, 1.0),
        ]

    def test_between_samples_a_jump_is_shared_out(self):
        delay = Delay(0.25, 1)
        assert [delay.take((value,)) for value in (0.0, 0.0, 8.0, 8.0)] == [(0.0,), (0.0,), (6.0,), (8.0,)]

    def test_the_field_is_late_and_the_noise_is_not(self):
        """What is read is the field of then under the errors of now."""
        errors = {"noise_t": 2e-7, "bias_t": (3e-7, -2e-7, 1e-7), "scale": (1.01, 0.98, 1.03)}
        late = MagnetometerPhysics(MagnetometerConfig(**errors, latency_s=2.0), 5, 4)
        prompt = MagnetometerPhysics(MagnetometerConfig(**errors), 5, 4)
        fields = [tuple((1.0 + 0.01 * k) * np.array(B)) for k in range(40)]
        for k, field in enumerate(fields):
            now, _ = late.measure(field, (0.0, 0.0, 0.0))
            then, _ = prompt.measure(fields[max(0, k - 8)], (0.0, 0.0, 0.0))
            assert now == pytest.approx(then, rel=1e-12)

    def test_the_coils_field_is_late_with_it(self):
        coupling = ((2e-5, 0.0, 0.0), (0.0, 2e-5, 0.0), (0.0, 0.0, 2e-5))
        sensor = MagnetometerPhysics(
            MagnetometerConfig(coil_coupling_t_per_am2=coupling, latency_s=1.0), 1, 1
        )
        on = (0.1, 0.0, 0.0)
        readings = [sensor.measure(B, m)[0][0] for m in (OFF, OFF, on, on, OFF, OFF)]
        assert np.array(readings) - B[0] == pytest.approx([0.0, 0.0, 0.0, 2e-6, 2e-6, 0.0])

    def test_the_sun_is_late_in_direction_and_in_light(self):
        sensor = SunSensorPhysics(SunSensorConfig(latency_s=2.0), 1, 1)
        suns = [(np.cos(0.01 * k), np.sin(0.01 * k), 0.0) for k in range(10)]
        lights = [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
        seen = [sensor.measure(sun, lit) for sun, lit in zip(suns, lights, strict=True)]
        assert [valid for _, valid in seen] == [True] * 6 + [False] * 3 + [True]
        for k in (3, 4, 5, 9):
            assert seen[k][0] == pytest.approx(suns[k - 2])
        assert seen[6][0] == OFF

    def test_a_sun_between_samples_is_a_unit_vector(self):
        sensor = SunSensorPhysics(SunSensorConfig(latency_s=0.4), 1, 1)
        suns = [(np.cos(0.3 * k), np.sin(0.3 * k), 0.0) for k in range(4)]
        for sun in suns:
            reading, _ = sensor.measure(sun, 1.0)
        assert np.linalg.norm(reading) == pytest.approx(1.0, abs=1e-15)
        assert np.arctan2(reading[1], reading[0]) == pytest.approx(0.3 * 2.6, abs=2e-3)


class TestFieldOfView:
    CONES = ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0))

    @pytest.mark.parametrize("half_deg", [10.0, 60.0, 89.0, 120.0])
    def test_the_sun_is_seen_within_a_cone_and_not_outside(self, half_deg):
        config = SunSensorConfig(fov_half_rad=radians(half_deg), boresights_body=((0.0, 0.6, 0.8),))
        turn = Rotation.from_rotvec([1.0, 0.0, 0.0])
        for phase in np.linspace(0.0, 2.0 * np.pi, 7):
            for off_deg, seen in ((half_deg - 0.1, True), (half_deg + 0.1, False)):
                tilt, axis = radians(off_deg), np.array([0.0, 0.6, 0.8])
                side = Rotation.from_rotvec(phase * axis).apply(turn.apply(np.cross(axis, [1.0, 0.0, 0.0])))
                side -= axis * (side @ axis)
                sun = np.cos(tilt) * axis + np.sin(tilt) * side / np.linalg.norm(side)
                reading, valid = SunSensorPhysics(config, 1).measure(tuple(sun), 1.0)
                assert valid is seen
                assert reading == (pytest.approx(sun) if seen else OFF)

    def test_any_of_the_cones_will_do(self):
        config = SunSensorConfig(fov_half_rad=radians(40.0), boresights_body=self.CONES)
        seen = {
            sun: SunSensorPhysics(config, 1).measure(sun, 1.0)[1]
            for sun in ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, -0.6, 0.8))
        }
        assert list(seen.values()) == [True, True, False, False, True]

    def test_without_cones_it_sees_all_around_and_none_sees_in_the_dark(self):
        wide = SunSensorConfig(fov_half_rad=radians(180.0), boresights_body=self.CONES)
        for axis in np.vstack([np.eye(3), -np.eye(3)]):
            assert SunSensorPhysics(SunSensorConfig(), 1).measure(tuple(axis), 1.0)[1]
            assert SunSensorPhysics(wide, 1).measure(tuple(axis), 1.0)[1]
            assert not SunSensorPhysics(wide, 1).measure(tuple(axis), 0.0)[1]

    def test_the_cone_is_the_body_s_whatever_the_sensor_s_misalignment(self):
        config = SunSensorConfig(
            misalignment_rad=(0.3, 0.0, 0.0), fov_half_rad=radians(5.0), boresights_body=((0.0, 0.0, 1.0),)
        )
        assert SunSensorPhysics(config, 1).measure((0.0, 0.0, 1.0), 1.0)[1]

    def test_what_is_out_of_view_draws_its_noise_all_the_same(self):
        config = SunSensorConfig(noise_rad=0.01, fov_half_rad=1.0, boresights_body=((0.0, 0.0, 1.0),))
        away, towards = SunSensorPhysics(config, 1), SunSensorPhysics(config, 1)
        away.measure((0.0, 0.0, -1.0), 1.0)
        towards.measure((0.0, 0.0, 1.0), 1.0)
        assert away.measure(S, 1.0) == towards.measure(S, 1.0)


class TestEarthlight:
    LIGHT = (0.05, -0.12, -0.18)
    CONES = ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0))

    def measured(self, config, light=LIGHT, lit=1.0, sun=S):
        return SunSensorPhysics(config, 1).measure(sun, lit, light)

    def test_it_is_added_to_the_sun_before_the_sensor_turns_it(self):
        tilt = (0.02, -0.03, 0.05)
        expected = Rotation.from_rotvec(tilt).inv().apply(np.add(S, self.LIGHT))
        reading, valid = self.measured(SunSensorConfig(misalignment_rad=tilt))
        assert valid
        assert reading == pytest.approx(expected / np.linalg.norm(expected))

    def test_light_out_of_view_is_not_seen(self):
        """The Sun in one cone; the light once in the other and once in none."""
        config = SunSensorConfig(fov_half_rad=radians(60.0), boresights_body=self.CONES)
        sun = (0.0, 0.6, 0.8)
        seen, _ = self.measured(config, (0.0, -0.2, -0.1), sun=sun)
        unseen, _ = self.measured(config, (-0.1, 0.0, -0.2), sun=sun)
        both = np.add(sun, (0.0, -0.2, -0.1))
        assert seen == pytest.approx(both / np.linalg.norm(both))
        assert unseen == pytest.approx(sun)

    def test_it_makes_no_sun_in_the_dark(self):
        assert self.measured(SunSensorConfig(), lit=0.0) == (OFF, False)

    def test_it_is_as_late_as_the_sun(self):
        late, prompt = (
            SunSensorPhysics(SunSensorConfig(latency_s=2.0), 1),
            SunSensorPhysics(SunSensorConfig(), 1),
        )
        lights = [(0.0, -0.02 * k, -0.1) for k in range(6)]
        expected = [prompt.measure(S, 1.0, light) for light in lights]
        assert [late.measure(S, 1.0, light) for light in lights][2:] == expected[:-2]


def test_the_wiring_leads_values_and_their_errors_to_the_channels():
    errors = {"bias_t": (3e-7, -2e-7, 1e-7), "scale": (1.01, 0.98, 1.03), "noise_t": 2e-7}
    x, y, z = read_field(MagnetometerConfig(**errors))[0]
    assert read_field(MagnetometerConfig(**errors, wiring=(-2, 3, 1)))[0] == (-y, z, x)


def test_a_saturated_sample_is_wired_too():
    reading, valid = read_field(MagnetometerConfig(saturation_t=2e-5, wiring=(3, -1, 2)))
    assert reading == (2e-5, -1.1e-5, -2e-5)
    assert not valid


class TestBiasThatChanges:
    CONFIG = MagnetometerConfig(
        bias_t=(3e-7, -2e-7, 1e-7),
        orbit_bias_t=(1e-7, 2e-7, -3e-7),
        orbit_bias_phase_rad=(0.0, 0.5, 2.0),
        orbit_s=6000.0,
        shadow_bias_t=(9e-7, -2e-7, 5e-7),
    )

    def bias(self, t_s, lit):
        shown, _ = MagnetometerPhysics(self.CONFIG, 1).measure(B, OFF, t_s, lit)
        return np.array(shown) - B

    @pytest.mark.parametrize("t_s", [0.0, 700.0, 1500.0, 6700.0])
    def test_follows_the_orbit_each_axis_with_its_phase(self, t_s):
        angle = 2.0 * np.pi * t_s / 6000.0
        wave = np.array((1e-7, 2e-7, -3e-7)) * np.sin(angle + np.array((0.0, 0.5, 2.0)))
        assert self.bias(t_s, 1.0) == pytest.approx(np.array((3e-7, -2e-7, 1e-7)) + wave, rel=1e-9)
        assert self.bias(t_s + 6000.0, 1.0) == pytest.approx(self.bias(t_s, 1.0), rel=1e-6)

    def test_steps_with_the_shadow(self):
        dark, half, light = (self.bias(700.0, lit) for lit in (0.0, 0.5, 1.0))
        assert dark - light == pytest.approx((9e-7, -2e-7, 5e-7), rel=1e-6)
        assert half - light == pytest.approx(0.5 * (dark - light), rel=1e-6)
