"""The interface of the fault detection: its events, and what it does to estimate and attitude."""

from copy import deepcopy
from dataclasses import fields
from math import inf

import pytest
from gate_samples import measured
from with_values import with_values

from fsw.core.fdir import fdir
from fsw.core.fdir.coils.health import NONE_OLDER, CoilHealth
from fsw.core.fdir.coils.weak_test import NOTHING_OLDER, Older, PartSum
from fsw.core.fdir.faults import OPEN_PART, CoilFault, SensorFault
from fsw.core.fdir.fdir import Evidence, Health
from fsw.core.fdir.sensors.cells import CellWatch
from fsw.core.fdir.sensors.health import SensorHealth, Watch
from fsw.core.fdir.sensors.pair import Pair, Standing
from fsw.core.fdir.sensors.plausibility import Findings
from fsw.core.orbit.ephemeris import reference_at
from fsw.core.packing import copy_state

FROZEN, SILENT = SensorFault.FROZEN, SensorFault.SILENT
OPEN, WEAK = CoilFault.OPEN, CoilFault.WEAK
WEAK_PART = "the most that is weak"
PROVEN = Pair(Standing.TRUSTED, proof=12.0)


def sensors(field=0, sun=0, **changes):
    return Health(sensors=SensorHealth(Watch(fault=field), Watch(fault=sun), **changes))


def test_a_restarted_plant_leaves_faults_and_doubts_and_takes_the_proof():
    pair = Pair(Standing.TRUSTED, proof=12.0, doubt=3.0)
    health = Health(SensorHealth(Watch(FROZEN), pair=pair), CoilHealth((OPEN, 0, 0)))
    fdir.discard_proof(health)
    left = Pair(Standing.NEW, doubt=3.0)
    assert health == Health(SensorHealth(Watch(FROZEN), pair=left), CoilHealth((OPEN, 0, 0)))
    disputed = sensors(pair=Pair(Standing.DISPUTED))
    fdir.discard_proof(disputed)
    assert disputed.sensors.pair.standing is Standing.DISPUTED


class TestTrusted:
    """What the filter gets."""

    FINE = Findings(0, 0, None, None, False, False)

    def trusted(self, health, findings):
        """Whether field and Sun are."""
        sent = measured()
        fdir.judge_samples(sent, health, findings)
        return sent.field_trusted, sent.sun_trusted

    def test_all_that_nothing_speaks_against(self):
        assert self.trusted(Health(), self.FINE) == (True, True)

    @pytest.mark.parametrize(
        ("health", "findings", "left"),
        [
            (sensors(field=FROZEN), FINE, (False, True)),
            (sensors(sun=SILENT), FINE, (True, False)),
            (Health(), with_values(FINE, field_cause=FROZEN), (False, True)),
            (Health(), with_values(FINE, sun_cause=FROZEN), (True, False)),
            (sensors(pair=Pair(Standing.DISPUTED)), FINE, (True, False)),
            (sensors(pair=Pair(Standing.ON_TRIAL)), FINE, (True, True)),
        ],
    )
    def test_without_what_is_isolated_implausible_or_disputed(self, health, findings, left):
        assert self.trusted(health, findings) == left


def judgement_of(found):
    """A judgement of the sensors that finds this, whatever they have sent."""

    def judge_sensors(health, *of_this_tick):
        for name, value in vars_of(deepcopy(found)).items():
            setattr(health, name, value)

    return judge_sensors


def vars_of(state):
    return {field.name: getattr(state, field.name) for field in fields(state)}


