"""Whether a log holds its whole flight: an end mark that fits, and a log that is cut."""

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantEnd
from sim.audit.auditor import AuditLimits, ViolationKind, audit
from sim.record.candump import read_log


def test_a_log_that_is_cut_is_judged_as_far_as_it_goes_and_is_not_complete(bus_log, fired, tmp_path):
    text = bus_log(1, 200, [fired(0, 110, 3100)]).text()
    path = tmp_path / "bus.log"
    path.write_text(text[: text.index(")", len(text) // 4 * 3)])
    line = path.read_text().count("\n") + 1
    report = audit(read_log(path), AuditLimits())
    assert [(one.kind, one.tick, one.coil) for one in report.violations] == [(ViolationKind.PULSE, 110, 0)]
    assert (report.truncated_at, report.complete) == (line, False)
    assert f"truncated: line {line} is incomplete; the lines before it are judged" in report.notes


@pytest.mark.parametrize(
    ("end", "wrong_end"),
    [
        (PlantEnd(50).encode(), None),
        (PlantEnd(9999).encode(), "its PLANT_END counts 9999 ticks, its last SYNC is of tick 49"),
        (PlantEnd(49).encode(), "its PLANT_END counts 49 ticks, its last SYNC is of tick 49"),
        (Frame(PlantEnd.ID, b"\0\1\2\3\4"), "its last frame is a PLANT_END with a wrong CRC or length"),
    ],
    ids=["fits", "of another run", "one too few", "broken"],
)
def test_only_an_end_mark_that_fits_makes_a_log_complete(bus_log, end, wrong_end):
    entries = bus_log(1, 50).entries()
    entries.append(entries[-1]._replace(line=len(entries) + 1, frame=end))
    report = audit(entries, AuditLimits(), expect_end=True)
    assert report.complete is (wrong_end is None)
    assert report.notes == (() if wrong_end is None else (f"the log has no end mark: {wrong_end}",))


def test_an_end_mark_in_the_middle_is_none(bus_log):
    entries = bus_log(1, 50).entries()
    entries.insert(60, entries[60]._replace(frame=PlantEnd(20).encode()))
    assert not audit(entries, AuditLimits(), expect_end=True).complete


def test_a_log_is_complete_without_an_end_mark_unless_one_is_expected(bus_log):
    entries = bus_log(ticks=20).entries()
    assert audit(entries, AuditLimits()).complete
    assert not audit(entries, AuditLimits(), expect_end=True).complete
