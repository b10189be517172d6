"""The figures of flights of the microsatellite, and that their initial states are as claimed."""

from math import inf

import numpy as np
import pytest
from scipy.stats import chi2

from fsw.table.config import flight_config
from fsw.wire.messages import Mode
from sim.campaign.flight import FlightResult
from sim.plant.environment.orbit import Sgp4Orbit
from sim.plant.environment.sun import illumination, sun_eci_m
from sim.record.estimates import EstimateRecorder
from sim.scenario.schema import flight_table, load, orbit_period_s
from sim.validate import microsat

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


class TestConsistency:
    """The truth is drawn from a distribution of its own, and the filter's claim can fail on both sides."""

    @pytest.fixture
    def drawn(self):
        orders = [task.args[0] for task in microsat.consistency().tasks]
        assert len(orders) == 100
        return {
            "rate": np.array([order.overrides["initial"]["rate_degps"] for order in orders]),
            "bias": np.array([order.overrides["sensors"]["magnetometer"]["bias_nt"] for order in orders]),
            "torque": np.array([order.overrides["disturbance"]["torque_nm"] for order in orders]),
            "part": np.array([order.overrides["disturbance"]["torque_daily_part"] for order in orders]),
            "noise": [order.overrides["disturbance"].get("torque_noise_nm_rts") for order in orders],
        }

    def test_sizes_are_as_stated_in_any_direction(self, drawn):
        for name, (least, most) in (
            ("rate", (0.0, microsat.RATE_DEGPS)),
            ("bias", microsat.BIAS_SIZES_NT),
            ("torque", microsat.TORQUES_NM),
        ):
            sizes = np.linalg.norm(drawn[name], axis=1)
            assert least <= sizes.min()
            assert 0.9 * most < sizes.max() <= most
            assert np.abs((drawn[name] / sizes[:, None]).mean(axis=0)).max() < 0.2
        assert 0.0 <= drawn["part"].min() < 0.05
        assert 0.25 < drawn["part"].max() <= microsat.DAILY_PART
        assert set(drawn["noise"]) == {None}

    def test_none_has_the_spread_that_the_filter_assumes(self, drawn):
        config = flight_config(flight_table(load("microsat"))).estimator.mekf
        sigma = np.sqrt(config.initial_covariance.diagonal())
        assert (drawn["bias"].std(axis=0) < 0.6 * sigma[6:9] * 1e9).all()
        assert (drawn["torque"].std(axis=0) < 0.6 * sigma[9:12]).all()
        assert config.process_noise.diagonal()[3:6].min() > 0.0, "white torque is assumed, none flies"

    @pytest.mark.parametrize(
        ("nees", "verdict"), [(6.0, "PASS"), (6.75, "FAIL"), (5.3, "FAIL"), (np.nan, "FAIL")]
    )
    def test_is_judged_on_both_sides(self, nees, verdict):
        study = microsat.consistency()
        flights = [FlightResult(task.args[0], {}, {"nees": nees}) for task in study.tasks]
        (outcome,) = study.conclude(flights)
        assert outcome.verdict.value == verdict
        assert outcome.claim.high == pytest.approx(chi2.ppf(0.975, 600) / 100)
        assert outcome.claim.low == pytest.approx(5.34, abs=0.005)

    def test_is_that_of_the_last_tick(self, monkeypatch, scenario):
        monkeypatch.setattr(microsat, "nees", lambda truth, estimates: np.array([9.0, 5.0, 3.5]))
        assert microsat.consistency_figures(scenario, {}, None) == {"nees": 3.5}


def test_the_row_on_acquisition_says_how_many_attitudes_were_drawn():
    study = microsat.acquisition()
    held = next(figure for figure in study.figures if figure.id == "held")
    assert f"from {len(study.orders)} random attitudes at 1 deg/s, all" in held.statement
