"""The same satellite, whatever its builders call its axes, flies the same flight."""

import numpy as np
import pytest
from turned_satellite import PAIRS, turned_satellite

from fsw.input.schema import TableError
from sim.campaign.flight import record_scenario
from sim.report.figures.attitude_arrays import angle_rad, law_attitude, law_vector
from sim.report.figures.performance import perform
from sim.scenario.schema import flight_table, load
from sim.tuning.rigid_flight import fly

TURNED = [pair for pair in PAIRS if pair != ("x", "y")]
CONTINUOUS = {"coils": {"driver": "continuous", "max_dipole_am2": 2.0}}


def satellite(up, ahead, law, more=None):
    return load("microsat", turned_satellite(up, ahead) | {"control": {"law": law}} | (more or {}))


@pytest.mark.parametrize("law", ["mpc", "pulse_mpc", "pd", "sliding", "bdot_held"])
def test_law_and_scheduler_do_the_same_in_each_of_24_turns(law):
    """Of laws of dipoles, of impulses and of pulses; no board, which tells its lockouts coil by coil."""
    flown = fly(satellite("x", "y", law), 0.4)
    assert np.abs(flown.m_body_am2).max() > 1.0
    for pair in TURNED:
        again = fly(satellite(*pair, law), 0.4)
        assert np.abs(again.q_body_from_orbit - flown.q_body_from_orbit).max() < 1e-10, pair
        assert np.abs(again.relative_body_radps - flown.relative_body_radps).max() < 1e-12, pair


@pytest.mark.parametrize("pair", [("z", "x"), ("-y", "-z"), ("-x", "y")])
def test_a_whole_flight_is_the_same(pair):
    """With boards and bus: to what rounding on the bus leaves, in other numbers for other axes."""
    flights = []
    for up, ahead in (("x", "y"), pair):
        scenario = satellite(up, ahead, "lqr", CONTINUOUS)
        record, axes = record_scenario(scenario, 5, 1.0), scenario.body.law_axes
        rate = law_vector(record.truth["omega_body_orbit_radps"], axes)
        flights.append((law_attitude(record.truth["q_body_from_orbit"], axes), rate))
    (attitude, rate), (again, rate_again) = flights
    assert np.abs(again - attitude).max() < 1e-3
    assert np.abs(rate_again - rate).max() < 1e-5
    assert np.degrees(angle_rad(attitude)).max() > 30.0


@pytest.mark.long
@pytest.mark.slow
def test_a_long_body_whose_long_axis_is_z_is_held_upright_by_the_filter():
    """Its attitude against the orbit is reported in its own axes: a quarter turn and more from 1 0 0 0."""
    body = {"inertia_kgm2": [0.04, 0.042, 0.008], "up": "z", "ahead": "x"}
    scenario = load("cubesat3u", {"body": body})
    record = record_scenario(scenario, 3, 4.0)
    last = perform(scenario, record.truth, record.estimates).figures()
    assert last["pointing_deg"]["rms_last_orbit"] < 5.0
    assert last["mode_final"] == "POINT"
    assert np.degrees(angle_rad(record.truth["q_body_from_orbit"][-600:])).min() > 90.0


@pytest.mark.long
@pytest.mark.slow
def test_held_the_other_way_it_falls_over():
    """What makes the difference is the key, not a strong coil."""
    scenario = load("cubesat3u", {"body": {"inertia_kgm2": [0.04, 0.042, 0.008]}})
    record = record_scenario(scenario, 3, 4.0)
    assert perform(scenario, record.truth, record.estimates).figures()["pointing_deg"]["final"] > 30.0


class TestTable:
    def test_axes_of_the_laws_that_are_those_of_the_body_change_no_table(self):
        said = load("microsat", {"body": {"up": "x", "ahead": "y"}})
        assert flight_table(said).crc == flight_table(load("microsat")).crc

    @pytest.mark.parametrize("pair", TURNED)
    def test_others_are_another_table(self, pair):
        turned = load("microsat", {"body": {"up": pair[0], "ahead": pair[1]}})
        assert flight_table(turned).crc != flight_table(load("microsat")).crc

    def test_two_axes_along_each_other_are_refused(self):
        with pytest.raises(TableError, match="body: '-z' cannot fly ahead where 'z' looks up"):
            load("microsat", {"body": {"up": "z", "ahead": "-z"}})

    def test_a_wheel_counts_as_along_the_normal_by_the_axes_of_the_laws(self):
        wheel = {
            "axis": [0.0, 1.0, 0.0],
            "inertia_kgm2": 1e-3,
            "max_torque_nm": 1e-3,
            "max_momentum_nms": 0.1,
        }
        given = {"wheel": wheel, "control": {"law": "pitch_wheel"}}
        load("microsat", given | {"body": {"up": "z", "ahead": "x"}})
        with pytest.raises(TableError, match=r"without a \[wheel\] along the orbit's normal"):
            load("microsat", given)
