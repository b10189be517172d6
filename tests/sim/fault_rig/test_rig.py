"""Plant, boards and flight software in one process under faults."""

from random import Random

import pytest

from fsw.core.algebra.vector import dot
from fsw.core.events import Event as Number
from fsw.wire.messages import CoilStatus, PlantEnd
from sim.errors import HarnessError
from sim.fault_rig import currents
from sim.fault_rig.record import FaultFlightRecord, ReportedEvent
from sim.fault_rig.rig import Rig
from sim.fault_table import case, checks
from sim.fault_table.case import fly, prepare
from sim.fault_table.row import SCENARIO, FaultRow, RowFault, When
from sim.fault_table.rows.table import ROWS, choose_rows
from sim.faults.fault import Condition, Fault
from sim.faults.kinds import make
from sim.scenario.schema import flight_table

TICKS = 420


def nothing():
    return make("none", {}, Random(1))


def verdicts(result):
    return {outcome.check: outcome.verdict for outcome in result.outcomes}


def test_without_a_fault_it_is_the_flight_of_the_loop(flown):
    record = flown(nothing(), TICKS)
    assert record.request_ticks[0] in (100, 101, 102), "each coil reports in every third tick"
    assert len(record.request_ticks) == len(currents.pulses(record.coil_drives, 1)) == 4
    assert record.refused == 0
    assert record.crash is None


def test_a_record_lasts_from_the_first_fault_to_the_end_of_the_last(rig):
    bench = rig()
    bench.inject(nothing(), 5, 9)
    bench.inject(nothing(), 20, 30)
    assert (bench.record.onset, bench.record.end) == (5, 30)
    bench.inject(nothing(), 6, None)
    bench.inject(nothing(), 7, 8)
    assert (bench.record.onset, bench.record.end) == (5, None)


def test_the_faults_of_a_row_begin_one_after_the_other():
    wrong = RowFault("mag_bias", {"axis": 1.0, "nt": 9000.0}, 10.0, "magnetometer", after_s=40.0)
    row = FaultRow("planted", "", "sun_unseen", {}, 5.0, When.BOOT, then=(wrong,), watch_s=20.0)
    seen = []

    class Watched(Rig):
        def tick(self):
            super().tick()
            seen.append([type(fault).__name__ for fault in self.plant.active])

    case._fly_fault(row, 0, 1, Watched(*prepare(), 1), 6000.0)
    assert seen[:5] == [["SunBlindness"]] * 5
    assert seen[5:40] == [[]] * 35
    assert seen[40:50] == [["WrongFieldReading"]] * 10
    assert seen[50:] == [[]] * 20


def test_a_killed_fsw_ends_no_pulse_early_and_waits_a_full_back_off(flown):
    class FswKill(Fault):
        def condition(self, tick):
            return Condition.DEAD

    record = flown(FswKill(Random(1), {}), TICKS, first=102, end=110)
    first, second = currents.pulses(record.coil_drives, 1)[:2]
    assert first.start_s in (100, 101), "before the kill"
    assert first.end_s - first.start_s == 3
    assert record.boots == [0, 110]
    assert second.start_s >= 210


def test_what_a_stopped_fsw_answers_late_is_refused(flown):
    fault = make("stopped", {}, Random(1))
    record = flown(fault, 130, first=95, end=110)
    assert record.request_ticks == [110], "the request for tick 100 goes out in tick 110"
    assert record.refused == 1
    assert currents.pulses(record.coil_drives, 1) == []


def test_the_log_of_the_audit_has_the_frames_that_the_board_sent_not_those_received(flown):
    record = flown(make("corruption", {"part": 1.0}, Random(1)), 50)
    assert sum(entry.frame.can_id == CoilStatus.ID for entry in record.entries) == 50
    assert all(
        CoilStatus.decode(entry.frame.data).level == 0
        for entry in record.entries
        if entry.frame.can_id == CoilStatus.ID
    )


def test_an_exception_in_a_step_is_noted_and_ends_fsw(flown):
    class Poison(Fault):
        def upset(self, state):
            state.sent.clear()
            return state

    record = flown(Poison(Random(1), {}), 20, first=10, end=11)
    assert "tick 10" in record.crash


