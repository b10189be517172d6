from dataclasses import replace

import pytest

from fsw.core import telemetry
from fsw.wire.messages import CLASSES, CoilBoot
from hil_stub import node
from sim.audit.auditor import AuditLimits, ViolationKind, audit
from sim.audit.check import CONTRACT_VERSION, check, limits_beside, render
from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.binding import bind
from sim.record.candump import LogError, read_log
from sim.record.log_index import LogIndex
from sim.record.pace import Pace
from sim.scenario.schema import load, parse_settings


@pytest.fixture
def run(tmp_path):
    """A run directory that holds a log and, unless it is None, a scenario."""

    def make(log, scenario: str | None = ""):
        log.write(tmp_path / "bus.log")
        if scenario is not None:
            (tmp_path / "scenario.toml").write_text(scenario)
        return tmp_path

    return make


# --- what is checked, and by which limits


def test_a_run_directory_is_checked_by_its_log(run, bus_log, fired):
    folder = run(bus_log(1, 400, [fired(0, 100), fired(1, 203)], boots=[0]))
    report = check(folder, None)
    assert report == check(folder / "bus.log", None)
    assert len(report.pulses) == 2
    assert report.exit_code == 0


def test_a_log_under_any_name_is_checked_by_the_scenario_beside_it(tmp_path, bus_log, fired):
    log = bus_log(1, 200, [fired(0, 100), fired(1, 110)]).write(tmp_path / "recorded.log")
    (tmp_path / "scenario.toml").write_text('[coils]\nbackoff = "per_coil"\n')
    assert check(log, None).ok


def test_without_a_scenario_the_back_off_is_shared(run, bus_log, fired):
    folder = run(bus_log(1, 200, [fired(0, 100), fired(1, 110)]), scenario=None)
    assert check(folder, None).limits == AuditLimits()
    assert not check(folder, None).ok
    assert not check(folder, "shared").ok
    assert check(folder, "per_coil").ok


def test_an_explicit_back_off_overrules_the_scenario(run, bus_log, fired):
    folder = run(bus_log(1, 200, [fired(0, 100), fired(1, 110)]), '[coils]\nbackoff = "per_coil"\n')
    assert check(folder, None).ok
    assert not check(folder, "shared").ok


def test_limits_come_from_the_scenario_and_other_keys_do_not_matter(tmp_path):
    scenario = """
        name = "other"
        [time]
        tick_hz = 10
        epoch_utc = 2015-03-28T03:30:17Z
        [coils]
        levels_am2 = [0.5, 2.0, 8.0]
        pulse_s = 2.5
        backoff_s = 50
        backoff = "per_coil"
        [body]
        inertia_kgm2 = [1.0, 2.0, 3.0]
    """
    (tmp_path / "scenario.toml").write_text(scenario)
    limits = AuditLimits(2_500_000, 50_000_000, 3, shared=False, tick_hz=10)
    assert limits_beside(tmp_path / "bus.log") == limits


def test_an_empty_scenario_means_the_usual_limits(tmp_path):
    (tmp_path / "scenario.toml").write_text("")
    assert limits_beside(tmp_path / "bus.log") == AuditLimits()


def test_no_scenario_means_no_limits(tmp_path):
    assert limits_beside(tmp_path / "bus.log") is None


@pytest.mark.parametrize(
    ("scenario", "reason"),
    [
        ("coils = 3", "coils is not a table"),
        ("[coils]\nbackoff = 'none'", "coils.backoff is 'none'"),
        ("[coils]\nbackoff = 1", "coils.backoff is 1"),
        ("[coils]\npulse_s = '3'", "coils.pulse_s is '3'"),
        ("[coils]\npulse_s = true", "coils.pulse_s is True"),
        ("[coils]\nbackoff_s = nan", "coils.backoff_s is nan"),
        ("[coils]\nbackoff_s = -1.0", "coils.backoff_s is -1.0"),
        ("[time]\ntick_hz = 0", "time.tick_hz is 0"),
        ("[time]\ntick_hz = 1.5", "time.tick_hz is 1.5"),
        ("[coils", "cannot be read"),
    ],
)
def test_a_scenario_that_makes_no_sense_is_named_in_one_sentence(run, bus_log, scenario, reason):
    folder = run(bus_log(ticks=5), scenario)
    with pytest.raises(HarnessError, match=reason) as refusal:
        check(folder, None)
    assert str(folder / "scenario.toml") in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert refusal.value.exit_code == 2


