"""The flight software as a real process, struck by signals."""

from random import Random

import pytest

from sim.fault_rig import currents
from sim.fault_rig.processes import WITHIN_TICK_S, ProcessRig, Struck, strikes
from sim.fault_rig.rig import prepared
from sim.fault_table import checks
from sim.fault_table.case import SCENARIO
from sim.fault_table.row import Row


@pytest.fixture
def struck(bounds):
    """Flies a real process that is struck once, in the second tick of a pulse: the record, judged."""

    def fly(stop):
        scenario, _ = prepared(SCENARIO, ())
        record = ProcessRig(scenario, seed=1, stop=stop).fly([Struck(0, 0.001)])
        for check in (checks.limits, checks.no_extra_pulse, checks.boots_locked):
            holds, said = check(Row("struck", "", "none"), record, bounds)
            assert holds, said
        return record

    return fly


def test_a_pulse_ends_by_itself_when_its_sender_is_killed(struck):
    record = struck(stop=False)
    first, *later = currents.pulses(record.coil_drives, 1)
    assert first.end_s - first.start_s == 3
    boot = record.boots[1]
    assert first.start_s < boot
    assert later[0].start_s >= max(first.end_s + 100, boot + 100)


def test_half_of_the_strikes_are_within_the_pulse():
    planned = strikes(400, Random(1))
    assert 0.45 < sum(struck.ticks < 3 for struck in planned) / 400 < 0.6
    assert all(0.0 <= struck.delay_s <= WITHIN_TICK_S for struck in planned)
