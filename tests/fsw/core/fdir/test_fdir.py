"""The interface of the fault detection: its events, and what it does to estimate and attitude."""

import pytest

from fsw.core.events import Event, Happening
from fsw.core.fdir import fdir
from fsw.core.fdir.coil_health import CoilFault, CoilHealth
from fsw.core.fdir.fdir import Evidence, Health
from fsw.core.fdir.sensor_health import SensorHealth
from fsw.core.fdir.sensor_pair import Pair
from fsw.core.fdir.sensor_watch import SensorFault, Watch
from fsw.core.gate.readings import NOTHING
from fsw.core.orbit.ephemeris import reference_at

FROZEN, SILENT = SensorFault.FROZEN, SensorFault.SILENT
OPEN, WEAK = CoilFault.OPEN, CoilFault.WEAK


def sensors(field=0, sun=0, **changes):
    return Health(sensors=SensorHealth(Watch(fault=field), Watch(fault=sun), **changes))


def coils(*faults):
    return Health(coils=CoilHealth(faults=faults))


class TestHappenings:
    @pytest.mark.parametrize(
        ("before", "after", "event", "argument"),
        [
            (sensors(), sensors(field=FROZEN), Event.SENSOR_ISOLATED, 100 + FROZEN),
            (sensors(), sensors(sun=SILENT), Event.SENSOR_ISOLATED, 200 + SILENT),
            (sensors(field=SILENT), sensors(field=FROZEN), Event.SENSOR_ISOLATED, 100 + FROZEN),
            (sensors(field=FROZEN), sensors(), Event.SENSOR_READMITTED, 100 + FROZEN),
            (sensors(), sensors(pair=Pair(contradictory=True)), Event.SENSORS_DISAGREE, 0),
            (coils(0, 0, 0), coils(0, WEAK, 0), Event.COIL_FAULT, 200 + WEAK),
            (coils(0, WEAK, 0), coils(0, OPEN, 0), Event.COIL_FAULT, 200 + OPEN),
        ],
    )
    def test_each_change_is_an_event(self, before, after, event, argument):
        assert fdir.happenings(before, after) == [Happening(event, argument)]

    @pytest.mark.parametrize(
        ("before", "after"),
        [
            (sensors(field=FROZEN, sun=SILENT), sensors(field=FROZEN, sun=SILENT)),
            (sensors(pair=Pair(contradictory=True)), sensors(pair=Pair(contradictory=True))),
            (sensors(pair=Pair(contradictory=True)), sensors()),
            (coils(OPEN, 0, WEAK), coils(OPEN, 0, WEAK)),
            (coils(OPEN, 0, WEAK), coils(0, 0, 0)),
        ],
    )
    def test_what_lasts_and_what_the_ground_clears_is_none(self, before, after):
        assert fdir.happenings(before, after) == []

    def test_they_are_in_a_fixed_order(self):
        found = Health(
            SensorHealth(Watch(FROZEN), Watch(SILENT), Pair(contradictory=True)), CoilHealth((1, 2, 3))
        )
        assert fdir.happenings(Health(), found) == [
            (Event.SENSOR_ISOLATED, 100 + FROZEN),
            (Event.SENSOR_ISOLATED, 200 + SILENT),
            (Event.SENSORS_DISAGREE, 0),
            *((Event.COIL_FAULT, 100 * number + number) for number in (1, 2, 3)),
        ]


@pytest.mark.parametrize(("proof", "left"), [(-7, -7), (0, 0), (12, 0)])
def test_a_restarted_plant_leaves_faults_and_debts_and_takes_the_proof(proof, left):
    before = Health(SensorHealth(Watch(FROZEN), pair=Pair(3, True, proof)), CoilHealth((OPEN, 0, 0)))
    after = fdir.plant_restarted(before)
    assert after.sensors.pair == Pair(3, True, left)
    assert after._replace(sensors=after.sensors._replace(pair=before.sensors.pair)) == before


class TestJudgement:
    @pytest.fixture
    def judged(self, make_world):
        """Health, estimator and attitude as judged in a sound flight with this health; the state before."""
        world = make_world()
        world.fly(60)
        state, config = world.state, world.config
        reference = reference_at(state.ephemeris, state.tick, config.ephemeris)
        evidence = Evidence(state.tick, NOTHING, state.coil, reference, fdir.Used(False, False, False))

        def judge(health):
            return fdir.judge(health, state.estimator, state.attitude, evidence, config.fdir), state

        return judge

    def test_a_healthy_flight_goes_on(self, judged):
        (_, estimator, attitude), state = judged(Health())
        assert attitude is state.attitude
        assert attitude.valid
        assert estimator.restarts == state.estimator.restarts

    def test_an_attitude_is_not_valid_while_a_current_flows_in_an_unknown_coil(self, judged):
        stray = Health(coils=CoilHealth(strange_ticks=9, stray_ma=40, stuck=True))
        (_, _, attitude), state = judged(stray)
        assert attitude == state.attitude._replace(valid=False)

    def test_a_contradiction_before_the_proof_restarts_the_filter(self, judged, monkeypatch):
        doubted = SensorHealth(doubted=True)
        monkeypatch.setattr(fdir.sensor_health, "judge", lambda *of_this_tick: doubted)
        (health, estimator, attitude), state = judged(Health())
        assert health.sensors is doubted
        assert (estimator.estimate, estimator.restarts) == (None, state.estimator.restarts + 1)
        assert attitude is fdir.UNKNOWN
