"""Effects that ship: the torque of each by hand, and what it cannot do."""

import tomllib
from dataclasses import replace
from importlib import import_module
from math import exp, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.input.quantities import with_values
from sim.effects.fluid_ring import FluidRing
from sim.effects.lorentz import EARTH_RADPS, ChargedBody, lorentz_torque, velocity_in_field
from sim.effects.solar_flaps import SUNLIGHT_PA, SolarFlaps
from sim.plant.own_effects import Moment
from sim.scenario.own_effects import GROUP

component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
TURNED = (0.6, 0.48, -0.64, 0.0)
MOMENT = Moment(
    t_s=100.0,
    q_body_from_eci=TURNED,
    omega_body_radps=(0.01, -0.02, 0.03),
    b_body_t=(1e-5, -2e-5, 3e-5),
    sun_body=(0.6, 0.48, 0.64),
    r_eci_m=(4e6, 5e6, 2.9e6),
    v_eci_mps=(-5e3, 1e3, 5.3e3),
)


class TestLorentz:
    def test_by_hand(self):
        """V x b = (0, 7000, 0) x (0, 0, 3e-5) = (0.21, 0, 0); P x that = (0, 0, -2e-6 * 0.21)."""
        torque = lorentz_torque((0.0, 2e-6, 0.0), (0.0, 7000.0, 0.0), (0.0, 0.0, 3e-5))
        assert torque == pytest.approx((0.0, 0.0, -4.2e-7))

    @pytest.mark.long
    @given(vectors, vectors, vectors)
    def test_it_is_the_sum_over_the_charges(self, first, second, b):
        """Charges of 2 and -1 micro C at two places, each with its own force."""
        v, b = np.array([0.0, 7000.0, 100.0]), 3e-5 * np.array(b)
        whole = sum(np.cross(rho, q * np.cross(v, b)) for q, rho in ((2e-6, first), (-1e-6, second)))
        moment = 2e-6 * np.array(first) - 1e-6 * np.array(second)
        np.testing.assert_allclose(lorentz_torque(tuple(moment), tuple(v), tuple(b)), whole, atol=1e-18)

    def test_a_satellite_that_turns_with_the_earth_feels_nothing(self):
        r = np.array([4.2e7, -1e6, 0.0])
        v = np.cross([0.0, 0.0, EARTH_RADPS], r)
        assert velocity_in_field(tuple(r), tuple(v)) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)

    def test_the_effect_turns_the_velocity_into_body_axes(self):
        """By the turning of vectors with the quaternion, as scipy has it."""
        q0, *qv = TURNED
        c = Rotation.from_quat([*qv, q0]).as_matrix().T
        v = c @ velocity_in_field(MOMENT.r_eci_m, MOMENT.v_eci_mps)
        expected = np.cross(1e-6 * np.array([3.0, -1.0, 2.0]), np.cross(v, MOMENT.b_body_t))
        np.testing.assert_allclose(ChargedBody(3.0, -1.0, 2.0).torque_body_nm(MOMENT), expected)