def test_a_scenario_that_cannot_be_read_is_named(run, bus_log):
    folder = run(bus_log(ticks=5), "#" * 1_000_001)
    with pytest.raises(HarnessError, match=r"scenario\.toml: cannot be read: it is larger than 1 MB"):
        check(folder, None)


@pytest.mark.parametrize(
    ("key", "accepted", "refused"),
    [
        ("coils.pulse_s", (0, 0.0, 0.5, 999_999_999), (-1, -1e-9, 1e9, "nan", "true")),
        ("coils.backoff_s", (0, 0.5, 999_999_999.5), (-1, 1_000_000_000, "inf", '"100"')),
        ("time.tick_hz", (1, 1_000_000), (0, 1_000_001, 1.0, "true")),
    ],
)
def test_the_ends_of_each_range_are_in_it(tmp_path, key, accepted, refused):
    scenario, (table, name) = tmp_path / "scenario.toml", key.split(".")
    for value in accepted:
        scenario.write_text(f"[{table}]\n{name} = {value}\n")
        limits = limits_beside(tmp_path / "bus.log")
        field, unit = {"pulse_s": ("pulse_us", 10**6), "backoff_s": ("backoff_us", 10**6)}.get(
            name, (name, 1)
        )
        assert getattr(limits, field) == value * unit
    for value in refused:
        scenario.write_text(f"[{table}]\n{name} = {value}\n")
        with pytest.raises(HarnessError, match=key):
            limits_beside(tmp_path / "bus.log")


def test_a_back_off_that_is_none_of_the_two_is_refused(run, bus_log):
    with pytest.raises(HarnessError, match="--backoff is 'both'"):
        check(run(bus_log(ticks=5)), "both")


# --- what is no log


def test_a_path_that_is_not_there(tmp_path):
    with pytest.raises(HarnessError, match=r"nothing\.log: no such file"):
        check(tmp_path / "nothing.log", None)


def test_a_directory_without_a_log(tmp_path):
    with pytest.raises(HarnessError, match=r"no bus\.log in it"):
        check(tmp_path, None)


@pytest.mark.parametrize("content", [b"", b"hello\n", b"\x00\xff" * 500])
def test_a_file_that_is_no_log(tmp_path, content):
    (tmp_path / "bus.log").write_bytes(content)
    with pytest.raises(LogError):
        check(tmp_path, None)


def test_a_log_that_was_altered_in_the_middle(run, bus_log):
    folder = run(bus_log(ticks=20))
    lines = (folder / "bus.log").read_text().splitlines(keepends=True)
    lines[30] = "garbage\n"
    (folder / "bus.log").write_text("".join(lines))
    with pytest.raises(LogError, match="line 31 "):
        check(folder, None)


BOOTS = [message for message in CLASSES.values() if message.__name__.endswith("Boot")]


@pytest.mark.parametrize("boot", BOOTS, ids=lambda boot: boot.__name__)
def test_a_log_of_another_bus_contract(run, bus_log, boot):
    log = bus_log(ticks=20)
    values = dict.fromkeys(boot.FIELDS, 0) | {"version": CONTRACT_VERSION + 1}
    log.statuses[7].insert(0, boot(**values).encode())
    with pytest.raises(HarnessError, match="line 22 is of version 2 of the bus contract, and only version 1"):
        check(run(log), None)


@pytest.mark.parametrize("boot", BOOTS, ids=lambda boot: boot.__name__)
def test_a_stray_boot_message_of_another_contract_is_a_note(run, bus_log, boot):
    log = bus_log(ticks=200, boots=[0])
    values = dict.fromkeys(boot.FIELDS, 0) | {"version": 65}
    log.statuses[7].insert(0, boot(**values).encode())
    report = check(run(log), None)
    assert report.ok
    note = "a boot message is of another version of the bus contract, first line 23, of version 65"
    assert note in report.notes
    log.statuses[9].insert(0, boot(**values).encode())
    assert any(note.startswith("2 boot messages are of another") for note in check(run(log), None).notes)


def test_a_coil_driver_of_another_contract_is_refused_whatever_the_others_are(run, bus_log):
    log = bus_log(ticks=20)
    for number, boot in enumerate(BOOTS):
        version = CONTRACT_VERSION + (boot is CoilBoot)
        log.statuses[number].insert(0, boot(**dict.fromkeys(boot.FIELDS, 0) | {"version": version}).encode())
    with pytest.raises(HarnessError, match="is of version 2 of the bus contract, and only version 1"):
        check(run(log), None)


