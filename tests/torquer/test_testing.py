"""The pytest plugin: a fixture that flies, and expressions over the summary."""

import json
import subprocess
import sys

import pytest

from torquer import InputError
from torquer.api.run import Run
from torquer.testing import ExpressionError, FlownScenario

SUMMARY = {
    "scenario": "microsat",
    "seed": 7,
    "sim_seconds": 302.0,
    "limits_ok": True,
    "mode_final": "POINT",
    "pulses": {"total": 7},
    "pointing_deg": {"final": 2.5, "settled": None},
    "isolated": ["coil 2"],
}


@pytest.fixture
def flown(tmp_path):
    (tmp_path / "summary.json").write_text(json.dumps(SUMMARY))
    return FlownScenario(Run(tmp_path))


@pytest.mark.parametrize(
    "expression",
    [
        "pointing_deg.final < 3",
        "pointing_deg.final<3.0",
        " pulses.total == 7 ",
        "pulses.total >= 7",
        "pulses.total <= 7",
        "pulses.total != 8",
        "pulses.total > 6.5",
        "mode_final == POINT",
        'mode_final == "POINT"',
        "limits_ok == true",
        "mode_final != SAFE",
        'isolated == ["coil 2"]',
        "isolated != []",
    ],
)
def test_what_holds(flown, expression):
    flown.expect(expression)


def test_all_that_does_not_hold_is_named_with_its_value(flown):
    with pytest.raises(AssertionError) as caught:
        flown.expect("pointing_deg.final < 2", "pulses.total == 7", "limits_ok == false")
    message = str(caught.value)
    assert "pointing_deg.final < 2 does not hold: 2.5" in message
    assert "limits_ok == false does not hold: True" in message
    assert "pulses" not in message


@pytest.mark.parametrize(
    ("expression", "what"),
    [
        ("", "is none"),
        ("pulses.total", "is none"),
        ("pulses.total = 7", "is none"),
        ("pulses.totl == 7", "no 'totl' in the summary, of total"),
        ("pulses.total.sum == 7", "no 'sum' in the summary, of none"),
        ("mode_final < 3", "'POINT' in the summary cannot be compared"),
        ("mode_final != SAFF", "no such mode, of .*SAFE"),
        ("mode_final != safe", "no such mode, of .*SAFE"),
        ("limits_ok != False", "True in the summary cannot be compared"),
        ("limits_ok == 1", "True in the summary cannot be compared"),
        ("pulses.total != seven", "7 in the summary cannot be compared"),
        ("pulses.total != nan", "7 in the summary cannot be compared"),
        ("pointing_deg.settled != 3", "None in the summary cannot be compared"),
        ("pulses != 7", "in the summary cannot be compared"),
        ("mode_final < SAFE", "only numbers have an order, 'POINT' is a word"),
        ("limits_ok >= false", "only numbers have an order, True is true or false"),
    ],
)
def test_what_cannot_be_judged_is_no_pass(flown, expression, what):
    with pytest.raises(ExpressionError, match=what):
        flown.expect(expression)


def test_nothing_expected_is_no_pass(flown):
    with pytest.raises(ExpressionError, match="asserts nothing"):
        flown.expect()


REQUIREMENTS = [
    {"index": "settling", "verdict": "met", "text": "settling of whole attitude from 0.9 orbits on"},
    {"index": "ape", "verdict": "not judged", "text": "APE: judged by orbit 5, flown were 4.00 orbits"},
]


@pytest.fixture
def required(tmp_path):
    def flown(requirements):
        (tmp_path / "summary.json").write_text(json.dumps({**SUMMARY, "requirements": requirements}))
        return FlownScenario(Run(tmp_path))

    return flown


class TestRequirementsOfTheScenario:
    def test_are_met_if_each_is(self, required):
        flown = required(REQUIREMENTS[:1])
        flown.expect("requirements == met", "requirements.settling == met", "requirements != failed")

    def test_that_were_not_judged_are_not_met(self, required):
        flown = required(REQUIREMENTS)
        flown.expect("requirements.settling == met", "requirements == not judged")
        with pytest.raises(AssertionError, match="not judged: APE: judged by orbit 5") as caught:
            flown.expect("requirements == met")
        assert "settling" not in str(caught.value)

    def test_one_that_failed_counts_more_than_one_not_judged(self, required):
        failed = {"index": "ake", "verdict": "failed", "text": "AKE 3 deg RMS, at most 1 deg"}
        with pytest.raises(AssertionError, match="failed: AKE 3 deg RMS"):
            required([*REQUIREMENTS, failed]).expect("requirements == met")

    @pytest.mark.parametrize(
        ("expression", "what"),
        [
            ("requirements == ok", "one of failed, not judged, met"),
            ("requirements < met", "== or !="),
            ("requirements.rate == met", "no such requirement in the scenario, of settling, ape"),
        ],
    )
    def test_what_cannot_be_judged_is_no_pass(self, required, expression, what):
        with pytest.raises(ExpressionError, match=what):
            required(REQUIREMENTS).expect(expression)

    def test_a_scenario_without_any_meets_none(self, required):
        with pytest.raises(ExpressionError, match="no such requirement in the scenario, of none"):
            required([]).expect("requirements == met")

    @pytest.mark.long
    def test_of_a_real_flight(self, fly):
        flight = fly("microsat", orbits=0.005)
        flight.expect("requirements == not judged", "requirements.ake != met")


@pytest.mark.long
def test_a_flight_as_a_fixture(fly):
    flight = fly("microsat", orbits=0.03, seed=7, control={"k_w": 5e6})
    flight.expect("limits_ok == true", "seed == 7", "ticks == 181", "replay.bit_exact == true")
    assert flight.audit().ok
    assert "k_w = 5000000.0" in (flight.run.path / "scenario.toml").read_text()


@pytest.mark.long
def test_a_flight_that_fails_fails_the_test(fly, monkeypatch):
    monkeypatch.setattr(
        "sim.report.conclude.failures", lambda *args, **named: {"limits": "the limits are broken"}
    )
    with pytest.raises(AssertionError, match="the limits are broken"):
        fly("microsat", orbits=0.005)


def test_a_flight_that_cannot_be_flown_is_an_error(fly):
    with pytest.raises(InputError, match="at most"):
        fly("microsat", orbits=1e9)


@pytest.mark.long
def test_the_plugin_is_light(pytester_process):
    assert pytester_process("import torquer.testing, sys; print('numpy' in sys.modules)") == "False"


@pytest.fixture
def pytester_process():
    def run(code):
        done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
        return done.stdout.strip()

    return run
