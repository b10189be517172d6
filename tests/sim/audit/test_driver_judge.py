"""What each kind of coil driver reports as driven, and what it must never report."""

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipoleStatus
from sim.audit.auditor import AuditLimits, ViolationKind, audit
from sim.audit.check import check, render
from sim.audit.documents import as_json, suites
from sim.audit.limits import limits_in
from sim.errors import HarnessError

CONTINUOUS = AuditLimits(on_fraction=0.8)


@pytest.fixture
def dipoles(bus_log):
    """A log of ten ticks at 1 Hz of a continuous driver that drives these fractions, by tick."""

    def make(driven=None, **values):
        log = bus_log(ticks=10, **values)
        for tick, frames in log.statuses.items():
            frames.append(CoilDipoleStatus(*(driven or {}).get(tick, (0, 0, 0)), counter=tick).encode())
        return log

    return make


def found(report):
    return [(one.kind, one.tick) for one in report.violations]


DRIVEN = {3: (0.5, -0.25, 0.0), 4: (0.5, 0.0, 0.0), 7: (0.0, 0.0, -1.0)}


def test_a_pulsed_driver_that_reports_dipoles_is_named_once_a_stretch(dipoles):
    report = audit(dipoles(DRIVEN).entries(), AuditLimits())
    assert found(report) == [(ViolationKind.DRIVER, 3), (ViolationKind.DRIVER, 7)]
    assert "a pulsed driver reports 0.5, -0.25, 0 of full scale as driven" in str(report.violations[0])
    assert report.exit_code == 1
    assert report.dipoles is None


def test_a_stretch_that_begins_with_the_first_status_is_named(dipoles):
    report = audit(dipoles({0: (1.0, 0.0, 0.0), 1: (1.0, 0.0, 0.0)}).entries(), AuditLimits())
    assert found(report) == [(ViolationKind.DRIVER, 0)]


def test_ticks_are_counted_by_coil(dipoles):
    driven = {tick: (float(tick < 1), float(tick < 2), float(tick < 4)) for tick in range(10)}
    count = audit(dipoles(driven).entries(), CONTINUOUS).dipoles
    assert (count.statuses, count.driven, count.any_driven) == (10, (1, 2, 4), 4)


def test_without_sync_it_is_named_at_its_time(dipoles):
    report = audit(dipoles(DRIVEN, sync=False).entries(), AuditLimits())
    assert [(one.kind, one.time_s) for one in report.violations] == [
        (ViolationKind.DRIVER, 3),
        (ViolationKind.DRIVER, 7),
    ]


def test_a_bare_log_with_driven_dipoles_fails(dipoles, tmp_path):
    report = check(dipoles(DRIVEN).write(tmp_path / "bus.log"), None)
    assert report.exit_code == 1


def test_dipoles_of_zero_are_no_fault_of_a_pulsed_driver(dipoles):
    assert audit(dipoles().entries(), AuditLimits()).exit_code == 0


def test_a_continuous_driver_has_a_verdict_of_its_own(dipoles, tmp_path):
    (tmp_path / "scenario.toml").write_text('[coils]\ndriver = "continuous"\n')
    dipoles(DRIVEN).write(tmp_path / "bus.log")
    report = check(tmp_path, None)
    assert report.exit_code == 0
    text = render(report)
    assert "one coil at a time" not in text
    assert "pulses (coil" not in text
    assert text.splitlines()[:2] == [
        "limits: continuous driver, each coil within +- full scale, driven for 0.8 of a tick; none on pulses",
        "driven in 3 of 10 ticks, duty 24.00 % of 9.000 s (coil 0, 1, 2: 16.00, 8.00, 8.00 %)",
    ]
    assert text.splitlines()[-1] == "OK: continuous driver within full scale"


def test_duty_of_a_continuous_driver_is_the_part_of_the_time_driven(dipoles):
    report = audit(dipoles(DRIVEN).entries(), CONTINUOUS)
    assert report.duty_per_coil == pytest.approx([0.16, 0.08, 0.08])
    assert report.duty_total == pytest.approx(0.24)
    values = as_json(report)
    assert (values["limits"]["driver"], values["statuses"], values["dipole_statuses"]) == (
        "continuous",
        10,
        10,
    )
    assert values["duty"]["total"] == report.duty_total


def test_a_continuous_driver_that_reports_a_level_is_named(dipoles):
    log = dipoles(DRIVEN)
    for tick in (5, 6):
        log.change(tick, level=2, coil=1)
    report = audit(log.entries(), CONTINUOUS)
    assert (ViolationKind.DRIVER, 5) in found(report)
    assert "a continuous driver reports level 2 of coil 1" in str(report)


def test_a_continuous_driver_that_reports_no_dipole_is_not_judged(bus_log):
    report = audit(bus_log(ticks=10).entries(), CONTINUOUS)
    assert (report.ok, report.missing) == (False, "COIL_DIPOLE_STATUS")
    assert report.duty_total == 0.0
    assert "no COIL_DIPOLE_STATUS in the log: nothing to judge" in report.notes
    assert render(report).splitlines()[-1] == "FAIL: nothing to judge"


def test_missing_dipoles_are_noted(dipoles):
    log = dipoles(DRIVEN)
    log.statuses[5].pop()
    notes = audit(log.entries(), CONTINUOUS).notes
    assert "9 COIL_DIPOLE_STATUS to 10 COIL_STATUS: one of each a tick is due" in notes


@pytest.mark.parametrize(("limits", "kinds"), [(CONTINUOUS, [ViolationKind.FRAME]), (AuditLimits(), [])])
def test_a_broken_dipole_counts_where_the_driver_sends_them(dipoles, limits, kinds):
    log = dipoles()
    log.statuses[5][1] = Frame(CoilDipoleStatus.ID, bytes(8))
    report = audit(log.entries(), limits)
    assert [one.kind for one in report.violations] == kinds
    assert "1 COIL_DIPOLE_STATUS with a wrong CRC or length" in report.notes


def test_the_rules_of_pulses_are_skipped_for_a_continuous_driver(dipoles):
    cases = {case.name: case.skipped for case in suites(audit(dipoles().entries(), CONTINUOUS))["limits"]}
    assert cases["two_coils"] == "no limit of a continuous driver"
    assert cases["driver"] == ""


@pytest.mark.parametrize(
    ("coils", "on_fraction"),
    [
        ({}, None),
        ({"driver": "pulsed", "on_fraction": 0.5}, None),
        ({"driver": "continuous"}, 0.8),
        ({"driver": "continuous", "on_fraction": 1}, 1.0),
    ],
)
def test_the_driver_is_that_of_the_scenario(coils, on_fraction):
    assert limits_in({"coils": coils}, "x.toml").on_fraction == on_fraction


@pytest.mark.parametrize(
    ("coils", "reason"),
    [
        ({"driver": "other"}, "x.toml: coils.driver is 'other', not 'pulsed' or 'continuous'"),
        ({"driver": "continuous", "on_fraction": 0}, "x.toml: coils.on_fraction is 0, not a part of a tick"),
        ({"driver": "continuous", "on_fraction": "1"}, "coils.on_fraction is '1'"),
    ],
)
def test_a_driver_that_makes_no_sense_is_refused(coils, reason):
    with pytest.raises(HarnessError, match=reason):
        limits_in({"coils": coils}, "x.toml")
