"""The flight software as a real process that gets signals."""

from contextlib import nullcontext
from random import Random

import pytest

from sim.fault_rig import currents
from sim.fault_rig.process_rig import PATIENCE_TICKS, WITHIN_TICK_S, ProcessRig, Strike, random_strikes
from sim.fault_table import checks
from sim.fault_table.case import prepare
from sim.fault_table.row import CheckVerdict, FaultRow


@pytest.fixture
def strike(bounds):
    """Flies a real process that is struck once, in the second tick of a pulse: the record, judged."""

    def fly(stop):
        scenario, _ = prepare()
        record = ProcessRig(scenario, seed=1, stop=stop).fly([Strike(0, 0.001)])
        for check in (checks.keeps_limits, checks.no_extra_pulse, checks.waits_after_boot):
            holds, said = check(FaultRow("struck", "", "none"), record, bounds)
            assert holds, said
        return record

    return fly


@pytest.mark.long
@pytest.mark.slow
def test_a_pulse_ends_by_itself_when_its_sender_is_killed(strike):
    record = strike(stop=False)
    first, *later = currents.pulses(record.coil_drives, 1)
    assert first.end_s - first.start_s == 3
    boot = record.boots[1]
    assert first.start_s < boot
    assert later[0].start_s >= max(first.end_s + 100, boot + 100)


class RigOfASilentProcess(ProcessRig):
    """Its process boots, answers and never fires."""

    def _bus(self):
        return nullcontext()

    def _await_boot(self):
        pass

    def _tick(self, strike=None):
        self.plant.begin_tick()
        self.plant.end_tick()
        self.record.coil_drives.append(self.plant.coil_drive)


def test_a_process_that_does_not_fire_fails_and_is_flown_no_further(bounds):
    scenario, _ = prepare()
    record = RigOfASilentProcess(scenario, seed=1).fly([Strike(0, 0.001)] * 5)
    assert record.ticks == PATIENCE_TICKS
    outcomes = checks.judge(FaultRow("struck", "", "sigkill"), record, bounds)
    failed = {one.check: one.said for one in outcomes if one.verdict is CheckVerdict.FAIL}
    assert failed["fires"] == "no pulse in 4120 s"


def test_half_of_the_strikes_are_within_the_pulse():
    planned = random_strikes(400, Random(1))
    assert 0.45 < sum(strike.ticks < 3 for strike in planned) / 400 < 0.6
    assert all(0.0 <= strike.delay_s <= WITHIN_TICK_S for strike in planned)
