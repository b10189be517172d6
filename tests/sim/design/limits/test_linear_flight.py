"""The linear body beside the plant's, and flights that keep the limits of the coils."""

from math import degrees

import numpy as np
import pytest

from fsw.core.algebra.quaternion import conjugate, multiply, normalise, rotate
from fsw.table.config import flight_config
from sim.design.from_scenario import body_of
from sim.design.limits.linear_flight import (
    LOST_DEG,
    LinearBody,
    LinearFlight,
    fly,
    law_input,
    least_deg,
    orbits_of,
)
from sim.design.theory.feedforward import least_error
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque
from sim.plant.environment.surroundings import Surroundings
from sim.scenario.schema import flight_table, load

START = (0.03, 0.04, -0.02)
ZERO = (0.0, 0.0, 0.0)
TORQUE = (7e-9, -5e-9, 9e-9)
TENSOR = [[1.02, 0.002, -0.001], [0.002, 1.85, 0.003], [-0.001, 0.003, 1.95]]
MU_M3PS2 = 3.986004418e14


def scenario(law="pulse_mpc", **sections):
    return load("microsat", {"control": {"law": law}} | sections)


def config_of(given):
    return flight_config(flight_table(given))


@pytest.mark.long
class TestBody:
    TICKS, DIPOLE = 1500, (2e-4, -1e-4, 3e-4)

    def linear(self, config, met):
        body, x = LinearBody(config, TORQUE), np.array([2e-6, -3e-6, 1e-6, 0.003, 0.004, -0.002])
        for tick, passed in enumerate(met[: self.TICKS]):
            b_body_t = law_input(x, passed, tick, config, (ZERO, ZERO)).b_body_t
            x = body.moved(x, tuple(np.cross(self.DIPOLE, b_body_t)), passed.rate_change_radps2)
        return x

    def plant(self, config, met):
        """The same from the plant's equations of motion, two ticks a step."""
        inertia, first = config.control.inertia_kgm2, met[0].reference
        half = (0.0015, 0.002, -0.001)
        from_orbit = normalise((1.0, *half))
        relative = (2e-6, -3e-6, 1e-6)
        spin = first.orbit_rate_radps * np.array(rotate(from_orbit, (0.0, 0.0, 1.0)))
        motion = Motion(multiply(first.q_orbit_from_eci, from_orbit), tuple(relative + spin))

        def around(tick):
            met_there = met[tick].reference
            e = tuple((np.array(met_there.r_eci_m) / met_there.radius_m).tolist())
            return Surroundings(e, 3.0 * MU_M3PS2 / met_there.radius_m**3, met_there.b_eci_t)

        body, torque = RigidBody(inertia), BodyTorque(inertia, self.DIPOLE, TORQUE)
        for tick in range(0, self.TICKS, 2):
            motion = body.step(motion, torque, 2.0, around(tick), around(tick + 1), around(tick + 2))
        last = met[self.TICKS].reference
        from_orbit = multiply(conjugate(last.q_orbit_from_eci), motion.q_body_from_eci)
        spin = last.orbit_rate_radps * np.array(rotate(from_orbit, (0.0, 0.0, 1.0)))
        theta = 2.0 * np.copysign(1.0, from_orbit[0]) * np.array(from_orbit[1:])
        return np.concatenate([np.array(motion.omega_body_radps) - spin, theta])

    def test_on_a_circle_it_moves_as_the_plants_does_for_small_angles(self):
        circle = {"tle": None, "altitude_km": 800.0, "inclination_deg": 98.6}
        config = config_of(scenario(body={"inertia_kgm2": TENSOR}, orbit=circle))
        met = orbits_of(config, 0.3)
        linear, plant = self.linear(config, met), self.plant(config, met)
        assert np.abs(plant[3:]).min() > 0.002
        assert linear[3:] == pytest.approx(plant[3:], abs=0.01 * np.abs(plant[3:]).max())
        assert linear[:3] == pytest.approx(plant[:3], abs=0.01 * np.abs(plant[:3]).max())

    def test_on_an_ellipse_it_does_so_about_the_normal(self, two_orbits):
        """About the other axes the plane of the orbit turns, which the laws leave out too."""
        config = config_of(scenario(body={"inertia_kgm2": TENSOR}))
        linear, plant = self.linear(config, two_orbits), self.plant(config, two_orbits)
        still = self.linear(config, [passed._replace(rate_change_radps2=0.0) for passed in two_orbits])
        assert linear[5] == pytest.approx(plant[5], rel=0.01)
        assert abs(still[5] - plant[5]) > 0.1 * abs(plant[5])
        assert linear[3:5] == pytest.approx(plant[3:5], abs=5e-4)