@pytest.mark.interpreted
def test_a_board_without_guards_is_found_out(rig, bounds, monkeypatch):
    monkeypatch.setattr("hil_stub.coils.guard.judge", lambda state, asked, tick, limits: None)
    monkeypatch.setattr("hil_stub.coils.guard.accept", take_unlocked)
    bench = rig()
    bench.inject(make("second_sender", {"frames": 1.0}, Random(3)), 5, None)
    for _ in range(60):
        bench.tick()
    record = bench.finish()
    row = FaultRow("planted", "", "none")
    holds, said = checks.keeps_limits(row, record, bounds)
    assert not holds
    assert said
    assert currents.violations(record.coil_drives, bounds.currents)


def take_unlocked(state, asked, limits):
    if asked.duration_ms <= 60000:
        state.coil, state.level, state.seq = asked.coil, asked.level, asked.seq
        state.remaining = limits.units(asked.duration_ms)


@pytest.mark.long
def test_the_same_case_is_the_same_flight():
    row = choose_rows(["loss-50"])[0]
    one, other = fly(row, 1, 2), fly(row, 1, 2)
    assert one.outcomes == other.outcomes
    timeless = [
        {name: value for name, value in result.measured.items() if "ms" not in name}
        for result in (one, other)
    ]
    assert timeless[0] == timeless[1]


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [
        "none",
        "corruption",
        "delay",
        "fsw-killed",
        "coil-board-restarts",
        "tick-back",
        "sync-forged-pair",
        "end-forged",
        "mag-nan-passing",
        "mag-twist",
        "clock-off",
        "mag-then-coil",
        "bit-flip",
    ],
)
@pytest.mark.requirement("REQ-FDIR-01", "REQ-FDIR-02")
@pytest.mark.slow
def test_a_sample_of_the_table_holds(name):
    result = fly(choose_rows([name])[0], 1, 2)
    assert not result.failed, result.outcomes


class TestForgery:
    """What the checks of forged SYNC, PLANT_END and TICK_DONE find."""

    @pytest.fixture
    def record(self):
        return FaultFlightRecord(1, onset=2, end=9)

    def test_a_few_ticks_may_go_unanswered_and_no_more(self, record, bounds):
        record.done = [False] * 5 + [True] + [False] * checks.MOST_UNANSWERED + [True]
        assert checks.keeps_answering(None, record, bounds)[0]
        record.done += [False] * (checks.MOST_UNANSWERED + 1)
        assert not checks.keeps_answering(None, record, bounds)[0]

    def test_a_restart_of_filter_or_plant_is_found(self, record, bounds):
        record.events = [
            ReportedEvent(1, Number.FILTER_RESTARTED, 1),
            ReportedEvent(5, Number.STRANGE_SYNC, 7),
        ]
        assert checks.estimate_continues(None, record, bounds)[0]
        record.events.append(ReportedEvent(5, Number.FILTER_RESTARTED, 2))
        assert not checks.estimate_continues(None, record, bounds)[0]
        record.events, record.restarts, record.requests_before = [], [5], [0]
        assert not checks.estimate_continues(None, record, bounds)[0]

    @pytest.mark.parametrize("number", [Number.STRANGE_SYNC, Number.PLANT_RESTARTED, Number.FALSE_END])
    def test_any_event_on_the_plant_is_a_report(self, record, bounds, number):
        record.events = [ReportedEvent(1, number, 0)]
        assert not checks.reports_forgery(None, record, bounds)[0]
        record.events = [ReportedEvent(2, number, 0)]
        assert checks.reports_forgery(None, record, bounds)[0]

    def test_a_request_soon_after_a_restart_is_found(self, record, bounds):
        record.restarts, record.requests_before, record.request_ticks = [50], [0], [149]
        assert not checks.waits_after_boot(None, record, bounds)[0]
        record.request_ticks = [150]
        assert checks.waits_after_boot(None, record, bounds)[0]

    def test_one_before_the_restart_in_the_same_tick_is_none(self, record, bounds):
        record.restarts, record.requests_before, record.request_ticks = [50], [1], [50]
        assert checks.waits_after_boot(None, record, bounds)[0]
        record.requests_before = [0]
        assert not checks.waits_after_boot(None, record, bounds)[0]

    def test_an_accepted_false_end_is_found(self, flown, bounds):
        class End(Fault):
            def strangers(self, tick):
                return [PlantEnd(tick).encode()]

        record = flown(End(Random(1), {}), 20, first=10, end=11)
        assert record.ended == 10
        assert not checks.answers_every_sync(None, record, bounds)[0]


