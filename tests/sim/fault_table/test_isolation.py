"""Which unit the flight software isolates, by its events."""

from dataclasses import replace
from math import inf

import pytest

from fsw.core.fdir.faults import Sensor, SensorFault
from fsw.core.monitors import Monitor
from fsw.core.telemetry import Event as Number
from hil_stub.coils.events import CoilEventCode
from sim.fault_rig.record import BoardEvent, FaultFlightRecord, ReportedEvent
from sim.fault_table import checks, isolation
from sim.fault_table.row import FaultRow, RowFault
from sim.fault_table.rows.table import ROWS


def record(*events, board=()):
    lit = [True] * 500
    return FaultFlightRecord(1, onset=100, events=list(events), board_events=list(board), lit=lit)


def isolated(tick, sensor):
    return ReportedEvent(tick, Number.SENSOR_ISOLATED, 100 * sensor + SensorFault.REFUSED)


def test_sensors_are_identified_by_isolation_and_boards_by_monitors():
    flown = record(
        isolated(120, Sensor.SUN_SENSOR),
        ReportedEvent(130, Number.MONITOR_TRIPPED, Monitor.FIELD_FRESH),
        ReportedEvent(131, Number.MODE_CHANGED, 0),
    )
    assert isolation.isolations(flown) == [(120, "sun sensor")]
    assert isolation.monitor_trips(flown) == [(130, "magnetometer")]


@pytest.mark.parametrize("identifier", [0x080, 0x088, 0x200, 0x610, 0x7FF])
def test_a_second_sender_is_reported_with_any_identifier(identifier):
    flown = record(ReportedEvent(120, Number.SECOND_SENDER, identifier))
    assert isolation.isolations(flown) == [(120, "second sender")]


def test_the_faulty_unit_must_be_isolated_and_no_other(bounds):
    row = FaultRow("planted", "", "none", unit="magnetometer")
    right, wrong = isolated(130, Sensor.MAGNETOMETER), isolated(125, Sensor.SUN_SENSOR)
    assert checks.isolates_faulty_unit(row, record(right), bounds) == (True, "found after 30 s")
    assert checks.isolates_faulty_unit(row, record(), bounds)[0] is False
    assert checks.isolates_faulty_unit(row, record(wrong), bounds)[0] is False
    assert checks.isolates_faulty_unit(row, record(wrong, right), bounds)[0] is False
    before = isolated(99, Sensor.SUN_SENSOR)
    assert checks.isolates_faulty_unit(row, record(before, right), bounds)[0] is True


def test_a_sensor_that_is_not_named_may_be_doubted_with_the_other_but_a_coil_must_be_named(bounds):
    doubted = ReportedEvent(140, Number.SENSORS_DISAGREE, 0)
    sensor, coil = (FaultRow("planted", "", "none", unit=unit) for unit in ("magnetometer", "coil 1"))
    assert checks.isolates_or_disputes_faulty_unit(sensor, record(doubted), bounds) == (
        True,
        "found after 40 s",
    )
    assert checks.isolates_faulty_unit(sensor, record(doubted), bounds)[0] is False
    assert checks.isolates_or_disputes_faulty_unit(sensor, record(), bounds)[0] is False
    early = ReportedEvent(99, Number.SENSORS_DISAGREE, 0)
    assert checks.isolates_or_disputes_faulty_unit(sensor, record(early), bounds)[0] is False
    wrong = isolated(125, Sensor.SUN_SENSOR)
    assert checks.isolates_or_disputes_faulty_unit(sensor, record(wrong, doubted), bounds)[0] is False
    pulsed = record(doubted)
    pulsed.request_ticks, pulsed.request_coils = list(range(101, 110)), [1] * 9
    assert checks.isolates_or_disputes_faulty_unit(coil, pulsed, bounds)[0] is False


