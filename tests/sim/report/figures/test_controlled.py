"""The spin that is asked for: that of the table, then that of the scenario's telecommands."""

import numpy as np
import pytest

from sim.record.estimates import EstimateRecorder
from sim.report.figures.controlled import error_vectors, spin_reference_radps
from sim.report.figures.performance import perform
from sim.report.requirements.judge import Gathered
from sim.scenario.schema import load


def with_spins(*spins, tick_hz=1, **others):
    telecommands = [{"message": "TC_SPIN", "at_s": at_s, "spin_radps": spin} for at_s, spin in spins]
    return load("posat1-spinup", {"telecommand": telecommands, "time": {"tick_hz": tick_hz}, **others})


@pytest.mark.parametrize("tick_hz", [1, 10])
def test_each_telecommand_holds_from_its_tick_on(tick_hz):
    scenario = with_spins((7.0, 0.01), (3.0, -0.005), (9.0, 0.12), tick_hz=tick_hz)
    t_s = np.arange(12 * tick_hz) / tick_hz
    table = scenario.control.spin_radps
    expected = np.select([t_s >= 7.0, t_s >= 3.0], [0.01, -0.005], table)  # 0.12 is refused
    assert table == 0.02
    assert (spin_reference_radps(scenario, t_s) == expected).all()


def test_the_last_of_a_tick_counts():
    assert spin_reference_radps(with_spins((2.0, 0.01), (2.0, 0.03)), np.arange(4.0)).tolist() == [
        0.02,
        0.02,
        0.03,
        0.03,
    ]


@pytest.fixture
def turning():
    """2000 s of exactly 0.01 rad/s about axis 1."""
    ticks = 2000
    truth = {
        "t_s": np.arange(float(ticks)),
        "q_body_from_orbit": np.tile([1.0, 0.0, 0.0, 0.0], (ticks, 1)),
        "omega_body_orbit_radps": np.tile([0.01, 0.0, 0.0], (ticks, 1)),
        "lit": np.ones(ticks),
        "m_body_am2": np.zeros((ticks, 3)),
    }
    return truth, EstimateRecorder(ticks).estimates()


def test_the_errors_are_from_what_is_asked_for(turning):
    truth, _ = turning
    error = error_vectors("spin", truth, with_spins((500.0, 0.01)))
    assert error[:500] == pytest.approx(np.degrees(-0.01))
    assert error[500:] == pytest.approx(0.0)
    assert error_vectors("rate", truth, load("posat1-spinup", {}))[:, 0] == pytest.approx(np.degrees(-0.01))


def test_the_summary_names_the_last_reference_and_settles_at_it(turning):
    spin = perform(with_spins((500.0, 0.01)), *turning).spin()
    assert spin["reference"] == 0.01
    assert spin["settle_s_1e-3"] == 500.0
    stopped = perform(with_spins((500.0, 0.0)), *turning).spin()
    assert (stopped["reference"], "settle_s_1e-3" in stopped) == (0.0, False)
    assert perform(load("microsat", {}), *turning).spin() is None


def test_a_requirement_on_the_spin_follows_it(turning):
    required = [{"index": "ape", "what": "spin", "at_most_degps": 0.01, "by_orbit": 0.2, "last_orbits": 0.2}]
    found = []
    for scenario in (
        with_spins((500.0, 0.01), requirement=required),
        load("posat1-spinup", {"requirement": required}),
    ):
        gathered = Gathered(scenario.requirement[0], scenario, 2000)
        gathered.take(*turning)
        found.append(gathered.value())
    assert found == pytest.approx([0.0, np.degrees(0.01)])
