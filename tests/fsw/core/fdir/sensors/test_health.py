"""Which sensor: what the filter refuses counts against one alone, and what it predicts clears it."""

from copy import deepcopy
from functools import partial

import numpy as np
import pytest
from cell_samples import Q_BODY_FROM_ECI, REFERENCE, cell_filter
from filter_steps import plain_filter
from with_values import with_values

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.algebra.vector import add, sub
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.update import CellsUsed
from fsw.core.estimation.estimator import Used
from fsw.core.fdir.evidence import weights
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.credibility import credibility_config
from fsw.core.fdir.sensors.health import SensorConfig, SensorHealth, is_suspected, judge_sensors
from fsw.core.fdir.sensors.pair import Pair, Standing
from fsw.core.fdir.sensors.plausibility import Findings
from fsw.core.fdir.sensors.watch import Watch

MEKF = plain_filter((1.02, 1.85, 1.95), attitude_sigma_rad=0.002)
WEIGHTS = weights(40.0, 1.0)
CONFIG = SensorConfig(WEIGHTS, credibility_config(MEKF), MEKF)
ESTIMATE = with_values(
    mekf.start(normalise((0.6, -0.4, 0.5, 0.3)), (0.0, 0.0, 0.0), MEKF), nis=5.0, numbers=6
)
TRUSTED = SensorHealth(pair=Pair(Standing.TRUSTED, proof=WEIGHTS.threshold))
FIELD, SUN, TOOK_BOTH = Used(True, False, False), Used(False, True, False), Used(True, True, False)
NEITHER = Used(False, False, False)


MODELLED = REFERENCE.replace(sun_eci=(0.6, 0.0, 0.8), b_rate_eci_tps=(2e-6, 0.0, -1e-6))
"""Field and Sun of every tick."""
B, S = (rotate(ESTIMATE.q_body_from_eci, v) for v in (MODELLED.b_eci_t, MODELLED.sun_eci))
SEEN = Findings(0, 0, B, S, True, False)


def after(health, used, ticks=1, findings=SEEN, estimate=ESTIMATE):
    """A copy of the health after these ticks."""
    health = deepcopy(health)
    for _ in range(ticks):
        judge_sensors(health, findings, used, estimate, MODELLED, CONFIG)
    return health


def faults(health):
    return health.field.fault, health.sun.fault


@pytest.mark.requirement("REQ-SENSOR-04")
class TestRefused:
    def test_the_sensor_that_the_filter_refuses_while_it_takes_the_other(self):
        assert faults(after(TRUSTED, SUN, 28)) == (0, 0)
        assert faults(after(TRUSTED, SUN, 29)) == (SensorFault.REFUSED, 0)
        assert faults(after(TRUSTED, FIELD, 29)) == (0, SensorFault.REFUSED)

    def test_the_magnetometer_alone_in_eclipse_but_not_the_sun_sensor_alone(self):
        dark = with_values(SEEN, sun=None, pair=False)
        assert faults(after(TRUSTED, NEITHER, 29, dark)) == (SensorFault.REFUSED, 0)
        blanked = with_values(SEEN, field=None, pair=False)
        assert faults(after(TRUSTED, NEITHER, 60, blanked)) == (0, 0)

    @pytest.mark.parametrize("standing", [Standing.NEW, Standing.ON_TRIAL])
    def test_a_filter_that_is_not_proven_accuses_nobody(self, standing):
        young = SensorHealth(pair=Pair(standing))
        assert faults(after(young, SUN, 100)) == (0, 0)

    def test_who_is_wrong_of_two_that_are_refused_is_not_known(self):
        begun = after(TRUSTED, SUN, 10)
        both = after(begun, NEITHER, 100)
        assert faults(both) == (0, 0)
        assert (both.field.nats, both.sun.nats) == (begun.field.nats, 0.0)

    @pytest.mark.parametrize("used", [SUN, FIELD])
    @pytest.mark.parametrize(("sigma_rad", "judged"), [(0.01, True), (0.055, False), (0.3, False)])
    def test_nothing_that_an_attitude_too_uncertain_for_linear_equations_refuses(
        self, used, sigma_rad, judged
    ):
        covariance = ESTIMATE.covariance.copy()
        covariance[0:3, 0:3] = sigma_rad**2 * np.eye(3)
        health = after(TRUSTED, used, 100, estimate=with_values(ESTIMATE, covariance=covariance))
        assert any(faults(health)) == judged

    def test_half_of_the_samples_isolate_nothing(self):
        health = TRUSTED
        for _ in range(400):
            health = after(after(health, SUN), TOOK_BOTH)
        assert faults(health) == (0, 0)