@pytest.mark.parametrize(
    ("lit", "valid", "lasts_s", "accepted"),
    [
        (False, False, 60.0, True),
        (True, False, 60.0, False),
        (False, True, 60.0, False),
        (False, False, inf, False),
    ],
    ids=["given up in the shadow", "in sunlight", "held to be valid", "one that lasts"],
)
@pytest.mark.parametrize(
    "later", [(), (ReportedEvent(400, Number.SENSORS_DISAGREE, 0),)], ids=["", "found later"]
)
def test_the_only_sensor_that_is_left_need_not_be_named_if_its_attitude_is_given_up(
    bounds, lit, valid, lasts_s, accepted, later
):
    row = FaultRow("planted", "", "none", unit="magnetometer", lasts_s=lasts_s, within_s=200.0)
    flown = record(*later)
    flown.lit = [lit] * 500
    flown.error_deg = [0.3] * 120 + [0.3 if valid else None] * 380
    assert checks.isolates_or_disputes_faulty_unit(row, flown, bounds)[0] is accepted
    assert checks.isolates_faulty_unit(row, flown, bounds)[0] is False, "where it must be named"


def test_a_disturbed_sensor_may_be_isolated_but_no_other(bounds):
    row = FaultRow("planted", "", "none", unit="sun sensor")
    right, wrong = isolated(130, Sensor.SUN_SENSOR), isolated(135, Sensor.MAGNETOMETER)
    assert checks.isolates_no_healthy_unit(row, record(), bounds)[0]
    assert checks.isolates_no_healthy_unit(row, record(right), bounds)[0]
    assert checks.isolates_no_healthy_unit(row, record(right, wrong), bounds) == (
        False,
        "magnetometer isolated in tick 135",
    )


def test_a_unit_is_healthy_before_its_fault(bounds):
    row = FaultRow("planted", "", "none", unit="sun sensor")
    early = isolated(99, Sensor.SUN_SENSOR)
    assert checks.isolates_no_healthy_unit(row, record(early), bounds) == (
        False,
        "sun sensor isolated in tick 99",
    )


class TestTwoFaults:
    """A magnetometer that is faulty from tick 100 on, and a Sun sensor from tick 400 on."""

    ROW = FaultRow(
        "planted",
        "",
        "none",
        unit="magnetometer",
        within_s=50.0,
        then=(RowFault("none", {}, 1.0, "sun sensor", 300.0),),
    )

    def test_each_unit_must_be_isolated_in_time_from_the_onset_of_its_own_fault(self, bounds):
        flown = record(isolated(120, Sensor.MAGNETOMETER), isolated(450, Sensor.SUN_SENSOR))
        assert checks.isolates_faulty_unit(self.ROW, flown, bounds) == (True, "found after 20 s, 50 s")
        assert checks.isolates_no_healthy_unit(self.ROW, flown, bounds)[0]

    def test_one_of_the_two_is_not_enough(self, bounds):
        flown = record(isolated(120, Sensor.MAGNETOMETER))
        assert checks.isolates_faulty_unit(self.ROW, flown, bounds) == (False, "sun sensor is not isolated")

    def test_late_is_a_failure(self, bounds):
        flown = record(isolated(120, Sensor.MAGNETOMETER), isolated(451, Sensor.SUN_SENSOR))
        assert checks.isolates_faulty_unit(self.ROW, flown, bounds) == (
            False,
            "sun sensor found after 51 s, later than 50 s",
        )

    def test_the_second_unit_is_healthy_until_its_own_fault(self, bounds):
        flown = record(isolated(120, Sensor.MAGNETOMETER), isolated(399, Sensor.SUN_SENSOR))
        assert not checks.isolates_no_healthy_unit(self.ROW, flown, bounds)[0]


def test_a_report_of_a_second_sender_that_is_none_fails(bounds):
    flown = record(ReportedEvent(120, Number.SECOND_SENDER, 0x080))
    assert not checks.invents_no_second_sender(FaultRow("planted", "", "none"), flown, bounds)[0]
    assert checks.invents_no_second_sender(FaultRow("planted", "", "second_sender"), flown, bounds)[0]
    assert checks.invents_no_second_sender(FaultRow("planted", "", "none"), record(), bounds)[0]


