"""Flights whose indices are known, judged: met, missed, not judged."""

from fractions import Fraction

import numpy as np
import pytest

from sim.audit.findings import DrivenPulse
from sim.report.requirements.judge import Outcome
from sim.statistics.settling import HELD_S


def ape(**values):
    return {"index": "ape", "at_most_deg": 2.0, "by_orbit": 1.0, **values}


def test_a_flight_that_is_as_long_as_its_orbit_is_judged_and_a_shorter_one_is_not(judge_made, orbit_ticks):
    (whole,) = judge_made([ape()], np.full(orbit_ticks, 1.0))
    assert (whole["verdict"], whole["measured"]) == (Outcome.MET, pytest.approx(1.0))
    (short,) = judge_made([ape()], np.full(orbit_ticks // 2, 130.0))
    assert (short["verdict"], short["measured"], short["reasons"]) == (Outcome.NOT_JUDGED, None, [])
    assert short["text"] == "APE of whole attitude: judged by orbit 1, flown were 0.50 orbits"


def test_a_requirement_with_a_name_is_called_by_it(judge_made, orbit_ticks):
    named, nameless = judge_made([ape(id="REQ-01"), ape()], np.full(orbit_ticks, 1.0))
    assert (named["id"], nameless["id"]) == ("REQ-01", None)
    assert named["text"] == f"REQ-01: {nameless['text']}"


def test_a_missed_one_says_by_how_much_and_why(judge_made, orbit_ticks):
    (one,) = judge_made([ape()], np.full(orbit_ticks, 130.0))
    assert one["verdict"] == Outcome.FAILED
    assert one["text"] == "APE of whole attitude 130 deg RMS over the whole flight of 1 orbit, at most 2 deg"
    assert one["reasons"]


def test_a_figure_just_over_its_limit_does_not_read_as_the_limit(judge_made, orbit_ticks):
    (one,) = judge_made([ape()], np.full(orbit_ticks, 2.001))
    assert "2.001 deg RMS" in one["text"]


def test_only_the_last_orbit_counts(judge_made, orbit_ticks):
    turn = np.concatenate((np.full(orbit_ticks, 90.0), np.full(orbit_ticks, 1.5)))
    (last,) = judge_made([ape()], turn)
    assert last["measured"] == pytest.approx(1.5)
    (both,) = judge_made([ape(last_orbits=2.0, by_orbit=2.0)], turn)
    assert both["measured"] == pytest.approx(np.sqrt((90.0**2 + 1.5**2) / 2), rel=1e-3)


def test_a_part_of_the_time_is_rounded_up_to_half_a_percent(judge_made, orbit_ticks):
    turn = np.linspace(0.0, 3.0, orbit_ticks)
    for probability in (0.5, 0.95, 1.0):
        (one,) = judge_made([ape(probability=probability)], turn)
        assert 3.0 * probability - 1e-3 <= one["measured"] <= 3.0 * probability * 1.006
        assert (one["verdict"] == Outcome.MET) == (probability == 0.5)


def test_in_sunlight_alone(judge_made, orbit_ticks):
    turn, lit = np.full(orbit_ticks, 1.0), np.ones(orbit_ticks)
    turn[:2000], lit[:2000] = 50.0, 0.0
    (one,) = judge_made([ape(sunlit=True)], turn, lit=lit)
    assert one["measured"] == pytest.approx(1.0)
    assert "in sunlight" in one["text"]
    (dark,) = judge_made([ape(sunlit=True)], turn, lit=0.0)
    assert (dark["verdict"], dark["measured"]) == (Outcome.FAILED, None)


@pytest.mark.parametrize("index", ["mpe", "rpe"])
@pytest.mark.parametrize("average_s", [1.0, 600.0, 777.0, 50_000.0])
def test_means_are_those_of_the_standard_however_the_flight_comes(judge_made, orbit_ticks, index, average_s):
    turn = 2.0 + np.sin(np.arange(orbit_ticks) / 300.0)
    (one,) = judge_made([ape(index=index, average_s=average_s)], turn)
    measured = means_and_deviations(turn, round(average_s))[index]
    assert one["measured"] == pytest.approx(np.sqrt(np.mean(np.square(measured))), rel=1e-9)


def means_and_deviations(turn, average):
    """Over whole windows, and over the last one that ends with the flight, for the ticks after these."""
    average = min(average, len(turn))
    whole = len(turn) // average * average
    parts = turn[:whole].reshape(-1, average)
    means, deviations = list(parts.mean(axis=1)), list((parts - parts.mean(axis=1, keepdims=True)).ravel())
    if whole < len(turn):
        means.append(turn[-average:].mean())
        deviations.extend(turn[whole:] - means[-1])
    return {"mpe": means, "rpe": deviations}


@pytest.mark.parametrize("index", ["mpe", "rpe"])
@pytest.mark.parametrize("average_s", [200.0, 600.0, 50_000.0])
def test_an_error_in_the_last_seconds_counts_among_means_and_deviations(
    judge_made, orbit_ticks, index, average_s
):
    """Also where no whole averaging time is left of the window."""
    turn = np.zeros(orbit_ticks)
    turn[-41:] = 120.0
    (one,) = judge_made([ape(index=index, average_s=average_s, probability=1.0)], turn)
    mean = 120.0 * 41 / min(average_s, orbit_ticks)
    expected = mean if index == "mpe" else 120.0 - mean
    assert one["measured"] == pytest.approx(expected, rel=0.006)


def test_knowledge_and_rate(judge_made, orbit_ticks):
    requirements = [
        {"index": "ake", "at_most_deg": 0.5, "by_orbit": 1.0},
        {"index": "rate", "at_most_degps": 0.1, "by_orbit": 1.0},
        {"index": "ape", "what": "spin", "at_most_degps": 0.1, "by_orbit": 1.0},
        {"index": "ape", "what": "axis", "at_most_deg": 0.1, "by_orbit": 1.0},
    ]
    found = judge_made(requirements, np.full(orbit_ticks, 1.0), wrong_deg=0.3, rate_radps=0.001)
    measured = [one["measured"] for one in found]
    assert measured == pytest.approx([0.3, np.degrees(0.001), np.degrees(0.001), 1.0], rel=1e-6)
    assert [one["verdict"] for one in found] == ["met", "met", "met", "failed"]


class TestSettling:
    def flight(self, orbit_ticks):
        turn = np.full(2 * orbit_ticks, 1.0)
        turn[: orbit_ticks // 2] = 20.0
        turn[orbit_ticks // 2 + 5000] = 5.0
        return turn

    def test_is_from_the_last_time_that_the_error_was_large(self, judge_made, orbit_ticks):
        requirement = {"index": "settling", "at_most_orbits": 1.5, "by_orbit": 2.0}
        (one,) = judge_made([requirement], self.flight(orbit_ticks))
        assert one["measured"] == pytest.approx((orbit_ticks // 2 + 5001) / orbit_ticks, rel=1e-3)
        assert "under 5 deg from 1.33 orbits on" in one["text"]
        (other,) = judge_made([requirement | {"settled_deg": 5.1}], self.flight(orbit_ticks))
        assert other["measured"] == pytest.approx(0.5, abs=1e-3)

    def test_one_that_is_not_settled_at_the_end_is_missed(self, judge_made, orbit_ticks):
        turn = self.flight(orbit_ticks)
        turn[-1] = 6.0
        for requirement in (
            {"index": "settling", "at_most_orbits": 2.0, "by_orbit": 2.0},
            ape(window="settled", by_orbit=2.0),
        ):
            (one,) = judge_made([requirement], turn)
            assert (one["verdict"], one["measured"]) == (Outcome.FAILED, None)

    def test_what_is_small_only_at_the_last_has_not_settled(self, judge_made, orbit_ticks):
        """It has, once it stayed small for the least time."""
        requirements = [
            {"index": "settling", "at_most_orbits": 1.0, "by_orbit": 1.0},
            ape(window="settled", probability=1.0),
        ]
        for held, verdict in ((1, "failed"), (round(HELD_S) - 1, "failed"), (round(HELD_S), "met")):
            turn = np.full(orbit_ticks, 90.0)
            turn[-held:] = 1.0
            settling, pointing = judge_made(requirements, turn)
            assert (settling["verdict"], pointing["verdict"]) == (verdict, verdict)
            assert (settling["measured"] is None) == (verdict == "failed")
        turn[-41:-1] = 90.0
        settling, pointing = judge_made(requirements, turn)
        assert "not under 5 deg for the last 600 s, at most 1 orbits" in settling["text"]
        assert "under 5 deg, by orbit 1, nor for the last 600 s; at most 2 deg" in pointing["text"]

    def test_a_flight_that_is_shorter_than_that_cannot_show_it(self, judge_made):
        requirements = [
            {"index": "settling", "at_most_orbits": 0.05, "by_orbit": 0.05, "last_orbits": 0.05},
            ape(window="settled", by_orbit=0.05),
            ape(by_orbit=0.05, last_orbits=0.05),
        ]
        found = judge_made(requirements, np.full(round(HELD_S) - 1, 1.0))
        assert [one["verdict"] for one in found] == ["not judged", "not judged", "met"]
        assert found[0]["text"].endswith(
            ": settled is what stays under its threshold for 600 s, flown were 599 s"
        )

    def test_a_window_from_settling_on_forgets_what_was_before(self, judge_made, orbit_ticks):
        (one,) = judge_made([ape(window="settled", by_orbit=2.0)], self.flight(orbit_ticks))
        assert (one["verdict"], one["measured"]) == (Outcome.MET, pytest.approx(1.0))
        assert "over 0.67 orbits from settling on" in one["text"]

    def test_settled_too_late_is_missed(self, judge_made, orbit_ticks):
        (one,) = judge_made([ape(window="settled", by_orbit=1.2)], self.flight(orbit_ticks))
        assert one["verdict"] == Outcome.FAILED
        assert "not settled, under 5 deg, by orbit 1.2, but from 1.33 orbits on" in one["text"]


def test_duty_and_energy_are_those_of_the_pulses_in_the_window(judge_made, orbit_ticks):
    pulses = [
        DrivenPulse(0, 3, Fraction(at), Fraction(at + 3)) for at in (10, orbit_ticks - 1, orbit_ticks + 500)
    ]
    requirements = [
        {"index": "duty", "at_most_percent": 1.0, "by_orbit": 2.0},
        {"index": "energy", "at_most_j": 1.0, "by_orbit": 2.0},
    ]
    settings = {"coils": {"resistance_ohm": 20.0}}
    duty, energy = judge_made(requirements, np.ones(2 * orbit_ticks), pulses, settings=settings)
    driven_s = 2.0 + 3.0  # of the pulse across the edge of the window, two seconds
    assert duty["measured"] == pytest.approx(100.0 * driven_s / orbit_ticks)
    assert energy["measured"] == pytest.approx(driven_s * 20.0 * (8.0 / 20.0) ** 2)