@pytest.mark.parametrize(
    ("cells", "fault"),
    [
        (CellsUsed(taken=(), refused=()), 0),
        (CellsUsed(taken=(), refused=(1,)), SensorFault.REFUSED),
    ],
    ids=["that the filter left out", "that it refused"],
)
def test_cells_speak_against_their_board_where_the_filter_refused_them(cells, fault):
    mekf_with_cells = cell_filter()
    config = SensorConfig(WEIGHTS, credibility_config(mekf_with_cells), mekf_with_cells)
    estimate = with_values(mekf.start(Q_BODY_FROM_ECI, (0.0, 0.0, 0.0), mekf_with_cells), nis=3.0, numbers=3)
    covariance = estimate.covariance.copy()
    covariance[0:3, 0:3] = 0.01**2 * np.eye(3)
    estimate = with_values(estimate, covariance=covariance)
    reference, used = REFERENCE, with_values(FIELD, cells=cells)
    field, sun = (rotate(Q_BODY_FROM_ECI, one) for one in (reference.b_eci_t, reference.sun_eci))
    seen, health = Findings(0, 0, field, sun, True, False, currents=(0.1,) * 6), deepcopy(TRUSTED)
    for _ in range(29):
        judge_sensors(health, seen, used, estimate, reference, config)
    assert faults(health) == (0, fault)


@pytest.mark.parametrize(
    "findings",
    [
        with_values(SEEN, field_cause=SensorFault.SILENT, sun_cause=SensorFault.SILENT, field=None, sun=None),
        with_values(SEEN, field_cause=SensorFault.STRENGTH, sun_cause=SensorFault.UNLIT),
    ],
    ids=["the bus loses both", "the clock is wrong"],
)
def test_what_speaks_against_both_at_once_speaks_against_neither(findings):
    seen = with_values(findings, pair=False)
    assert faults(after(TRUSTED, NEITHER, 300, seen)) == (0, 0)
    dead = with_values(TRUSTED, sun=Watch(SensorFault.SILENT))
    assert faults(after(dead, NEITHER, 300, seen))[0] == findings.field_cause, "of one that is left it does"


def test_a_check_isolates_though_no_filter_is_proven():
    strong = with_values(SEEN, field_cause=SensorFault.STRENGTH, pair=False)
    assert faults(after(SensorHealth(), SUN, 29, strong)) == (SensorFault.STRENGTH, 0)
    assert is_suspected(after(SensorHealth(), SUN, 1, strong))


@pytest.mark.parametrize(
    ("findings", "named"),
    [
        (with_values(SEEN, field_cause=SensorFault.STRENGTH, pair=False), (SensorFault.STRENGTH, 0)),
        (with_values(SEEN, sun_cause=SensorFault.STRENGTH, pair=False), (0, SensorFault.STRENGTH)),
    ],
)
def test_a_check_isolates_though_a_filter_that_is_not_proven_refuses_the_other(findings, named):
    """Which may be the estimate's fault: against the other, in use, nothing counts, nor for it."""
    begun = SensorHealth(field=Watch(nats=1.0), sun=Watch(nats=1.0))
    refused = after(begun, NEITHER, 25, findings)
    assert faults(refused) == (0, 0)
    assert {refused.field.nats, refused.sun.nats} == {13.5, 1.0}
    assert faults(after(begun, NEITHER, 29, findings)) == named
    assert faults(after(begun, NEITHER, 29)) == (0, 0), "without a check it is not known who is wrong"


