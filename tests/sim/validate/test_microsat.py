"""The figures of flights of the microsatellite, and that their initial states are as claimed."""

from math import inf

import numpy as np
import pytest
from scipy.stats import chi2

from fsw.table.config import flight_config
from fsw.wire.messages import Mode
from sim.campaign.claim import ClaimVerdict
from sim.campaign.flight import FlightResult
from sim.plant.environment.orbit import Sgp4Orbit
from sim.plant.environment.sun import illumination, sun_eci_m
from sim.record.estimates import EstimateRecorder
from sim.scenario.schema import flight_table, load, orbit_period_s
from sim.validate import microsat, posat1

ORBIT = 6041


@pytest.fixture
def scenario():
    assert round(orbit_period_s(load("microsat"))) == ORBIT
    return load("microsat")


def histories(angle_deg, axis=1):
    """Truth of a flight turned by angles about one axis."""
    half = 0.5 * np.radians(np.asarray(angle_deg, dtype=float))
    q = np.zeros((len(half), 4))
    q[:, 0], q[:, axis] = np.cos(half), np.sin(half)
    return {
        "t_s": np.arange(len(half)).astype(float),
        "q_body_from_orbit": q,
        "omega_body_orbit_radps": np.zeros((len(half), 3)),
        "lit": np.ones(len(half)),
    }


def modes(values):
    estimates = EstimateRecorder(len(values)).estimates()
    estimates.mode[:] = values
    return estimates


def test_rms_is_over_the_last_four_orbits(scenario):
    angles = np.full(5 * ORBIT, 3.0)
    angles[: ORBIT - 10] = 90.0
    angles[-ORBIT:] = 5.0
    truth = histories(angles, axis=2)
    found = microsat.pointing_figures(scenario, truth, modes([Mode.POINT] * len(angles)))["rms_deg"]
    assert found == pytest.approx(np.sqrt((3 * 9.0 + 25.0) / 4.0), rel=1e-3)


