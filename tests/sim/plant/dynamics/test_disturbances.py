"""What acts only where it is asked for: in the truth by its name, in the motion by its torque."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.wire.messages import MagField, SunVector
from sim.plant.config import BodyConfig, DisturbanceConfig, InitialConfig, OrbitConfig, PlateConfig
from sim.plant.dynamics import torques
from sim.plant.dynamics.disturbances import TorqueNoise, bias_torque, residual_dipole
from sim.plant.environment.atmosphere import altitude_m, density_kgpm3
from sim.plant.environment.orbit import make_orbit
from sim.plant.environment.sun import AU_M, sun_eci_m

INERTIA = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
LOW = OrbitConfig(None, 400e3, 1.1, 0.6, 0.35)
PLATES = (
    PlateConfig(0.30, (0.6, 0.0, 0.8), (0.2, 0.1, -0.02), 2.2, 0.3, 0.2),
    PlateConfig(0.12, (0.0, 1.0, 0.0), (0.1, 0.31, -0.05), 2.5, 0.1, 0.7),
    PlateConfig(0.45, (0.0, -0.8, -0.6), (0.06, -0.02, 0.4), 1.9, 0.5, 0.1),
)
BODY = BodyConfig(INERTIA, (0.002, -0.001, 0.003), PLATES)
ALL = DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03), 1.5, 1361.0, 50.0, 1e-7)


@pytest.fixture
def fly(make_plant):
    """Plant and truth of some ticks, undriven."""

    def fly(ticks, **parts):
        plant, rows = make_plant(**{"orbit": LOW, "body": BODY, "disturbance": ALL} | parts), []
        for _ in range(ticks):
            rows.append(plant.truth())
            plant.begin_tick()
            plant.end_tick()
        return plant, rows

    return fly


def by_source(plant, row):
    return dict(zip(plant.torque_sources, map(np.array, row.torque_body_nm), strict=True))


@pytest.mark.parametrize(
    ("asked", "names"),
    [
        ({}, ()),
        ({"density_scale": 1.0}, ("drag",)),
        ({"solar_flux_wpm2": 1361.0}, ("solar_pressure",)),
        ({"eddy_nms_per_t2": 1.0}, ("eddy",)),
        ({"torque_noise_nm_rts": 1e-9}, ("noise",)),
        (
            {"density_scale": 0.0, "torque_noise_nm_rts": 1e-9, "eddy_nms_per_t2": 1.0},
            ("drag", "eddy", "noise"),
        ),
    ],
)
def test_truth_names_what_is_asked_for_after_what_is_always_there(fly, asked, names):
    plant, (row,) = fly(1, disturbance=DisturbanceConfig(**asked))
    assert plant.torque_sources == (*torques.SOURCES, *names)
    assert len(row.torque_body_nm) == len(plant.torque_sources)


def test_drag_is_that_of_the_orbit_and_of_air_that_turns_with_the_earth(fly, make_config):
    """Against positions, velocities and forces computed here, plate by plate."""
    plant, rows = fly(900)
    orbit = make_orbit(LOW, make_config().epoch_unix_s)
    for tick in range(0, 900, 90):
        row = rows[tick]
        (r,), (v,) = orbit.at(np.array([float(tick)]))
        wind = v - np.cross([0.0, 0.0, 7.2921159e-5], r)
        e1, e3 = r / np.linalg.norm(r), np.cross(r, v) / np.linalg.norm(np.cross(r, v))
        body_from_orbit = Rotation.from_quat(row.q_body_from_orbit, scalar_first=True).as_matrix().T
        wind_body = body_from_orbit @ np.stack([e1, np.cross(e3, e1), e3]) @ wind
        speed = np.linalg.norm(wind_body)
        density = 1.5 * density_kgpm3(altitude_m(r[None]))[0]
        expected = np.zeros(3)
        for plate in PLATES:
            facing = max(0.0, np.dot(plate.normal_body, wind_body) / speed)
            force = -0.5 * density * plate.drag_coefficient * plate.area_m2 * facing * speed * wind_body
            expected += np.cross(plate.centre_body_m, force)
        found = by_source(plant, row)["drag"]
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-16)
        assert np.linalg.norm(found) > 1e-8


@pytest.mark.long
def test_light_presses_by_its_flux_and_distance_while_there_is_light(fly, make_config):
    plant, rows = fly(5600)
    epoch, lit_seen = make_config().epoch_unix_s, set()
    for tick in range(0, 5600, 40):
        row = rows[tick]
        distance_m = np.linalg.norm(sun_eci_m(epoch, np.array([float(tick)]))[0] - row.r_eci_m)
        pressure = 1361.0 / 299792458.0 * (AU_M / distance_m) ** 2 * row.lit
        expected = np.zeros(3)
        for plate in PLATES:
            n, s = np.array(plate.normal_body), np.array(row.sun_body)
            facing = max(0.0, n @ s)
            push = 2.0 * (plate.diffuse / 3.0 + plate.specular * facing) * n + (1.0 - plate.specular) * s
            expected += np.cross(plate.centre_body_m, -pressure * plate.area_m2 * facing * push)
        found = by_source(plant, row)["solar_pressure"]
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-18)
        lit_seen.add(row.lit)
        if row.lit == 0.0:
            assert not found.any()
    assert {0.0, 1.0} <= lit_seen


def test_eddy_torque_is_that_of_the_inertial_rate(fly):
    plant, rows = fly(300, initial=InitialConfig(omega_body_orbit_radps=(0.02, -0.03, 0.01)))
    before = None
    for row in rows[::30]:
        e3 = Rotation.from_quat(row.q_body_from_orbit, scalar_first=True).as_matrix().T[:, 2]
        w0 = np.sqrt(3.986004418e14 / (6378.137e3 + 400e3) ** 3)
        omega, b = np.array(row.omega_body_orbit_radps) + w0 * e3, np.array(row.b_body_t)
        found = by_source(plant, row)["eddy"]
        assert found == pytest.approx(50.0 * np.cross(np.cross(omega, b), b), rel=1e-6)
        assert found @ omega < 0.0
        assert before is None or (found != before).any()
        before = found


def test_torques_by_source_are_those_that_turn_the_body_and_its_wheel(fly):
    """J dw/dt = T - w x (J w + h), every source among them, by the change of w over a tick of 0.1 s."""
    j, h = np.array(INERTIA), np.array(BODY.wheel_body_nms)
    calm = DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03), 1.5, 1361.0, 2e4)
    plant, rows = fly(200, tick_hz=10, disturbance=calm)
    omega = []
    for row in rows:
        e3 = Rotation.from_quat(row.q_body_from_orbit, scalar_first=True).as_matrix().T[:, 2]
        w0 = np.sqrt(3.986004418e14 / (6378.137e3 + 400e3) ** 3)
        omega.append(np.array(row.omega_body_orbit_radps) + w0 * e3)
    for k in range(1, 199):
        change = (omega[k + 1] - omega[k - 1]) / 0.2
        torque = np.sum(rows[k].torque_body_nm, axis=0)
        gyroscopic = np.cross(omega[k], j @ omega[k] + h)
        assert j @ change + gyroscopic == pytest.approx(torque, rel=1e-5, abs=2e-11)
    assert all(np.linalg.norm(t) > 1e-9 for name, t in by_source(plant, rows[9]).items() if name != "coils")


def test_a_wheel_alone_keeps_the_whole_angular_momentum(make_plant):
    """Inertial direction and size of J w + h, free of gravity's part by a body of equal moments."""
    j = np.diag([1.5, 1.5, 1.5])
    body = BodyConfig(tuple(map(tuple, j.tolist())), (0.02, -0.03, 0.05))
    plant = make_plant(orbit=LOW, body=body, disturbance=DisturbanceConfig(), max_substep_s=0.25)
    start, momenta = plant.motion.omega_body_radps, []
    for _ in range(300):
        q, w = plant.motion.q_body_from_eci, plant.motion.omega_body_radps
        inertial = Rotation.from_quat(q, scalar_first=True).apply(j @ w + body.wheel_body_nms)
        momenta.append(inertial)
        plant.begin_tick()
        plant.end_tick()
    assert np.abs(np.array(momenta) - momenta[0]).max() < 1e-11
    assert np.linalg.norm(np.subtract(plant.motion.omega_body_radps, start)) > 1e-4