def test_the_contract_that_is_judged_is_that_of_the_nodes():
    assert CONTRACT_VERSION == telemetry.CONTRACT_VERSION == node.CONTRACT_VERSION


@pytest.mark.parametrize("broken", [False, True])
def test_a_log_that_its_index_contradicts(run, bus_log, fired, broken):
    folder = run(bus_log(1, 200, [fired(0, 110)]))
    log = folder / "bus.log"
    index = LogIndex(log)
    index.add(log.read_bytes().replace(b"vcan0", b"vcan1" if broken else b"vcan0"), 600)
    index.close(ended=True)
    report = check(folder, None)
    assert (report.exit_code, report.genuine) == ((1, False) if broken else (0, True))
    last = "FAIL: limits kept as far as the log goes, but its index contradicts it"
    assert (render(report).splitlines()[-1] == last) is broken
    assert ("note: altered: lines 1 to 600 are not what was flown" in render(report)) is broken


@pytest.mark.parametrize(("ended", "exit_code"), [(True, 0), (False, 1)])
def test_a_log_that_its_index_does_not_vouch_for_to_the_end_is_incomplete(run, bus_log, ended, exit_code):
    folder = run(bus_log(ticks=20))
    index = LogIndex(folder / "bus.log")
    index.add((folder / "bus.log").read_bytes(), 61)
    index.close(ended)
    report = check(folder, None)
    assert (report.exit_code, report.complete, report.genuine) == (exit_code, ended, True)
    assert ("has no end mark" in render(report)) is not ended


# --- the run that a log belongs to


@pytest.fixture
def bound(tmp_path, bus_log, fired):
    """A run whose coils back off for 10 s by its scenario, and its log, with digests of both."""
    scenario = load("microsat", parse_settings(("coils.backoff_s=10.0",)))
    run_dir.begin(tmp_path, scenario, 1, 200, "virtual", Pace())
    bus_log(1, 200, [fired(0, 100), fired(1, 120)]).write(tmp_path / "bus.log")
    bind(tmp_path, "bus.log")
    return tmp_path


def test_a_log_with_its_run_is_judged_by_the_scenario_of_that(bound):
    report = check(bound, None)
    assert (report.limits.backoff_us, report.mismatches, report.exit_code) == (10_000_000, (), 0)
    assert check(bound / "bus.log", None) == report


def test_a_scenario_that_is_not_the_runs_widens_no_limit(bound):
    scenario = bound / "scenario.toml"
    scenario.write_text(scenario.read_text().replace("backoff_s = 10.0", "backoff_s = 5.0"))
    report = check(bound, None)
    assert report.limits == AuditLimits()
    assert [violation.kind for violation in report.violations] == [ViolationKind.GAP]
    assert "judged by the usual limits: scenario.toml is not the run's" in report.notes
    (sentence,) = report.mismatches
    assert f"MISMATCH {sentence}" in render(report).splitlines()
    assert report.exit_code == 1


def test_a_log_that_is_not_the_runs_fails_though_it_keeps_the_limits(bound, bus_log, fired):
    bus_log(1, 200, [fired(0, 100), fired(1, 130)]).write(bound / "bus.log")
    report = check(bound, None)
    assert (report.ok, report.complete, report.genuine, report.exit_code) == (True, True, True, 1)
    assert (
        render(report)
        .splitlines()[-1]
        .startswith("FAIL: limits kept as far as the log goes, but the files are not")
    )


def test_an_error_in_a_log_that_is_not_the_runs_names_both(bound):
    with (bound / "bus.log").open("a") as log:
        log.write("nothing\n")
    with pytest.raises(LogError, match=r"is not a candump line.*; bus\.log is not the run's own"):
        check(bound, None)


@pytest.mark.parametrize("name", ["run.json", "scenario.toml"])
def test_another_file_of_the_run_is_no_log_and_no_log_of_another_run(bound, name):
    with pytest.raises(LogError, match="not a candump log") as caught:
        check(bound / name, None)
    assert "the run's own" not in str(caught.value)


# --- where a log ends


def test_a_complete_log_ends_with_its_end_mark(run, bus_log):
    report = check(run(bus_log(ticks=20)), None)
    assert report.complete
    assert report.notes == ("nothing vouches for the log: there is no bus.log.index beside it",)


def test_a_recorded_log_without_end_mark_is_incomplete(run, bus_log):
    report = check(run(bus_log(ticks=20, end=False)), None)
    assert report.ok
    assert not report.complete
    assert report.exit_code == 1
    assert "the log has no end mark" in render(report)