class TestFlight:
    @pytest.mark.long
    @pytest.mark.parametrize("law", ["mpc", "pulse_mpc"])
    def test_no_pulse_breaks_the_limits(self, law, two_orbits):
        flight = fly(scenario(law, coils={"backoff_s": 41.0, "pulse_s": 2.0}), START, two_orbits[:6000])
        ticks = [fired.tick for fired in flight.fired]
        assert ticks[0] >= 41
        assert min(np.diff(ticks)) >= 43
        assert {fired.coil for fired in flight.fired} == {0, 1, 2}
        assert all(1 <= abs(fired.level) <= 3 for fired in flight.fired)

    @pytest.mark.long
    def test_coils_with_a_back_off_of_their_own_never_overlap(self, two_orbits):
        flight = fly(scenario("mpc", coils={"backoff": "per_coil"}), START, two_orbits[:4000])
        ticks = [fired.tick for fired in flight.fired]
        assert min(np.diff(ticks)) >= 3
        for coil in range(3):
            assert min(np.diff([fired.tick for fired in flight.fired if fired.coil == coil])) >= 103

    @pytest.mark.long
    def test_what_the_law_is_not_told_it_pays_for(self, two_orbits):
        given = scenario(disturbance={"residual_dipole_am2": [0.01, 0.01, 0.01]})
        told, untold = (fly(given, START, two_orbits, told).rms_deg() for told in (True, False))
        assert untold > 1.5 * told

    def test_a_body_that_cannot_be_held_is_lost_and_not_averaged(self, two_orbits):
        given = scenario(disturbance={"torque_nm": [0.0, 1e-5, 0.0]})
        flight = fly(given, START, two_orbits)
        assert flight.error_deg[-1] > LOST_DEG
        assert len(flight.error_deg) < flight.ticks
        assert flight.rms_deg() == np.inf

    def test_the_last_half_counts(self):
        flight = LinearFlight(np.array([9.0, 9.0, 3.0, 4.0]), (), 4)
        assert flight.rms_deg() == pytest.approx(np.sqrt(12.5))

    @pytest.mark.long
    def test_once_settled_more_back_off_never_helps(self, two_orbits):
        quiet, near = {"torque_nm": [0.0, 0.0, 0.0]}, (0.003, 0.004, -0.002)
        errors_deg = [
            fly(
                scenario(coils={"backoff_s": backoff_s}, disturbance=quiet), near, two_orbits[:9000]
            ).rms_deg()
            for backoff_s in (80.0, 160.0)
        ]
        assert errors_deg[0] < 1.05 * errors_deg[1]


# --- The bound on the field that is flown, beside that of the direct dipole's and below the laws

LARGER_TORQUE = (2e-8, 3e-8, 5e-8)
NEAR_START = (0.005, 0.004, -0.006)
UNEQUAL = {"body": {"inertia_kgm2": [1.02, 1.75, 2.05]}}


@pytest.mark.long
def test_on_the_direct_dipoles_field_it_comes_near_the_periodic_one_from_below():
    """Another method, collocation of the periodic motion; here beginning and end are free, which helps."""
    circle = {"tle": None, "altitude_km": 800.0, "inclination_deg": 98.6}
    scenario = load("microsat", UNEQUAL | {"orbit": circle, "flight": {"field": {"model": "direct_dipole"}}})
    config = config_of(scenario)
    periodic = degrees(least_error(body_of(scenario), LARGER_TORQUE).rms_rad)
    met = orbits_of(config)
    one_orbit, three_orbits = (
        least_deg(config, LARGER_TORQUE, met[: round(part * len(met))]) for part in (1 / 3, 1)
    )
    assert one_orbit < three_orbits < periodic
    assert three_orbits > 0.93 * periodic


@pytest.mark.long
def test_it_is_in_proportion_to_the_torque(two_orbits):
    config = config_of(load("microsat", UNEQUAL))
    one, three = (
        least_deg(config, tuple(n * part for part in LARGER_TORQUE), two_orbits) for n in (10.0, 30.0)
    )
    assert three == pytest.approx(3.0 * one, rel=0.01)


@pytest.mark.long
@pytest.mark.parametrize("law", ["mpc", "pulse_mpc"])
@pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), LARGER_TORQUE])
def test_no_law_is_below_it(law, torque, two_orbits):
    changed = {"control": {"law": law}, "disturbance": {"torque_nm": list(torque)}}
    scenario = load("microsat", UNEQUAL | changed)
    flown = fly(scenario, NEAR_START, two_orbits).rms_deg()
    assert least_deg(config_of(scenario), torque, two_orbits) < flown