def test_asked_for_with_no_effect_the_motion_is_the_same(fly):
    still = DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03))
    nothing = DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03), 0.0, 0.0)
    (_, one), (_, other) = fly(100, disturbance=still), fly(100, disturbance=nothing)
    assert [row.q_body_from_orbit for row in one] == [row.q_body_from_orbit for row in other]
    (_, moved) = fly(100)
    assert moved[-1].q_body_from_orbit != one[-1].q_body_from_orbit


class TestDaily:
    DAILY = DisturbanceConfig((3e-8, -2e-8, 1e-8), (0.01, 0.02, -0.03), torque_daily_part=0.4)

    @pytest.mark.parametrize(
        ("hours", "factor"), [(0, 1.4), (4, 1.2), (6, 1.0), (12, 0.6), (20, 1.2), (24, 1.4)]
    )
    def test_it_is_most_at_the_start_and_least_half_a_day_later(self, hours, factor):
        expected = factor * np.array(self.DAILY.torque_body_nm)
        assert bias_torque(self.DAILY, 3600.0 * hours) == pytest.approx(expected, rel=1e-12)

    def test_the_truth_shows_the_torque_of_its_instant(self, fly):
        plant, rows = fly(1201, tick_hz=2, disturbance=self.DAILY)
        for tick in (0, 500, 1200):
            found = by_source(plant, rows[tick])["bias"]
            assert found == pytest.approx(np.array(bias_torque(self.DAILY, 0.5 * tick)), rel=1e-15)
        assert (found != np.array(self.DAILY.torque_body_nm)).all()

    def test_the_body_turns_by_it(self, make_plant):
        """On a body of equal moments nothing else acts: J times the change of rate is its impulse."""
        body = BodyConfig(((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0)))
        daily = DisturbanceConfig((3e-5, -2e-5, 1e-5), torque_daily_part=0.4)
        plant = make_plant(orbit=LOW, body=body, disturbance=daily)
        start = np.array(plant.motion.omega_body_radps)
        for _ in range(3600):
            plant.begin_tick()
            plant.end_tick()
        impulse_s = 3600.0 + 0.4 * np.sin(2.0 * np.pi / 24.0) * 86400.0 / (2.0 * np.pi)
        change = np.array(plant.motion.omega_body_radps) - start
        assert change == pytest.approx(impulse_s * np.array(daily.torque_body_nm) / 2.0, rel=1e-4)

    def test_without_it_the_torque_is_the_constant_one_itself(self):
        constant = DisturbanceConfig((3e-8, -2e-8, 1e-8))
        assert bias_torque(constant, 7777.0) == constant.torque_body_nm

    @pytest.mark.parametrize(("lit", "acts"), [(1.0, False), (0.999, True), (0.001, True), (0.0, False)])
    def test_that_of_the_penumbra_acts_there_alone(self, lit, acts):
        snapping = DisturbanceConfig((3e-8, -2e-8, 1e-8), penumbra_torque_body_nm=(1e-5, -2e-5, 4e-6))
        expected = np.array(snapping.torque_body_nm) + acts * np.array(snapping.penumbra_torque_body_nm)
        assert bias_torque(snapping, 7777.0, lit) == pytest.approx(expected, rel=1e-12)

    @pytest.mark.parametrize("part", [-0.1, 1.1, float("nan")])
    def test_a_part_that_is_none_is_refused(self, part):
        with pytest.raises(ValueError, match="torque_daily_part must lie between 0 and 1"):
            DisturbanceConfig(torque_daily_part=part)