def test_no_pulse_is_requested_beside_a_second_sender_and_one_is_afterwards(bounds):
    row = FaultRow("planted", "", "second_sender", unit="second sender")
    flown = record(ReportedEvent(120, Number.SECOND_SENDER, 0x080))
    flown.end = 200
    for asked, holds in (([90, 119, 200], True), ([119], False), ([120, 300], False), ([199, 300], False)):
        flown.request_ticks = asked
        assert checks.stops_requests(row, flown, bounds)[0] is holds


def test_a_unit_that_fsw_cannot_isolate_is_no_failure(bounds):
    row = FaultRow("planted", "", "none", unit="the cat")
    assert checks.isolates_faulty_unit(row, record(), bounds)[0] is None


def test_any_isolation_is_a_false_alarm_without_a_fault(bounds):
    row = FaultRow("planted", "", "none")
    assert checks.isolates_nothing(row, record(), bounds)[0]
    assert not checks.isolates_nothing(row, record(isolated(120, Sensor.SUN_SENSOR)), bounds)[0]
    assert not checks.isolates_nothing(
        row, record(ReportedEvent(9, Number.MONITOR_TRIPPED, Monitor.RATE_BOUNDED)), bounds
    )[0]


def test_the_board_identifies_the_coil_that_is_on(bounds):
    row = FaultRow("planted", "", "none", unit="coil 2")
    cut = BoardEvent(101, CoilEventCode.NO_CURRENT, 2)
    other = BoardEvent(101, CoilEventCode.NO_CURRENT, 0)
    assert checks.board_identifies_unit(row, record(board=[cut]), bounds)[0]
    assert not checks.board_identifies_unit(row, record(board=[other, cut]), bounds)[0]
    assert not checks.board_identifies_unit(row, record(), bounds)[0]
    stuck = FaultRow("planted", "", "none", unit="coil 2", expect=("stuck",))
    shorted = BoardEvent(101, CoilEventCode.CURRENT_WHILE_OFF, None)
    beside = BoardEvent(101, CoilEventCode.CURRENT_WRONG, 0)
    assert checks.board_identifies_unit(stuck, record(board=[shorted]), bounds)[0]
    assert checks.board_identifies_unit(stuck, record(board=[beside, shorted]), bounds)[0]
    assert checks.board_identifies_unit(stuck, record(board=[other, shorted]), bounds)[0], "they cancel"
    later = [
        BoardEvent(104, CoilEventCode.NO_CURRENT, 0),
        BoardEvent(105, CoilEventCode.CURRENT_WHILE_OFF, None),
    ]
    assert not checks.board_identifies_unit(stuck, record(board=later), bounds)[0]


@pytest.mark.parametrize(("valid_before", "holds"), [(1, False), (0, None)])
def test_a_coil_that_conducts_by_itself_must_be_isolated_without_any_pulse_of_its_own(
    bounds, valid_before, holds
):
    """Unless no attitude was valid before: what it does to one that comes later shows nothing."""
    row = FaultRow("planted", "", "none", unit="coil 2", expect=("named", "stuck"))
    flown = record()
    flown.error_deg = [None] * (100 - valid_before) + [0.3] * (400 + valid_before)
    assert checks.isolates_faulty_unit(row, flown, bounds)[0] is holds


@pytest.mark.parametrize(("pulses", "holds"), [(4, None), (5, False)])
def test_a_coil_that_was_hardly_used_need_not_be_isolated(pulses, holds, bounds):
    flown = record()
    flown.request_ticks = [50, *range(100, 100 + 2 * pulses)]
    flown.request_coils = [2, *[2, 1] * pulses]
    row = FaultRow("planted", "", "none", unit="coil 2")
    assert checks.isolates_faulty_unit(row, flown, bounds)[0] is holds