class TestAcquired:
    TICKS = 2 * ORBIT

    def orbits(self, scenario, angles, mode):
        return microsat.acquisition_figures(scenario, histories(angles), modes(mode))["held_orbits"]

    def test_from_the_tick_from_which_on_both_hold(self, scenario):
        angles, mode = np.full(self.TICKS, 9.9), np.full(self.TICKS, int(Mode.POINT))
        assert self.orbits(scenario, angles, mode) == 0.0
        angles[ORBIT // 2] = 10.1
        assert self.orbits(scenario, angles, mode) == pytest.approx(0.5, abs=1e-3)
        mode[ORBIT] = Mode.ACQUIRE
        assert self.orbits(scenario, angles, mode) == pytest.approx(1.0, abs=1e-3)

    def test_upside_down_at_the_end_is_never(self, scenario):
        angles = np.full(self.TICKS, 5.0)
        angles[-1] = 180.0
        assert self.orbits(scenario, angles, np.full(self.TICKS, int(Mode.POINT))) == inf

    def test_a_start_in_eclipse_is_reported(self, scenario):
        truth = histories([0.0, 0.0])
        assert microsat.acquisition_figures(scenario, truth, modes([3, 3]))["dark_start"] == 0.0
        truth["lit"][0] = 0.0
        assert microsat.acquisition_figures(scenario, truth, modes([3, 3]))["dark_start"] == 1.0


def test_starts_of_acquisition_are_any_and_half_of_them_dark():
    orders = [task.args[0] for task in microsat.acquisition().tasks]
    assert len(orders) == 20
    dark = []
    for order in orders:
        flown = load(order.scenario, order.overrides)
        epoch, start = flown.epoch_unix_s, np.zeros(1)
        r_m, _ = Sgp4Orbit(flown.orbit.tle, epoch).at(start)
        dark.append(illumination(r_m, sun_eci_m(epoch, start))[0])
        assert np.linalg.norm(flown.initial.rate_degps) == pytest.approx(1.0)
        assert np.linalg.norm(flown.initial.axis) == pytest.approx(1.0)
    assert sorted(dark) == [0.0] * 10 + [1.0] * 10
    angles = [order.overrides["initial"]["angle_deg"] for order in orders]
    assert max(angles) > 150.0
    assert all(0.0 <= angle <= 180.0 for angle in angles)
    assert len({order.seed for order in orders}) == 20


def test_starts_of_pointing_are_within_60_deg_and_the_same_for_each_torque():
    orders = [task.args[0] for task in microsat.pointing().tasks]
    starts = [order.overrides["initial"] for order in orders]
    assert len(orders) == 30
    assert starts[:10] == starts[10:20] == starts[20:]
    assert 30.0 < max(start["angle_deg"] for start in starts) <= 60.0
    torques = [order.overrides["disturbance"]["torque_nm"][0] for order in orders[::10]]
    assert torques == [0.0, 3e-8, 1e-7]


def test_the_filters_runs_are_drawn_from_what_it_assumes():
    orders = [task.args[0] for task in microsat.consistency().tasks]
    assert len(orders) == 100
    torque = np.array([order.overrides["disturbance"]["torque_nm"] for order in orders])
    bias = np.array([order.overrides["sensors"]["magnetometer"]["bias_nt"] for order in orders])
    config = flight_config(flight_table(load("microsat"))).estimator.mekf
    sigma = np.sqrt(config.initial_covariance.diagonal())
    assert bias.std(axis=0) == pytest.approx(sigma[6:9] * 1e9, rel=0.2)
    assert torque.std(axis=0) == pytest.approx(sigma[9:12], rel=0.2)
    (noise,) = {order.overrides["disturbance"]["torque_noise_nm_rts"] for order in orders}
    assert noise == pytest.approx(1e-8)
    rates = noise**2 * np.square(config.rotor.inertia_inverse).sum(axis=1)
    np.testing.assert_allclose(config.process_noise.diagonal()[3:6], rates, rtol=1e-9)


@pytest.mark.parametrize(
    ("nees", "verdict"), [(6.0, "PASS"), (5.3, "FAIL"), (6.75, "FAIL"), (np.nan, "FAIL")]
)
def test_consistency_is_judged_by_the_chi_square_bounds_of_the_mean(nees, verdict):
    study = microsat.consistency()
    flights = [FlightResult(task.args[0], {}, {"nees": nees}) for task in study.tasks]
    outcome = study.conclude(flights)[0]
    assert outcome.verdict.value == verdict
    assert outcome.claim.low == pytest.approx(chi2.ppf(0.025, 600) / 100)
    assert outcome.claim.high == pytest.approx(chi2.ppf(0.975, 600) / 100)


class TestPosat1:
    def flights(self, study, settle):
        return [
            FlightResult(task.args[0], {"limits_ok": True, "axis1_deg": {"settle_orbits_5deg": orbits}}, {})
            for task, orbits in zip(study.tasks, settle, strict=True)
        ]

    def verdicts(self, settle):
        study = posat1.libration()
        outcomes = study.conclude(self.flights(study, settle))
        return {o.claim.id.rpartition(".")[2]: o.verdict for o in outcomes}

    def test_twelve_starts_twice(self):
        orders = [task.args[0] for task in posat1.libration().tasks]
        starts = [str(order.overrides["orbit"]) + str(order.overrides["initial"]) for order in orders]
        assert len(set(starts[:12])) == 12
        assert starts[:12] == starts[12:]
        assert all("coils" not in order.overrides for order in orders[:12])
        flown = load(orders[12].scenario, orders[12].overrides)
        assert (flown.coils.driver, flown.control.law) == ("continuous", "predictive")
        assert flown.initial.angle_deg == 60.0

    def test_median_worst_and_ratio(self):
        settle = [2.0] * 6 + [2.9] * 6
        assert set(self.verdicts(settle * 2).values()) == {ClaimVerdict.PASS}
        late = [*settle[:-1], 4.6]
        assert self.verdicts(late + settle)["all"] is ClaimVerdict.FAIL
        assert self.verdicts([3.1] * 12 + [3.1] * 12)["median"] is ClaimVerdict.FAIL
        assert self.verdicts([2.0] * 12 + [1.7] * 12)["restricted"] is ClaimVerdict.FAIL
        assert self.verdicts([2.0] * 12 + [2.4] * 12)["restricted"] is ClaimVerdict.FAIL

    def test_one_that_never_settles_fails(self):
        study = posat1.libration()
        flights = self.flights(study, [2.0] * 24)
        flights[3] = FlightResult(flights[3].order, {"limits_ok": True, "axis1_deg": {}}, {})
        failed = {o.claim.id for o in study.conclude(flights) if o.verdict is ClaimVerdict.FAIL}
        assert failed == {"posat1.all"}
        flights[3] = FlightResult(
            flights[3].order, {"limits_ok": False, "axis1_deg": {"settle_orbits_5deg": 2.0}}, {}
        )
        failed = {o.claim.id for o in study.conclude(flights) if o.verdict is ClaimVerdict.FAIL}
        assert failed == {"posat1.limits"}

    def test_the_final_spin_is_that_of_the_last_tick(self):
        truth = histories([0.0, 0.0])
        truth["omega_body_orbit_radps"][:, 0] = [0.5, 0.0197]
        scenario = load("posat1-spinup")
        assert posat1.final_spin(scenario, truth, modes([3, 3]))["spin_error"] == pytest.approx(3e-4)

    def test_twelve_phases_of_the_spin_up(self):
        orders = [task.args[0] for task in posat1.spin_up().tasks]
        assert len({str(order.overrides) for order in orders}) == 12
