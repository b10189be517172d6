"""A campaign file that cannot be flown is refused: a sentence names file, key and what is allowed."""

import pytest

from fsw.input.schema import TableError
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.definition.columns import input_cells
from sim.errors import HarnessError

HEAD = 'scenario = "microsat"\nruns = 2\n'


def disperse(key, rest):
    return f'{HEAD}[[disperse]]\nkey = "{key}"\n{rest}'


ANGLE, NOISE, BACKOFF = "initial.angle_deg", "sensors.magnetometer.noise_nt", "coils.backoff"
NORMAL = 'distribution = "normal"\nmean = 0.0\nsigma = 1.0'
REFUSED = {
    "runs": ('scenario = "microsat"\nruns = 0', "runs = 0 is not allowed: .* at least 1 "),
    "scenario": ('scenario = "nosuch"\nruns = 1', "there is no scenario 'nosuch'"),
    "no runs": ('scenario = "microsat"', "runs is missing"),
    "set": (HEAD + "set.foo = 1", "scenario microsat: foo is not a known key"),
    "no distribution": (disperse(ANGLE, ""), "disperse.0.distribution is missing"),
    "another distribution": (disperse(ANGLE, 'distribution = "gauss"'), "disperse.0.distribution = 'gauss'"),
    "unknown key": (
        disperse("sensors.magnetometer.nois", NORMAL),
        "disperse.0: sensors.magnetometer.nois is not",
    ),
    "unknown onboard key": (
        disperse("flight.estimator.x", NORMAL),
        r"disperse.0: \[flight\]: estimator.x is not",
    ),
    "range": (
        disperse(NOISE, 'distribution = "uniform"\nlow = -5.0\nhigh = 1.0'),
        "noise_nt = -5.0 is not allowed: allowed is a number at least 0",
    ),
    "far range": (
        disperse(ANGLE, 'distribution = "uniform"\nlow = 0.0\nhigh = 190.0'),
        "angle_deg = 190.0 is not allowed: .* at most 180",
    ),
    "whole number": (
        disperse("time.tick_hz", NORMAL),
        "tick_hz = 0.0 is not allowed: allowed is a whole number",
    ),
    "shape": (
        disperse(NOISE, 'distribution = "normal"\nmean = [1.0, 2.0]\nsigma = 1.0'),
        r"disperse.0 \(sensors.magnetometer.noise_nt\): parameters are 2 numbers, the scenario's value is",
    ),
    "sigma": (
        disperse(ANGLE, 'distribution = "normal"\nmean = 0.0\nsigma = -1.0'),
        "disperse.0.normal: sigma = -1.0 is not allowed: allowed is a number at least 0",
    ),
    "no number": (
        disperse(ANGLE, 'distribution = "normal"\nmean = "a"\nsigma = 1.0'),
        "normal.mean: must be a number",
    ),
    "no interval": (
        disperse(ANGLE, 'distribution = "uniform"\nlow = 2.0\nhigh = 1.0'),
        "low = 2.0 must not be above",
    ),
    "no logarithm": (
        disperse(ANGLE, 'distribution = "log_uniform"\nlow = 0.0\nhigh = 1.0'),
        "low = 0.0 .* above 0",
    ),
    "nothing between": (disperse(ANGLE, f"{NORMAL}\nlow = 50.0"), "at least a millionth"),
    "text": (disperse(BACKOFF, f'{NORMAL}\napply = "add"'), "the scenario's value is 'shared', not a number"),
    "choice": (
        disperse(BACKOFF, 'distribution = "choice"\nvalues = ["no"]'),
        "coils.backoff = 'no' is not allowed",
    ),
    "kinds": (
        disperse(BACKOFF, 'distribution = "choice"\nvalues = ["shared", 1]'),
        "values must be all numbers",
    ),
    "tables": (
        disperse(
            "sensors.magnetometer",
            'distribution = "choice"\nvalues = [{noise_nt = 1.0}, {bias_nt = [1, 2, 3]}]',
        ),
        "disperse.0.*tables with the same keys",
    ),
    "text and number in a table": (
        disperse("control", 'distribution = "choice"\nvalues = [{k_w = 1.0}, {k_w = "x"}]'),
        "disperse.0.*tables with the same keys",
    ),
    "weights": (
        disperse(BACKOFF, 'distribution = "choice"\nvalues = ["shared"]\nweights = [1.0, 2.0]'),
        "weights must be as many as values",
    ),
    "direction": (disperse(ANGLE, 'distribution = "direction"\nlow = 0.0\nhigh = 1.0'), "three components"),
    "element": (disperse("body.inertia_kgm2.3", NORMAL), "no element body.inertia_kgm2.3"),
    "no value": (disperse("orbit.altitude_km", f'{NORMAL}\napply = "add"'), "value is None"),
    "sizes": (
        HEAD
        + '[[disperse]]\nkeys = ["initial.angle_deg", "initial.rate_degps"]\ndistribution = "correlated"\n'
        "mean = [0.0, 0.0]\ncovariance = [[1, 0], [0, 1]]",
        "mean has 2 numbers, and the keys have 4 components",
    ),
    "covariance": (
        HEAD + '[[disperse]]\nkeys = ["initial.angle_deg", "control.k_w"]\ndistribution = "correlated"\n'
        "mean = [0.0, 0.0]\ncovariance = [[1, 2], [2, 1]]",
        "covariance must not have a negative eigenvalue",
    ),
    "twice": (
        disperse(ANGLE, NORMAL) + f'\n[[disperse]]\nkey = "{ANGLE}"\n{NORMAL}',
        "gives initial.angle_deg twice",
    ),
    "unlike": (
        HEAD + "requirement.zzzz = 3.0",
        "no figure .*of the pointing pointing_deg, of the rate rate_degps",
    ),
    "requirement": (HEAD + "requirement.pointing = 3.0", "requirement.pointing is no figure .*'pointing_deg"),
    "one figure twice": (
        HEAD + "requirement.pointing_deg = 3.0\nrequirement.pointing_deg_rms_last_orbit = 9.0",
        "_rms_last_orbit has two entries, requirement.pointing_deg and requirement.pointing_deg_rms_last_",
    ),
    "one figure twice by dots": (
        HEAD + "requirement.nees_mean = 3.0\n[requirement.nees]\nmean.at_least = 1.0",
        "nees_mean has two entries",
    ),
    "no limit": (
        HEAD + "[requirement.pointing_deg]",
        "requirement.pointing_deg has no limit: give a number, at_least or at_most",
    ),
    "limit": (
        HEAD + 'requirement.pointing_deg = "x"',
        "pointing_deg = 'x' is not allowed: allowed is a number",
    ),
    "index": (HEAD + "index.ape = -1.0", "index.ape = -1.0 is not allowed: .* above 0"),
    "other index": (HEAD + "index.pde = 1.0", "index.pde is not a known key"),
    "probability": (HEAD + "statistics.probability = 1.5", "probability = 1.5 .* below 1"),
}