@pytest.mark.requirement("REQ-SENSOR-05")
def test_silence_weighs_half_since_the_bus_may_be_the_cause():
    silent = with_values(SEEN, sun_cause=SensorFault.SILENT, sun=None, pair=False)
    assert faults(after(TRUSTED, FIELD, 57, silent)) == (0, 0)
    assert faults(after(TRUSTED, FIELD, 58, silent)) == (0, SensorFault.SILENT)


@pytest.mark.requirement("REQ-SENSOR-06")
class TestReadmitted:
    FIELD_OUT = with_values(TRUSTED, field=Watch(SensorFault.STRENGTH))
    SUN_OUT = with_values(TRUSTED, sun=Watch(SensorFault.REFUSED))

    @pytest.mark.parametrize(("health", "used"), [(FIELD_OUT, SUN), (SUN_OUT, FIELD)])
    def test_once_it_is_for_long_what_the_estimate_predicts(self, health, used):
        assert any(faults(after(health, used, 128)))
        back = after(health, used, 129)
        assert faults(back) == (0, 0)
        assert not back.pair.ended

    def test_not_while_it_is_off_by_more_than_the_gate_allows(self):
        for step, ticks in ((6e-7, 129), (1.2e-6, 1000)):
            moved = with_values(SEEN, field=add(B, (step, 0.0, 0.0)))
            assert faults(after(self.FIELD_OUT, SUN, ticks, moved)) == (
                (0, 0) if step < 1e-6 else (SensorFault.STRENGTH, 0)
            )

    def test_by_the_field_where_the_satellite_was_when_the_sample_was_taken(self):
        """As the filter compares it, whose samples are a second old here; the field of now is another."""
        old = with_values(ESTIMATE, parameters=with_values(ESTIMATE.parameters, delay_s=(1.0, 0.0)))
        b_then = rotate(old.q_body_from_eci, sub(MODELLED.b_eci_t, MODELLED.b_rate_eci_tps))
        then = with_values(SEEN, field=b_then)
        assert faults(after(self.FIELD_OUT, SUN, 129, then, old)) == (0, 0)
        assert faults(after(self.FIELD_OUT, SUN, 1000, SEEN, old)) == (SensorFault.STRENGTH, 0)
        assert faults(after(self.FIELD_OUT, SUN, 1000, then)) == (SensorFault.STRENGTH, 0)

    def test_not_by_an_estimate_that_is_less_certain_than_the_sensor(self):
        vague = with_values(ESTIMATE, covariance=1000.0 * np.asarray(ESTIMATE.covariance))
        fly = partial(after, self.SUN_OUT, FIELD, estimate=vague)
        assert fly(ticks=400).sun.nats == 0.0
        assert fly(ticks=400).pair.accord > 0.0

    def test_what_an_estimate_has_shown_counts_when_it_can_tell_no_longer(self):
        vague = with_values(ESTIMATE, covariance=1000.0 * np.asarray(ESTIMATE.covariance))
        half = after(self.SUN_OUT, FIELD, 64)
        assert faults(after(self.SUN_OUT, FIELD, 300, estimate=vague)) == (0, SensorFault.REFUSED)
        back = after(half, FIELD, 300, estimate=vague)
        assert faults(back) == (0, 0)

    def test_then_by_agreeing_with_the_other_for_longer_and_the_filter_is_tried_anew(self):
        lost = after(self.SUN_OUT, NEITHER, 510, estimate=None)
        assert faults(lost) == (0, SensorFault.REFUSED)
        back = after(self.SUN_OUT, NEITHER, 520, estimate=None)
        assert faults(back) == (0, 0)
        assert back.pair.standing is Standing.ON_TRIAL
