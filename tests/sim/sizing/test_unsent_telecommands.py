"""Telecommands that a run is too short for."""

import pytest

from sim.flight.record_flight import ticks_of
from sim.scenario.schema import load
from sim.scenario.telecommands import uplink
from sim.sizing.doubts import doubts
from sim.sizing.unsent_telecommands import unsent_telecommands

TIMES_S = (0.0, 59.3, 60.0, 60.01, 1e9)


def scenario_with(*times_s, tick_hz=1):
    sent = [{"at_s": at_s, "message": "TC_CLEAR"} for at_s in times_s]
    return load("microsat", {"telecommand": sent, "time": {"tick_hz": tick_hz}})


@pytest.mark.parametrize("tick_hz", [1, 3, 10])
@pytest.mark.parametrize("seconds", [1, 60, 61])
def test_it_names_those_that_no_tick_of_the_run_sends(tick_hz, seconds):
    scenario, ticks = scenario_with(*TIMES_S, tick_hz=tick_hz), seconds * tick_hz
    frames = uplink(scenario.telecommand, tick_hz)
    sent = sum(len(frames(tick)) for tick in range(ticks))
    unsent = unsent_telecommands(scenario, ticks)
    assert len(unsent) == len(TIMES_S) - sent
    assert [sentence.partition(",")[0] for sentence in unsent] == [
        f"telecommand[{place}]" for place in range(sent, len(TIMES_S))
    ]


def test_it_says_when_the_run_ends():
    (sentence,) = unsent_telecommands(scenario_with(12.0, 600.0), 500)
    assert sentence == "telecommand[1], TC_CLEAR at 600 s, will not be sent: the last tick is at 499 s"


def test_a_scenario_that_is_shorter_than_its_telecommands_is_doubted():
    ticks = ticks_of(scenario_with(), None)
    assert doubts(scenario_with(ticks - 1.0)) == []
    (doubt,) = doubts(scenario_with(float(ticks)))
    assert "will not be sent" in doubt


def test_what_counts_is_how_long_the_run_is():
    asked = scenario_with(600.0)
    assert doubts(asked, 601) == []
    (doubt,) = doubts(asked, 600)
    assert "at 600 s, will not be sent: the last tick is at 599 s" in doubt
    late = scenario_with(float(ticks_of(asked, None)))
    assert doubts(late, 2 * ticks_of(asked, None)) == []