@pytest.mark.parametrize(("text", "sentence"), REFUSED.values(), ids=REFUSED)
def test_a_wrong_file_is_one_sentence(text, sentence, tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(TableError, match=sentence) as caught:
        load_campaign(str(path), {}, {})
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(f"{path}: ")


def test_a_run_that_is_too_long_is_refused(tmp_path):
    path = tmp_path / "long.toml"
    path.write_text(HEAD + "orbits = 9000.0")
    with pytest.raises(HarnessError, match="at most 16777215 ticks"):
        load_campaign(str(path), {}, {})


def test_a_scenario_alone_is_a_campaign_of_its_noise(tmp_path):
    campaign = load_campaign("microsat", {"runs": 3, "orbits": 0.5}, {})
    assert (campaign.name, campaign.runs, campaign.disperse) == ("microsat", 3, ())
    assert campaign.base["time"]["orbits"] == 0.5
    assert load_campaign("microsat", {}, {}).runs == 100


def test_a_scenario_file_lies_beside_its_campaign(tmp_path):
    from importlib.resources import files

    shipped = files("sim.scenario.shipped").joinpath("microsat.toml").read_text()
    (tmp_path / "mine.toml").write_text(shipped.replace('name = "microsat"', 'name = "mine"'))
    path = tmp_path / "campaign.toml"
    path.write_text('scenario = "mine.toml"\nruns = 2')
    assert load_campaign(str(path), {}, {}).name == "mine"
    assert load_campaign(str(tmp_path / "mine.toml"), {}, {}).name == "mine"


def test_a_choice_of_tables_with_the_same_keys_has_their_columns(tmp_path):
    path = tmp_path / "tables.toml"
    values = "[{noise_nt = 1.0, bias_nt = [1.0, 2.0, 3.0]}, {noise_nt = 2.0, bias_nt = [0.0, 0.0, 0.0]}]"
    path.write_text(disperse("sensors.magnetometer", f'distribution = "choice"\nvalues = {values}'))
    campaign = load_campaign(str(path), {}, {})
    columns = {tuple(input_cells(campaign.draw(run).inputs)) for run in range(20)}
    assert len(columns) == 1
    assert "input_sensors_magnetometer_noise_nt" in columns.pop()