def test_a_foreign_log_without_end_mark_is_only_noted(run, bus_log):
    report = check(run(bus_log(ticks=20, end=False), scenario=None), None)
    assert report.complete
    assert report.exit_code == 0
    assert "note: the log has no end mark" in render(report)


@pytest.mark.long
@pytest.mark.parametrize("scenario", ["", None])
def test_a_log_cut_at_any_byte_is_judged_as_far_as_it_goes(run, bus_log, fired, scenario):
    folder = run(bus_log(1, 3, [fired(0, 1, 1000)]), scenario)
    log = folder / "bus.log"
    content = log.read_bytes()
    whole = audit(read_log(log), AuditLimits())
    for length in range(1, len(content)):
        log.write_bytes(content[:length])
        report = check(folder, None)
        lines = content[:length].count(b"\n")
        cut = not content[:length].endswith(b"\n")
        assert report.truncated_at == (lines + 1 if cut else None)
        assert (f"truncated: line {lines + 1} is incomplete" in render(report)) == cut
        assert report.violations == ()
        assert len(report.pulses) <= len(whole.pulses)
        if cut or scenario is not None:
            assert report.exit_code == 1


def test_violations_before_the_cut_are_found(run, bus_log, fired):
    folder = run(bus_log(1, 200, [fired(0, 110, level=4)]))
    log = folder / "bus.log"
    log.write_bytes(log.read_bytes()[:-30])
    report = check(folder, None)
    assert [one.kind for one in report.violations] == [ViolationKind.LEVEL]
    assert report.truncated_at is not None


# --- what is printed


@pytest.mark.long
def test_a_violation_is_printed_with_time_tick_coil_and_line(run, bus_log, fired):
    report = check(run(bus_log(10, 13_000, [fired(1, 12_340, 3100)])), None)
    expected = "VIOLATION t=1234.000 s (tick 12340) coil 1: pulse of 3.100 s exceeds 3.000 s [line 37024]"
    assert expected in render(report).splitlines()
    assert render(report).splitlines()[-1] == "FAIL: 1 violation of the limits"


def test_a_good_verdict_says_what_was_judged(run, bus_log, fired):
    text = render(check(run(bus_log(1, 401, [fired(0, 100), fired(1, 203)])), None))
    assert text.splitlines() == [
        "limits: pulse <= 3.000 s, back-off >= 100.000 s shared, level -3..3, one coil at a time",
        "2 pulses (coil 0, 1, 2: 1, 1, 0), longest 3.000 s, shortest gap 100.000 s, duty 1.50 % of 400.000 s",
        "note: nothing vouches for the log: there is no bus.log.index beside it",
        "OK: limits kept",
    ]


@pytest.mark.parametrize("starts", [50, 51, 52])
def test_violations_are_printed_up_to_fifty(run, bus_log, fired, starts):
    pulses = [fired(0, start, 1000) for start in range(0, 2 * starts, 2)]
    text = render(check(run(bus_log(1, 120, pulses)), None))
    assert text.count("VIOLATION") == min(50, starts - 1)
    assert ("... and" in text) == (starts == 52)


@pytest.mark.parametrize(
    ("limits", "text"),
    [
        (AuditLimits(), "pulse <= 3.000 s, back-off >= 100.000 s shared,"),
        (
            AuditLimits(2_500_001, 99_900_000, shared=False),
            "pulse <= 2.500001 s, back-off >= 99.900 s per coil,",
        ),
    ],
)
def test_the_limits_are_printed(run, bus_log, limits, text):
    report = replace(check(run(bus_log(ticks=20)), None), limits=limits)
    assert text in render(report)


@pytest.mark.long
def test_thousands_of_violations_are_not_all_printed(run, bus_log, fired):
    report = check(run(bus_log(1, 400, [fired(0, start, 1000) for start in range(0, 400, 2)])), None)
    assert len(report.violations) == 199
    text = render(report)
    assert text.count("VIOLATION") == 50
    assert "... and 149 more" in text
    assert "FAIL: 199 violations of the limits" in text


def test_nothing_to_judge_is_no_good_verdict(run, bus_log):
    log = bus_log(ticks=20)
    log.statuses = {tick: [] for tick in range(20)}
    report = check(run(log), None)
    assert report.exit_code == 1
    assert render(report).splitlines()[-1] == "FAIL: nothing to judge"
