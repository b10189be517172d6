"""The pulses as data: a lane a coil; of very many the strongest."""

from fractions import Fraction

import pytest

from sim.audit.findings import DrivenPulse
from sim.report.charts.coils import MOST_PULSES, pulse_lanes, shown


def pulses(count):
    return [DrivenPulse(0, 3 if i % 2 else -1, Fraction(10 * i), Fraction(10 * i + 3)) for i in range(count)]


def test_every_pulse_has_its_span_and_its_level(made_run):
    flight = made_run(
        ticks=300,
        pulses=(
            DrivenPulse(0, -2, Fraction(100), Fraction("103.25")),
            DrivenPulse(2, 3, Fraction(210), Fraction(213)),
        ),
    ).flown()
    data = pulse_lanes(flight)
    assert [lane["spans_s"] for lane in data["lanes"]] == [[[100.0, 103.25]], [], [[210.0, 213.0]]]
    assert [lane["levels"] for lane in data["lanes"]] == [[-2], [], [3]]
    assert (data["backoff_s"], data["shared"], data["most"]) == (100.0, True, 3)


@pytest.mark.long
def test_of_very_many_the_strongest_of_each_part_stays():
    many = pulses(2 * MOST_PULSES)
    kept = shown(many, 20.0 * MOST_PULSES)
    assert len(kept) == MOST_PULSES
    assert {pulse.level for pulse in kept} == {3}
    assert shown(many[:MOST_PULSES], 1e9) == many[:MOST_PULSES]
