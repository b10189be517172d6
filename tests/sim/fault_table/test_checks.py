"""Which checks a row has."""

import pytest

from sim.fault_rig.record import FaultFlightRecord
from sim.fault_table import checks
from sim.fault_table.row import FaultRow
from sim.fault_table.rows.table import ROWS


@pytest.mark.parametrize("row", [row for row in ROWS if row.slow], ids=lambda row: row.name)
def test_what_a_process_of_its_own_does_not_show_is_not_counted_as_passed(row, bounds):
    outcomes = {outcome.check for outcome in checks.judge(row, FaultFlightRecord(1), bounds)}
    assert outcomes == {"limits", "fires", "nobody invented", "no healthy named", *row.expect}


def test_all_others_are_judged_by_every_check(bounds):
    outcomes = [
        one.check for one in checks.judge(FaultRow("planted", "", "none"), FaultFlightRecord(1), bounds)
    ]
    assert outcomes == list(checks.ALWAYS)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_every_check_of_a_row_is_one(row):
    assert set(checks.checks_of(row)) <= set(checks.CHECKS)
