"""A run is drawn from seed and number alone, and its values arrive at the scenario."""

import numpy as np
import pytest

from sim.campaign.definition.campaign import nominal_values, value_at, with_value
from sim.campaign.definition.campaign_file import load_campaign
from sim.scenario.schema import flight_table, load

NOMINAL = {"a": {"b": [1.0, 2.0, 3.0], "c": 4.0}, "list": [{"x": 1.0, "y": 2.0}]}


def test_values_are_found_by_name_and_number():
    assert value_at(NOMINAL, "a.c") == 4.0
    assert value_at(NOMINAL, "a.b.2") == 3.0
    assert value_at(NOMINAL, "list.0.y") == 2.0
    assert [value_at(NOMINAL, key) for key in ("a.d", "a.b.3", "a.c.0", "b")] == [None] * 4


def test_an_element_keeps_its_neighbours_and_those_set_before():
    first = with_value({}, NOMINAL, "a.b.0", 7.0)
    assert first == {"a": {"b": [7.0, 2.0, 3.0]}}
    both = with_value(first, NOMINAL, "a.b.2", 9.0)
    assert both == {"a": {"b": [7.0, 2.0, 9.0]}}
    assert with_value(both, NOMINAL, "list.0.y", 5.0)["list"] == [{"x": 1.0, "y": 5.0}]
    assert NOMINAL["a"]["b"] == [1.0, 2.0, 3.0]


def test_a_key_without_a_value_can_be_set_but_no_element_of_it():
    assert with_value({}, NOMINAL, "new.key", 1.0) == {"new": {"key": 1.0}}
    for key in ("new.0", "a.b.3", "list.1.x", "list.0.z"):
        with pytest.raises(ValueError, match=f"no element {key}"):
            with_value({}, NOMINAL, key, 1.0)
    with pytest.raises(ValueError, match="is not a key"):
        with_value({}, NOMINAL, "a..b", 1.0)


def test_the_onboard_table_is_whole():
    values = nominal_values(load("realsat"))
    assert value_at(values, "flight.body.inertia_kgm2") == [1.02, 1.85, 1.95]
    assert value_at(values, "flight.estimator.sun_sigma_deg") > 0.5
    assert value_at(values, "body.inertia_kgm2.0.1") == -0.029
    assert value_at(values, "orbit.altitude_km") is None


# --- A run is drawn from seed and number alone, and its values arrive at the scenario


def test_a_run_does_not_depend_on_the_others(small):
    backwards = {run: small.draw(run) for run in reversed(range(6))}
    assert backwards[3] == small.draw(3)
    assert len({drawn.seed for drawn in backwards.values()}) == 6


def test_a_dispersion_does_not_depend_on_the_others(campaign_file, small, tmp_path):
    """One that is added, or stands elsewhere in the file, leaves what another draws."""
    head, *entries = campaign_file.read_text().split("[[disperse]]")
    fewer = tmp_path / "fewer.toml"
    fewer.write_text("[[disperse]]".join([head, *reversed(entries[:3])]))
    theirs, ours = load_campaign(str(fewer), {}, {}).draw(2), small.draw(2)
    assert theirs.seed == ours.seed
    assert list(theirs.inputs) != list(ours.inputs)
    assert {key: ours.inputs[key] for key in theirs.inputs} == theirs.inputs


@pytest.mark.long
def test_dispersions_are_independent_of_each_other(tmp_path):
    entry = '[[disperse]]\nkey = "{}"\ndistribution = "uniform"\nlow = 0.0\nhigh = 1.0\n'
    keys = ("initial.angle_deg", "sensors.sun.noise_deg")
    path = tmp_path / "two.toml"
    path.write_text('scenario = "microsat"\nruns = 2\n' + "".join(map(entry.format, keys)))
    campaign = load_campaign(str(path), {}, {})
    drawn = np.array([[campaign.draw(run).inputs[key] for key in keys] for run in range(400)])
    assert abs(np.corrcoef(drawn.T)[0, 1]) < 0.15


def test_another_seed_gives_other_runs(campaign_file, small):
    other = load_campaign(str(campaign_file), {"seed": 12}, {}).draw(0)
    assert other.inputs["initial.angle_deg"] != small.draw(0).inputs["initial.angle_deg"]
    assert other.seed != small.draw(0).seed


def test_what_is_drawn_is_what_flies(small):
    drawn = small.draw(4)
    scenario, table = small.scenario(drawn), flight_table(small.scenario(drawn))
    inputs = drawn.inputs
    assert list(scenario.sensors.magnetometer.bias_nt) == inputs["sensors.magnetometer.bias_nt"]
    assert list(scenario.disturbance.residual_dipole_am2) == inputs["disturbance.residual_dipole_am2"]
    assert inputs["disturbance.residual_dipole_am2.length"] == pytest.approx(
        np.linalg.norm(scenario.disturbance.residual_dipole_am2)
    )
    assert scenario.initial.angle_deg == inputs["initial.angle_deg"]
    assert np.array(scenario.body.inertia_kgm2) / [1.02, 1.85, 1.95] == pytest.approx(1.0, abs=0.05)
    assert list(scenario.body.inertia_kgm2) == inputs["body.inertia_kgm2"] != [1.02, 1.85, 1.95]
    turn = scenario.sensors.sun.misalignment_deg
    assert turn == (inputs["sensors.sun.misalignment_deg.0"], 0.0, inputs["sensors.sun.misalignment_deg.2"])
    assert table.estimator.sun_sigma_deg == inputs["flight.estimator.sun_sigma_deg"]
    assert table.coils.backoff == inputs["coils.backoff"]
    assert scenario.sensors.magnetometer.noise_nt == 150.0
    assert {small.draw(run).inputs["coils.backoff"] for run in range(6)} == {"shared", "per_coil"}


def test_a_campaign_is_written_and_read_again(small, tmp_path):
    small.write(tmp_path)
    again = load_campaign(str(tmp_path), {}, {})
    assert again.digest == small.digest
    assert [again.draw(run) for run in range(6)] == [small.draw(run) for run in range(6)]
    assert again.scenario(again.draw(1)) == small.scenario(small.draw(1))


@pytest.mark.parametrize(
    ("over", "same"), [({"runs": 9}, True), ({"seed": 3}, False), ({"orbits": 0.03}, False)]
)
def test_a_campaign_is_the_same_with_more_runs_and_no_other_change(campaign_file, small, over, same):
    assert (load_campaign(str(campaign_file), over, {}).digest == small.digest) is same


def test_limits_on_the_indices_may_change(campaign_file, small, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text(campaign_file.read_text().replace("ape = 150.0", "ape = 3.0"))
    changed = load_campaign(str(other), {}, {})
    assert changed.index.ape == 3.0
    assert changed.digest == small.digest


def test_settings_are_part_of_it(campaign_file, small):
    changed = load_campaign(str(campaign_file), {}, {"control": {"k_w": 5.0e6}})
    assert changed.digest != small.digest
    assert changed.scenario(changed.draw(0)).control.k_w == 5.0e6
    assert changed.scenario(changed.draw(0)).sensors.magnetometer.noise_nt == 150.0
