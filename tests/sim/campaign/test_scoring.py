"""What is scored of a flight agrees with its summary, and with rotations written out."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.campaign.definition.campaign import StatisticsSection
from sim.campaign.flight import record_scenario
from sim.campaign.one_run import score
from sim.report.figures.attitude_arrays import angle_rad, axis1_errors, rotation_vectors
from sim.scenario.schema import load, orbit_period_s

ORBITS = 0.1


@pytest.fixture(scope="module")
def flight():
    return record_scenario(load("realsat"), seed=3, orbits=ORBITS)


def test_vectors_are_those_of_the_turns():
    turns = Rotation.random(50, random_state=np.random.default_rng(1))
    scalar_first = turns.as_quat(canonical=True)[:, [3, 0, 1, 2]]
    assert rotation_vectors(scalar_first) == pytest.approx(turns.as_rotvec())
    assert rotation_vectors(np.array([[1.0, 0.0, 0.0, 0.0]])).tolist() == [[0.0, 0.0, 0.0]]


def test_the_turn_of_axis_1_leads_to_the_vertical():
    orbit_from_body = Rotation.random(40, random_state=np.random.default_rng(2))
    q = orbit_from_body.as_quat(canonical=True)[:, [3, 0, 1, 2]]  # Hamilton: v_body = C(q) v_orbit
    vertical_body = orbit_from_body.inv().apply([1.0, 0.0, 0.0])
    found = axis1_errors(q)
    assert not found[:, 0].any()
    assert Rotation.from_rotvec(found).apply([1.0, 0.0, 0.0]) == pytest.approx(vertical_body)


@pytest.mark.long
def test_the_indices_of_the_whole_flight_are_those_of_its_summary(flight):
    found = score(flight, StatisticsSection(last_orbits=1.0))
    assert found.figures["ape_deg_rms"] == pytest.approx(flight.summary()["pointing_deg"]["rms_last_orbit"])
    assert found.figures["ape_deg_max"] == pytest.approx(flight.summary()["pointing_deg"]["max_last_orbit"])


def test_a_part_of_the_flight_counts(flight):
    pointing_deg = np.degrees(angle_rad(flight.truth["q_body_from_orbit"]))
    last = round(len(pointing_deg) * 0.25)
    found = score(flight, StatisticsSection(last_orbits=0.25 * ORBITS))
    assert found.figures["ape_deg_rms"] == pytest.approx(np.sqrt(np.mean(pointing_deg[-last:] ** 2)))


def test_the_error_over_the_flight_is_its_root_mean_square(flight):
    found = score(flight, StatisticsSection()).error_deg
    pointing_deg = np.degrees(angle_rad(flight.truth["q_body_from_orbit"]))
    assert len(found) == 6
    assert np.sqrt(np.mean(found**2)) == pytest.approx(np.sqrt(np.mean(pointing_deg**2)), rel=0.01)


def test_no_estimate_counts_as_half_a_turn(flight):
    flight.estimates.q_body_from_orbit[-30:-20] = np.nan
    assert score(flight, StatisticsSection()).figures["ake_deg_max"] == pytest.approx(180.0)


def test_a_boom_is_judged_by_its_axis_alone():
    flight = record_scenario(load("posat1"), seed=3, orbits=0.02)
    found = score(flight, StatisticsSection())
    axis1 = flight.summary()["axis1_deg"]
    assert found.figures["ape_deg_rms"] == pytest.approx(axis1["rms_last_orbit"])
    assert found.figures["ape_deg_rms"] != pytest.approx(flight.summary()["pointing_deg"]["rms_last_orbit"])


def turns_of(generator, ticks):
    """Attitudes, scalar first, and their rotation vectors in degrees, all of them small."""
    turn = Rotation.from_rotvec(generator.normal([0.02, -0.05, 0.03], 0.02, (ticks, 3)))
    return turn.as_quat(canonical=True, scalar_first=True), np.degrees(turn.as_rotvec())


def test_window_and_last_orbits_are_times_at_any_tick_rate():
    scenario = load("microsat", {"time": {"tick_hz": 2}})
    per_orbit = round(2.0 * orbit_period_s(scenario))
    last, window = round(0.05 * per_orbit), 2 * 30
    q, error_deg = turns_of(np.random.default_rng(3), per_orbit // 10)
    record = SimpleNamespace(
        scenario=scenario,
        truth={"t_s": 0.5 * np.arange(len(q)), "q_body_from_orbit": q},
        estimates=SimpleNamespace(q_body_from_orbit=np.tile([1.0, 0.0, 0.0, 0.0], (len(q), 1))),
    )
    found = score(record, StatisticsSection(last_orbits=0.05, window_s=30.0))
    counted = error_deg[-last:]
    windows = [counted[first : first + window] for first in range(0, last - window + 1, window)]
    windows += [counted[-window:]] if last % window else []
    means = [np.linalg.norm(rows.mean(axis=0)) for rows in windows]
    assert found.figures["mpe_deg_max"] == pytest.approx(max(means))
    assert found.figures["ape_deg_max"] == pytest.approx(np.linalg.norm(counted, axis=1).max())
    assert found.figures["ake_deg_rms"] == pytest.approx(np.sqrt(np.mean(np.sum(counted**2, axis=1))))
    assert len(found.error_deg) == 6
    sixth = np.sum(error_deg[: len(q) // 6] ** 2, axis=1)
    assert found.error_deg[0] == pytest.approx(np.sqrt(np.mean(sixth)), rel=1e-6)
