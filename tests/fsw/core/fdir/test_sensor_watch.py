"""One sensor by itself: suspicion, a reading that stands still, silence, and readmission."""

from math import inf, nan, radians

import pytest

from fsw.core.fdir.sensor_pair import MISFIT, PairConfig
from fsw.core.fdir.sensor_watch import (
    AGAINST_ESTIMATE,
    DARK,
    FULL,
    SLIGHT,
    SensorFault,
    SensorHealthConfig,
    Watch,
    as_predicted,
    judge_sample,
    probe,
)

CONFIG = SensorHealthConfig(
    max_field_error_t=3e-6,
    max_norm_error=0.05,
    max_angle_error_rad=radians(5.0),
    field_noise_t=8e-7,
    sun_noise_rad=0.035,
    max_bias_t=2e-6,
    max_torque_nm=4e-7,
    frozen_ticks=12,
    silent_ticks=17,
    name_suspicion=FULL * 10,
    readmit_ticks=25,
    pair=PairConfig(report_ticks=10, prove_ticks=15, agree_ticks=100),
)
SAMPLE = (0.36, 0.48, 0.8)
MOVING = Watch()
"""The other sensor, whose samples differ."""
STRENGTH, REFUSED = SensorFault.STRENGTH, SensorFault.REFUSED


def differing(number):
    """Samples no two of which are alike."""
    return [(0.36, 0.48, 0.8 + 1e-6 * index) for index in range(number)]


def after(watch, samples, cause=0, weight=FULL, other=MOVING):
    for sample in samples:
        watch = judge_sample(watch, sample, other, cause, weight, CONFIG)
    return watch


class TestSuspicion:
    @pytest.mark.parametrize(("weight", "ticks"), [(FULL, 10), (SLIGHT, 15)])
    def test_it_isolates_when_it_is_large_enough(self, weight, ticks):
        almost = after(Watch(), differing(ticks - 1), STRENGTH, weight)
        assert (almost.fault, almost.cause) == (0, STRENGTH)
        assert after(almost, [SAMPLE], STRENGTH, weight).fault == STRENGTH

    def test_a_good_sample_takes_a_bad_one_back(self):
        suspected = after(Watch(), differing(2), STRENGTH)
        assert suspected.suspicion == 2 * FULL
        assert [after(suspected, differing(count)).suspicion for count in (1, 2, 3)] == [FULL, 0, 0]

    def test_two_slight_ones_are_more_than_a_good_sample_takes_back(self):
        suspected = after(Watch(), differing(2), REFUSED, SLIGHT)
        assert after(suspected, [SAMPLE]).suspicion == 2 * SLIGHT - FULL

    def test_bad_samples_among_as_many_good_ones_never_isolate(self):
        watch = Watch()
        for tick, sample in enumerate(differing(400)):
            watch = after(watch, [sample], STRENGTH if tick % 2 else 0)
            assert not watch.fault

    def test_the_latest_cause_is_the_fault(self):
        watch = after(after(Watch(), differing(9), STRENGTH), [SAMPLE], REFUSED)
        assert (watch.fault, watch.suspicion) == (REFUSED, 0)

    def test_a_fault_is_not_replaced_by_another(self):
        assert after(Watch(fault=REFUSED), differing(40), STRENGTH).fault == REFUSED


class TestStandingStill:
    def test_it_is_a_fault_after_some_ticks_not_before(self):
        almost = after(Watch(), [SAMPLE] * CONFIG.frozen_ticks)
        assert (almost.fault, almost.same) == (0, CONFIG.frozen_ticks - 1)
        assert after(almost, [SAMPLE]).fault == SensorFault.FROZEN

    def test_a_sample_that_moves_starts_the_count_anew(self):
        for sample in differing(20):
            watch = after(Watch(sample=sample), [sample] * (CONFIG.frozen_ticks - 1))
            assert not watch.fault
            assert after(watch, [(0.0, 0.6, 0.8)]).same == 0

    @pytest.mark.parametrize(("still", "fault"), [(5, SensorFault.FROZEN), (6, 0)])
    def test_it_is_none_while_the_other_sensor_stands_still_too(self, still, fault):
        """As before a stimulus that does not move: for more than half of the time."""
        assert after(Watch(), [SAMPLE] * 13, other=Watch(same=still)).fault == fault

    def test_a_sun_sensor_without_a_sun_does_not_stand_still(self):
        assert after(Watch(), [DARK] * 100) == Watch(sample=DARK)


