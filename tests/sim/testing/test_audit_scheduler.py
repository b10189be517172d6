"""The bench for a user's schedulers: good ones pass, and each planted fault is found and named."""

import os
import subprocess
import sys
from math import nan

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from fsw.core.laws.interface import Demand
from fsw.core.laws.table import LAWS
from fsw.wire.messages import CoilStatus, Sync, intact
from sim.audit.auditor import audit
from sim.audit.findings import AuditLimits, ViolationKind
from sim.testing import (
    Fire,
    Flight,
    Limits,
    Reboot,
    ShippedScheduler,
    Stretch,
    UnsoundLawError,
    audit_law,
    audit_scheduler,
    dipoles,
    fields,
    flights,
    fly,
    limits,
)

FLIGHTS = int(os.environ.get("TORQUER_SCHEDULER_FLIGHTS", "20"))
"""``make planted`` takes more."""
SOME = settings(max_examples=FLIGHTS, deadline=None, suppress_health_check=list(HealthCheck))
FOUND = settings(
    max_examples=5000,
    deadline=None,
    derandomize=True,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
    report_multiple_bugs=False,
)
FLOWN = limits(st.sampled_from((1, 2)), st.just((3000, 100_000)), st.just(True))
SHORT = limits(st.just(1), st.just((3000, 10_000)), st.just(True))
"""For a fault that few flights show: the same timing, flown in a tenth of the ticks."""
STRONG, FIELD = (0.0, 40.0, 0.0), (3e-5, 0.0, 0.0)


