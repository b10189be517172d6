"""Any legal train of pulses passes; the same train with any one thing wrong does not."""

from math import ceil

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilStatus
from sim.audit.auditor import AuditLimits, ViolationKind, audit

BACKOFF_S = 7
RATES = [1, 2, 3, 5, 7, 10]
TICKS = st.just(True)


def found(log, shared):
    """Kind, tick and coil of each violation."""
    report = audit(log.entries(), AuditLimits(backoff_us=BACKOFF_S * 1_000_000, shared=shared))
    return [(one.kind, one.tick, one.coil) for one in report.violations]


@st.composite
def trains(draw, bus_log, fired, sync=TICKS):
    """A log of a board that keeps its limits, and whether its back-off is shared."""
    hz = draw(st.sampled_from(RATES))
    shared = draw(st.booleans())
    free = dict.fromkeys(range(3), 0)
    pulses, off = [], 0
    for _ in range(draw(st.integers(1, 5))):
        coil = draw(st.integers(0, 2))
        allowed = max(free.values()) if shared else max(free[coil], off)
        start = allowed + draw(st.integers(0, 3 * hz))
        duration_ms = draw(st.one_of(st.just(3000), st.integers(1, 3000)))
        pulses.append(fired(coil, start, duration_ms, draw(st.sampled_from([-3, -2, -1, 1, 2, 3]))))
        off = start + ceil(duration_ms * hz / 1000)
        free[coil] = off + BACKOFF_S * hz
    return bus_log(hz, off + 5 * hz, pulses, sync=draw(sync)), shared


@pytest.mark.long
def test_legal_trains_pass(bus_log, fired):
    @given(trains(bus_log, fired, sync=st.booleans()))
    def check(train):
        log, shared = train
        assert found(log, shared) == []

    check()


def planted(bus_log, fired):
    """A legal train, and which of its pulses is to be spoiled."""
    return trains(bus_log, fired).flatmap(
        lambda train: st.tuples(st.just(train), st.integers(0, len(train[0].pulses) - 1))
    )


@pytest.mark.long
def test_a_pulse_that_is_too_long_is_found(bus_log, fired):
    @given(planted(bus_log, fired), st.integers(3001, 3500))
    def check(case, duration_ms):
        (log, shared), which = case
        pulse = log.pulses[which]._replace(duration_ms=duration_ms)
        log = bus_log(log.tick_hz, log.ticks, [pulse])
        assert found(log, shared) == [(ViolationKind.PULSE, pulse.start, pulse.coil)]

    check()


@pytest.mark.long
def test_a_pulse_that_is_too_soon_is_found(bus_log, fired):
    @given(planted(bus_log, fired), st.data())
    def check(case, data):
        (log, shared), which = case
        first = log.pulses[which]
        off = first.start + ceil(first.duration_ms * log.tick_hz / 1000)
        start = data.draw(st.integers(off, off + BACKOFF_S * log.tick_hz - 1))
        coil = data.draw(st.integers(0, 2)) if shared else first.coil
        log = bus_log(log.tick_hz, start + 5 * log.tick_hz, [first, fired(coil, start)])
        assert found(log, shared) == [(ViolationKind.GAP, start, coil)]

    check()


@pytest.mark.long
def test_a_pulse_too_soon_after_a_boot_is_found(bus_log, fired):
    @given(planted(bus_log, fired), st.data())
    def check(case, data):
        (log, shared), which = case
        pulse = log.pulses[which]
        log.boots = [max(0, pulse.start - data.draw(st.integers(0, BACKOFF_S * log.tick_hz - 1)))]
        assert (ViolationKind.BOOT, pulse.start, pulse.coil) in found(log, shared)

    check()


@pytest.mark.long
def test_a_bad_level_is_found(bus_log, fired):
    @given(planted(bus_log, fired), st.sampled_from([-8, -7, -6, -5, -4, 4, 5, 6, 7]))
    def check(case, level):
        (log, shared), which = case
        pulse = log.pulses[which]
        log.change(pulse.start + 1, level=level)
        assert found(log, shared) == [(ViolationKind.LEVEL, pulse.start + 1, pulse.coil)]

    check()


@pytest.mark.long
def test_a_second_coil_is_found(bus_log, fired):
    @given(planted(bus_log, fired), st.integers(1, 2), st.integers(0, 1))
    def check(case, offset, position):
        (log, shared), which = case
        pulse = log.pulses[which]
        coil = (pulse.coil + offset) % 3
        log.statuses[pulse.start + 1].insert(position, CoilStatus(1, coil, 0, 0, 0, 200).encode())
        assert (ViolationKind.TWO_COILS, pulse.start) in [one[:2] for one in found(log, shared)]

    check()


@pytest.mark.long
def test_an_announcement_of_too_much_is_found(bus_log, fired):
    @given(planted(bus_log, fired), st.data())
    def check(case, data):
        (log, shared), which = case
        pulse = log.pulses[which]
        announced_ms = data.draw(st.integers(3001, 4095))
        passed_ms = 1000 // log.tick_hz
        log.change(pulse.start + 1, remaining_ms=announced_ms - passed_ms)
        assert (ViolationKind.ANNOUNCED, pulse.start, pulse.coil) in found(log, shared)

    check()


@pytest.mark.long
def test_any_flipped_bit_of_any_status_is_found(bus_log, fired):
    @given(trains(bus_log, fired), st.data())
    def check(train, data):
        log, shared = train
        tick = data.draw(st.integers(0, log.ticks - 1))
        frame = log.statuses[tick][0]
        bit = data.draw(st.integers(0, 8 * CoilStatus.LENGTH - 1))
        spoiled = int.from_bytes(frame.data, "little") ^ 1 << bit
        log.statuses[tick] = [Frame(CoilStatus.ID, spoiled.to_bytes(CoilStatus.LENGTH, "little"))]
        assert (ViolationKind.FRAME, tick, None) in found(log, shared)

    check()


@pytest.mark.long
def test_any_shifted_timestamp_is_found(bus_log, fired):
    @given(trains(bus_log, fired), st.data())
    def check(train, data):
        log, shared = train
        tick = data.draw(st.integers(1, log.ticks - 1))
        exact = tick * 1_000_000 % log.tick_hz == 0
        least = 1 if exact else 2
        shift_us = data.draw(st.one_of(st.integers(least, 10**9), st.integers(-(10**9), -least)))
        log.shifts_us = {tick: shift_us}
        assert (ViolationKind.TIMESTAMP, tick, None) in found(log, shared)

    check()


@pytest.mark.long
def test_missing_statuses_never_make_a_legal_train_illegal(bus_log, fired):
    @settings(max_examples=200)
    @given(trains(bus_log, fired), st.data())
    def check(train, data):
        log, shared = train
        for tick in data.draw(st.sets(st.integers(0, log.ticks - 1), max_size=10)):
            log.statuses[tick] = []
        assert found(log, shared) == []

    check()
