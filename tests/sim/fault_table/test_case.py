"""One case of the table, on flight software that is of no use."""

from types import SimpleNamespace

import pytest

from sim.fault_rig.record import FaultFlightRecord
from sim.fault_table import case
from sim.fault_table.row import CheckVerdict, FaultRow, When
from sim.plant.coil_drive import OFF


class RigThatNeverFires:
    """Flight software that answers and never requests a pulse; ``crash_tick``: its step raises there."""

    def __init__(self, crash_tick=None):
        self.record, self.plant = FaultFlightRecord(1), SimpleNamespace(tick=0)
        self._crash_tick = crash_tick

    def tick(self):
        record = self.record
        record.coil_drives.append(OFF)
        record.error_deg.append(None)
        record.done.append(True)
        record.lit.append(True)
        record.modes.append(None)
        if self.plant.tick == self._crash_tick:
            record.crash = f"tick {self._crash_tick}: ValueError: planted"
        self.plant.tick += 1

    def inject(self, fault, first, end):
        pytest.fail("there is no tick to count from")

    def finish(self):
        return self.record


@pytest.fixture
def fly(monkeypatch):
    """Flies a case with a rig in place of its own: the failed checks and what they say."""

    def flown(row, rig):
        monkeypatch.setattr(case, "Rig", lambda scenario, config, seed: rig)
        result = case.fly(row, 0, 1)
        return {one.check: one.said for one in result.outcomes if one.verdict is CheckVerdict.FAIL}

    return flown


@pytest.mark.parametrize(
    "expect", [(), ("goes on", "recovers"), ("named", "board names"), ("named or doubted",)]
)
def test_a_flight_software_that_never_fires_fails_where_a_pulse_is_awaited(fly, expect):
    rig = RigThatNeverFires()
    failed = fly(FaultRow("planted", "", "coil_open", expect=expect, unit="coil 0"), rig)
    assert failed["fires"] == "no pulse in 4300 s"
    assert rig.plant.tick == case.PATIENCE_S


@pytest.mark.parametrize("when", [When.PULSE, When.SUNLIT, When.ECLIPSE, When.ORBIT])
def test_a_flight_that_ends_in_an_exception_before_its_fault_is_flown_no_further(fly, when):
    rig = RigThatNeverFires(crash_tick=100)
    failed = fly(FaultRow("planted", "", "none", when=when, expect=("recovers",)), rig)
    assert failed["no exception"] == "tick 100: ValueError: planted"
    assert rig.plant.tick == 101