class TestFlaps:
    def test_by_hand(self):
        """Black flaps: the one on +2 faces axis 1, cosine 0.6; that on -2 axis 3, cosine 0.64."""
        flaps = SolarFlaps(area_m2=0.1, arm_m=2.0, plus_deg=0.0, minus_deg=90.0)
        force = -SUNLIGHT_PA * 0.1 * np.array(MOMENT.sun_body)
        expected = np.cross([0.0, 2.0, 0.0], 0.6 * force) + np.cross([0.0, -2.0, 0.0], 0.64 * force)
        np.testing.assert_allclose(flaps.torque_body_nm(MOMENT), expected, rtol=1e-12)

    @pytest.mark.parametrize("turns", [(30.0, 100.0), (-20.0, 65.0), (150.0, -110.0)])
    def test_a_flap_is_turned_from_axis_1_towards_axis_3(self, turns):
        """Black: P A |cos| along the light, its normal (cos, 0, sin) of the turn."""
        flaps = SolarFlaps(area_m2=0.1, arm_m=2.0, plus_deg=turns[0], minus_deg=turns[1])
        push = -SUNLIGHT_PA * 0.1 * np.array(MOMENT.sun_body)
        plus, minus = (
            abs(np.cos(np.radians(turn)) * 0.6 + np.sin(np.radians(turn)) * 0.64) * push for turn in turns
        )
        expected = np.cross((0.0, 2.0, 0.0), plus - minus)
        np.testing.assert_allclose(flaps.torque_body_nm(MOMENT), expected, rtol=1e-12)

    def test_flaps_alike_and_the_dark_give_none(self):
        assert SolarFlaps(plus_deg=30.0, minus_deg=30.0).torque_body_nm(MOMENT) == pytest.approx((0.0,) * 3)
        assert SolarFlaps().torque_body_nm(MOMENT.replace(lit=0.0)) == (0.0, 0.0, 0.0)

    def test_the_light_on_either_side_counts(self):
        behind = MOMENT.replace(sun_body=(-0.6, 0.7, -0.1))
        assert np.linalg.norm(SolarFlaps().torque_body_nm(behind)) > 1e-8


class TestRing:
    def test_the_pump_accelerates_the_fluid_and_the_body_the_other_way(self):
        """At the start p A R = 0.05 * pi 16e-6 * 0.15; later the wall holds the fluid."""
        at_start = MOMENT.replace(t_s=0.0, omega_body_radps=(0.0, 0.0, 0.0))
        assert FluidRing().torque_body_nm(at_start) == pytest.approx((0.0, 0.0, -0.05 * pi * 16e-6 * 0.15))
        late = at_start.replace(t_s=20.0 * FluidRing().time_s)
        assert FluidRing().torque_body_nm(late) == pytest.approx((0.0, 0.0, 0.0), abs=1e-14)

    def test_what_the_body_gets_the_fluid_has(self):
        """The momentum is the integral of the torque against it, on a body that does not turn."""
        ring = FluidRing(axis=2.0)
        times = np.linspace(0.0, 3.0 * ring.time_s, 3001)
        still = MOMENT.replace(omega_body_radps=(0.0, 0.0, 0.0))
        torque = [ring.torque_body_nm(still.replace(t_s=t))[1] for t in times.tolist()]
        given = -np.trapezoid(torque, times)
        assert given == pytest.approx(ring.momentum_nms(float(times[-1])), rel=1e-5)
        assert given == pytest.approx(ring.most_momentum_nms * (1.0 - exp(-3.0)), rel=1e-5)

    def test_on_a_turning_body_it_is_a_gyroscope(self):
        """The torque of momentum h e at rest in the body is -omega x h e."""
        ring = FluidRing(axis=1.0)
        late = MOMENT.replace(t_s=50.0 * ring.time_s)
        h = np.array([ring.most_momentum_nms, 0.0, 0.0])
        expected = -np.cross(MOMENT.omega_body_radps, h)
        np.testing.assert_allclose(ring.torque_body_nm(late), expected, atol=1e-18)

    def test_before_it_begins_there_is_nothing(self):
        assert FluidRing(begins_s=200.0).torque_body_nm(MOMENT) == (0.0, 0.0, 0.0)

    def test_its_axis_is_one_of_the_body_s(self):
        with pytest.raises(ValueError, match="body axis 1, 2 or 3"):
            FluidRing(axis=1.5)


@pytest.mark.parametrize("kind", [ChargedBody, FluidRing, SolarFlaps])
def test_a_package_offers_each_and_a_table_sets_its_parameters(kind, pytestconfig):
    project = tomllib.loads((pytestconfig.rootpath / "pyproject.toml").read_text())["project"]
    offered = [entry.split(":") for entry in project["entry-points"][GROUP].values()]
    assert kind in [getattr(import_module(module), name) for module, name in offered]
    name = next(iter(kind.__dataclass_fields__))
    assert with_values(kind, {name: 1.0}, "effect.0.parameters", "test") == replace(kind(), **{name: 1.0})