def test_a_fault_of_the_sun_sensor_that_never_shows_is_not_yet_decided(bounds):
    row = FaultRow("planted", "", "sun_swapped", lasts_s=20.0, unit="sun sensor")
    flown = record()
    assert checks.isolates_faulty_unit(row, flown, bounds)[0] is False
    flown.lit[100:120] = [False] * 20
    assert checks.isolates_faulty_unit(row, flown, bounds) == (None, "the fault of sun sensor never shows")


LIGHT, SHADOW = (True,), (False,)


NAMED_ROWS = [row for row in ROWS if {"named", "named or doubted"} & {*row.expect}]


class TestAFaultThatShowedMustBeNamed:
    """Without any event nothing is named: that fails where the fault showed, and never passes."""

    def judged(self, bounds, row, lit):
        """The row on a flight in which all coils were fired and fsw reported nothing."""
        flown = FaultFlightRecord(1, onset=100, lit=list(lit) * 20_000, error_deg=[0.3] * 20_000 * len(lit))
        flown.lit_cells = [(1, 2, 3, 4, 5, 6) if one else () for one in flown.lit]
        flown.request_ticks = list(range(100, 20_000, 100))
        flown.request_coils = [tick // 100 % 3 for tick in flown.request_ticks]
        return checks.isolates_faulty_unit(row, flown, bounds)[0]

    @pytest.mark.parametrize(
        ("kind", "parameters", "unit", "in_light", "in_shadow"),
        [
            ("albedo", {"part": 0.0}, "sun sensor", None, False),
            ("albedo", {"part": 0.4}, "sun sensor", False, False),
            ("albedo", {}, "sun sensor", False, False),
            ("sun_frozen", {}, "sun sensor", False, False),
            ("extreme_codes", {"sun": 1.0}, "sun sensor", False, False),
            ("sun_swapped", {}, "sun sensor", False, None),
            ("cell_dead", {}, "cell 1", False, None),
            ("cell_stuck", {}, "cell 1", False, None),
            ("cell_stuck", {"percent": 90.0}, "cell 1", False, False),
            ("mag_swapped", {}, "magnetometer", False, False),
            ("coil_wired", {}, "coil 1", False, None),
        ],
    )
    @pytest.mark.parametrize("lasts_s", [600.0, inf])
    def test_where_its_kind_shows(self, bounds, kind, parameters, unit, in_light, in_shadow, lasts_s):
        row = FaultRow("planted", "", kind, parameters, lasts_s, unit=unit)
        assert self.judged(bounds, row, LIGHT) is in_light
        assert self.judged(bounds, row, SHADOW) is in_shadow

    @pytest.mark.parametrize(
        "row",
        [row for row in ROWS if {"named", "named or doubted"} & {*row.expect}],
        ids=lambda row: row.name,
    )
    def test_of_every_row(self, bounds, row):
        assert self.judged(bounds, row, (*LIGHT, *SHADOW)) is False
        for lit in (LIGHT, SHADOW):
            assert self.judged(bounds, row, lit) is not True


def test_a_fault_that_is_not_yet_decided_excuses_no_other(bounds):
    second = RowFault("sun_swapped", {}, inf, "sun sensor", 10.0)
    row = FaultRow("planted", "", "coil_wired", unit="coil 1", then=(second,))
    assert checks.isolates_faulty_unit(row, record(), bounds) == (False, "sun sensor is not isolated")
    named = isolated(130, Sensor.SUN_SENSOR)
    assert checks.isolates_faulty_unit(row, record(named), bounds)[0] is None


def test_a_fault_that_nothing_may_show_need_not_be_named_but_no_other_unit_may_be(bounds):
    second = RowFault("coil_wired", {}, inf, "coil 1", 10.0, shows=False)
    row = FaultRow("planted", "", "none", unit="magnetometer", then=(second,))
    first = isolated(130, Sensor.MAGNETOMETER)
    assert checks.isolates_faulty_unit(row, record(first), bounds)[0] is True
    assert (
        checks.isolates_faulty_unit(row, record(first, isolated(140, Sensor.SUN_SENSOR)), bounds)[0] is False
    )


def test_no_coil_need_be_isolated_once_a_faulty_sensor_makes_them_disagree(bounds):
    flown = record(ReportedEvent(110, Number.SENSORS_DISAGREE, 0))
    flown.request_ticks, flown.request_coils = list(range(101, 130)), [1] * 29
    coil = RowFault("coil_wired", {}, inf, "coil 1")
    row = FaultRow("planted", "", "none", unit="magnetometer", then=(coil,))
    assert checks.isolates_or_disputes_faulty_unit(row, flown, bounds)[0] is False, "nine before"
    flown.request_ticks = list(range(107, 136))
    assert checks.isolates_or_disputes_faulty_unit(row, flown, bounds)[0] is None, "three before"
    alone = FaultRow("planted", "", "none", unit="coil 1")
    assert checks.isolates_faulty_unit(alone, flown, bounds)[0] is False, "no sensor is faulty"


class TestUsedAgain:
    """A coil is brought back, fired once its fault has passed, and not isolated again."""

    ROW = FaultRow("planted", "", "coil_open", {"axis": 1.0}, unit="coil 1")
    NAMED, BACK = ReportedEvent(120, Number.COIL_FAULT, 201), ReportedEvent(250, Number.COIL_READMITTED, 201)

    def judged(self, bounds, *events, fired=((300, 1),)):
        flown = record(*events)
        flown.end = 200
        flown.request_ticks, flown.request_coils = [list(each) for each in zip(*fired, strict=True)]
        return isolation.uses_unit_again(self.ROW, flown, bounds)

    def test_it_is(self, bounds):
        assert self.judged(bounds, self.NAMED, self.BACK) == (True, "coil 1 fired 1 times")

    def test_brought_back_while_it_was_faulty_it_is_if_it_stays_in_use(self, bounds):
        early = replace(self.BACK, tick=150)
        assert self.judged(bounds, self.NAMED, early) == (True, "coil 1 fired 1 times")
        assert not self.judged(bounds, self.NAMED, early, fired=((199, 1),))[0], "not fired since"
        assert not self.judged(bounds, self.NAMED, early, replace(self.NAMED, tick=190))[0]

    def test_it_is_not_if_another_is_brought_back(self, bounds):
        other = replace(self.BACK, argument=301)
        assert self.judged(bounds, self.NAMED, other) == (False, "coil 1 is not brought back")

    @pytest.mark.parametrize("fired", [((240, 1), (300, 2)), ((250, 1),)])
    def test_nor_without_a_pulse_since(self, bounds, fired):
        assert not self.judged(bounds, self.NAMED, self.BACK, fired=fired)[0]

    def test_nor_isolated_again(self, bounds):
        again = replace(self.NAMED, tick=310)
        holds, finding = self.judged(bounds, self.NAMED, self.BACK, again)
        assert (holds, finding) == (False, "coil 1 fired 1 times, and isolated again")


@pytest.mark.parametrize(
    ("kind", "needs_light"), [("cell_dead", True), ("cell_scaled", True), ("cell_stuck", False)]
)
def test_a_cell_that_gives_too_little_shows_it_where_the_sun_shines_on_it(bounds, kind, needs_light):
    row = FaultRow("planted", "", kind, {"cell": 3.0}, inf, unit="cell 3")
    flown = record()
    flown.lit_cells = [(1, 2, 3)] * 100 + [(1, 2)] * (len(flown.lit) - 100)
    undecided = (None, "the fault of cell 3 never shows")
    assert (checks.isolates_faulty_unit(row, flown, bounds) == undecided) is needs_light
    flown.lit_cells[150] = (3,)
    assert checks.isolates_faulty_unit(row, flown, bounds) == (False, "cell 3 is not isolated")