class Good:
    """Waits for its own timers and for the board's word; the faults below are planted in it."""

    gap_s, pulse_more_ticks, boot_wait, coils, level = 0, 0, True, 1, 3
    hears_board_boot = hears_word = hears_lockout = True

    def __init__(self, limits):
        self.limits = limits
        self.pulse = limits.pulse_ms * limits.tick_hz // 1000
        self.backoff = -(-limits.backoff_ms * limits.tick_hz // 1000) + self.gap_s * limits.tick_hz
        self.ready = None

    def step(self, heard):
        if self.ready is None or (heard.booted and self.hears_board_boot):
            self.ready = heard.tick + (self.backoff if self.boot_wait else 0)
        size, coil = max((abs(m), axis) for axis, m in enumerate(heard.m_body_am2))
        if size == 0.0 or heard.tick < self.ready:
            return []
        if self.hears_word and (heard.status is None or heard.status.coil != coil):
            return []
        if self.hears_word and self.hears_lockout and heard.status.lockout_ms:
            return []
        pulse = self.pulse + self.pulse_more_ticks
        self.ready = heard.tick + pulse + self.backoff
        duration_ms = pulse * 1000 // self.limits.tick_hz
        return [Fire((coil + more) % 3, self.level, duration_ms) for more in range(self.coils)]


def planted(**fault):
    return type("Planted", (Good,), fault)


WITHOUT_WORD = {"hears_word": False}
FAULTS = {
    "a gap of 99 s": (planted(gap_s=-1, **WITHOUT_WORD), {ViolationKind.GAP, ViolationKind.BOOT}),
    "a gap of nothing": (planted(gap_s=-100, **WITHOUT_WORD), {ViolationKind.GAP, ViolationKind.BOOT}),
    "a pulse a tick long": (planted(pulse_more_ticks=1), {ViolationKind.PULSE, ViolationKind.ANNOUNCED}),
    "two coils": (planted(coils=2), {ViolationKind.TWO_COILS}),
    "three coils": (planted(coils=3), {ViolationKind.TWO_COILS}),
    "fires after its own reboot": (
        planted(boot_wait=False, **WITHOUT_WORD),
        {ViolationKind.GAP, ViolationKind.PULSE, ViolationKind.BOOT},
    ),
    "its own reboot in a pulse": (planted(hears_lockout=False), {ViolationKind.GAP}),
    "fires after the board's reboot": (planted(hears_board_boot=False, **WITHOUT_WORD), {ViolationKind.BOOT}),
    "level 4": (planted(level=4), {ViolationKind.LEVEL}),
    "level -4": (planted(level=-4), {ViolationKind.LEVEL}),
}
RARE = ("its own reboot in a pulse",)


@pytest.mark.long
@SOME
@given(flights())
@pytest.mark.slow
def test_one_without_a_fault_passes(flight):
    assert audit_scheduler(Good, flight).ok


@pytest.mark.long
@pytest.mark.parametrize(
    ("scheduler", "kinds", "within"),
    [(*fault, SHORT if name in RARE else FLOWN) for name, fault in FAULTS.items()],
    ids=FAULTS,
)
def test_each_planted_fault_is_found(scheduler, kinds, within):
    """By flights as they are drawn for such limits."""

    @FOUND
    @given(flights(within))
    def keeps_the_limits(flight):
        report = audit_scheduler(scheduler, flight)
        assert {violation.kind for violation in report.violations} <= kinds | {
            ViolationKind.GAP,
            ViolationKind.BOOT,
        }
        assert not kinds & {violation.kind for violation in report.violations}, "found"

    with pytest.raises(AssertionError, match="found"):
        keeps_the_limits()


class Asks:
    """Makes the same requests once, in tick 110."""

    def __init__(self, *requests):
        self.requests = requests

    def __call__(self, limits):
        return self

    def step(self, heard):
        return self.requests if heard.tick == 110 else ()


@pytest.mark.parametrize(
    ("requests", "kind"),
    [
        ([Fire(1, 0, 3000)], ViolationKind.LEVEL),
        ([Fire(1, 16, 3000)], ViolationKind.LEVEL),
        ([Fire(1, -9, 3000)], ViolationKind.LEVEL),
        ([Fire(1, 3, 0)], ViolationKind.PULSE),
        ([Fire(1, 3, -1)], ViolationKind.PULSE),
        ([Fire(1, 3, 65_536)], ViolationKind.PULSE),
        ([Fire(-1, 3, 3000)], ViolationKind.COIL),
        ([Fire(4, 3, 3000)], ViolationKind.COIL),
        ([Fire(1, 3, 3000), Fire(1, 3, 3000)], ViolationKind.GAP),
    ],
)
@pytest.mark.parametrize("lost_requests", [0, 0xFF])
def test_a_request_that_no_board_could_drive_is_a_violation(requests, kind, lost_requests):
    flight = Flight(Limits(), 0, (Stretch(120, STRONG, FIELD, lost_requests=lost_requests),))
    violations = audit_scheduler(Asks(*requests), flight).violations
    assert (kind, 110) in {(violation.kind, violation.tick) for violation in violations}


def test_a_proper_request_is_no_violation():
    flight = Flight(Limits(), 0, (Stretch(120, STRONG, FIELD),))
    assert audit_scheduler(Asks(Fire(1, 3, 3000)), flight).ok


def test_nothing_at_all_for_a_coil_that_there_is_not():
    flight = Flight(Limits(), 0, (Stretch(120, STRONG, FIELD),))

    class Fourth:
        def __init__(self, limits):
            pass

        def step(self, heard):
            return [Fire(3, 1, 3000)] if heard.tick == 110 else []

    assert ViolationKind.COIL in {violation.kind for violation in audit_scheduler(Fourth, flight).violations}


# --- the scheduler that ships


@pytest.mark.long
@SOME
@given(flights())
@pytest.mark.slow
def test_the_shipped_scheduler_keeps_the_limits_over_a_board_without_an_interlock(flight):
    report = audit_scheduler(ShippedScheduler, flight)
    assert report.ok, report.violations


@pytest.mark.parametrize("tick_hz", [1, 4, 10])
def test_and_it_does_fire(tick_hz):
    flight = Flight(Limits(tick_hz), 17, (Stretch(340 * tick_hz, STRONG, FIELD),))
    report = audit_scheduler(ShippedScheduler, flight)
    assert [float(pulse.length_s) for pulse in report.pulses] == [3.0] * 3
    assert report.min_gap_any_s >= 100.0


def test_a_reboot_in_a_pulse_costs_a_back_off_from_its_end():
    stretches = (
        Stretch(102, STRONG, FIELD),
        Stretch(210, STRONG, FIELD, reboot=Reboot.SCHEDULER),
    )
    report = audit_scheduler(ShippedScheduler, Flight(Limits(), 0, stretches))
    first, second = report.pulses[:2]
    assert first.start_s < 102 < second.start_s
    assert second.start_s - first.end_s >= 100


@pytest.mark.long
@SOME
@given(flights(), st.sampled_from(["pd", "bdot", "rate_damping", "predictive"]))
@pytest.mark.slow
def test_laws_that_ship_keep_the_limits(flight, name):
    assert audit_law(LAWS[name].point, flight).ok


@pytest.mark.long
@SOME
@given(flights(), dipoles(), fields())
@pytest.mark.slow
def test_so_does_any_law_of_numbers(flight, wish, b):
    def law(seen, memory, setpoint, config):
        return Demand(wish, impulse_body_nms=b if seen.tick % 2 else None, memory=(1.0, *memory)[:3])

    assert audit_law(law, flight).ok


def test_a_law_that_asks_for_what_is_no_number_is_named():
    def law(seen, memory, setpoint, config):
        return Demand((0.0, nan if seen.tick == 5 else 1.0, 0.0))

    with pytest.raises(UnsoundLawError, match="tick 5: "):
        audit_law(law, Flight(Limits(), 0, (Stretch(10, STRONG, FIELD),)))


# --- what a scheduler hears


class Listener:
    """Keeps what it has heard."""

    boots = 0

    def __init__(self, limits):
        self.heard = []
        Listener.boots += 1
        Listener.last = self

    def step(self, heard):
        self.heard.append(heard)
        return [Fire(0, 1, 1000)] if heard.tick in (3, 4) else []


class Long:
    """Asks for more than a status can tell."""

    def __init__(self):
        Long.heard = []

    def step(self, heard):
        Long.heard.append(heard.status)
        return [Fire(0, 1, 6000)] if heard.tick == 3 else []


def listen_to(flight):
    list(fly(Listener, flight))
    return Listener.last.heard


def listen(*stretches, first_tick=0, **limits):
    Listener.boots = 0
    entries = list(fly(Listener, Flight(Limits(**limits), first_tick, stretches)))
    assert all(intact(entry.frame) or entry.frame.can_id == Sync.ID for entry in entries)
    return Listener.last.heard


def test_ticks_rise_by_one_and_statuses_tell_of_each_coil_in_turn():
    heard = listen(Stretch(3, STRONG, FIELD), Stretch(3, STRONG, FIELD), first_tick=300)
    assert [one.tick for one in heard] == list(range(300, 306))
    assert [one.status.coil for one in heard] == [0, 1, 2] * 2
    assert [one.status.lockout_ms for one in heard] == [1000 * s for s in range(100, 94, -1)]


def test_the_stretches_are_flown_lap_after_lap():
    stretches = (Stretch(3, STRONG, FIELD), Stretch(2, FIELD, FIELD))
    heard = list(listen_to(Flight(Limits(), 7, stretches, laps=3)))
    assert [one.tick for one in heard] == list(range(7, 22))
    assert [one.m_body_am2 for one in heard] == ([STRONG] * 3 + [FIELD] * 2) * 3


def test_what_is_heard_is_what_stands_in_the_log():
    """Rest and lockout are too long for their fields, and a tick is no whole number of ms."""
    flight = Flight(Limits(7, 3000, 700_000), 0, (Stretch(60, STRONG, FIELD),))
    entries = list(fly(lambda limits: Long(), flight))
    logged = [CoilStatus.decode(one.frame.data) for one in entries if one.frame.can_id == CoilStatus.ID]
    assert Long.heard == logged
    assert {4095} < {status.remaining_ms for status in logged}
    assert max(status.lockout_ms for status in logged) == 163_830


def test_a_violation_names_its_line_of_the_log():
    flight = Flight(Limits(), 0, (Stretch(400, STRONG, FIELD),))
    scheduler = planted(level=4)
    log = list(fly(scheduler, flight))
    assert [entry.line for entry in log] == list(range(1, len(log) + 1))
    for violation in audit_scheduler(scheduler, flight).violations:
        frame = log[violation.line - 1].frame
        assert (frame.can_id, CoilStatus.decode(frame.data).level) == (CoilStatus.ID, 4)


@pytest.mark.long
@pytest.mark.parametrize(
    "scheduler",
    [Good, planted(hears_lockout=False), planted(hears_board_boot=False, **WITHOUT_WORD), planted(coils=2)],
    ids=["without a fault", "its own reboot", "the board's reboot", "two coils"],
)
@pytest.mark.slow
def test_the_first_violation_is_that_of_the_whole_log(scheduler):
    """Though a flight that is judged is cut short, and its quiet ticks are left out."""

    @settings(SOME, max_examples=10)
    @given(flights())
    def the_same(flight):
        limits = flight.limits
        bounds = AuditLimits(
            1000 * limits.pulse_ms, 1000 * limits.backoff_ms, shared=limits.shared, tick_hz=limits.tick_hz
        )
        whole = audit(fly(scheduler, flight), bounds).violations[:1]
        assert audit_scheduler(scheduler, flight).violations[:1] == whole

    the_same()


def test_a_flight_ends_soon_after_a_limit_was_broken():
    """What comes after it would say nothing new, and would be flown at every step of shrinking."""
    flight = Flight(Limits(), 0, (Stretch(10_000, STRONG, FIELD),))
    report = audit_scheduler(planted(pulse_more_ticks=1), flight)
    assert not report.ok
    assert report.statuses < 150


def test_a_message_is_lost_in_the_ticks_whose_bit_is_set():
    heard = listen(Stretch(20, STRONG, FIELD, lost_statuses=0b0000_0110))
    assert [one.tick for one in heard if one.status is None] == [1, 2, 9, 10, 17, 18]


def test_a_request_that_is_lost_drives_nothing():
    """Requested in ticks 3 and 4, the first is lost."""
    heard = listen(Stretch(8, STRONG, FIELD, lost_requests=0b0000_1000))
    assert [one.tick for one in heard if one.status.level] == [5]


@pytest.mark.parametrize(
    ("reboot", "boots", "told"),
    [
        (Reboot.NOBODY, 1, [0]),
        (Reboot.SCHEDULER, 2, []),
        (Reboot.BOARD, 1, [0, 5]),
        (Reboot.SCHEDULER | Reboot.BOARD, 2, [5]),
    ],
)
def test_who_is_started_anew(reboot, boots, told):
    heard = listen(Stretch(5, STRONG, FIELD), Stretch(5, STRONG, FIELD, reboot=reboot))
    assert Listener.boots == boots
    assert [one.tick for one in heard if one.booted] == told


def test_a_board_that_is_started_anew_is_off_and_locked_out_in_full():
    heard = listen(Stretch(5, STRONG, FIELD), Stretch(3, STRONG, FIELD, reboot=Reboot.BOARD))
    assert heard[4].status.level == 1
    assert (heard[5].status.level, heard[5].status.lockout_ms) == (0, 100_000)


# --- as a public module


def test_all_names_are_there_and_documented():
    import sim.testing

    assert len(set(sim.testing.__all__)) == len(sim.testing.__all__) > 20
    for name in sim.testing.__all__:
        if name != "MakeScheduler":  # a type
            assert getattr(sim.testing, name).__doc__, name


@pytest.mark.long
def test_no_other_part_needs_hypothesis():
    code = (
        "import sys; sys.modules['hypothesis'] = None\n"
        "import torquer.cli.main, sim.report.conclude, sim.flight.record_flight, fsw.node, hil_stub.bench\n"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