def test_rows_have_names_of_their_own_and_known_checks():
    assert len({row.name for row in ROWS}) == len(ROWS)
    for row in ROWS:
        assert set(row.expect) <= set(checks.CHECKS)
        assert ("recovers" in row.expect) <= (not row.stays)


def test_an_unknown_row_is_a_sentence():
    with pytest.raises(HarnessError, match="--only nonsense"):
        choose_rows(["nonsense"])


def test_every_second_case_flies_a_satellite_of_its_own():
    cases = [[case.satellite_of(phase, seed) for seed in range(1, 6)] for phase in range(10)]
    drawn = [number for numbers in cases for number in numbers if number is not None]
    assert len(drawn) == len(set(drawn)) == 25
    assert {numbers.count(None) for numbers in cases} == {2, 3}
    assert {numbers.count(None) for numbers in zip(*cases, strict=True)} == {5}
    assert case.satellite_of(0, 1) is None, "what is flown once is the scenario itself"


def test_a_satellite_differs_from_its_table_and_the_row_has_the_last_word():
    nominal, scenario = prepare()[0], prepare(("sensors.magnetometer.bias_nt=[700.0, -50.0, 20.0]",), 7)[0]
    assert scenario.sensors.magnetometer.bias_nt == (700.0, -50.0, 20.0)
    assert scenario.body.inertia != nominal.body.inertia == flight_table(scenario).body.inertia
    assert scenario.coils.dipole_scale != nominal.coils.dipole_scale
    assert prepare((), 7)[0] != prepare((), 8)[0]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_every_row_can_be_flown(row):
    """Those of the usual scenario with a satellite of the population."""
    if row.scenario != SCENARIO:
        assert prepare(case.settings_of(row, 1), None, row.scenario)[0].name == row.scenario
        return
    scenario, _ = prepare(case.settings_of(row, 1), 7)
    assert scenario.body.inertia != prepare()[0].body.inertia


def test_a_fault_after_an_orbit_begins_after_an_orbit():
    row = FaultRow("planted", "", "sun_unseen", {}, 5.0, When.ORBIT, watch_s=10.0)
    for phase in (0, 3):
        record = case._fly_fault(row, phase, 1, Rig(*prepare(), 1), 77.0)
        assert (record.onset, record.end, record.ticks) == (77, 82, 92)


@pytest.mark.long
def test_phases_of_another_scenario_go_round_its_orbit():
    row = FaultRow("planted", "", "none", when=When.ORBIT, scenario="cubesat-cells")
    starts = [
        prepare(case.settings_of(row, phase), None, row.scenario)[0].orbit.u0_deg for phase in range(10)
    ]
    assert starts == pytest.approx([36.0 * phase for phase in range(10)])


@pytest.mark.long
def test_phases_go_round_the_orbit():
    row = FaultRow("planted", "", "none", when=When.ORBIT)
    starts = [prepare(case.settings_of(row, phase))[0].epoch_unix_s for phase in range(10)]
    assert starts[0] == prepare()[0].epoch_unix_s
    orbit_s = checks.bounds_of(prepare()[0]).orbit_s
    assert [start - starts[0] for start in starts] == pytest.approx(
        [phase * orbit_s / 10.0 for phase in range(10)], abs=5.0
    )


def test_phases_go_through_the_pulse():
    rng = Random(1)
    phases = [case.phase_s(When.PULSE, phase, rng) for phase in range(40)]
    assert {0.0, 1.0, 2.0, 3.0, 102.0} <= set(phases)
    assert all(0.0 <= phase <= case.CYCLE_S for phase in phases)


def test_the_record_says_on_which_cells_the_sun_shines():
    scenario, config = prepare(name="cubesat-cells")
    rig = Rig(scenario, config, 1)
    for _ in range(3):
        rig.tick()
    truth = rig.plant.truth()
    light = {
        cell: truth.lit * dot(normal, truth.sun_body)
        for cell, normal in enumerate(rig.record.cell_normals_body, 1)
    }
    assert len(light) == 6
    assert rig.record.lit_cells[-1]
    assert set(rig.record.lit_cells[-1]) == {cell for cell, one in light.items() if one > 0.2}