class TestResidualDipole:
    VARIES = DisturbanceConfig(
        residual_dipole_body_am2=(0.01, 0.02, -0.03), residual_dipole_eclipse_body_am2=(-0.004, 0.006, 0.05)
    )

    @pytest.mark.parametrize(
        ("lit", "expected"),
        [(1.0, (0.011, 0.022, -0.027)), (0.0, (0.007, 0.028, 0.023)), (0.75, (0.01, 0.0235, -0.0145))],
    )
    def test_it_is_the_sum_of_what_is_constant_what_the_shadow_adds_and_remanence(self, lit, expected):
        assert residual_dipole(self.VARIES, lit, (0.001, 0.002, 0.003)) == pytest.approx(expected)

    @pytest.mark.long
    def test_the_truth_shows_its_torque_in_light_and_in_shadow(self, fly):
        plant, rows = fly(5600, disturbance=self.VARIES)
        seen = set()
        for row in rows[::100]:
            m = np.array([0.01, 0.02, -0.03]) + (1.0 - row.lit) * np.array([-0.004, 0.006, 0.05])
            assert by_source(plant, row)["residual_dipole"] == pytest.approx(np.cross(m, row.b_body_t))
            seen.add(row.lit)
        assert {0.0, 1.0} <= seen

    @pytest.mark.long
    def test_in_the_dark_the_body_turns_as_by_the_sum_and_in_light_as_without(self, make_plant, fly):
        """To the last bit, for as long as neither begins nor ends."""
        summed = DisturbanceConfig(residual_dipole_body_am2=(0.01 - 0.004, 0.02 + 0.006, -0.03 + 0.05))
        plain = DisturbanceConfig(residual_dipole_body_am2=(0.01, 0.02, -0.03))
        orbits = [replace(LOW, u0_rad=u0) for u0 in np.arange(0.0, 6.3, 0.1)]
        lit = [make_plant(orbit=orbit).truth().lit for orbit in orbits]
        for light, same, other in ((0.0, summed, plain), (1.0, plain, summed)):
            orbit = orbits[lit.index(light)]
            (_, varying), (_, alike), (_, unlike) = (
                fly(60, orbit=orbit, disturbance=disturbance) for disturbance in (self.VARIES, same, other)
            )
            assert {row.lit for row in varying} == {light}
            assert varying == alike
            assert varying[-1].omega_body_orbit_radps != unlike[-1].omega_body_orbit_radps


