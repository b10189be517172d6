"""A flight does not fail by what the faults of its scenario send and break: no word of the board."""

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilStatus
from sim.audit.auditor import AuditLimits, audit
from sim.campaign.flight import record_scenario
from sim.record import run_dir
from sim.record.candump import read_log
from sim.report.conclude import conclude
from sim.report.flight_audit import audit_flight
from sim.scenario.schema import load

LIMITS = AuditLimits()


@pytest.fixture(scope="module")
def forged(fly_run):
    """A run in which a stranger sends SYNC, and its scenario."""
    folder = fly_run(260, fault=[{"kind": "sync_forged", "at_s": 20.0}])
    return folder, run_dir.read_scenario(folder)


def test_the_limits_are_judged_without_forged_sync(forged):
    folder, scenario = forged
    entries = list(read_log(folder / run_dir.BUS_LOG))
    assert not audit(entries, LIMITS).ok
    report = audit_flight(entries, LIMITS, scenario, expect_end=True)
    assert (report.exit_code, report.violations) == (0, ())
    assert report.pulses


@pytest.mark.long
def test_such_a_flight_passes(forged):
    folder, _ = forged
    summary = conclude(folder)
    assert summary["limits_ok"]
    assert "failures" not in summary


def test_a_pulse_that_is_too_long_is_found_among_forged_sync(forged):
    folder, scenario = forged
    entries = list(read_log(folder / run_dir.BUS_LOG))
    short = AuditLimits(pulse_us=1_000_000)
    found = audit_flight(entries, short, scenario, expect_end=True).violations
    assert {violation.kind.value for violation in found} == {"pulse"}


def test_without_such_a_fault_a_forged_sync_is_a_violation(forged):
    folder, _ = forged
    entries = list(read_log(folder / run_dir.BUS_LOG))
    assert not audit_flight(entries, LIMITS, load("microsat", {})).ok


def test_broken_frames_count_unless_a_fault_breaks_them(bus_log):
    log = bus_log(ticks=50)
    log.statuses[7] = [Frame(CoilStatus.ID, bytes(CoilStatus.LENGTH))]
    broken = load("microsat", {"fault": [{"kind": "corruption", "at_s": 1.0}]})
    assert not audit_flight(log.entries(), LIMITS, load("microsat", {})).ok
    assert audit_flight(log.entries(), LIMITS, broken).ok


def test_a_flight_of_a_campaign_is_judged_likewise():
    fault = {"fault": [{"kind": "sync_forged", "at_s": 20.0}]}
    assert record_scenario(load("microsat", fault), 1, 0.04).audit.ok
