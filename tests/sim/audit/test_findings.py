"""What an audit reports: figures over the pulses, the verdict, and violations in words."""

from dataclasses import replace
from fractions import Fraction

import pytest

from sim.audit.findings import AuditLimits, AuditReport, DrivenPulse, Violation, ViolationKind, seconds_text


def pulse(coil, start_s, end_s, level=1):
    return DrivenPulse(coil, level, Fraction(start_s), Fraction(end_s))


PULSES = (pulse(1, 10, 13), pulse(0, 110, "111.5"), pulse(1, 230, 232, level=-3), pulse(1, 400, 401))
REPORT = AuditReport(
    limits=AuditLimits(),
    pulses=PULSES,
    violations=(),
    notes=(),
    statuses=500,
    span_s=Fraction(500),
    truncated_at=None,
    complete=True,
)
VIOLATION = Violation(ViolationKind.GAP, Fraction("12.5"), 125, 2, 77, "too soon")


def test_the_limits_are_those_of_the_invariant_unless_others_are_given():
    limits = AuditLimits()
    assert (limits.pulse_us, limits.backoff_us, limits.max_level) == (3_000_000, 100_000_000, 3)
    assert (limits.shared, limits.tick_hz) == (True, None)


class TestFigures:
    def test_of_pulses(self):
        assert [one.length_s for one in PULSES] == [3, Fraction("1.5"), 2, 1]
        assert REPORT.pulses_per_coil == [1, 3, 0]
        assert REPORT.max_pulse_s == 3.0
        assert REPORT.duty_per_coil == [0.003, 0.012, 0.0]
        assert REPORT.duty_total == 0.015

    def test_gaps_are_from_end_to_start(self):
        assert REPORT.min_gap_any_s == 97.0
        assert REPORT.min_gap_per_coil_s == [None, 168.0, None]

    def test_pulses_that_overlap_have_no_gap(self):
        report = replace(REPORT, pulses=(pulse(0, 10, 13), pulse(1, 11, 14), pulse(0, 200, 203)))
        assert (report.min_gap_any_s, report.min_gap_per_coil_s) == (0.0, [187.0, None, None])

    def test_without_pulses(self):
        report = replace(REPORT, pulses=())
        assert (report.max_pulse_s, report.min_gap_any_s, report.duty_total) == (None, None, 0.0)
        assert (report.pulses_per_coil, report.min_gap_per_coil_s) == ([0, 0, 0], [None] * 3)

    @pytest.mark.parametrize(("span_s", "duty"), [(0, 0.0), (1, 7.5), (2, 3.75)])
    def test_over_no_time_there_is_no_duty(self, span_s, duty):
        assert replace(REPORT, span_s=Fraction(span_s)).duty_total == duty


class TestVerdict:
    def test_kept_complete_and_genuine(self):
        assert (REPORT.ok, REPORT.exit_code) == (True, 0)

    @pytest.mark.parametrize("change", [{"statuses": 0}, {"violations": (VIOLATION,)}])
    def test_nothing_judged_or_a_limit_broken(self, change):
        report = replace(REPORT, **change)
        assert (report.ok, report.exit_code) == (False, 1)

    def test_one_status_is_something(self):
        assert replace(REPORT, statuses=1).ok

    @pytest.mark.parametrize("change", [{"complete": False}, {"genuine": False}])
    def test_limits_kept_in_a_log_that_is_not_whole_or_not_as_flown(self, change):
        report = replace(REPORT, **change)
        assert (report.ok, report.exit_code) == (True, 1)


@pytest.mark.parametrize(
    ("tick", "coil", "text"),
    [
        (125, 2, "t=12.500 s (tick 125) coil 2: too soon [line 77]"),
        (0, 0, "t=12.500 s (tick 0) coil 0: too soon [line 77]"),
        (None, 2, "t=12.500 s coil 2: too soon [line 77]"),
        (125, None, "t=12.500 s (tick 125): too soon [line 77]"),
    ],
)
def test_a_violation_in_words(tick, coil, text):
    assert str(replace(VIOLATION, tick=tick, coil=coil)) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (3, "3.000"),
        (Fraction("3.1"), "3.100"),
        (Fraction("0.0101"), "0.0101"),
        (Fraction(1, 3), "0.333333"),
        (-0.5, "-0.500"),
        (100.000001, "100.000001"),
    ],
)
def test_seconds_have_three_decimals_or_as_many_as_they_need(seconds, text):
    assert seconds_text(seconds) == text