class TestNoise:
    def test_each_tick_has_its_own_torque_and_truth_shows_that_of_the_tick_before(self, fly, make_config):
        plant, rows = fly(50)
        found = [tuple(by_source(plant, row)["noise"]) for row in rows]
        drawn = TorqueNoise(1e-7, make_config().seed, 1)
        assert found == [(0.0, 0.0, 0.0), *(drawn.next() for _ in range(49))]
        assert len(set(found)) == 50

    @pytest.mark.parametrize("tick_hz", [1, 4, 25])
    def test_its_integral_has_the_same_variance_at_every_tick_rate(self, make_config, tick_hz):
        """Var of the integral of a white torque over t is q t."""
        noise = TorqueNoise(1e-7, make_config().seed, tick_hz)
        seconds, runs = 4, 800
        impulses = [
            np.sum([noise.next() for _ in range(seconds * tick_hz)], axis=0) / tick_hz for _ in range(runs)
        ]
        assert np.std(impulses, axis=0) == pytest.approx([1e-7 * np.sqrt(seconds)] * 3, rel=0.1)

    def test_it_turns_the_body_as_a_random_walk_of_its_rate(self, make_plant):
        """The rate's change over a tick is J^-1 times the impulse, on a body without other torques."""
        j = 2.0
        body = BodyConfig(((j, 0.0, 0.0), (0.0, j, 0.0), (0.0, 0.0, j)))
        disturbance = DisturbanceConfig(torque_noise_nm_rts=1e-6)
        plant = make_plant(orbit=LOW, body=body, disturbance=disturbance, tick_hz=2)
        for _ in range(40):
            before = np.array(plant.motion.omega_body_radps)
            plant.begin_tick()
            plant.end_tick()
            change = np.array(plant.motion.omega_body_radps) - before
            assert change == pytest.approx(by_source(plant, plant.truth())["noise"] * 0.5 / j, rel=1e-6)

    def test_it_has_a_stream_of_its_own(self, fly):
        (_, loud), (_, still) = fly(20, seed=3), fly(20, seed=4)
        assert loud[-1].torque_body_nm[-1] != still[-1].torque_body_nm[-1]

    def test_sensors_do_not_hear_it(self, make_plant):
        """Their noise is the same with and without it."""
        with_it = make_plant(disturbance=DisturbanceConfig(torque_noise_nm_rts=1e-12))
        without = make_plant(disturbance=DisturbanceConfig())
        for _ in range(5):
            heard, alone = (
                [frame for frame in plant.begin_tick() if frame.can_id in (MagField.ID, SunVector.ID)]
                for plant in (with_it, without)
            )
            assert heard == alone
            with_it.end_tick()
            without.end_tick()


@pytest.mark.parametrize(
    "name", ["density_scale", "solar_flux_wpm2", "eddy_nms_per_t2", "torque_noise_nm_rts"]
)
def test_what_cannot_be_negative_is_refused(name):
    with pytest.raises(ValueError, match=name):
        DisturbanceConfig(**{name: -1e-9})
    with pytest.raises(ValueError, match=name):
        DisturbanceConfig(**{name: float("nan")})
