"""Pulses kept in few bytes are the pulses that were added."""

import sys
from fractions import Fraction

import pytest

from sim.audit.findings import DrivenPulse
from sim.audit.pulse_judge import PulseTable

THIRD = Fraction(1, 3_000_000)
MONTH = 30 * 86400 * 3_000_000


@pytest.fixture
def table():
    """Three pulses, counted in thirds of a microsecond."""
    pulses = PulseTable(THIRD)
    for coil, level, start in ((2, -8, MONTH), (0, 7, 3_000_001), (1, 1, -5)):
        pulses.add(coil, level, start, start + 9_000_001)
    return pulses


def test_edges_are_exact(table):
    assert table[0] == DrivenPulse(2, -8, Fraction(MONTH, 3_000_000), Fraction(MONTH + 9_000_001, 3_000_000))
    assert table[1].length_s == Fraction(9_000_001, 3_000_000)


def test_it_is_a_sequence(table):
    assert [pulse.coil for pulse in table] == [2, 0, 1]
    assert table[-1].level == 1
    assert table[:2] == tuple(table)[:2]
    assert table == tuple(table)
    assert table != tuple(table)[:2]
    with pytest.raises(IndexError):
        table[3]


def test_by_start_they_are_in_order_and_the_table_stays_as_it_was(table):
    assert [pulse.coil for pulse in table.by_start()] == [1, 0, 2]
    assert [pulse.coil for pulse in table] == [2, 0, 1]


def test_no_pulses_are_an_empty_table():
    assert PulseTable(THIRD) == ()
    assert not PulseTable(THIRD).by_start()


def test_a_pulse_takes_few_bytes(table):
    for number in range(10_000):
        table.add(0, 1, number, number + 1)
    kept = (table._coils, table._levels, table._starts, table._ends)
    assert sum(map(sys.getsizeof, kept)) < 25 * 10_000