class TestJudgement:
    @pytest.fixture
    def judged(self, make_world):
        """Health, estimator and attitude as judged in a sound flight with this health; the state before."""
        world = make_world()
        world.fly_until_valid()
        state, config = world.state, world.config
        reference = reference_at(state.ephemeris, state.tick, config.ephemeris)
        findings = fdir.examine(measured(), state.health, reference, config.fdir)
        used = fdir.Used(False, False, False)
        evidence = Evidence(state.tick, findings, state.coil, reference, used)

        def judge(health, estimator=state.estimator):
            health, estimator = copy_state(health), estimator.copy()
            attitude = fdir.judge(health, estimator, state.attitude, evidence, config.fdir)
            return (health, estimator, attitude), state

        return judge

    def test_a_healthy_flight_goes_on(self, judged):
        (_, estimator, attitude), state = judged(sensors(pair=PROVEN))
        assert attitude is state.attitude
        assert attitude.valid
        assert estimator.restarts == state.estimator.restarts

    @pytest.mark.parametrize(
        ("part", "proof", "valid"), [(0.5, 0.0, True), (0.6, 0.0, False), (0.6, 1.0, True)]
    )
    def test_over_half_against_a_coil_needs_an_estimate_that_is_proven(
        self, make_world, judged, part, proof, valid
    ):
        """A coil that is tried again has half against it, and costs no attitude in the shadow."""
        threshold = make_world().config.fdir.sensors.weights.threshold
        pair = with_values(PROVEN, proof=proof * threshold)
        shown = CoilHealth(older=(NOTHING_OLDER, Older(kept=part * threshold), NOTHING_OLDER))
        (_, _, attitude), _ = judged(Health(sensors(pair=pair).sensors, shown))
        assert attitude.valid is valid

    @pytest.mark.parametrize(
        "health",
        [
            Health(sensors(pair=PROVEN).sensors, CoilHealth(unrequested_ticks=9, stray_ma=40, stuck=True)),
            sensors(pair=Pair(Standing.NEW)),
            sensors(pair=Pair(Standing.DISPUTED)),
            sensors(pair=Pair(Standing.ON_TRIAL)),
            sensors(pair=with_values(PROVEN, blind_ticks=120)),
        ],
        ids=[
            "a current in an unknown coil",
            "an estimate that is not proven",
            "a disputed pair",
            "a pair on trial",
            "nothing taken for too long",
        ],
    )
    def test_an_attitude_is_not_valid_with(self, judged, health):
        (_, _, attitude), state = judged(health)
        assert attitude == state.attitude.invalid()

    def test_by_an_estimate_that_lagged_and_has_not_borne_it_out_yet_one_may_control(self, judged):
        (_, _, attitude), state = judged(sensors(pair=with_values(PROVEN, proof_required=0.1)))
        assert attitude == state.attitude.doubted()
        assert attitude.usable
        assert not attitude.valid

    @pytest.mark.interpreted
    def test_an_estimate_that_the_pair_eases_goes_on_not_valid_and_what_pulses_showed_is_forgotten(
        self, judged, monkeypatch
    ):
        eased = SensorHealth(pair=with_values(PROVEN, proof_required=5.0, easing=True, eased=True))
        monkeypatch.setattr(fdir.sensor_health, "judge_sensors", judgement_of(eased))
        older = Older(PartSum(2, 30.0, 9.0, 2.7), kept=1.0)
        (health, estimator, attitude), state = judged(
            Health(SensorHealth(pair=PROVEN), CoilHealth(older=(older, older, older)))
        )
        assert attitude == state.attitude.doubted()
        assert estimator.easings == state.estimator.easings + 1
        assert estimator.restarts == state.estimator.restarts
        assert health.coils.older == NONE_OLDER

    @pytest.mark.parametrize(
        ("inertia_percent", "field", "valid"), [(0.0, False, True), (10.0, False, False), (10.0, True, True)]
    )
    def test_what_a_stuck_coil_turns_unseen_is_not_valid_unless_its_inertia_is_exact(
        self, make_world, inertia_percent, field, valid
    ):
        world = make_world(flight={"uncertainty": {"inertia_percent": inertia_percent}})
        world.fly_until_valid()
        state, config = world.state, world.config
        reference = reference_at(state.ephemeris, state.tick, config.ephemeris)
        findings = fdir.examine(measured(), state.health, reference, config.fdir)
        stuck = CoilHealth(faults=(0, CoilFault.STUCK, 0), unrequested_ticks=90, stray_ma=40, stuck=True)
        evidence = Evidence(state.tick, findings, state.coil, reference, fdir.Used(field, True, False))
        health = Health(sensors(pair=deepcopy(PROVEN)).sensors, stuck)
        attitude = fdir.judge(health, state.estimator, state.attitude, evidence, config.fdir)
        assert attitude.valid is valid

    @pytest.mark.interpreted
    def test_what_the_filter_knows_of_a_cell_that_is_isolated_is_forgotten_once(self, judged, monkeypatch):
        """Whoever judges the sensors; of which cells, and how, is the cells' own."""
        named = [CellWatch(Watch(SensorFault.STRENGTH)), CellWatch()]
        forgotten = []
        monkeypatch.setattr(
            fdir.sensor_health, "judge_sensors", judgement_of(SensorHealth(pair=PROVEN, cells=named))
        )
        monkeypatch.setattr(
            fdir, "forget_isolated", lambda state, *change: (forgotten.append(change[:2]), state)[1]
        )
        (health, _, _), _ = judged(sensors(pair=PROVEN, cells=[CellWatch(), CellWatch()]))
        judged(health)
        assert forgotten == [((0, 0), named)]

    @pytest.mark.interpreted
    @pytest.mark.parametrize(
        "judgement",
        [
            SensorHealth(field=Watch(FROZEN), pair=PROVEN),
            SensorHealth(pair=Pair(Standing.DISPUTED, ended=True)),
        ],
        ids=["an isolated sensor", "a dispute"],
    )
    def test_what_pulses_showed_is_forgotten_with(self, judged, monkeypatch, judgement):
        older = Older(PartSum(2, 30.0, 9.0, 2.7), kept=1.0)
        shown = CoilHealth(nats=(1.0, 2.0, 3.0), older=(older, older, older))
        before = Health(SensorHealth(pair=PROVEN), shown)
        (health, _, _), _ = judged(before)
        assert health.coils == shown
        monkeypatch.setattr(fdir.sensor_health, "judge_sensors", judgement_of(judgement))
        (health, _, _), _ = judged(before)
        assert health.coils == with_values(shown, older=NONE_OLDER)

    @pytest.mark.interpreted
    @pytest.mark.parametrize(
        ("pair", "believed"),
        [
            (PROVEN, (WEAK_PART, WEAK_PART)),
            (with_values(PROVEN, proof_required=5.0), (OPEN_PART, 0.5)),
            (with_values(PROVEN, proof=0.0), (-inf, -inf)),
        ],
        ids=["proven", "lagged", "not proven"],
    )
    def test_what_is_believed_of_a_coil_while_the_estimate_is(
        self, make_world, judged, monkeypatch, pair, believed
    ):
        asked = []

        def judge_effect(health, view, reference, state, tick, parts, *others):
            asked.append((parts.by_pulses, parts.by_gain))

        monkeypatch.setattr(fdir.torques, "judge_effect", judge_effect)
        judged(sensors(pair=pair))
        weak_part = make_world().config.fdir.coils.weak.weak_part
        assert asked == [tuple(weak_part if part is WEAK_PART else part for part in believed)]

    @pytest.fixture
    def in_doubt(self, make_world, monkeypatch):
        """As ``judged``, while the time is in doubt: no sensor may be judged."""
        world = make_world()
        world.fly_until_valid()
        state, config = world.state, world.config
        reference = reference_at(state.ephemeris, state.tick, config.ephemeris)
        findings = fdir.examine(measured(), state.health, reference, config.fdir)
        used = fdir.Used(True, True, False)
        evidence = Evidence(state.tick, findings, state.coil, reference, used, settled=False)
        monkeypatch.setattr(fdir.sensor_health, "judge_sensors", None)

        def judge(health):
            health, estimator = copy_state(health), state.estimator.copy()
            attitude = fdir.judge(health, estimator, state.attitude, evidence, config.fdir)
            return (health, estimator, attitude), state

        return judge

    @pytest.mark.interpreted
    @pytest.mark.parametrize(
        ("before", "valid"),
        [
            (sensors(pair=PROVEN), True),
            (Health(), False),
            (
                Health(
                    sensors(pair=PROVEN).sensors, CoilHealth(unrequested_ticks=9, stray_ma=40, stuck=True)
                ),
                False,
            ),
        ],
        ids=["proven", "new", "stray current"],
    )
    def test_while_the_time_is_in_doubt_no_sensor_is_judged(self, in_doubt, before, valid):
        (health, estimator, attitude), state = in_doubt(before)
        assert (health.sensors.field, health.sensors.sun) == (before.sensors.field, before.sensors.sun)
        assert health.coils == before.coils
        assert attitude == with_values(state.attitude, valid=valid, usable=valid)
        assert estimator.estimate.trace is None

    @pytest.mark.interpreted
    def test_nor_does_what_is_taken_show_the_attitude(self, in_doubt, make_world):
        limit = make_world().config.fdir.sensors.weights.blind_ticks
        for blind_ticks, valid in ((limit - 1, True), (limit, False)):
            (health, _, attitude), _ = in_doubt(sensors(pair=with_values(PROVEN, blind_ticks=blind_ticks)))
            assert health.sensors.pair.blind_ticks == blind_ticks + 1
            assert attitude.valid is valid

    @pytest.mark.interpreted
    def test_enough_doubt_ends_the_filter(self, judged, monkeypatch):
        disputed = SensorHealth(pair=Pair(Standing.DISPUTED, ended=True))
        monkeypatch.setattr(fdir.sensor_health, "judge_sensors", judgement_of(disputed))
        (health, estimator, attitude), state = judged(Health())
        assert health.sensors == disputed
        assert (estimator.estimate, estimator.restarts) == (None, state.estimator.restarts + 1)
        assert not attitude.valid
        (_, again, _), _ = judged(Health(), estimator)
        assert again == estimator, "without an estimate nothing starts anew"