class TestSilence:
    def test_it_is_a_fault_after_some_ticks_not_before(self):
        almost = after(Watch(), [None] * (CONFIG.silent_ticks - 1))
        assert (almost.fault, almost.missing) == (0, CONFIG.silent_ticks - 1)
        assert after(almost, [None]).fault == SensorFault.SILENT

    def test_one_sample_ends_it(self):
        watch = after(Watch(), [None] * (CONFIG.silent_ticks - 1))
        assert after(watch, [SAMPLE, *[None] * (CONFIG.silent_ticks - 1)]).fault == 0

    def test_it_does_not_take_back_suspicion(self):
        suspected = after(Watch(), differing(4), STRENGTH)
        assert after(suspected, [None] * 5) == suspected._replace(missing=5)

    def test_it_does_not_replace_a_fault(self):
        assert after(Watch(fault=REFUSED), [None] * 40).fault == REFUSED


class TestReadmission:
    ISOLATED = Watch(fault=REFUSED, sample=SAMPLE)

    def probed(self, ticks, watch=ISOLATED, fits=True, agree=True):
        contradicts = False
        for _ in range(ticks):
            watch, contradicts = probe(watch, fits, agree, CONFIG)
        return watch, contradicts

    def test_samples_as_predicted_bring_it_back(self):
        almost, _ = self.probed(CONFIG.readmit_ticks - 1, agree=False)
        assert almost.fault == REFUSED
        assert self.probed(1, almost, agree=False) == (Watch(sample=SAMPLE), False)

    def test_one_that_is_not_undoes_many(self):
        watch, _ = self.probed(CONFIG.readmit_ticks - 1)
        assert self.probed(1, watch, fits=False)[0].good == CONFIG.readmit_ticks - 1 - MISFIT
        assert self.probed(1, self.probed(1)[0], fits=False)[0].good == 0

    def test_both_sensors_that_agree_for_much_longer_contradict_the_estimate(self):
        almost, _ = self.probed(AGAINST_ESTIMATE * CONFIG.readmit_ticks - 1, fits=False)
        assert almost.fault == REFUSED
        assert self.probed(1, almost, fits=False) == (Watch(sample=SAMPLE), True)

    def test_a_tick_in_which_they_disagree_undoes_many(self):
        watch, _ = self.probed(50, fits=False)
        assert self.probed(1, watch, fits=False, agree=False)[0].agreed == 50 - MISFIT

    def test_a_sample_that_stands_still_is_not_good(self):
        watch, contradicts = self.probed(500, self.ISOLATED._replace(same=1))
        assert (watch.fault, contradicts) == (REFUSED, False)


class TestPrediction:
    NOISE, SIGMA3_RAD = 0.01, 0.02

    @pytest.mark.parametrize(
        ("off", "fits"), [(0.0, True), (0.0499, True), (0.0501, False), (nan, False), (inf, False)]
    )
    def test_a_sample_may_be_off_by_noise_and_by_the_error_of_the_estimate(self, off, fits):
        """The predicted vector is two long: three deviations of its direction move it by twice as much."""
        sample = (2.0, off, 0.0)
        assert as_predicted(sample, not fits, (2.0, 0.0, 0.0), self.NOISE, self.SIGMA3_RAD) is fits

    @pytest.mark.parametrize("agree", [True, False])
    def test_without_an_estimate_the_other_sensor_decides(self, agree):
        assert as_predicted(SAMPLE, agree, None, self.NOISE, self.SIGMA3_RAD) is agree
