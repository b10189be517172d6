"""``torquer judge`` flies the flight software in C on this machine, and has nothing against it."""

import pytest
from click.testing import CliRunner

from torquer.cli.main import main

pytestmark = pytest.mark.long

OF_ESTIMATES = {"tells its estimate", "is honest", "its rate is true"}
"""Rules of the profile attitude."""


def test_nothing_is_held_against_it(flight):
    _, told, _ = flight
    assert (told["ok"], told["reasons"]) == (True, [])
    assert {one["verdict"] for one in told["invariants"]} == {"kept", "not judged"}
    assert {one["verdict"] for one in told["requirements"]} == {"met"}, told["requirements"]


def test_what_it_did_was_enough_to_be_judged(flight):
    _, told, _ = flight
    unjudged = {one["name"] for one in told["invariants"] if one["verdict"] == "not judged"}
    brakes = {"brakes the body"} if told["profile"] == "actuator" else set()
    assert unjudged <= OF_ESTIMATES | {"heeds a stuck coil"} | brakes


def test_its_log_is_that_of_a_sound_flight(flight):
    _, _, run = flight
    assert CliRunner().invoke(main, ["check", str(run)]).exit_code == 0
    assert (run / "flight-software.log").read_text() == "", "it has nothing to say"
